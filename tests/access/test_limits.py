"""The limits of a principal: how they are read."""

from __future__ import annotations

import math

import pytest

from fibws.access.limits import Limits
from fibws.access.token_file import Tokens, digest_of
from fibws.errors import AccessError

FILE = f"""\
[tokens.teleop]
sha256 = "{digest_of("secret")}"

[tokens.teleop.limits]
connections = 3
messages_per_second = 0.5

[anonymous]
limits = {{subscriptions = 0}}
"""


def test_limits_are_read_from_the_file_of_tokens() -> None:
    tokens = Tokens.parse(FILE, "tokens.toml")
    teleop = tokens.find("secret")
    assert teleop is not None
    assert teleop.limits == Limits(connections=3, messages_per_second=0.5)
    assert tokens.anonymous is not None
    assert tokens.anonymous.limits == Limits(subscriptions=0)


def test_missing_limits_are_left_to_the_hub() -> None:
    assert Limits.parse({}, "limits") == Limits()
    assert Limits().table() == {}


def test_table_of_limits_is_read_back() -> None:
    limits = Limits(connections=3, bytes_per_second=0)
    assert Limits.parse(limits.table(), "limits") == limits


@pytest.mark.parametrize(
    ("table", "facts"),
    [
        (3, ("tokens.a.limits", "table", "3")),
        ({"connection": 3}, ("tokens.a.limits.connection", "did you mean connections")),
        ({"connections": -1}, ("tokens.a.limits.connections", ">= 0", "-1")),
        ({"connections": 1.5}, ("tokens.a.limits.connections", "whole", "1.5")),
        ({"connections": True}, ("tokens.a.limits.connections", "True")),
        ({"bytes_per_second": "1"}, ("tokens.a.limits.bytes_per_second", "'1'")),
        ({"bytes_per_second": math.inf}, ("tokens.a.limits.bytes_per_second", "inf")),
        ({"bytes_per_second": math.nan}, ("tokens.a.limits.bytes_per_second", "nan")),
    ],
)
def test_invalid_limits_are_refused(table: object, facts: tuple[str, ...]) -> None:
    with pytest.raises(AccessError) as refusal:
        Limits.parse(table, "tokens.a.limits")
    assert all(fact in str(refusal.value) for fact in facts)
