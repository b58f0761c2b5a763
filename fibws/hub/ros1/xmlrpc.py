"""XML-RPC (http://xmlrpc.com/spec.md) as ROS 1 uses it: calls and responses as bytes.

It writes only what roscpp's XmlRpc++ can read, which looks for tags as text: no ``<nil/>``, no
``<i8>``, and no whitespace between tags. Whatever is written takes a little time per value, so that
long responses are written in pieces, between which the event loop serves others.
"""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from datetime import datetime
from typing import Any
from xml.parsers import expat

from fibws.hub.errors import XmlRpcError

DEEPEST = 100
"""Values that may be nested."""
PIECE = 500
"""Values that are written, or read, before others have their turn: a millisecond at most."""
_LEAST, _MOST = -(2**31), 2**31 - 1
_EXACT = 2**53
"""Up to here a double holds every integer."""
_SPECIAL = re.compile("[&<>\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
_ESCAPES = {"&": "&amp;", "<": "&lt;", ">": "&gt;"}

_DATE = "%Y%m%dT%H:%M:%S"
_HEAD = "<?xml version='1.0'?>\n"


_READERS: dict[str, Callable[[str], object]] = {
    "string": str,
    "int": int,
    "i4": int,
    "i8": int,
    "double": float,
    "boolean": {"0": False, "1": True}.__getitem__,
    "base64": lambda text: binascii.a2b_base64("".join(text.split()), strict_mode=True),
    "dateTime.iso8601": lambda text: datetime.strptime(text.strip(), _DATE),
}
"""What the text of an element with a value stands for."""
_CONTAINERS = frozenset({"array", "struct"})
_WITHOUT_VALUE = frozenset(
    {"methodCall", "methodResponse", "params", "param", "member", "data", "value"}
)


class CallParser:
    """Reads a call, or a response, whose bytes arrive in pieces.

    Document types are refused: without them there are no entities that grow when they are read.
    """

    def __init__(self) -> None:
        # Expat refers to its handlers: were they the parser's own methods, what it has read would
        # stay until the cyclic garbage collector comes.
        self._values = values = _Values()
        self._parser = parser = expat.ParserCreate()
        parser.StartDoctypeDeclHandler = values.refuse_doctype
        parser.StartElementHandler = values.start
        parser.EndElementHandler = values.end
        parser.CharacterDataHandler = values.text.append
        parser.buffer_text = True

    def feed(self, data: bytes) -> None:
        """Read the next bytes; raises `XmlRpcError` if they cannot be XML-RPC."""
        self._parse(data, False)

    def call(self) -> tuple[str, list[Any]]:
        """Return the method and the parameters; raises `XmlRpcError`."""
        self._parse(b"", True)
        if not self._values.method:
            raise XmlRpcError("expected a methodCall with a methodName")
        return self._values.method, self._values.found

    def response(self) -> Any:
        """Return the value of a response; raises `XmlRpcError`, also for a fault."""
        self._parse(b"", True)
        if len(self._values.found) != 1 or self._values.method:
            count = len(self._values.found)
            raise XmlRpcError(f"expected a methodResponse with 1 value, got {count}")
        [value] = self._values.found
        if self._values.is_fault:
            match value:
                case {"faultCode": code, "faultString": text}:
                    raise XmlRpcError(f"fault {code}: {text}")
            raise XmlRpcError(f"fault: {value!r}"[:500])
        return value

    def _parse(self, data: bytes, is_last: bool) -> None:
        try:
            self._parser.Parse(data, is_last)
        except XmlRpcError:
            raise
        except expat.ExpatError as error:
            raise XmlRpcError(f"invalid XML: {error}") from None
        except (ValueError, LookupError, TypeError) as error:  # Such as <int>x</int>.
            raise XmlRpcError(f"invalid XML-RPC: {error!r}") from None


class _Values:
    """The values of a message, and the handlers of its elements."""

    def __init__(self) -> None:
        self.found: list[Any] = []
        """The values that are complete, those of open arrays and structs among them."""
        self.text: list[str] = []
        """The text since the last tag."""
        self.method = ""
        self.is_fault = False
        self._begins: list[int] = []
        """Where the values of each open array and struct begin."""
        self._is_string = False
        """Whether no tag has followed the last ``<value>``, so that its text is a string."""

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Begin an element."""
        if tag == "value":
            self._is_string = True
        else:
            self._is_string = False
            if tag in _CONTAINERS:
                self._begins.append(len(self.found))
                if len(self._begins) > DEEPEST:
                    raise XmlRpcError(f"invalid XML-RPC: nested too deeply, limit is {DEEPEST}")
        self.text.clear()

    def end(self, tag: str) -> None:
        """End an element."""
        reader = _READERS.get(tag)
        if reader is not None:
            self.found.append(reader("".join(self.text)))
        elif tag in _WITHOUT_VALUE:
            if self._is_string:
                self.found.append("".join(self.text))
        elif tag == "name":
            self.found.append("".join(self.text))
        elif tag == "array":
            begin = self._begins.pop()
            self.found[begin:] = [self.found[begin:]]
        elif tag == "struct":
            self._end_struct()
        elif tag == "methodName":
            self.method = "".join(self.text).strip()
        elif tag == "fault":
            self.is_fault = True
        else:
            raise XmlRpcError(f"invalid XML-RPC: <{tag}> is not a type of ROS")
        self._is_string = False
        self.text.clear()

    def _end_struct(self) -> None:
        begin = self._begins.pop()
        members = self.found[begin:]
        names = members[::2]
        if len(members) % 2 or not all(isinstance(name, str) for name in names):
            raise XmlRpcError("invalid XML-RPC: each member of a struct has a name and a value")
        self.found[begin:] = [dict(zip(names, members[1::2], strict=True))]

    def refuse_doctype(self, *arguments: object) -> None:
        """Raise `XmlRpcError`."""
        raise XmlRpcError("invalid XML-RPC: document types are refused")


def write_call(method: str, params: Iterable[object]) -> bytes:
    """Return a call."""
    parts = [_HEAD, "<methodCall><methodName>", method, "</methodName><params>"]
    for each in params:
        parts.append("<param>")
        parts.extend(_write(each))
        parts.append("</param>")
    parts.append("</params></methodCall>\n")
    return "".join(parts).encode()


def iter_response(value: object) -> Iterator[bytes]:
    """Yield the response with a value in pieces of about `PIECE` values."""
    parts = [_HEAD, "<methodResponse><params><param>"]
    for part in _write(value):
        parts.append(part)
        if len(parts) >= PIECE:
            yield "".join(parts).encode()
            parts.clear()
    parts.append("</param></params></methodResponse>\n")
    yield "".join(parts).encode()


def write_fault(code: int, text: str) -> bytes:
    """Return the response of a call that cannot be answered."""
    fault = "".join(_write({"faultCode": code, "faultString": text}))
    return f"{_HEAD}<methodResponse><fault>{fault}</fault></methodResponse>\n".encode()


class Written:
    """A value whose XML is at hand.

    Args:
        xml: its ``<value>`` element.
    """

    __slots__ = ("xml",)

    def __init__(self, xml: str) -> None:
        self.xml = xml


def write_value(value: object) -> str:
    """Return a value's ``<value>`` element."""
    return "".join(_write(value))


def _write(value: object) -> Iterator[str]:
    """Yield the parts of a value's element."""
    scalar = _scalar(value)
    if scalar:
        yield scalar
        return
    match value:
        case list() | tuple():
            yield "<value><array><data>"
            for each in value:
                yield from _write(each)
            yield "</data></array></value>"
        case Mapping():
            yield "<value><struct>"
            for key, each in value.items():
                yield f"<member><name>{escaped(key)}</name>"
                yield from _write(each)
                yield "</member>"
            yield "</struct></value>"
        case Written():
            yield value.xml
        case _:
            raise TypeError(f"XML-RPC has no {type(value).__name__}")


def _scalar(value: object) -> str:
    """Return the element of a value that holds no others; an empty text for other values."""
    match value:
        case str():
            return f"<value><string>{escaped(value)}</string></value>"
        case bool():
            return f"<value><boolean>{value:d}</boolean></value>"
        case int():
            return _integer(value)
        case float():
            return f"<value><double>{value!r}</double></value>"
        case bytes():
            return f"<value><base64>{base64.b64encode(value).decode()}</base64></value>"
        case datetime():
            text = f"{value.year:04}{value:%m%dT%H:%M:%S}"
            return f"<value><dateTime.iso8601>{text}</dateTime.iso8601></value>"
    return ""


def _integer(value: int) -> str:
    """Return an integer's element.

    XML-RPC has integers of 32 bits: others become doubles, or strings where a double is not exact.
    """
    if _LEAST <= value <= _MOST:
        return f"<value><int>{value}</int></value>"
    if abs(value) <= _EXACT:
        return f"<value><double>{value}.0</double></value>"
    return f"<value><string>{value}</string></value>"


def escaped(text: str) -> str:
    """Return a text for XML, with U+FFFD in place of characters that XML cannot hold."""
    return _SPECIAL.sub(lambda found: _ESCAPES.get(found[0], "\ufffd"), text)
