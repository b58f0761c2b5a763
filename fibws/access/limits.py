"""Limits of connections, registrations and rates that clients of a principal or address share."""

from __future__ import annotations

import ipaddress
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any, Self

from fibws.errors import AccessError
from fibws.suggestions import suggestion_or_known

PREFIX_LENGTH = 64
"""Bits of an IPv6 address that one customer has (RFC 6177): the rest is the customer's choice."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits that the clients of one principal share.

    None leaves a limit to the hub's settings; 0 means unlimited.

    Attributes:
        connections: clients at once.
        subscriptions: topics that they subscribe to.
        advertisements: topics, services and actions that they advertise.
        messages_per_second: messages that they send; all operations and pings count.
        bytes_per_second: bytes of these messages.
    """

    connections: int | None = None
    subscriptions: int | None = None
    advertisements: int | None = None
    messages_per_second: float | None = None
    bytes_per_second: float | None = None

    @classmethod
    def parse(cls, table: object, where: str) -> Self:
        """Return the limits of a TOML table or a JSON object.

        Args:
            where: the table's name, for errors.

        Raises:
            AccessError: a limit is unknown, or is not a number >= 0.
        """
        if not isinstance(table, Mapping):
            raise AccessError(f"{where} must be a table of limits, got {table!r}")
        for key, value in table.items():
            if key not in LIMIT_NAMES:
                raise AccessError(
                    f"unknown limit {where}.{key}{suggestion_or_known(key, LIMIT_NAMES)}"
                )
            _check(value, f"{where}.{key}", whole=key in WHOLE)
        return cls(**table)

    def with_defaults(self, defaults: Self) -> Self:
        """Return these limits with others in place of None."""
        return type(self)(**{**defaults.table(), **self.table()})

    def table(self) -> dict[str, Any]:
        """Return the table that `parse` takes."""
        return {name: value for name in LIMIT_NAMES if (value := getattr(self, name)) is not None}


LIMIT_NAMES = tuple(field.name for field in fields(Limits))
DEFAULT = Limits()
"""Leaves all limits to the hub's settings."""
WHOLE = ("connections", "subscriptions", "advertisements")


def _check(value: object, where: str, *, whole: bool) -> None:
    kinds = int if whole else int | float
    if not isinstance(value, kinds) or isinstance(value, bool) or not 0 <= value < math.inf:
        expected = "a whole number" if whole else "a number"
        raise AccessError(f"{where} must be {expected} >= 0, got {value!r}")


@lru_cache(maxsize=1024)
def network_of(address: str) -> str:
    """Return the network that counts as one address: of IPv6 the first 64 bits."""
    try:
        parsed = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(parsed, ipaddress.IPv4Address):
        return str(parsed)
    if parsed.ipv4_mapped is not None:
        return str(parsed.ipv4_mapped)
    network = ipaddress.ip_network((int(parsed), PREFIX_LENGTH), strict=False)
    return str(network)
