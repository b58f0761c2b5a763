"""What a text in a launch file is as a value: ``1`` a number, ``true`` a bool, ``1 m`` a text."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

from fibws.suggestions import nearest

Yaml: TypeAlias = Callable[[str], Any]
"""Reads a text in YAML; it raises `ValueError` if it is none."""

BOOLS = {"true": True, "1": True, "false": False, "0": False}
TYPES = ("auto", "str", "string", "int", "double", "bool", "boolean", "yaml")
"""What <param> may name as its type."""


def convert(text: str, type_: str, yaml: Yaml) -> Any:
    """The value of a text that is to have a type, one of `TYPES`.

    Raises:
        ValueError: there is no such type, or the text is none of it.
    """
    match type_:
        case "auto":
            return automatic(text)
        case "str" | "string":
            return text
        case "int" | "double":
            try:
                return int(text) if type_ == "int" else float(text)
            except ValueError:
                raise ValueError(f"{text.strip()[:80]!r} is no {type_}") from None
        case "bool" | "boolean":
            return boolean(text)
        case "yaml":
            return yaml(text)
    near = nearest({"float": "double"}.get(type_, type_), TYPES)
    hint = f"did you mean {near}?" if near else f"it is one of {', '.join(TYPES)}"
    raise ValueError(f"there is no type {type_!r}: {hint}")


def automatic(text: str) -> bool | int | float | str:
    """A number if the text is one, true or false if it says that, else the text itself."""
    try:
        if "." in text:
            return float(text)
        if "_" not in text:
            # Python would read 1_000 as a number, which no other ROS tool does.
            return int(text)
    except ValueError:
        pass
    if text.lower() in ("true", "false"):
        return boolean(text)
    return text


def boolean(text: str) -> bool:
    """True or false; it raises `ValueError` if the text says neither."""
    value = BOOLS.get(text.strip().lower())
    if value is None:
        raise ValueError(f"{text!r} is neither true nor false")
    return value
