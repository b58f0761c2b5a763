"""Rates and drops: the difference between two responses of /rosapi/statistics."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from typing import Any, Self

SORTS = ("rate", "bw", "name")


@dataclass(frozen=True, slots=True)
class Topic:
    """The messages of a topic between two responses."""

    topic: str
    rate: float
    """Messages per second from all publishers."""
    bandwidth: float
    """Bytes per second that the hub received."""
    publishers: int
    subscribers: int
    dropped: int
    """Messages dropped because subscribers were too slow."""
    dropped_in_all: int
    """The same since the current subscriptions began."""


@dataclass(frozen=True, slots=True)
class Client:
    """A client's send queue; ``dropped`` counts since it connected."""

    node: str
    address: str
    kept_bytes: int
    dropped: int
    slow: bool


@dataclass(frozen=True, slots=True)
class Measurement:
    """The topics and clients between two responses."""

    stamp: float
    """The time of the newer response by the hub's clock, in seconds since 1970."""
    seconds: float
    topics: list[Topic]
    clients: list[Client]

    @classmethod
    def between(
        cls, before: dict[str, Any], now: dict[str, Any], *, exclude: str, sort: str
    ) -> Self:
        """Compare two responses of /rosapi/statistics.

        Args:
            before: the older one; if both are the same, rates are 0.
            now: the newer one.
            exclude: the node that requested them.
            sort: the order of topics: one of `SORTS`.
        """
        stamp = _seconds(now["stamp"])
        seconds = stamp - _seconds(before["stamp"])
        older = {each["topic"]: each for each in before["topics"]}
        topics = [_topic(older.get(each["topic"], {}), each, seconds) for each in now["topics"]]
        clients = [_client(each) for each in now["clients"] if each["node"] != exclude]
        return cls(
            stamp,
            max(0.0, seconds),
            sorted(topics, key=lambda each: _rank(each, sort)),
            sorted(clients, key=lambda each: (-each.slow, -each.kept_bytes, each.node)),
        )

    def as_json(self) -> dict[str, Any]:
        """Return all of it for JSON."""
        return asdict(self)


def _rank(topic: Topic, sort: str) -> tuple[float, str]:
    return {"rate": -topic.rate, "bw": -topic.bandwidth}.get(sort, 0.0), topic.topic


def _topic(before: dict[str, Any], now: dict[str, Any], seconds: float) -> Topic:
    older, newer = before.get("publishers", []), now["publishers"]
    old_subscriptions, subscriptions = before.get("subscriptions", []), now["subscriptions"]
    per_second = 1 / seconds if seconds > 0 else 0.0
    return Topic(
        topic=now["topic"],
        rate=_increase(older, newer, "messages") * per_second,
        bandwidth=_increase(older, newer, "bytes") * per_second,
        publishers=len(newer),
        subscribers=len({each["node"] for each in subscriptions}),
        dropped=_increase(old_subscriptions, subscriptions, "dropped"),
        dropped_in_all=sum(each["dropped"] for each in subscriptions),
    )


def _client(now: dict[str, Any]) -> Client:
    return Client(**{field.name: now[field.name] for field in fields(Client)})


def _increase(before: Iterable[dict[str, Any]], now: Iterable[dict[str, Any]], number: str) -> int:
    """Return the increase of a total of nodes; one that was restarted began at 0."""
    older, newer = _totals(before, number), _totals(now, number)
    return sum(
        total - older.get(node, 0) if total >= older.get(node, 0) else total
        for node, total in newer.items()
    )


def _totals(each_node: Iterable[dict[str, Any]], number: str) -> dict[str, int]:
    totals: dict[str, int] = {}
    for each in each_node:
        totals[each["node"]] = totals.get(each["node"], 0) + each[number]
    return totals


def _seconds(stamp: dict[str, int]) -> float:
    return stamp["secs"] + stamp["nsecs"] / 1e9
