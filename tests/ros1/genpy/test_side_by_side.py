"""Messages are what the real genpy makes of them: in Python, as text, in bytes."""

from __future__ import annotations

import random

import pytest

from fibws.interfaces import Interfaces, builtin
from fibws.interfaces.definition import Field

from .conftest import Agree, say

INTERFACES = Interfaces()
TYPES = [name for package in INTERFACES.packages() for name in INTERFACES.messages(package)]
TEXTS = ["", "hello", "two words", "grüße 🤖", "line\nbreak", "yes", "x" * 90, 'a "b" \\', "\0"]
LONG = 5000
"""The length of a definition of which one random message is compared, not three."""
FLOATS = ["0.0", "-1.5", "1e300", "nan", "inf", "-inf", "3", "0.1"]
FLOATS32 = ["0.0", "-1.5", "nan", "inf", "-inf", "3", "0.25"]

ABOUT = "(C({t!r}).__slots__, C({t!r})._slot_types, C({t!r})._md5sum, C({t!r})._has_header)"


@pytest.mark.long
def test_standard_messages_are_the_same(agree: Agree) -> None:
    # The longest first: the real genpy makes the classes of a definition's parts with it.
    for type_ in sorted(TYPES, key=lambda type_: -len(INTERFACES.full_text(type_))):
        check_type(agree, type_)


def check_type(agree: Agree, type_: str) -> None:
    new = f"M({type_!r})"
    asked = [
        *(ABOUT.format(t=type_), f"C({type_!r})._full_text", f"constants(C({type_!r}))"),
        *(f"str({new})", f"repr({new})", f"packed({new})", f"parts({new})"),
    ]
    chance = random.Random(type_)
    for _ in range(1 if len(INTERFACES.full_text(type_)) > LONG else 3):
        message = written(type_, chance)
        data = say(f"packed({message})")
        read = f"{new}.deserialize({data})"
        asked += [f"str({message})", f"parts({message})", f"packed({message})"]
        asked += [f"parts({read})", f"str({read})", f"packed({read}) == {data}"]
    agree.on_all(type_, asked, type_)


@pytest.mark.parametrize("type_", ["roscpp/Empty", "roscpp/GetLoggers", "roscpp/SetLoggerLevel"])
def test_services_are_the_same(agree: Agree, type_: str) -> None:
    agree(f"(srv({type_!r}), srv({type_!r})._type, srv({type_!r})._md5sum)")
    for part in ("_request_class", "_response_class"):
        message = f"srv({type_!r}).{part}"
        agree(message)
        for name in ("_type", "_md5sum", "_full_text", "__slots__", "_slot_types", "_has_header"):
            agree(f"{message}.{name}")
        agree(f"str({message}())")
        agree(f"packed({message}())")


def written(type_: str, chance: random.Random) -> str:
    """An expression that makes a message with something in every field."""
    fields = INTERFACES.message(type_).fields
    values = ", ".join(f"{field.name}={any_value(field, chance)}" for field in fields)
    return f"M({type_!r}, {values})" if values else f"M({type_!r})"


def any_value(field: Field, chance: random.Random) -> str:
    if field.array is None:
        return element(field.type, chance)
    size = chance.randrange(4) if field.array.fixed is None else field.array.fixed
    elements = [element(field.type, chance) for _ in range(size)]
    if field.is_bytes and chance.random() < 0.5:
        return repr(bytes(map(int, elements)))
    return f"[{', '.join(elements)}]"


def element(type_: str, chance: random.Random) -> str:
    if type_ in builtin.INTEGERS:
        low, high = builtin.INTEGERS[type_]
        return str(chance.choice([low, high, 0, chance.randint(low, high)]))
    if type_ == "bool":
        return chance.choice(["True", "False"])
    if type_ in builtin.FLOATS:
        return chance.choice(FLOATS if type_ == "float64" else FLOATS32)
    if type_ in builtin.STRINGS:
        return repr(chance.choice(TEXTS))
    if type_ == "time":
        return f"Time({chance.randrange(2**31)}, {chance.randrange(10**9)})"
    if type_ == "duration":
        return f"Duration({chance.randrange(-(2**31), 2**31)}, {chance.randrange(10**9)})"
    return written(type_, chance)
