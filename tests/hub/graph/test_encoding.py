"""What a publication is on the wire."""

from __future__ import annotations

import json
import math
from collections import Counter
from dataclasses import replace
from struct import pack, unpack
from typing import Any

import cbor2
import pytest
from protocol.pictures import read_text

from fibws.errors import OperationError
from fibws.hub.graph.encoding import COMPRESSIONS, PLAIN, Encoding, Publication
from fibws.hub.graph.types import MessageType, Types
from fibws.interfaces import Interfaces
from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import Fragment, Subscribe

from ..fakes import BINARY, INT32, NANOSECONDS, TEXT, frames

TYPES = Types(Interfaces(), lambda: NANOSECONDS, strict=False)
NUMBER = TYPES.message(INT32)
PUBLISH = {"op": "publish", "topic": "/a", "msg": {"data": 5}}


def publication(message: dict[str, Any] | None = None, type_: MessageType = NUMBER) -> Publication:
    return Publication(message or {"data": 5}, type_, NANOSECONDS)


def framed(encoding: Encoding, message: dict[str, Any] | None = None) -> list[tuple[int, bytes]]:
    return list(frames(encoding.framer("/a")(publication(message))))


def reassembled(found: list[tuple[int, bytes]], size: int) -> tuple[bytes, list[Fragment]]:
    """The text that fragments of at most ``size`` characters make up, and they themselves."""
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
        ([{"compression": "zip"}], PLAIN),
        ([{"compression": "PNG"}], PLAIN),
        ([{"compression": ""}], PLAIN),
        ([{"compression": "png"}], Encoding("png")),
        ([{"compression": "cbor"}], Encoding("cbor")),
        ([{"compression": "cbor-raw"}], Encoding("cbor-raw")),
        ([{}, {"compression": "png"}], Encoding("png")),
        ([{"compression": "cbor"}, {"compression": "png"}, {}], Encoding("cbor")),
        ([{"compression": "cbor"}, {"compression": "cbor-raw"}], Encoding("cbor-raw")),
        ([{"compression": "zip"}, {"compression": "png"}], Encoding("png")),
        ([{"fragment_size": 100}], Encoding("none", 100)),
        ([{"fragment_size": 100}, {"fragment_size": 10}, {}], Encoding("none", 10)),
        ([{"fragment_size": 100}, {"compression": "png"}], Encoding("png", 100)),
        ([{"fragment_size": 100, "compression": "cbor"}], Encoding("cbor")),
        ([{"fragment_size": 100}, {"compression": "cbor-raw"}], Encoding("cbor-raw")),
        ([{"fragment_size": 2147483647}], Encoding("none", 2147483647)),
        ([{"headers": False}], PLAIN),
        ([{"headers": True}], Encoding(headers=True)),
        ([{"headers": True}, {}], Encoding(headers=True)),
        ([{"headers": True, "compression": "zip"}], Encoding(headers=True)),
        ([{"headers": True, "fragment_size": 100}, {}], Encoding("none", 100, True)),
        ([{"headers": True, "compression": "png"}], Encoding("png")),
        ([{"headers": True}, {"compression": "cbor"}], Encoding("cbor")),
    ],
)
def test_of_several_requests_the_strongest_compression_counts_and_the_smallest_pieces(
    asked: list[dict[str, Any]], encoding: Encoding
) -> None:
    for requests in (asked, asked[::-1]):
        assert Encoding.merged([Subscribe(topic="/a", **each) for each in requests]) == encoding


# One frame.


def test_json_is_the_ordinary_way() -> None:
    assert framed(PLAIN) == [(TEXT, b'{"op":"publish","topic":"/a","msg":{"data":5}}')]


def test_the_header_is_beside_the_message_for_those_who_ask() -> None:
    one = Publication({"data": 5}, NUMBER, NANOSECONDS, b'{"callerid":"/talker"}')
    text = b'{"op":"publish","topic":"/a","msg":{"data":5},"header":{"callerid":"/talker"}}'
    assert list(frames(Encoding(headers=True).framer("/a")(one))) == [(TEXT, text)]
    pieces = list(frames(Encoding("none", 30, True).framer("/a")(one)))
    assert reassembled(pieces, 30)[0] == text
    assert list(frames(PLAIN.framer("/a")(one))) == framed(PLAIN)


@pytest.mark.parametrize("size", [0, 50, 100, 70_000])
@pytest.mark.parametrize("compression", ["none", "png", "cbor"])
def test_a_message_may_have_any_size(compression: str, size: int) -> None:
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
    frame = Encoding("cbor").framer("/a")(publication(message, type_))
    [(_, payload)] = frames(frame)
    assert cbor2.loads(payload)["msg"]["data"] == b"\1\2\3"
    type_ = TYPES.message("geometry_msgs/PoseWithCovariance")
    message = type_.validate({"covariance": [0.5] * 36})
    [(_, payload)] = frames(Encoding("cbor").framer("/a")(publication(message, type_)))
    found = cbor2.loads(payload)["msg"]["covariance"]
    assert (found.tag, found.value) == (86, pack("<36d", *[0.5] * 36))


def test_cbor_keeps_numbers_that_json_does_not_have() -> None:
    type_ = TYPES.message("std_msgs/Float64MultiArray")
    message = type_.validate({"data": [None, float("nan"), float("inf"), 0.5]})
    [(_, payload)] = frames(Encoding("cbor").framer("/a")(publication(message, type_)))
    found = cbor2.loads(payload)["msg"]["data"]
    numbers = unpack("<4d", found.value)
    assert (found.tag, numbers[2:]) == (86, (float("inf"), 0.5))
    assert all(math.isnan(each) for each in numbers[:2])


