"""XML-RPC (http://xmlrpc.com/spec.md) as ROS 1 uses it: calls and responses as bytes.

It writes only what roscpp's XmlRpc++ can read, which looks for tags as text: no ``<nil/>``, no
``<i8>``, and no whitespace between tags. Whatever is written takes a little time per value, so that
long responses are written in pieces, between which the event loop serves others.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Iterator, Mapping
from datetime import datetime
from typing import Any
from xml.parsers import expat
from xmlrpc.client import Fault, Unmarshaller

from fibws.errors import XmlRpcError

DEEPEST = 100
"""Values that may be nested."""
PIECE = 500
"""Values that are written, or read, before others have their turn: a millisecond at most."""
_LEAST, _MOST = -(2**31), 2**31 - 1
_EXACT = 2**53
"""Up to here a double holds every integer."""
_SPECIAL = re.compile("[&<>\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
_ESCAPES = {"&": "&amp;", "<": "&lt;", ">": "&gt;"}

_HEAD = "<?xml version='1.0'?>\n"


class CallParser:
    """Reads a call, or a response, whose bytes arrive in pieces.

    Document types are refused: without them there are no entities that grow when they are read.
    """

    def __init__(self) -> None:
        self._target = Unmarshaller(use_builtin_types=True)
        self._target.xml("", None)  # Strings are decoded already.
        self._depth = 0
        self._parser = parser = expat.ParserCreate()
        parser.StartDoctypeDeclHandler = self._refuse_doctype
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._target.data
        parser.buffer_text = True

    def feed(self, data: bytes) -> None:
        """Read the next bytes; raises `XmlRpcError` if they cannot be XML-RPC."""
        self._parse(data, False)

    def call(self) -> tuple[str, list[Any]]:
        """Return the method and the parameters; raises `XmlRpcError`."""
        params = self._close()
        method = self._target.getmethodname()
        if not isinstance(method, str) or not method:
            raise XmlRpcError("expected a methodCall with a methodName")
        return method, params

    def response(self) -> Any:
        """Return the value of a response; raises `XmlRpcError`, also for a fault."""
        params = self._close()
        if len(params) != 1:
            raise XmlRpcError(f"expected a methodResponse with 1 value, got {len(params)}")
        return params[0]

    def _close(self) -> list[Any]:
        self._parse(b"", True)
        try:
            return list(self._target.close())
        except Fault as fault:
            raise XmlRpcError(f"fault {fault.faultCode}: {fault.faultString}") from None
        except Exception as error:  # The standard library reports bad nesting in many ways.
            raise XmlRpcError(f"invalid XML-RPC: {error!r}") from None

    def _parse(self, data: bytes, is_last: bool) -> None:
        try:
            self._parser.Parse(data, is_last)
        except XmlRpcError:
            raise
        except expat.ExpatError as error:
            raise XmlRpcError(f"invalid XML: {error}") from None
        except Exception as error:  # Such as <int>x</int>, or an unknown tag.
            raise XmlRpcError(f"invalid XML-RPC: {error!r}") from None

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._depth += 1
        if self._depth > 4 * DEEPEST:  # Each level of a struct has four tags.
            raise XmlRpcError(f"invalid XML-RPC: nested too deeply, limit is {DEEPEST}")
        if tag == "nil":
            raise XmlRpcError("invalid XML-RPC: <nil/> is not a value of ROS")
        self._target.start(tag, attributes)

    def _end(self, tag: str) -> None:
        self._depth -= 1
        self._target.end(tag)

    def _refuse_doctype(self, *arguments: object) -> None:
        raise XmlRpcError("invalid XML-RPC: document types are refused")


def parse_call(data: bytes) -> tuple[str, list[Any]]:
    """Return the method and the parameters of a whole call; raises `XmlRpcError`."""
    parser = CallParser()
    parser.feed(data)
    return parser.call()


def parse_response(data: bytes) -> Any:
    """Return the value of a whole response; raises `XmlRpcError`, also for a fault."""
    parser = CallParser()
    parser.feed(data)
    return parser.response()


def write_call(method: str, params: Iterable[object]) -> bytes:
    """Return a call."""
    parts = [_HEAD, "<methodCall><methodName>", method, "</methodName><params>"]
    for each in params:
        parts.append("<param>")
        parts.extend(_write(each))
        parts.append("</param>")
    parts.append("</params></methodCall>\n")
    return "".join(parts).encode()


def write_response(value: object) -> bytes:
    """Return the response with a value."""
    return b"".join(iter_response(value))


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
    """Yield the parts of a value's element.

    XML-RPC has integers of 32 bits: others become doubles, or strings where a double is not exact.
    """
    match value:
        case str():
            yield f"<value><string>{_escaped(value)}</string></value>"
        case bool():
            yield f"<value><boolean>{value:d}</boolean></value>"
        case int():
            if _LEAST <= value <= _MOST:
                yield f"<value><int>{value}</int></value>"
            elif abs(value) <= _EXACT:
                yield f"<value><double>{value}.0</double></value>"
            else:
                yield f"<value><string>{value}</string></value>"
        case float():
            yield f"<value><double>{value!r}</double></value>"
        case list() | tuple():
            yield "<value><array><data>"
            for each in value:
                yield from _write(each)
            yield "</data></array></value>"
        case Mapping():
            yield "<value><struct>"
            for key, each in value.items():
                yield f"<member><name>{_escaped(key)}</name>"
                yield from _write(each)
                yield "</member>"
            yield "</struct></value>"
        case Written():
            yield value.xml
        case bytes():
            yield f"<value><base64>{base64.b64encode(value).decode()}</base64></value>"
        case datetime():
            text = value.strftime("%Y%m%dT%H:%M:%S")
            yield f"<value><dateTime.iso8601>{text}</dateTime.iso8601></value>"
        case _:
            raise TypeError(f"XML-RPC has no {type(value).__name__}")


def _escaped(text: str) -> str:
    """Return a text for XML, with U+FFFD in place of characters that XML cannot hold."""
    return _SPECIAL.sub(lambda found: _ESCAPES.get(found[0], "\ufffd"), text)
