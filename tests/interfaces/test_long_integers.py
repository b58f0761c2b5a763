"""64-bit integers as strings."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.interfaces import Interfaces, Validators
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.client_definitions import ClientDefinitions
from fibws.interfaces.long_integers import LongIntegers

SEPARATOR = "\n" + "=" * 80 + "\nMSG: "
TEXT = (
    f"Inner one\nInner[] many\nInner[1] fixed\nint32 small{SEPARATOR}"
    "my_msgs/Inner\nint64 signed\nuint64[] unsigned\ntime stamp\nfloat64 real"
)


def learned() -> Definitions:
    definition = ClientDefinitions(Interfaces()).read("msg", "my_msgs/Outer", TEXT, "/client")
    assert definition is not None
    return definition


DEFINITIONS = learned()
LONG = LongIntegers(DEFINITIONS)
VALIDATE = Validators(DEFINITIONS, lambda: 0).of("my_msgs/Outer").validate


def inner(number: Any, numbers: list[Any]) -> dict[str, Any]:
    stamp = {"secs": 2**32 - 1, "nsecs": 1}
    return {"signed": number, "unsigned": numbers, "stamp": stamp, "real": 1.5}


def outer(number: Any, numbers: list[Any]) -> dict[str, Any]:
    one = inner(number, numbers)
    return {"one": one, "many": [one, one], "fixed": [one], "small": 5}


def test_every_long_integer_becomes_a_string() -> None:
    convert = LONG.of("my_msgs/Outer")
    assert convert is not None
    message = outer(-(2**63), [0, 2**64 - 1])
    assert convert(message) == outer("-9223372036854775808", ["0", "18446744073709551615"])
    assert message == outer(-(2**63), [0, 2**64 - 1])


def test_converting_back_restores_the_message() -> None:
    convert = LONG.of("my_msgs/Outer")
    assert convert is not None
    message = VALIDATE(outer(-(2**63), [0, 2**64 - 1]))
    lenient = Validators(DEFINITIONS, lambda: 0, lenient=True).of("my_msgs/Outer")
    assert lenient.validate(convert(message)) == message


@pytest.mark.parametrize(
    ("name", "is_needed"),
    [
        ("std_msgs/Int64", True),
        ("std_msgs/UInt64MultiArray", True),
        ("std_msgs/Int32", False),
        ("std_msgs/Time", False),
        ("sensor_msgs/Image", False),
        ("nav_msgs/Odometry", False),
    ],
)
def test_other_types_need_no_conversion(name: str, is_needed: bool) -> None:
    assert (LONG.of(name) is not None) == is_needed
