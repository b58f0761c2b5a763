"""JSON text to operations' fields: one object a frame, or several, as the real server does."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any

from pydantic_core import from_json

from fibws.errors import InvalidUtf8, OperationError
from fibws.protocol.parsing import quoted

_SCANNER = json.JSONDecoder()


def objects(data: bytes) -> Iterable[dict[str, Any]]:
    """The JSON objects in a text, which may stand one behind another.

    Raises:
        OperationError: the text is not JSON, or holds something other than objects.
        InvalidUtf8: the bytes are no text.
    """
    try:
        value = from_json(data)
    except ValueError as error:
        return _several(data, error)
    return (_object(value),)


def _several(data: bytes, fault: ValueError) -> Iterator[dict[str, Any]]:
    try:
        rest = data.decode().lstrip()
    except UnicodeDecodeError as error:
        raise InvalidUtf8(str(error)) from None
    position, end = 0, len(rest)
    while position < end:
        try:
            # Only finds where the object ends: what it means is from_json's to say, as ever.
            _, stop = _SCANNER.raw_decode(rest, position)
            value = from_json(rest[position:stop])
        except (ValueError, RecursionError):
            raise OperationError(
                f"Expected JSON objects: {fault}. Original message was: {quoted(rest[position:])}"
            ) from None
        yield _object(value)
        while stop < end and rest[stop] in " \t\r\n":
            stop += 1
        position = stop


def _object(value: object) -> dict[str, Any]:
    if isinstance(value, dict):
        return value
    raise OperationError(f"Expected a JSON object. Original message was: {quoted(value)}")
