"""Encodings: how a publication becomes the frame that a subscription requests.

A publication is encoded once in each requested form (`Publication`). What is left to
do for a group of subscriptions that are alike is to add the topic's name and the frame's header.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from itertools import count
from typing import NamedTuple, TypeAlias

import cbor2
from pydantic_core import to_json

from fibws.hub.delivery.send_queue import Frame, frame_of
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Topic
from fibws.protocol.fragments import split
from fibws.protocol.operations import Png, Subscribe, encode
from fibws.protocol.png import encode_png
from fibws.protocol.serialized import ROS1, deliver_head
from fibws.protocol.websocket import BINARY, TEXT, server_frame, server_header

COMPRESSIONS = ("cbor-raw", "cbor", "png", "none")
"""The compressions of rosbridge; of several requests the first of these counts."""
_PRECEDENCE = (ROS1, *COMPRESSIONS)

EncodeFrame: TypeAlias = Callable[[Publication], Frame]
"""Makes the frame of a publication; raises `OperationError` if it cannot be encoded so."""


class Encoding(NamedTuple):
    """How a subscription wants its messages.

    ``compression`` is one of `COMPRESSIONS`, or `ROS1` on connections of ``fibws.v1``.
    ``fragment_size`` is the most characters of a text in one piece. ``headers`` adds connection
    headers, in JSON and `ROS1` only; JSON then has infinity as a number, too. ``strings`` makes
    64-bit integers strings, in JSON only. ``deflate`` is the size of the client's window for
    compressed frames, as a power of two, or 0; in JSON only.
    """

    compression: str = "none"
    fragment_size: int | None = None
    headers: bool = False
    strings: bool = False
    deflate: int = 0

    @classmethod
    def merged(cls, requests: Collection[Subscribe]) -> Encoding:
        """Return the encoding that the requests of one subscription come to."""
        if all(map(_is_plain, requests)):
            return PLAIN  # Nearly always, and there may be thousands of subscriptions.
        asked = {request.compression for request in requests}
        compression = next((each for each in _PRECEDENCE if each in asked), "none")
        sizes = [each.fragment_size for each in requests if each.fragment_size is not None]
        is_text = compression in ("png", "none")  # Only texts can be sent in pieces.
        headers = compression in ("none", ROS1) and any(each.headers for each in requests)
        strings = compression == "none" and any(each.int64 for each in requests)
        return cls(compression, min(sizes, default=None) if is_text else None, headers, strings)

    def deflated(self, bits: int) -> Encoding:
        """Return the same for a client that has negotiated compression with such a window."""
        return self._replace(deflate=bits) if bits and self.compression == "none" else self

    @property
    def needs_definition(self) -> bool:
        """Whether messages can be encoded only if the fields of their type are known."""
        return self.compression in (ROS1, "cbor-raw")

    @property
    def is_slow(self) -> bool:
        """Whether large messages take so long that they are encoded in a thread."""
        return self.compression == "png"

    def for_topic(self, topic: Topic, spelling: str) -> EncodeFrame:
        """Return the encoder of a topic's messages, with the client's spelling of its name."""
        if self.compression == ROS1:
            return _serialized(topic, headers=self.headers)
        if self.compression == "cbor":
            return _cbor(spelling, Publication.cbor)
        if self.compression == "cbor-raw":
            return _cbor(spelling, _raw)
        if self.compression == "png":
            make = self.png_maker(spelling)
            return lambda publication: make(publication.json())
        return self.text_encoder(spelling)

    def text_encoder(self, spelling: str) -> Callable[[Publication], bytes]:
        """Return the encoder of a topic's messages in JSON, without compression."""
        return _json(spelling) if self._replace(deflate=0) == PLAIN else _text(spelling, self)

    def png_maker(self, spelling: str) -> Callable[[bytes], Frame]:
        """Return what makes the frame of a message in JSON, in any thread."""
        before = _before(spelling)
        new_id = _fragment_ids(spelling)

        def make(message: bytes) -> Frame:
            png = encode_png(b"%b%b}" % (before, message))
            return text_frames(encode(Png(data=png)), self.fragment_size, new_id)

        return make


