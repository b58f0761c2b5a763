"""Rates and drops: differences between two responses of /rosapi/statistics, or of /rosapi/hubs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from typing import Any, Self

Entry = dict[str, Any]
"""A response, or a client, a topic or a link in one, with the fields of its message."""

SORTS = ("rate", "bw", "name")
TOTALS = ("messages_received", "bytes_received", "messages_sent", "bytes_sent")
"""The totals of clients and of links; the rate of each is called ``<total>_per_second``."""


@dataclass(frozen=True, slots=True)
class TopicRates:
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
class ClientQueue:
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
    topics: list[TopicRates]
    clients: list[ClientQueue]

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
        stamp = seconds_of(now)
        seconds = stamp - seconds_of(before)
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


def clients(before: Entry, now: Entry) -> list[Entry]:
    """Return the clients of a response of /rosapi/statistics with their rates, sorted by node.

    Args:
        before: an older response.
        now: the newer one.
    """
    found = sorted(now["clients"], key=lambda each: str(each["node"]))
    return _with_rates(before, now, found, before["clients"], ("node",))


def links(before: Entry, now: Entry) -> list[Entry]:
    """Return the links of a response of /rosapi/hubs with their rates, sorted by name.

    Args:
        before: an older response.
        now: the newer one.
    """
    found = sorted(now["links"], key=lambda each: (each["name"], each["address"]))
    return _with_rates(before, now, found, before["links"], ("id", "kind"))


def topics_of(before: Entry, now: Entry, node: str) -> Entry:
    """Return what a client publishes and subscribes to, with rates.

    Args:
        before: an older response of /rosapi/statistics.
        now: the newer one.
        node: the client's node.
    """
    seconds = seconds_of(now) - seconds_of(before)
    older = {each["topic"]: each for each in before["topics"]}
    publications, subscriptions = [], []
    for topic in now["topics"]:
        name = topic["topic"]
        was = older.get(name, {"publishers": [], "subscriptions": []})
        for each in topic["publishers"]:
            if each["node"] == node:
                past = _sums(was["publishers"], node, "messages", "bytes")
                publications.append(
                    {
                        "topic": name,
                        "messages": each["messages"],
                        "bytes": each["bytes"],
                        "messages_per_second": per_second(
                            past["messages"], each["messages"], seconds
                        ),
                        "bytes_per_second": per_second(past["bytes"], each["bytes"], seconds),
                    }
                )
        mine = _sums(topic["subscriptions"], node, "messages", "dropped", "throttled")
        if any(each["node"] == node for each in topic["subscriptions"]):
            past = _sums(was["subscriptions"], node, "messages")
            rate = per_second(past["messages"], mine["messages"], seconds)
            subscriptions.append({"topic": name, **mine, "messages_per_second": rate})
    return {"published": publications, "subscribed": subscriptions}


def per_second(before: int, now: int, seconds: float) -> float:
    """Return the growth of a total in a second."""
    return round(max(0, now - before) / seconds, 3) if seconds > 0 else 0.0


def seconds_of(response: Entry) -> float:
    """Return the time of a response, in seconds since 1970."""
    stamp = response["stamp"]
    return float(stamp["secs"] + stamp["nsecs"] / 1e9)


def _with_rates(
    before: Entry, now: Entry, entries: list[Entry], older: list[Entry], key: tuple[str, ...]
) -> list[Entry]:
    """Return entries with their rates; totals of a new connection began at 0."""
    seconds = seconds_of(now) - seconds_of(before)
    known = {tuple(each[name] for name in key): each for each in older}
    found = []
    for each in entries:
        past = known.get(tuple(each[name] for name in key))
        is_same = past is not None and past["since"] == each["since"]
        start = past if past is not None and is_same else dict.fromkeys(TOTALS, 0)
        rates = {
            f"{name}_per_second": per_second(start[name], each[name], seconds) for name in TOTALS
        }
        found.append({**each, **rates})
    return found


def _rank(topic: TopicRates, sort: str) -> tuple[float, str]:
    return {"rate": -topic.rate, "bw": -topic.bandwidth}.get(sort, 0.0), topic.topic


def _topic(before: dict[str, Any], now: dict[str, Any], seconds: float) -> TopicRates:
    older, newer = before.get("publishers", []), now["publishers"]
    old_subscriptions, subscriptions = before.get("subscriptions", []), now["subscriptions"]
    per_second = 1 / seconds if seconds > 0 else 0.0
    return TopicRates(
        topic=now["topic"],
        rate=_increase(older, newer, "messages") * per_second,
        bandwidth=_increase(older, newer, "bytes") * per_second,
        publishers=len(newer),
        subscribers=len({each["node"] for each in subscriptions}),
        dropped=_increase(old_subscriptions, subscriptions, "dropped"),
        dropped_in_all=sum(each["dropped"] for each in subscriptions),
    )


def _client(now: dict[str, Any]) -> ClientQueue:
    return ClientQueue(**{field.name: now[field.name] for field in fields(ClientQueue)})


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


def _sums(entries: list[Entry], node: str, *names: str) -> dict[str, int]:
    """Return the sums of a node's entries."""
    own = [each for each in entries if each["node"] == node]
    return {name: sum(each[name] for each in own) for name in names}
