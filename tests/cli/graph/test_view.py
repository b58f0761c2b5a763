"""What a drawing shows of what /rosapi/graph tells."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.cli.graph.view import Topic, View, in_order_of_flow

ME = "/fibws_graph_1_2"


def topic(name: str, publishers: str = "", subscribers: str = "", **others: Any) -> dict[str, Any]:
    """As the hub tells of it; nodes are divided by spaces."""
    return {
        "name": name,
        "type": "std_msgs/String",
        "checked": True,
        "publishers": [{"node": node, "latch": False} for node in publishers.split()],
        "subscriptions": [
            {"node": node, "queue_length": 0, "throttle_rate": 0, "compression": "none"}
            for node in subscribers.split()
        ],
        **others,
    }


def graph(
    *topics: dict[str, Any],
    nodes: str = "",
    services: tuple[tuple[str, str], ...] = (),
    actions: tuple[tuple[str, str, bool], ...] = (),
) -> dict[str, Any]:
    """As the hub tells of it: its own node, these, and the one that asks."""
    return {
        "revision": 1,
        "nodes": [
            {"name": "/rosapi", "address": "", "own": True},
            *({"name": node, "address": "a", "own": False} for node in nodes.split()),
            {"name": ME, "address": "a", "own": False},
        ],
        "topics": list(topics),
        "services": [
            {"name": name, "type": "std_srvs/Trigger", "node": node} for name, node in services
        ],
        "actions": [
            {"name": name, "type": "my/Do", "node": node, "over_topics": over_topics}
            for name, node, over_topics in actions
        ],
    }


def view(told: dict[str, Any], **others: Any) -> View:
    return View.of(told, but=ME, **others)


def names(topics: list[Topic]) -> list[str]:
    return [topic.name for topic in topics]


def test_both_ends_of_a_topic_are_there_and_who_asks_is_not() -> None:
    shown = view(graph(topic("/chatter", f"/b /a {ME}", f"/c /c {ME}"), nodes="/a /b /c"))
    assert shown.nodes == ["/a", "/b", "/c"]
    assert shown.topics == [Topic("/chatter", "std_msgs/String", True, ["/a", "/b"], ["/c"])]


def test_what_every_graph_has_is_left_out_and_counted() -> None:
    told = graph(
        topic("/rosout", "/a"),
        topic("/rosout_agg"),
        topic("/chatter", "/a"),
        nodes="/a",
        services=(("/a/get_loggers", "/a"), ("/rosapi/topics", "/rosapi"), ("/a/reset", "/a")),
    )
    shown = view(told)
    assert names(shown.topics) == ["/chatter"]
    assert [each.name for each in shown.services] == ["/a/reset"]
    assert shown.nodes == ["/a"]
    assert (shown.hidden_topics, shown.hidden_services) == (2, 2)


def test_everything_can_be_shown() -> None:
    told = graph(topic("/rosout", "/a"), nodes="/a", services=(("/rosapi/topics", "/rosapi"),))
    shown = view(told, everything=True)
    assert names(shown.topics) == ["/rosout"]
    assert [each.name for each in shown.services] == ["/rosapi/topics"]
    assert shown.nodes == ["/a", "/rosapi"]
    assert (shown.hidden_topics, shown.hidden_services) == (0, 0)


def test_an_action_stands_for_its_topics_and_tells_who_sends_goals() -> None:
    topics = [topic(f"/do/{each}", "/server", "/client") for each in ("status", "result")]
    told = graph(
        topic("/do/goal", "/client", "/server"),
        *topics,
        nodes="/client /server",
        actions=(("/do", "/server", True), ("/own", "/server", False)),
    )
    shown = view(told)
    assert shown.topics == []
    assert [(each.name, each.clients) for each in shown.actions] == [
        ("/do", ["/client"]),
        ("/own", []),
    ]
    assert names(view(told, everything=True).topics) == ["/do/goal", "/do/result", "/do/status"]


def test_a_topic_that_is_called_as_one_of_an_action_is_still_shown() -> None:
    assert names(view(graph(topic("/soccer/goal", "/a"))).topics) == ["/soccer/goal"]


def test_a_namespace_has_its_topics_and_those_of_its_nodes() -> None:
    told = graph(
        topic("/robot/scan", "/laser"),
        topic("/scan", "/robot/driver"),
        topic("/robots", "/laser"),
        nodes="/robot/driver /laser /robot",
        services=(("/robot/stop", "/other"), ("/stop", "/other")),
    )
    shown = view(told, namespace="/robot")
    assert names(shown.topics) == ["/robot/scan", "/scan"]
    assert [each.name for each in shown.services] == ["/robot/stop"]
    assert shown.nodes == ["/robot", "/robot/driver"]


def test_nodes_that_nothing_names_are_idle() -> None:
    told = graph(
        topic("/a", "/p", "/s"), nodes="/p /s /idle /provider", services=(("/x", "/provider"),)
    )
    assert view(told).idle() == ["/idle"]


def test_topics_follow_the_flow() -> None:
    told = graph(
        topic("/a_last", "/planner", "/motor"),
        topic("/m_objects", "/detector", "/planner"),
        topic("/z_image", "/camera", "/detector"),
    )
    assert names(view(told).topics) == ["/z_image", "/m_objects", "/a_last"]


@pytest.mark.parametrize("length", [2, 5000])
def test_circles_end(length: int) -> None:
    circle = [
        Topic(f"/t{number}", "", True, [f"/n{number}"], [f"/n{(number + 1) % length}"])
        for number in range(length)
    ]
    assert sorted(names(in_order_of_flow(circle))) == sorted(names(circle))


def test_json_has_what_is_shown() -> None:
    shown = view(graph(topic("/chatter", "/a"), nodes="/a", services=(("/x", "/a"),)))
    assert shown.as_json() == {
        "nodes": ["/a"],
        "topics": [
            {
                "name": "/chatter",
                "type": "std_msgs/String",
                "checked": True,
                "publishers": ["/a"],
                "subscribers": [],
            }
        ],
        "services": [{"name": "/x", "type": "std_srvs/Trigger", "node": "/a"}],
        "actions": [],
    }
