"""Differences between two responses of /rosapi/statistics."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.client.statistics import ClientQueue, Measurement, TopicRates

ME = "/fibws_top_1_2"


def topic(
    name: str, *, published: dict[str, tuple[int, int]] | None = None, **dropped: int
) -> dict[str, Any]:
    """Return a topic as the hub reports it, with messages and bytes of publishers, and drops."""
    return {
        "topic": name,
        "publishers": [
            {"node": node, "messages": messages, "bytes": number}
            for node, (messages, number) in (published or {}).items()
        ],
        "subscriptions": [
            {"node": f"/{node}", "messages": 1000, "dropped": number}
            for node, number in dropped.items()
        ],
    }


def statistics(
    seconds: float, *topics: dict[str, Any], clients: tuple[dict[str, Any], ...] = ()
) -> dict[str, Any]:
    return {
        "revision": 1,
        "stamp": {"secs": 1700000000 + int(seconds), "nsecs": int(seconds % 1 * 1e9)},
        "topics": list(topics),
        "clients": list(clients),
    }


def client(node: str, **others: Any) -> dict[str, Any]:
    return {
        "node": node,
        "address": "127.0.0.1:5",
        "kept_bytes": 0,
        "dropped": 0,
        "slow": False,
        **others,
    }


def between(before: dict[str, Any], now: dict[str, Any], sort: str = "rate") -> Measurement:
    return Measurement.between(before, now, exclude=ME, sort=sort)


def one(before: dict[str, Any], now: dict[str, Any], seconds: float = 2) -> TopicRates:
    (topic,) = between(statistics(0, before), statistics(seconds, now)).topics
    return topic


def test_rates_are_differences_by_the_hubs_clock() -> None:
    measured = one(
        topic("/t", published={"/a": (100, 1000), "/b": (5, 50)}, x=3, y=0),
        topic("/t", published={"/a": (120, 1400), "/b": (6, 60)}, x=7, y=1),
    )
    assert measured == TopicRates(
        "/t", rate=10.5, bandwidth=205, publishers=2, subscribers=2, dropped=5, dropped_in_all=8
    )


def test_new_nodes_count_from_0() -> None:
    measured = one(
        topic("/t", published={"/a": (100, 0)}),
        topic("/t", published={"/a": (100, 0), "/b": (8, 0)}, x=2),
    )
    assert (measured.rate, measured.dropped) == (4, 2)


def test_nodes_that_left_do_not_count() -> None:
    measured = one(
        topic("/t", published={"/a": (100, 0), "/b": (7, 0)}, x=5),
        topic("/t", published={"/a": (102, 0)}),
    )
    assert (measured.rate, measured.dropped, measured.publishers) == (1, 0, 1)


def test_restarted_nodes_count_from_0() -> None:
    measured = one(topic("/t", published={"/a": (100, 0)}), topic("/t", published={"/a": (4, 0)}))
    assert measured.rate == 2


def test_new_topics_count_from_0() -> None:
    now = statistics(1, topic("/t", published={"/a": (3, 0)}))
    assert between(statistics(0), now).topics[0].rate == 3


def test_two_subscriptions_of_a_node_are_one_subscriber() -> None:
    now = topic("/t", x=1)
    now["subscriptions"] *= 2
    assert one(topic("/t", x=1), now).subscribers == 1


def test_first_measurement_has_no_rates() -> None:
    response = statistics(1, topic("/t", published={"/a": (3, 9)}, x=4))
    measurement = between(response, response)
    assert measurement.seconds == 0
    assert (measurement.topics[0].rate, measurement.topics[0].dropped_in_all) == (0, 4)


@pytest.mark.parametrize(
    ("sort", "names"),
    [
        ("rate", ["/many", "/big", "/idle"]),
        ("bw", ["/big", "/many", "/idle"]),
        ("name", ["/big", "/idle", "/many"]),
    ],
)
def test_topics_are_sorted(sort: str, names: list[str]) -> None:
    now = statistics(
        1,
        topic("/big", published={"/a": (1, 5000)}),
        topic("/idle"),
        topic("/many", published={"/a": (10, 100)}),
    )
    assert [each.topic for each in between(statistics(0), now, sort).topics] == names


def test_slow_clients_come_first_without_the_tool() -> None:
    now = statistics(
        1, clients=(client("/a"), client(ME), client("/b", slow=True), client("/c", kept_bytes=1))
    )
    measurement = between(statistics(0), now)
    assert [each.node for each in measurement.clients] == ["/b", "/c", "/a"]
    assert measurement.clients[0] == ClientQueue("/b", "127.0.0.1:5", 0, 0, True)


def test_measurement_as_json() -> None:
    response = statistics(1.5, topic("/t"), clients=(client("/a"),))
    assert between(statistics(1), response).as_json() == {
        "stamp": 1700000001.5,
        "seconds": 0.5,
        "topics": [
            {
                "topic": "/t",
                "rate": 0,
                "bandwidth": 0,
                "publishers": 0,
                "subscribers": 0,
                "dropped": 0,
                "dropped_in_all": 0,
            }
        ],
        "clients": [client("/a")],
    }
