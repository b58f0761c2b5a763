"""The md5 and the full text that stand for a type, computed as genmsg does (gentools.py).

Two nodes understand each other if their md5s agree: it covers names and types, but no comments.
"""

from __future__ import annotations

from collections.abc import Callable
from hashlib import md5
from typing import TypeAlias

from fibws.interfaces.definition import MessageDefinition, ServiceDefinition
from fibws.interfaces.parser import FULL_TEXT_SEPARATOR

Lookup: TypeAlias = Callable[[str], MessageDefinition]
"""Finds the definition of a nested type by its full name."""


def message_md5(definition: MessageDefinition, lookup: Lookup) -> str:
    """The md5 of a message: 32 hexadecimal digits."""
    return _hexdigest(_md5_text(definition, lookup, {}))


def service_md5(definition: ServiceDefinition, lookup: Lookup) -> str:
    """The md5 of a service: that of its two texts, one behind the other."""
    request = _md5_text(definition.request, lookup, {})
    return _hexdigest(request + _md5_text(definition.response, lookup, {}))


def full_text(definition: MessageDefinition, lookup: Lookup) -> str:
    """The message's text, then that of every type nested in it, depth first, each once."""
    nested: dict[str, MessageDefinition] = {}
    _collect(definition, lookup, nested)
    parts = [definition.text, *(f"MSG: {name}\n{found.text}" for name, found in nested.items())]
    return f"\n{FULL_TEXT_SEPARATOR}\n".join(parts)


def _collect(
    definition: MessageDefinition, lookup: Lookup, nested: dict[str, MessageDefinition]
) -> None:
    for field in definition.fields:
        if field.is_nested and field.type not in nested:
            nested[field.type] = lookup(field.type)
            _collect(nested[field.type], lookup, nested)


def _md5_text(definition: MessageDefinition, lookup: Lookup, known: dict[str, str]) -> str:
    lines = [
        f"{constant.type} {constant.name}={constant.text}" for constant in definition.constants
    ]
    for field in definition.fields:
        if not field.is_nested:
            lines.append(f"{field.ros1_type} {field.name}")
            continue
        if field.type not in known:
            known[field.type] = _hexdigest(_md5_text(lookup(field.type), lookup, known))
        lines.append(f"{known[field.type]} {field.name}")
    return "\n".join(lines)


def _hexdigest(text: str) -> str:
    return md5(text.encode(), usedforsecurity=False).hexdigest()