def test_cbor_raw_is_the_time_and_the_bytes_of_ros_1() -> None:
    [(first, payload)] = framed(Encoding("cbor-raw"))
    assert first == BINARY
    secs, nsecs = divmod(NANOSECONDS, 10**9)
    raw = {"secs": secs, "nsecs": nsecs, "bytes": pack("<i", 5)}
    assert cbor2.loads(payload) == {"op": "publish", "topic": "/a", "msg": raw}


def test_cbor_raw_of_an_unknown_type_is_refused() -> None:
    frame = Encoding("cbor-raw").framer("/a")
    with pytest.raises(OperationError, match="cbor-raw needs the definition of my_msgs/Thing"):
        frame(publication({"any": 1}, TYPES.message("my_msgs/Thing")))


@pytest.mark.parametrize("compression", ["none", "png"])
def test_numbers_that_json_does_not_have_are_null(compression: str) -> None:
    [(_, payload)] = framed(Encoding(compression), {"data": [float("nan"), float("-inf")]})
    operation = json.loads(payload)
    if compression == "png":
        operation = json.loads(read_text(operation["data"]))
    assert operation["msg"] == {"data": [None, None]}


@pytest.mark.parametrize("compression", ["none", "png", "cbor", "cbor-raw"])
@pytest.mark.parametrize("spelling", ["/a", "a", "~a/b_1"])
def test_the_topic_is_spelled_as_the_subscriber_did(compression: str, spelling: str) -> None:
    [(first, payload)] = frames(Encoding(compression).framer(spelling)(publication()))
    operation = cbor2.loads(payload) if first == BINARY else json.loads(payload)
    if compression == "png":
        operation = json.loads(read_text(operation["data"]))
    assert operation["topic"] == spelling


# Pieces.


@pytest.mark.parametrize("compression", ["none", "png"])
@pytest.mark.parametrize("size", [1, 7, 30])
def test_a_long_text_comes_in_pieces(compression: str, size: int) -> None:
    message = {"data": "\N{ROBOT FACE}ä\n" * 50}
    text, fragments = reassembled(framed(Encoding(compression, size), message), max(size, 30))
    [(_, whole)] = framed(Encoding(compression), message)
    assert text == whole
    assert fragments[0].total == len(fragments) > 1


@pytest.mark.parametrize("size", [46, 47, 1000, 2147483647])
def test_a_short_text_comes_in_one_frame(size: int) -> None:
    assert framed(Encoding("none", size)) == framed(PLAIN)


def test_a_text_that_is_longer_in_bytes_than_in_characters_is_in_one_frame_as_well() -> None:
    message = {"data": "ä" * 100}
    [(_, whole)] = framed(PLAIN, message)
    assert framed(Encoding("none", len(whole.decode())), message) == framed(PLAIN, message)
    assert len(framed(Encoding("none", len(whole.decode()) - 1), message)) == 2


def test_each_message_has_pieces_of_its_own_id() -> None:
    frame = Encoding("none", 20).framer("/a")
    ids = {
        each["id"]
        for _ in range(3)
        for each in (json.loads(payload) for _, payload in frames(frame(publication())))
    }
    assert len(ids) == 3


def test_who_wants_tiny_pieces_of_a_long_text_gets_a_thousand() -> None:
    found = framed(Encoding("none", 1), {"data": "x" * 50_000})
    assert len(found) <= 1000
    text, _ = reassembled(found, 51)
    assert json.loads(text)["msg"] == {"data": "x" * 50_000}


# Encoded once.


class Counting:
    """A type that counts how often it encodes."""

    def __init__(self) -> None:
        self.times: Counter[str] = Counter()
        self.type = replace(
            NUMBER,
            cbor=lambda message: self._count("cbor", NUMBER.cbor(message)),
            binary=lambda message: self._count("binary", NUMBER.binary(message)),
        )

    def _count(self, way: str, data: bytes) -> bytes:
        self.times[way] += 1
        return data


def test_a_publication_is_encoded_when_somebody_wants_it_and_once_in_each_way() -> None:
    counting = Counting()
    one = publication(type_=counting.type)
    assert counting.times == {}
    for spelling in ("/a", "a"):
        for compression in COMPRESSIONS:
            for size in (None, 10, 20):
                Encoding(compression, size).framer(spelling)(one)
    assert counting.times == {"cbor": 1, "binary": 1}
    assert one.json() is one.json()
    assert one.cbor() is one.cbor()
    assert one.raw() is one.raw()


def test_infinity_is_null_but_for_those_who_ask_for_headers() -> None:
    message = {"data": [1.0, math.inf, -math.inf, math.nan]}
    type_ = TYPES.message("std_msgs/Float32MultiArray")
    whole = type_.validate(message)
    for settled in (False, True):
        one = Publication(whole, type_, NANOSECONDS)
        if settled:
            one.settle()
        assert json.loads(one.exact_json())["data"][:3] == [1.0, math.inf, -math.inf]
        assert json.loads(one.exact_json())["data"][3] is None
        assert json.loads(one.json())["data"] == [1.0, None, None, None]


@pytest.mark.parametrize("exact_first", [False, True])
def test_a_message_without_infinity_is_written_once(exact_first: bool) -> None:
    one = publication()
    texts = [one.exact_json(), one.json()] if exact_first else [one.json(), one.exact_json()]
    assert texts[0] is texts[1]
