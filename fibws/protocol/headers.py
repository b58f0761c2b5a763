"""Connection headers: what a node says of itself beside its messages, as ROS 1's TCPROS has it.

Rosbridge has none; they are an addition of fibws.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

MOST_BYTES: Final = 4096
"""UTF-8 that the names and values of one header may have together: each message carries it."""

EXPECTED: Final = (
    f"an object of strings, of {MOST_BYTES} bytes in all, whose names are not empty and have no ="
)


def check_headers(headers: Any) -> dict[str, str]:
    """A copy of what may be a header: TCPROS writes each field as ``name=value``.

    Raises:
        ValueError: it is none.
    """
    if isinstance(headers, Mapping) and all(_is_field(*field) for field in headers.items()):
        try:
            size = sum(len(text.encode()) for field in headers.items() for text in field)
        except UnicodeEncodeError:  # Half a surrogate pair.
            size = MOST_BYTES + 1
        if size <= MOST_BYTES:
            return dict(headers)
    raise ValueError(f"headers are {EXPECTED}")


def _is_field(name: object, value: object) -> bool:
    return isinstance(name, str) and isinstance(value, str) and bool(name) and "=" not in name


def _of_operation(headers: Any) -> dict[str, str]:
    try:
        return check_headers(headers)
    except ValueError:
        raise PydanticCustomError("headers", EXPECTED) from None


def _of_hub(header: Any) -> dict[str, str] | None:
    if isinstance(header, dict) and all(type(value) is str for value in header.values()):
        return header
    return None


Headers = Annotated[dict[str, str], BeforeValidator(_of_operation)]
"""A header that a client sends."""

HubHeader = Annotated[dict[str, str] | None, BeforeValidator(_of_hub)]
"""A header of the hub's making; what else comes there counts as absent."""
