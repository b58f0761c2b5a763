"""The md5 that stands for a type, computed as genmsg does (gentools.py).

Two nodes understand each other if their md5s agree: it covers names and types, but no comments.
"""

from __future__ import annotations

from collections.abc import Callable
from hashlib import md5
from typing import TypeAlias

from fibws.interfaces.definition import MessageDefinition, ServiceDefinition

Lookup: TypeAlias = Callable[[str], MessageDefinition]
"""Finds the definition of a nested type by its full name."""


def message_md5(definition: MessageDefinition, lookup: Lookup, known: dict[str, str]) -> str:
    """The md5 of a message: 32 hexadecimal digits.

    Args:
        definition: the message's.
        lookup: finds the types nested in it.
        known: the md5s of nested types, as far as they were needed before; it is added to.
    """
    return _hexdigest(_md5_text(definition, lookup, known))


def service_md5(definition: ServiceDefinition, lookup: Lookup, known: dict[str, str]) -> str:
    """The md5 of a service: that of its two texts, one behind the other; as `message_md5`."""
    request = _md5_text(definition.request, lookup, known)
    return _hexdigest(request + _md5_text(definition.response, lookup, known))


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