PLAIN = Encoding()
"""JSON in one piece."""


def text_frame(text: bytes) -> bytes:
    """Return an unmasked frame with one text message."""
    return server_frame(TEXT, text)


def text_frames(text: bytes, fragment_size: int | None, new_id: Callable[[], str]) -> bytes:
    """Return a text's frame; or those of its fragments, if it is longer than they may be."""
    if fragment_size is not None and len(text) > fragment_size:
        pieces = split(text.decode(), fragment_size, new_id())
        frames = b"".join(text_frame(encode(piece)) for piece in pieces)
        if frames:
            return frames
    return text_frame(text)


def _is_plain(request: Subscribe) -> bool:
    return (
        request.compression == "none"
        and request.fragment_size is None
        and not request.headers
        and request.int64 is None
    )


def _serialized(topic: Topic, *, headers: bool) -> EncodeFrame:
    def encode_frame(publication: Publication) -> Frame:
        header = publication.header if headers else b""
        head = deliver_head(topic.number_of(publication.type), publication.received, header)
        message = publication.ros1()
        return frame_of(server_header(BINARY, len(head) + len(message)) + head, message)

    return encode_frame


def _json(spelling: str) -> Callable[[Publication], bytes]:
    before, after = _before(spelling), b"}"
    around = len(before) + len(after)

    def encode_frame(publication: Publication) -> bytes:
        body = publication.json()
        return b"".join((server_header(TEXT, around + len(body)), before, body, after))

    return encode_frame


def _text(spelling: str, encoding: Encoding) -> Callable[[Publication], bytes]:
    before = _before(spelling)
    new_id = _fragment_ids(spelling)

    def encode_frame(publication: Publication) -> bytes:
        if encoding.strings:
            message = publication.json_with_strings(exact=encoding.headers)
        else:
            message = publication.exact_json() if encoding.headers else publication.json()
        header = b',"header":%b' % publication.header if encoding.headers else b""
        text = b"%b%b%b}" % (before, message, header)
        return text_frames(text, encoding.fragment_size, new_id)

    return encode_frame


def _cbor(spelling: str, encode_message: Callable[[Publication], bytes]) -> EncodeFrame:
    # The map {op, topic, msg} up to its last value.
    before = b"\xa3" + b"".join(map(cbor2.dumps, ("op", "publish", "topic", spelling, "msg")))

    def encode_frame(publication: Publication) -> Frame:
        message = encode_message(publication)
        return frame_of(server_header(BINARY, len(before) + len(message)) + before, message)

    return encode_frame


def _raw(publication: Publication) -> bytes:
    """Return a CBOR map of the receive time and of the message in ROS 1's serialization."""

    def make() -> bytes:
        secs, nsecs = divmod(publication.received, 1_000_000_000)
        message = publication.ros1()
        head = cbor2.dumps({"secs": secs, "nsecs": nsecs})[1:]  # without the map's own head
        return b"".join((b"\xa3", head, b"\x65bytes", _byte_string_head(len(message)), message))

    return publication.cached("cbor-raw", make)


def _byte_string_head(size: int) -> bytes:
    """Return the head of a byte string in CBOR (RFC 8949, section 3.1)."""
    if size < 24:
        return bytes((0x40 | size,))
    exponent = next(each for each in range(4) if size < 1 << (8 << each))
    return bytes((0x58 + exponent,)) + size.to_bytes(1 << exponent, "big")


def _fragment_ids(spelling: str) -> Callable[[], str]:
    numbers = count(1)
    return lambda: f"publish:{spelling}:{next(numbers)}"


def _before(spelling: str) -> bytes:
    return b'{"op":"publish","topic":%b,"msg":' % to_json(spelling)
