"""What goes on in the graph: the differences of two answers of /rosapi/statistics."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any, Self

SORTS = ("rate", "bw", "name")


@dataclass(frozen=True, slots=True)
class Topic:
    """What went over a topic in the time that was measured."""

    topic: str
    rate: float
    """Messages a second, of all publishers."""
    bandwidth: float
    """Bytes a second, as they came to the hub."""
    publishers: int
    subscribers: int
    dropped: int
    """Messages that subscribers were too slow for."""
    dropped_in_all: int
    """The same, since those who subscribe now do."""


@dataclass(frozen=True, slots=True)
class Client:
    """How a client keeps up; ``dropped`` counts from its coming on."""

    node: str
    address: str
    kept_bytes: int
    dropped: int
    slow: bool


@dataclass(frozen=True, slots=True)
class Measure:
    """What went on within some seconds."""

    stamp: float
    """When it was measured, by the hub's clock, in seconds since 1970."""
    seconds: float
    topics: list[Topic]
    clients: list[Client]

    @classmethod
    def between(cls, before: dict[str, Any], now: dict[str, Any], *, but: str, sort: str) -> Self:
        """What went on between two answers of /rosapi/statistics.

        Args:
            before: the older one; if it is the newer one itself, nothing went on.
            now: the newer one.
            but: the node that asks, which is no part of it.
            sort: what comes first: one of `SORTS`.
        """
        stamp = _seconds(now["stamp"])
        seconds = stamp - _seconds(before["stamp"])
        older = {each["topic"]: each for each in before["topics"]}
        topics = [_topic(older.get(each["topic"], {}), each, seconds) for each in now["topics"]]
        clients = [Client(**each) for each in now["clients"] if each["node"] != but]
        return cls(
            stamp,
            max(0.0, seconds),
            sorted(topics, key=lambda each: _rank(each, sort)),
            sorted(clients, key=lambda each: (-each.slow, -each.kept_bytes, each.node)),
        )

    def as_json(self) -> dict[str, Any]:
        """All of it, fit for JSON."""
        return asdict(self)


def _rank(topic: Topic, sort: str) -> tuple[float, str]:
    return {"rate": -topic.rate, "bw": -topic.bandwidth}.get(sort, 0.0), topic.topic


def _topic(before: dict[str, Any], now: dict[str, Any], seconds: float) -> Topic:
    older, newer = before.get("publishers", []), now["publishers"]
    heard, hear = before.get("subscriptions", []), now["subscriptions"]
    per_second = 1 / seconds if seconds > 0 else 0.0
    return Topic(
        topic=now["topic"],
        rate=_more(older, newer, "messages") * per_second,
        bandwidth=_more(older, newer, "bytes") * per_second,
        publishers=len(newer),
        subscribers=len({each["node"] for each in hear}),
        dropped=_more(heard, hear, "dropped"),
        dropped_in_all=sum(each["dropped"] for each in hear),
    )


def _more(before: Iterable[dict[str, Any]], now: Iterable[dict[str, Any]], number: str) -> int:
    """By how much a total of some nodes grew; who begins anew within the time begins at 0."""
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
