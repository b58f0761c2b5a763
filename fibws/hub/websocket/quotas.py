"""Quotas: limits that the clients of one principal, or of one address, share.

Rates are measured by token buckets. A client is charged once in a millisecond, or for 16 KiB, and
not for each message: one that is within its limits costs next to nothing more. A client whose
bucket is empty has its messages dropped until the bucket has something again, and is closed if that
goes on.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import Literal, Protocol, TypeAlias

from fibws.access.limits import LIMIT_NAMES, Limits, network_of
from fibws.access.rights import Principal
from fibws.hub.errors import LimitReached
from fibws.hub.settings import KIB, Settings
from fibws.hub.websocket.endpoint import Registration

BURST_SECONDS = 2.0
"""Size of a burst, in seconds of the rate."""
LEAST_MESSAGES = 100
"""Messages that may come at once at any rate: a node registers much when it starts."""
LEAST_BYTES = 64 * KIB
"""Bytes that may come at once at any rate."""
CHARGE_SECONDS = 0.001
"""Seconds after which a client is charged again: not more often, to cost it next to nothing."""
CHARGED_BYTES = 16 * KIB
"""Bytes with which a client is charged at once."""
SUSTAINED_SECONDS = 5
"""Seconds in a row with dropped messages after which a client is closed."""
MOST_IDLE = 10_000
"""Addresses and principals without clients that are remembered; more forget the oldest."""

Whose: TypeAlias = Literal["client", "principal", "address"]


class QuotaMember(Protocol):
    """A client's connection, as far as it counts here."""

    @property
    def node(self) -> str:
        """The global name of the client's node; empty before it has one."""

    @property
    def messages_received(self) -> int:
        """How many messages have come from the client."""

    def registrations(self, what: Registration) -> int:
        """Return how many of something the client has registered."""


class TokenBucket:
    """Measures a rate: full at first, it loses what is charged and gains its rate each second.

    It may be charged more than it has, as it is after the fact; that must be gained back, too. In
    the long run no more comes than the rate, the burst, and the last charge.

    Args:
        rate: what it gains in a second; more than 0.
        least: what it holds at least when it is full.
    """

    __slots__ = ("_at", "_level", "burst", "rate")

    def __init__(self, rate: float, least: float, now: float) -> None:
        self.rate = rate
        self.burst = max(rate * BURST_SECONDS, least)
        self._level = self.burst
        self._at = now

    def charge(self, amount: float, now: float) -> float:
        """Take an amount; return the seconds until there is something left."""
        level = self._level + (now - self._at) * self.rate
        if level > self.burst:
            level = self.burst
        level -= amount
        self._level = level
        self._at = now
        return 0.0 if level > 0 else -level / self.rate

    def is_full(self, now: float) -> bool:
        """Return whether it holds as much as at first."""
        return self._level + (now - self._at) * self.rate >= self.burst


@dataclass(frozen=True, slots=True)
class ArrivalRate:
    """A limited rate.

    Attributes:
        refusal: the text for a client that has gone beyond it.
    """

    bucket: TokenBucket
    refusal: str


class Quota:
    """Use and limits of the clients of one principal or one address.

    Two proofs of one principal may have different limits: each such group of clients has a quota
    with its own rates, but connections and registrations of all of them count together.

    Args:
        whose: what they have in common, for errors.
        limits: without None.
        flags: where each limit was set, by its name.
        group: the quotas of the same principal or address, by their limits, with this one.
    """

    __slots__ = ("bytes", "flags", "group", "limits", "members", "messages", "whose")

    def __init__(
        self,
        whose: Whose,
        limits: Limits,
        flags: dict[str, str],
        now: float,
        group: Mapping[Limits, Quota],
    ) -> None:
        self.whose = whose
        self.limits = limits
        self.flags = flags
        self.group = group
        self.members: set[QuotaMember] = set()
        self.messages = self._rate("messages_per_second", LEAST_MESSAGES, now)
        self.bytes = self._rate("bytes_per_second", LEAST_BYTES, now)

    def check_room(self, what: Registration) -> None:
        """Raise `LimitReached` if its clients have as many of something as they may have."""
        limit = getattr(self.limits, what)
        if limit and self._registrations(what) >= limit:
            raise LimitReached(self._refusal(what))

    def check_connections(self, node: str | None) -> None:
        """Raise `LimitReached` if there is no room for another client.

        Args:
            node: the node that it wants to be. There is room if one of the clients is that node,
                which will be replaced: its connection may be broken without the hub knowing yet.
        """
        limit = self.limits.connections
        if not limit or sum(len(quota.members) for quota in self.group.values()) < limit:
            return
        members = chain.from_iterable(quota.members for quota in self.group.values())
        if node not in [each.node for each in members]:
            raise LimitReached(self._refusal("connections"))

    def is_idle(self, now: float) -> bool:
        """Return whether it has no client, and is as it was at first."""
        rates = filter(None, (self.messages, self.bytes))
        return not self.members and all(rate.bucket.is_full(now) for rate in rates)

    def _registrations(self, what: Registration) -> int:
        members = chain.from_iterable(quota.members for quota in self.group.values())
        return sum(each.registrations(what) for each in members)

    def _rate(self, name: str, least: int, now: float) -> ArrivalRate | None:
        rate = getattr(self.limits, name)
        return ArrivalRate(TokenBucket(rate, least, now), self._refusal(name)) if rate else None

    def _refusal(self, name: str) -> str:
        what = name.replace("_", " ")
        limit = getattr(self.limits, name)
        return f"too many {what} of one {self.whose} (limit {limit:g}, {self.flags[name]})"


