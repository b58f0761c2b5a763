"""Messages of any type, as hypothesis makes them up."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from math import nan
from typing import Any

from hypothesis import strategies as st

from fibws.interfaces import Interfaces
from fibws.interfaces.builtin import FLOATS, INTEGERS, STRINGS, TIMES
from fibws.interfaces.definition import Field

FEW = 3
"""How many elements an array has at most, unless its size is fixed."""


def messages(
    interfaces: Interfaces, type_: str, *, canonical: bool = False
) -> st.SearchStrategy[dict[str, Any]]:
    """Valid messages of the type, with every field in them.

    If they are ``canonical``, no time has whole seconds in its nanoseconds.
    """
    fields = interfaces.message(type_).fields
    return st.fixed_dictionaries(
        {field.name: _values(interfaces, field, canonical) for field in fields}
    )


def _values(interfaces: Interfaces, field: Field, canonical: bool) -> st.SearchStrategy[Any]:
    if field.array is None:
        return _elements(interfaces, field.type, canonical)
    size = field.array.fixed
    least, most = (0, FEW) if size is None else (size, size)
    if field.is_bytes:
        return st.binary(min_size=least, max_size=most).map(lambda data: b64encode(data).decode())
    elements = _elements(interfaces, field.type, canonical)
    return st.lists(elements, min_size=least, max_size=most)


def _elements(interfaces: Interfaces, type_: str, canonical: bool) -> st.SearchStrategy[Any]:
    if type_ in INTEGERS:
        return st.integers(*INTEGERS[type_])
    if type_ in FLOATS:
        width: Any = 32 if type_ == "float32" else 64
        return st.floats(width=width, allow_nan=False) | st.sampled_from([nan, None])
    if type_ in STRINGS:
        return st.text(max_size=5)
    if type_ == "bool":
        return st.booleans()
    if type_ in TIMES:
        part = st.integers(*INTEGERS[TIMES[type_]])
        nsecs = st.integers(0, 999_999_999) if canonical else part
        return st.fixed_dictionaries({"secs": part, "nsecs": nsecs})
    return messages(interfaces, type_, canonical=canonical)


def with_nan(value: Any) -> Any:
    """The same value with NaN for every None in it."""
    return _replaced(value, lambda leaf: nan if leaf is None else leaf)


def comparable(value: Any) -> Any:
    """The same value with a text for every NaN in it, since NaN equals nothing."""
    return _replaced(value, lambda leaf: "NaN" if leaf != leaf else leaf)


def _replaced(value: Any, replace: Callable[[Any], Any]) -> Any:
    if isinstance(value, dict):
        return {name: _replaced(member, replace) for name, member in value.items()}
    if isinstance(value, list):
        return [_replaced(element, replace) for element in value]
    return replace(value)
