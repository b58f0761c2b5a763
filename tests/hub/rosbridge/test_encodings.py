"""Encodings of publications as frames."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable
from struct import pack, unpack
from typing import Any

import cbor2
import pytest
from protocol.png_reader import read_text

from fibws.errors import OperationError
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Topic
from fibws.hub.graph.types import MessageType, Types
from fibws.hub.rosbridge.encodings import COMPRESSIONS, PLAIN, EncodeFrame, Encoding
from fibws.interfaces import Interfaces
from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import Fragment, Subscribe

from ..fakes import BINARY, INT32, NANOSECONDS, TEXT, frames

TYPES = Types(Interfaces(), lambda: NANOSECONDS, strict=False)
NUMBER = TYPES.message(INT32)
PUBLISH = {"op": "publish", "topic": "/a", "msg": {"data": 5}}


def publication(
    message: dict[str, Any] | None = None, type_: MessageType = NUMBER, header: bytes = b""
) -> Publication:
    return Publication(type_, "/talker", header, NANOSECONDS, message or {"data": 5})


def encoder(encoding: Encoding, spelling: str = "/a") -> EncodeFrame:
    return encoding.for_topic(Topic("/a"), spelling)


def framed(encoding: Encoding, message: dict[str, Any] | None = None) -> list[tuple[int, bytes]]:
    return list(frames(encoder(encoding)(publication(message))))


def reassembled(found: list[tuple[int, bytes]], size: int) -> tuple[bytes, list[Fragment]]:
    """Return the text that fragments of at most ``size`` characters make up, and the fragments."""
    assert {first for first, _ in found} == {TEXT}
    fields = [json.loads(payload) for _, payload in found]
    assert {each.pop("op") for each in fields} == {"fragment"}
    fragments = [Fragment(**each) for each in fields]
    assert all(0 < len(each.data) <= size for each in fragments)
    assert all(type(each.id) is str and each.id for each in fragments)
    assert [each.num for each in fragments] == list(range(fragments[0].total))
    reassembly = Reassembly(max_size=10**7)
    *missing, text = (reassembly.add(each, 0) for each in fragments)
    assert text is not None and set(missing) <= {None}
    return text.encode(), fragments


# Which encoding requests come to.


@pytest.mark.parametrize(
    ("asked", "encoding"),
    [
        ([{}], PLAIN),
        ([{"compression": "none"}], PLAIN),
        ([{"compression": "png"}], Encoding("png")),
        ([{"compression": "cbor"}], Encoding("cbor")),
        ([{"compression": "cbor-raw"}], Encoding("cbor-raw")),
        ([{}, {"compression": "png"}], Encoding("png")),
        ([{"compression": "cbor"}, {"compression": "png"}, {}], Encoding("cbor")),
        ([{"compression": "cbor"}, {"compression": "cbor-raw"}], Encoding("cbor-raw")),
        ([{"compression": "ros1"}, {"compression": "cbor-raw"}], Encoding("ros1")),
        ([{"compression": "ros1", "fragment_size": 9}], Encoding("ros1")),
        ([{"compression": "ros1"}, {"headers": True}], Encoding("ros1", None, True)),
        ([{"fragment_size": 100}], Encoding("none", 100)),
        ([{"fragment_size": 100}, {"fragment_size": 10}, {}], Encoding("none", 10)),
        ([{"fragment_size": 100}, {"compression": "png"}], Encoding("png", 100)),
        ([{"fragment_size": 100, "compression": "cbor"}], Encoding("cbor")),
        ([{"fragment_size": 100}, {"compression": "cbor-raw"}], Encoding("cbor-raw")),
        ([{"fragment_size": 2147483647}], Encoding("none", 2147483647)),
        ([{"headers": False}], PLAIN),
        ([{"headers": True}], Encoding(headers=True)),
        ([{"headers": True}, {}], Encoding(headers=True)),
        ([{"headers": True, "fragment_size": 100}, {}], Encoding("none", 100, True)),
        ([{"headers": True, "compression": "png"}], Encoding("png")),
        ([{"headers": True}, {"compression": "cbor"}], Encoding("cbor")),
        ([{"int64": "string"}, {}], Encoding(strings=True)),
        ([{"int64": "string"}, {"headers": True}], Encoding(headers=True, strings=True)),
        ([{"int64": "string", "fragment_size": 9}], Encoding("none", 9, strings=True)),
        ([{"int64": "string", "compression": "png"}], Encoding("png")),
        ([{"int64": "string"}, {"compression": "cbor"}], Encoding("cbor")),
    ],
)
def test_merged_requests_get_the_strongest_compression_and_smallest_fragments(
    asked: list[dict[str, Any]], encoding: Encoding
) -> None:
    for requests in (asked, asked[::-1]):
        assert Encoding.merged([Subscribe(topic="/a", **each) for each in requests]) == encoding


# One frame.


def test_plain_encoding_is_json() -> None:
    assert framed(PLAIN) == [(TEXT, b'{"op":"publish","topic":"/a","msg":{"data":5}}')]


def test_header_follows_the_message_on_request() -> None:
    one = publication(header=b'{"callerid":"/talker"}')
    text = b'{"op":"publish","topic":"/a","msg":{"data":5},"header":{"callerid":"/talker"}}'
    assert list(frames(encoder(Encoding(headers=True))(one))) == [(TEXT, text)]
    pieces = list(frames(encoder(Encoding("none", 30, True))(one)))
    assert reassembled(pieces, 30)[0] == text
    assert list(frames(encoder(PLAIN)(one))) == framed(PLAIN)


@pytest.mark.parametrize("size", [0, 50, 100, 70_000])
@pytest.mark.parametrize("compression", ["none", "png", "cbor"])
def test_messages_of_any_size_are_encoded(compression: str, size: int) -> None:
    message = {"data": "x" * size}
    [(first, payload)] = framed(Encoding(compression), message)
    if compression == "cbor":
        # The message has no int32 in it, but that is not the encoder's to judge.
        assert (first, cbor2.loads(payload)["msg"]) == (BINARY, message)
        return
    assert first == TEXT
    operation = json.loads(payload)
    if compression == "png":
        assert operation.keys() == {"op", "data"}
        assert operation["op"] == "png"
        operation = json.loads(read_text(operation["data"]))
    assert operation == {**PUBLISH, "msg": message}


def test_cbor_is_a_map_in_a_binary_frame() -> None:
    [(first, payload)] = framed(Encoding("cbor"))
    assert (first, cbor2.loads(payload)) == (BINARY, PUBLISH)
    assert list(cbor2.loads(payload)) == ["op", "topic", "msg"]


def test_cbor_has_typed_arrays_and_byte_strings() -> None:
    type_ = TYPES.message("sensor_msgs/Image")
    message = type_.validate({"header": {"stamp": {"secs": 1}}, "data": [1, 2, 3]})
    frame = encoder(Encoding("cbor"))(publication(message, type_))
    [(_, payload)] = frames(frame)
    assert cbor2.loads(payload)["msg"]["data"] == b"\1\2\3"
    type_ = TYPES.message("geometry_msgs/PoseWithCovariance")
    message = type_.validate({"covariance": [0.5] * 36})
    [(_, payload)] = frames(encoder(Encoding("cbor"))(publication(message, type_)))
    found = cbor2.loads(payload)["msg"]["covariance"]
    assert (found.tag, found.value) == (86, pack("<36d", *[0.5] * 36))


def test_cbor_keeps_nan_and_infinity() -> None:
    type_ = TYPES.message("std_msgs/Float64MultiArray")
    message = type_.validate({"data": [None, float("nan"), float("inf"), 0.5]})
    [(_, payload)] = frames(encoder(Encoding("cbor"))(publication(message, type_)))
    found = cbor2.loads(payload)["msg"]["data"]
    numbers = unpack("<4d", found.value)
    assert (found.tag, numbers[2:]) == (86, (float("inf"), 0.5))
    assert all(math.isnan(each) for each in numbers[:2])


def test_cbor_raw_is_the_receive_time_and_the_serialized_message() -> None:
    [(first, payload)] = framed(Encoding("cbor-raw"))
    assert first == BINARY
    secs, nsecs = divmod(NANOSECONDS, 10**9)
    raw = {"secs": secs, "nsecs": nsecs, "bytes": pack("<i", 5)}
    assert cbor2.loads(payload) == {"op": "publish", "topic": "/a", "msg": raw}


def test_cbor_raw_of_an_unknown_type_is_refused() -> None:
    frame = encoder(Encoding("cbor-raw"))
    with pytest.raises(OperationError, match="definition of my_msgs/Thing"):
        frame(publication({"any": 1}, TYPES.message("my_msgs/Thing")))


@pytest.mark.parametrize("compression", ["none", "png"])
def test_nan_and_infinity_are_null_in_json(compression: str) -> None:
    [(_, payload)] = framed(Encoding(compression), {"data": [float("nan"), float("-inf")]})
    operation = json.loads(payload)
    if compression == "png":
        operation = json.loads(read_text(operation["data"]))
    assert operation["msg"] == {"data": [None, None]}


@pytest.mark.parametrize("compression", ["none", "png", "cbor", "cbor-raw"])
@pytest.mark.parametrize("spelling", ["/a", "a", "~a/b_1"])
def test_frame_has_the_subscribers_spelling(compression: str, spelling: str) -> None:
    [(first, payload)] = frames(encoder(Encoding(compression), spelling)(publication()))
    operation = cbor2.loads(payload) if first == BINARY else json.loads(payload)
    if compression == "png":
        operation = json.loads(read_text(operation["data"]))
    assert operation["topic"] == spelling


# Pieces.


@pytest.mark.parametrize("compression", ["none", "png"])
@pytest.mark.parametrize("size", [1, 7, 30])
def test_long_text_is_fragmented(compression: str, size: int) -> None:
    message = {"data": "\N{ROBOT FACE}ä\n" * 50}
    text, fragments = reassembled(framed(Encoding(compression, size), message), max(size, 30))
    [(_, whole)] = framed(Encoding(compression), message)
    assert text == whole
    assert fragments[0].total == len(fragments) > 1


@pytest.mark.parametrize("size", [46, 47, 1000, 2147483647])
def test_short_text_is_not_fragmented(size: int) -> None:
    assert framed(Encoding("none", size)) == framed(PLAIN)


def test_fragment_size_counts_characters_not_bytes() -> None:
    message = {"data": "ä" * 100}
    [(_, whole)] = framed(PLAIN, message)
    assert framed(Encoding("none", len(whole.decode())), message) == framed(PLAIN, message)
    assert len(framed(Encoding("none", len(whole.decode()) - 1), message)) == 2


def test_fragments_of_each_message_have_their_own_id() -> None:
    frame = encoder(Encoding("none", 20))
    ids = {
        each["id"]
        for _ in range(3)
        for each in (json.loads(payload) for _, payload in frames(frame(publication())))
    }
    assert len(ids) == 3


def test_number_of_fragments_is_limited() -> None:
    found = framed(Encoding("none", 1), {"data": "x" * 50_000})
    assert len(found) <= 1000
    text, _ = reassembled(found, 51)
    assert json.loads(text)["msg"] == {"data": "x" * 50_000}


# Encoded once.


def test_publication_is_encoded_once_in_each_form(monkeypatch: pytest.MonkeyPatch) -> None:
    times: Counter[str] = Counter()

    def counting(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def count(values: dict[str, Any]) -> Any:
            times[name] += 1
            return function(values)

        return count

    type_ = Types(Interfaces(), lambda: NANOSECONDS, strict=False).message(INT32)
    monkeypatch.setattr(type_, "cbor", counting("cbor", type_.cbor))
    monkeypatch.setattr(type_, "serialize", counting("serialize", type_.serialize))
    one = publication(type_=type_)
    for spelling in ("/a", "a"):
        for compression in (*COMPRESSIONS, "ros1"):
            for size in (None, 10, 20):
                encoder(Encoding(compression, size), spelling)(one)
    assert times == {"cbor": 1, "serialize": 1}
    assert one.json() is one.json()
    assert one.cbor() is one.cbor()
    assert one.ros1() is one.ros1()


@pytest.mark.parametrize("compacted", [False, True])
def test_infinity_is_null_in_json_and_a_number_in_exact_json(compacted: bool) -> None:
    type_ = TYPES.message("std_msgs/Float32MultiArray")
    values = type_.validate({"data": [1.0, math.inf, -math.inf, math.nan]})
    one = publication(values, type_)
    if compacted:
        one.compact()
    assert json.loads(one.exact_json())["data"][:3] == [1.0, math.inf, -math.inf]
    assert json.loads(one.exact_json())["data"][3] is None
    assert json.loads(one.json())["data"] == [1.0, None, None, None]


@pytest.mark.parametrize("exact_first", [False, True])
def test_message_without_infinity_is_encoded_as_json_once(exact_first: bool) -> None:
    one = publication()
    texts = [one.exact_json(), one.json()] if exact_first else [one.json(), one.exact_json()]
    assert texts[0] is texts[1]
