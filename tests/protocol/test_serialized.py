"""Binary frames of fibws.v1."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import OperationError
from fibws.protocol.serialized import (
    MOST_PUBLISHERS,
    deliver_head,
    publish_head,
    read_delivery,
    read_publish,
)

MESSAGE = b"\x05\x00\x00\x00"


def test_frames_have_the_documented_bytes() -> None:
    assert publish_head(258).hex() == "0102010000"
    assert publish_head(1, "/ä").hex() == "0201000000" + "0300" + "2fc3a4"
    assert deliver_head(258, 1).hex() == "0102010000" + "0100000000000000"
    assert deliver_head(1, 2, b"{}").hex() == "0201000000" + "0200000000000000" + "0200" + "7b7d"


@given(
    st.integers(0, MOST_PUBLISHERS - 1), st.none() | st.text(min_size=1, max_size=9), st.binary()
)
def test_published_message_is_read_back(publisher: int, node: str | None, message: bytes) -> None:
    try:
        frame = publish_head(publisher, node) + message
    except UnicodeEncodeError:
        return
    for data in (frame, bytearray(frame)):
        read = read_publish(data)
        assert (read.publisher, read.node, bytes(read.message)) == (publisher, node, message)


@given(st.integers(0, 2**32 - 1), st.integers(0, 2**64 - 1), st.binary(), st.binary())
def test_delivered_message_is_read_back(
    topic: int, received: int, header: bytes, message: bytes
) -> None:
    frame = deliver_head(topic, received, header) + message
    for data in (frame, bytearray(frame)):
        read = read_delivery(data)
        assert (read.topic, read.received, read.header) == (topic, received, header)
        assert bytes(read.message) == message


def test_message_is_a_view_of_the_frame() -> None:
    frame = deliver_head(1, 2) + MESSAGE
    assert read_delivery(frame).message.obj is frame
    frame = publish_head(1, "/node") + MESSAGE
    assert read_publish(frame).message.obj is frame


PUBLISHED = [publish_head(1), publish_head(1, "/node")]
DELIVERED = [deliver_head(1, 2), deliver_head(1, 2, b'{"callerid":"/node"}')]


@pytest.mark.parametrize("head", PUBLISHED)
def test_published_frame_that_is_too_short_is_refused(head: bytes) -> None:
    assert bytes(read_publish(head).message) == b""
    for size in range(1, len(head)):
        with pytest.raises(OperationError, match=f"invalid binary frame: {size} bytes are too few"):
            read_publish(head[:size])


@pytest.mark.parametrize("head", DELIVERED)
def test_delivered_frame_that_is_too_short_is_refused(head: bytes) -> None:
    assert bytes(read_delivery(head).message) == b""
    for size in range(1, len(head)):
        with pytest.raises(OperationError, match=f"invalid binary frame: {size} bytes are too few"):
            read_delivery(head[:size])


@pytest.mark.parametrize(("frame", "kind"), [(b"", "None"), (b"\x00abc", "0"), (b"\x04", "4")])
def test_frame_of_an_unknown_kind_is_refused(frame: bytes, kind: str) -> None:
    for read in (read_publish, read_delivery):
        with pytest.raises(OperationError, match=f"kind must be 1, 2 or 3, got {kind}"):
            read(frame)


def test_name_that_is_not_utf8_is_refused() -> None:
    with pytest.raises(OperationError, match="the node's name is not UTF-8"):
        read_publish(publish_head(1, "/n").replace(b"/n", b"\xff\xfe") + MESSAGE)
