"""What a type is made of, in the lines of rosmsg show."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, NamedTuple

from fibws.values.typedefs import TIMES, Typedefs

if TYPE_CHECKING:
    from fibws.interfaces import MessageDefinition


class Member(NamedTuple):
    """One line of a definition, and the message type whose lines follow it, if it is a field's."""

    line: str
    nested: str | None = None


Look = Callable[[str], list[Member]]
"""Gives the members of a message type by its name: constants first, then fields."""


def lines(members: list[Member], look: Look, indent: str = "") -> Iterator[str]:
    """A type's lines, with those of the types in it two blanks to the right of them."""
    for line, nested in members:
        yield indent + line
        if nested is not None:
            yield from lines(look(nested), look, f"{indent}  ")


def of_definition(definition: MessageDefinition) -> list[Member]:
    """The members of a message that is defined here."""
    constants = [Member(f"{each.type} {each.name}={each.text}") for each in definition.constants]
    fields = [
        Member(f"{each.full_type} {each.name}", each.type if each.is_nested else None)
        for each in definition.fields
    ]
    return constants + fields


def of_typedefs(typedefs: Typedefs, type_: str) -> list[Member]:
    """The members of a message that the hub told of; it does not tell the types of constants."""
    constants = [Member(f"{name}={value}") for name, value in typedefs.constants(type_).items()]
    fields = [
        Member(
            f"{each.written_type} {each.name}",
            each.type if each.type in typedefs and each.type not in TIMES else None,
        )
        for each in typedefs.fields(type_)
    ]
    return constants + fields