class Meter:
    """Measures what one client sends, and says when to drop it.

    A client keeps its meter as long as it is connected, so that a new login makes nothing good.

    Attributes:
        refusal: why messages are dropped now; None if they are not.
        reason: why messages were dropped last.
        charged: messages of the client that have been charged, or dropped.
        uncharged_bytes: bytes that have come since the last charge.
        due: when the next charge is due, unless there are `CHARGED_BYTES` before.
    """

    __slots__ = (
        "_bytes",
        "_dropped",
        "_messages",
        "_resumes",
        "_strikes",
        "charged",
        "due",
        "reason",
        "refusal",
        "uncharged_bytes",
    )

    def __init__(self) -> None:
        self._messages: tuple[ArrivalRate, ...] = ()
        self._bytes: tuple[ArrivalRate, ...] = ()
        self._resumes = 0.0
        self._strikes = 0
        self._dropped = 0
        self.refusal: str | None = None
        self.reason = ""
        self.charged = 0
        self.uncharged_bytes = 0
        self.due = -math.inf

    def set_quotas(self, quotas: Iterable[Quota], received: int) -> None:
        """Charge other quotas from now on, and accept messages until these refuse them.

        Args:
            received: messages that have come so far.
        """
        if not self.is_needed:  # It has not measured until now.
            self.charged = received
            self.uncharged_bytes = 0
        quotas = tuple(quotas)
        self._messages = tuple(each.messages for each in quotas if each.messages)
        self._bytes = tuple(each.bytes for each in quotas if each.bytes)
        self._resumes = 0.0
        self.refusal = None
        self.due = -math.inf

    @property
    def is_needed(self) -> bool:
        """Whether any rate is limited."""
        return bool(self._messages or self._bytes)

    def charge(self, messages: int, size: int, now: float) -> None:
        """Charge what has come; sets ``refusal`` if that was more than the client may send."""
        self.charged += messages
        self.due = now + CHARGE_SECONDS
        for amount, rates in ((messages, self._messages), (size, self._bytes)):
            for rate in rates:
                seconds = rate.bucket.charge(amount, now)
                if seconds:
                    self.refusal = self.reason = rate.refusal
                    self._resumes = max(self._resumes, now + seconds)

    def resumes(self, now: float) -> bool:
        """Return whether messages that were dropped until now may come again."""
        if now < self._resumes:
            return False
        self.refusal = None
        return True

    def sweep(self, dropped: int) -> bool:
        """Return whether the client has gone beyond a limit for too long; called once a second.

        Args:
            dropped: messages of the client that were dropped so far.
        """
        self._strikes = self._strikes + 1 if dropped > self._dropped else 0
        self._dropped = dropped
        return self._strikes >= SUSTAINED_SECONDS


