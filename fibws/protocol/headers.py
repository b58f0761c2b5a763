"""Connection headers: fields that a node sends beside its messages, as in ROS 1's TCPROS.

They are an addition of fibws to rosbridge.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

MOST_BYTES: Final = 4096
"""Most bytes of UTF-8 in all names and values of a header: each message carries it."""

EXPECTED: Final = (
    f"an object of strings with non-empty names without =, of at most {MOST_BYTES} bytes in total"
)


def check_headers(headers: Any) -> dict[str, str]:
    """Return a copy of a valid header. TCPROS writes each field as ``name=value``.

    Raises:
        ValueError: it is not a valid header.
    """
    if isinstance(headers, Mapping) and all(_is_field(*field) for field in headers.items()):
        try:
            size = sum(len(text.encode()) for field in headers.items() for text in field)
        except UnicodeEncodeError:  # A lone surrogate.
            size = MOST_BYTES + 1
        if size <= MOST_BYTES:
            return dict(headers)
    raise ValueError(f"headers must be {EXPECTED}")


def _is_field(name: object, value: object) -> bool:
    return isinstance(name, str) and isinstance(value, str) and bool(name) and "=" not in name


def _client_header(headers: Any) -> dict[str, str]:
    try:
        return check_headers(headers)
    except ValueError:
        raise PydanticCustomError("headers", EXPECTED) from None


def _hub_header(header: Any) -> dict[str, str] | None:
    if isinstance(header, dict) and all(type(value) is str for value in header.values()):
        return header
    return None


Headers = Annotated[dict[str, str], BeforeValidator(_client_header)]
"""A header that a client sends; an invalid one is an error."""

HubHeader = Annotated[dict[str, str] | None, BeforeValidator(_hub_header)]
"""A header that the hub sends; an invalid one counts as absent."""
