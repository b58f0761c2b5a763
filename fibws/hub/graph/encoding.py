"""The encodings of messages: what a publication is on the wire for each kind of subscription.

A publication is encoded once in each way that somebody asked for. What remains to be done for a
channel, whose subscriptions are alike, is to name the topic and to make a frame of it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from itertools import count
from typing import Any, NamedTuple, TypeAlias

import cbor2
from pydantic_core import from_json, to_json

from fibws.hub.frames import binary_frame, text_frame, text_frames, text_header
from fibws.hub.graph.types import MessageType
from fibws.interfaces.json_text import INFINITE, exact_json_of
from fibws.protocol.operations import Png, Subscribe, encode
from fibws.protocol.png import encode_png

COMPRESSIONS = ("cbor-raw", "cbor", "png", "none")
"""What a subscription may ask for; of several requests the first of these counts."""


class Publication:
    """One published message, encoded when that is first asked for.

    Args:
        message: it, valid.
        received: when, in nanoseconds since 1970.
        header: its publisher's, as JSON text.
    """

    __slots__ = ("_encoded", "_exact", "_json", "_message", "_received", "_type", "header")

    def __init__(
        self, message: dict[str, Any], type_: MessageType, received: int, header: bytes = b"{}"
    ) -> None:
        self._message: dict[str, Any] | None = message
        self._type = type_
        self._received = received
        self.header = header
        self._json: bytes | None = None
        self._exact: bytes | None = None
        self._encoded: dict[object, bytes] | None = None

    @property
    def message(self) -> dict[str, Any]:
        """It, as it was validated."""
        if self._message is not None:
            return self._message
        message: dict[str, Any] = from_json(self.exact_json())
        return message

    def json(self) -> bytes:
        """It as JSON text, in which infinity is null."""
        if self._json is None:
            self._json = to_json(self.message, inf_nan_mode="null")
        return self._json

    def exact_json(self) -> bytes:
        """It as JSON text, in which infinity is what it is."""
        if self._exact is None:
            if self._json is not None and b"null" not in self._json:
                self._exact = self._json
            else:
                self._exact = exact_json_of(self._message)
                if INFINITE not in self._exact:
                    self._json = self._exact
        return self._exact

    def settle(self) -> None:
        """Keep it as JSON text alone, which takes a fraction of the memory."""
        self.exact_json()
        self._message = self._encoded = None

    def cbor(self) -> bytes:
        """It as CBOR, with typed arrays."""
        return self._once("cbor", lambda: self._type.cbor(self.message))

    def raw(self) -> bytes:
        """A CBOR map of when it came and of its bytes in ROS 1's serialization.

        Raises:
            OperationError: nobody knows its fields.
        """
        return self._once("raw", self._serialize)

    def png(self, before: bytes) -> bytes:
        """The text of a png operation with it in a publish operation, which begins so."""

        def make() -> bytes:
            return encode(Png(data=encode_png(b"%b%b}" % (before, self.json()))))

        return self._once(before, make)

    def _serialize(self) -> bytes:
        secs, nsecs = divmod(self._received, 1_000_000_000)
        data = self._type.binary(self.message)
        return cbor2.dumps({"secs": secs, "nsecs": nsecs, "bytes": data})

    def _once(self, name: object, make: Callable[[], bytes]) -> bytes:
        if self._encoded is None:
            self._encoded = {}
        if name not in self._encoded:
            self._encoded[name] = make()
        return self._encoded[name]


Frame: TypeAlias = Callable[[Publication], bytes]


class Encoding(NamedTuple):
    """How a subscription wants its messages.

    One of `COMPRESSIONS`, in pieces of which size, and whether with headers, as only JSON has them:
    who asks for those reads infinity, too.
    """

    compression: str = "none"
    fragment_size: int | None = None
    headers: bool = False

    @classmethod
    def merged(cls, requests: Collection[Subscribe]) -> Encoding:
        """What the requests of one subscription come to."""
        if all(map(_is_plain, requests)):
            return PLAIN  # nearly always, and there may be thousands of subscriptions
        asked = {request.compression for request in requests}
        compression = next((each for each in COMPRESSIONS if each in asked), "none")
        sizes = [each.fragment_size for each in requests if each.fragment_size is not None]
        # Only texts can be in pieces.
        is_text = compression in ("png", "none")
        headers = compression == "none" and any(each.headers for each in requests)
        return cls(compression, min(sizes, default=None) if is_text else None, headers)

    def framer(self, spelling: str) -> Frame:
        """Makes frames of publications on the topic that is spelled so."""
        if self.compression == "cbor":
            return _cbor_framer(spelling, Publication.cbor)
        if self.compression == "cbor-raw":
            return _cbor_framer(spelling, Publication.raw)
        if self.compression == "none" and self.fragment_size is None:
            return _headed_framer(spelling) if self.headers else _json_framer(spelling)
        return _text_framer(spelling, self)


PLAIN = Encoding()
"""JSON in one piece."""


def _is_plain(request: Subscribe) -> bool:
    return request.compression == "none" and request.fragment_size is None and not request.headers


def _json_framer(spelling: str) -> Frame:
    before, after = _before(spelling), b"}"
    around = len(before) + len(after)

    def frame(publication: Publication) -> bytes:
        body = publication.json()
        return b"".join((text_header(around + len(body)), before, body, after))

    return frame


def _headed_framer(spelling: str) -> Frame:
    before = _before(spelling)

    def frame(publication: Publication) -> bytes:
        return text_frame(_headed(before, publication))

    return frame


def _text_framer(spelling: str, encoding: Encoding) -> Frame:
    before = _before(spelling)
    numbers = count(1)

    def new_id() -> str:
        return f"publish:{spelling}:{next(numbers)}"

    def frame(publication: Publication) -> bytes:
        if encoding.compression == "png":
            text = publication.png(before)
        elif encoding.headers:
            text = _headed(before, publication)
        else:
            text = b"%b%b}" % (before, publication.json())
        return text_frames(text, encoding.fragment_size, new_id)

    return frame


def _cbor_framer(spelling: str, encode_message: Callable[[Publication], bytes]) -> Frame:
    # The map {op, topic, msg}, but for the last value.
    before = b"\xa3" + b"".join(map(cbor2.dumps, ("op", "publish", "topic", spelling, "msg")))

    def frame(publication: Publication) -> bytes:
        return binary_frame(before + encode_message(publication))

    return frame


def _headed(before: bytes, publication: Publication) -> bytes:
    return b'%b%b,"header":%b}' % (before, publication.exact_json(), publication.header)


def _before(spelling: str) -> bytes:
    return b'{"op":"publish","topic":%b,"msg":' % to_json(spelling)