class Quotas:
    """The quotas of all principals and addresses of one hub.

    Only limits that are set cost anything: a quota without any is not made.
    """

    def __init__(self, settings: Settings) -> None:
        self._client = Limits(
            messages_per_second=settings.max_messages_per_second,
            bytes_per_second=settings.max_bytes_per_second,
        ).with_defaults(NO_LIMITS)
        self._address = Limits(
            settings.max_address_connections,
            settings.max_address_subscriptions,
            settings.max_address_advertisements,
            settings.max_address_messages_per_second,
            settings.max_address_bytes_per_second,
        )
        self._principal = Limits(
            settings.max_principal_connections,
            settings.max_principal_subscriptions,
            settings.max_principal_advertisements,
            settings.max_principal_messages_per_second,
            settings.max_principal_bytes_per_second,
        )
        self._handshakes_per_second = settings.max_address_handshakes_per_second
        self._handshakes: OrderedDict[str, TokenBucket] = OrderedDict()
        """By address, those that have sent requests lately; the oldest request comes first."""
        self._groups: OrderedDict[tuple[Whose, str], dict[Limits, Quota]] = OrderedDict()
        """The quotas of principals and addresses, by their limits; the oldest use comes first."""

    def __len__(self) -> int:
        return sum(map(len, self._groups.values())) + len(self._handshakes)

    def handshake_refusal(self, address: str, now: float) -> str | None:
        """Return why an address may send no request now; None if it may, which is counted."""
        limit = self._handshakes_per_second
        if not limit:
            return None
        network = network_of(address)
        bucket = self._handshakes.get(network)
        if bucket is None:
            bucket = self._handshakes[network] = TokenBucket(limit, LEAST_MESSAGES, now)
            if len(self._handshakes) > MOST_IDLE:
                self._handshakes.popitem(last=False)
        self._handshakes.move_to_end(network)
        if not bucket.charge(1, now):
            return None
        bucket.charge(-1, now)
        flag = "--max-address-handshakes-per-second"
        return f"too many handshakes per second of one address (limit {limit:g}, {flag})"

    def of_client(self, now: float) -> Quota | None:
        """Return a new quota for one client alone; None if it is unlimited."""
        if not _is_limited(self._client):
            return None
        flags = {name: _flag("client", name) for name in LIMIT_NAMES}
        return Quota("client", self._client, flags, now, {})

    def of_address(self, address: str, now: float) -> Quota | None:
        """Return the quota of an address; None if it is unlimited."""
        if not _is_limited(self._address):
            return None
        flags = {name: _flag("address", name) for name in LIMIT_NAMES}
        return self._shared("address", network_of(address), self._address, flags, now)

    def of_principal(self, principal: Principal, now: float) -> Quota | None:
        """Return the quota of a principal; None if it is unlimited."""
        own = principal.limits.table()
        limits = principal.limits.with_defaults(self._principal)
        if not _is_limited(limits):
            return None
        flags = {
            name: f"limits.{name} of its token" if name in own else _flag("principal", name)
            for name in LIMIT_NAMES
        }
        return self._shared("principal", principal.title, limits, flags, now)

    def sweep(self, now: float) -> None:
        """Forget addresses and principals that have no clients, and have been quiet for a while."""
        for network in [each for each, bucket in self._handshakes.items() if bucket.is_full(now)]:
            del self._handshakes[network]
        idle = [
            (key, quota)
            for key, group in self._groups.items()
            for quota in group.values()
            if not quota.members
        ]
        for number, (key, quota) in enumerate(idle):
            if len(idle) - number > MOST_IDLE or quota.is_idle(now):
                group = self._groups[key]
                del group[quota.limits]
                if not group:
                    del self._groups[key]

    def _shared(
        self, whose: Whose, key: str, limits: Limits, flags: dict[str, str], now: float
    ) -> Quota:
        group = self._groups.setdefault((whose, key), {})
        self._groups.move_to_end((whose, key))
        if limits not in group:
            group[limits] = Quota(whose, limits, flags, now, group)
        return group[limits]


class ClientQuotas:
    """The quotas that one client belongs to: its own, its address's, and its principal's."""

    __slots__ = ("_joined", "_meter", "_quotas", "meter")

    def __init__(self, quotas: Quotas) -> None:
        self._quotas = quotas
        self._joined: dict[Whose, Quota] = {}
        self._meter = Meter()
        self.meter: Meter | None = None
        """Measures what the client sends; None if its rates are unlimited."""

    def join_address(
        self, member: QuotaMember, address: str, now: float, node: str | None = None
    ) -> None:
        """Count the client of an address; raises `LimitReached` if there are too many.

        Args:
            node: the node that the client wants to be.
        """
        self._join(member, "address", self._quotas.of_address(address, now), node)
        own = self._quotas.of_client(now)
        if own is not None:
            self._joined["client"] = own
        self._set_meter(member)

    def join_principal(
        self, member: QuotaMember, principal: Principal, now: float, node: str | None = None
    ) -> None:
        """Count the client of a principal; raises and arguments as in `join_address`."""
        self._join(member, "principal", self._quotas.of_principal(principal, now), node)
        self._set_meter(member)

    def check_room(self, what: Registration) -> None:
        """Raise `LimitReached` if the limit of this kind of registration is reached."""
        for quota in self._joined.values():
            if quota.whose != "client":
                quota.check_room(what)

    def leave(self, member: QuotaMember) -> None:
        """Stop counting the client; the second call does nothing."""
        for quota in self._joined.values():
            quota.members.discard(member)
        self._joined.clear()

    def _join(
        self, member: QuotaMember, whose: Whose, quota: Quota | None, node: str | None
    ) -> None:
        older = self._joined.get(whose)
        if quota is not None and (older is None or older.group is not quota.group):
            quota.check_connections(node)
        self._joined.pop(whose, None)
        if older is not None:
            older.members.discard(member)
        if quota is not None:
            self._joined[whose] = quota
            quota.members.add(member)

    def _set_meter(self, member: QuotaMember) -> None:
        self._meter.set_quotas(self._joined.values(), member.messages_received)
        self.meter = self._meter if self._meter.is_needed else None


NO_LIMITS = Limits(0, 0, 0, 0, 0)


def _is_limited(limits: Limits) -> bool:
    return any(limits.table().values())


def _flag(whose: Whose, name: str) -> str:
    owner = "" if whose == "client" else f"{whose}-"
    return f"--max-{owner}{name.replace('_', '-')}"
