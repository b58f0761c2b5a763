"""The part of the graph that is drawn and checked."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from fibws.client.graph_view import DrawnConflict, DrawnTopic, View, in_order_of_flow, is_hidden

ME = "/fibws_graph_1_2"
HUB_CLIENT = {"api": "", "fault": ""}
"""Of nodes that are connected to the hub."""
WEB_TEST = Path(__file__).parents[2] / "web" / "src" / "hidden_names.test.ts"


def topic(name: str, publishers: str = "", subscribers: str = "", **others: Any) -> dict[str, Any]:
    """Return a topic as the hub reports it; nodes are separated by spaces."""
    return {
        "name": name,
        "type": "std_msgs/String",
        "checked": True,
        "publishers": [{"node": node, "latch": False} for node in publishers.split()],
        "subscriptions": [
            {"node": node, "queue_length": 0, "throttle_rate": 0, "compression": "none"}
            for node in subscribers.split()
        ],
        "conflicts": [],
        **others,
    }


def graph(
    *topics: dict[str, Any],
    nodes: str = "",
    services: tuple[tuple[str, str], ...] = (),
    actions: tuple[tuple[str, str, bool], ...] = (),
) -> dict[str, Any]:
    """Return a graph as the hub reports it: its own node, these, and the requesting one."""
    return {
        "revision": 1,
        "nodes": [
            {"name": "/rosapi", "address": "", "own": True, **HUB_CLIENT},
            *({"name": node, "address": "a", "own": False, **HUB_CLIENT} for node in nodes.split()),
            {"name": ME, "address": "a", "own": False, **HUB_CLIENT},
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


def view(response: dict[str, Any], **others: Any) -> View:
    return View.of(response, exclude=ME, **others)


def names(topics: list[DrawnTopic]) -> list[str]:
    return [topic.name for topic in topics]


def test_topic_has_its_publishers_and_subscribers_without_the_tool() -> None:
    shown = view(graph(topic("/chatter", f"/b /a {ME}", f"/c /c {ME}"), nodes="/a /b /c"))
    assert shown.nodes == ["/a", "/b", "/c"]
    assert shown.topics == [DrawnTopic("/chatter", "std_msgs/String", True, ["/a", "/b"], ["/c"])]


def test_names_of_the_hub_are_hidden_and_counted() -> None:
    response = graph(
        topic("/rosout", "/a"),
        topic("/rosout_agg"),
        topic("/chatter", "/a"),
        nodes="/a",
        services=(("/a/get_loggers", "/a"), ("/rosapi/topics", "/rosapi"), ("/a/reset", "/a")),
    )
    shown = view(response)
    assert names(shown.topics) == ["/chatter"]
    assert [each.name for each in shown.services] == ["/a/reset"]
    assert shown.nodes == ["/a"]
    assert (shown.hidden_nodes, shown.hidden_topics, shown.hidden_services) == (1, 2, 2)


def test_pages_and_commands_are_hidden() -> None:
    page, tool, publisher = "/page_0a1b2c3d", "/fibws_top_4_5", "/fibws_pub_4_5"
    response = graph(
        topic("/chatter", publisher, f"/a {page}"),
        topic("/viewed", "", page),
        nodes=f"/a {page} {tool} {publisher}",
        services=(("/x", tool),),
        actions=(("/do", "/a", True),),
    )
    response["topics"].append(topic("/do/goal", f"{page} /a", "/a"))
    shown = view(response)
    assert shown.nodes == ["/a", publisher]
    assert shown.topics == [DrawnTopic("/chatter", "std_msgs/String", True, [publisher], ["/a"])]
    assert (shown.services, shown.actions[0].clients) == ([], ["/a"])
    assert (shown.hidden_nodes, shown.hidden_topics, shown.hidden_services) == (3, 2, 1)
    assert {page, tool} <= set(view(response, everything=True).nodes)


def test_same_names_are_hidden_as_by_the_page() -> None:
    cases = WEB_TEST.read_text("utf-8").split("test.each(")[1:]
    for case, expected in zip(cases, (True, False), strict=True):
        names = re.findall(r'"(/[^"]+)"', case)
        assert names and {name: is_hidden(name) for name in names} == dict.fromkeys(names, expected)


def test_everything_includes_hidden_names() -> None:
    response = graph(topic("/rosout", "/a"), nodes="/a", services=(("/rosapi/topics", "/rosapi"),))
    shown = view(response, everything=True)
    assert names(shown.topics) == ["/rosout"]
    assert [each.name for each in shown.services] == ["/rosapi/topics"]
    assert shown.nodes == ["/a", "/rosapi"]
    assert (shown.hidden_nodes, shown.hidden_topics, shown.hidden_services) == (0, 0, 0)


def test_action_replaces_its_topics_and_has_clients() -> None:
    topics = [topic(f"/do/{each}", "/server", "/client") for each in ("status", "result")]
    response = graph(
        topic("/do/goal", "/client", "/server"),
        *topics,
        nodes="/client /server",
        actions=(("/do", "/server", True), ("/own", "/server", False)),
    )
    shown = view(response)
    assert shown.topics == []
    assert [(each.name, each.clients) for each in shown.actions] == [
        ("/do", ["/client"]),
        ("/own", []),
    ]
    assert names(view(response, everything=True).topics) == ["/do/goal", "/do/result", "/do/status"]


def test_topic_named_goal_without_an_action_is_shown() -> None:
    assert names(view(graph(topic("/soccer/goal", "/a"))).topics) == ["/soccer/goal"]


def test_namespace_includes_its_topics_and_those_of_its_nodes() -> None:
    response = graph(
        topic("/robot/scan", "/laser"),
        topic("/scan", "/robot/driver"),
        topic("/robots", "/laser"),
        nodes="/robot/driver /laser /robot",
        services=(("/robot/stop", "/other"), ("/stop", "/other")),
    )
    shown = view(response, namespace="/robot")
    assert names(shown.topics) == ["/robot/scan", "/scan"]
    assert [each.name for each in shown.services] == ["/robot/stop"]
    assert shown.nodes == ["/robot", "/robot/driver"]


def test_nodes_without_connections_are_idle() -> None:
    response = graph(
        topic("/a", "/p", "/s"), nodes="/p /s /idle /provider", services=(("/x", "/provider"),)
    )
    assert view(response).idle() == ["/idle"]


def test_topics_are_in_the_order_of_the_flow() -> None:
    response = graph(
        topic("/a_last", "/planner", "/motor"),
        topic("/m_objects", "/detector", "/planner"),
        topic("/z_image", "/camera", "/detector"),
    )
    assert names(view(response).topics) == ["/z_image", "/m_objects", "/a_last"]


@pytest.mark.parametrize("length", [2, 5000])
def test_cycles_are_ordered(length: int) -> None:
    circle = [
        DrawnTopic(f"/t{number}", "", True, [f"/n{number}"], [f"/n{(number + 1) % length}"])
        for number in range(length)
    ]
    assert sorted(names(in_order_of_flow(circle))) == sorted(names(circle))


def test_json_has_the_names_of_the_view() -> None:
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
        "conflicts": [],
        "unreachable": {},
    }


def test_conflicts_and_unreachable_ros1_nodes_are_in_the_view() -> None:
    conflict = {"node": "/camera", "type": "a/B", "publishes": True, "fault": "why"}
    response = graph(topic("/chatter", "/talker", conflicts=[conflict]), nodes="/camera /talker /x")
    response["nodes"][1].update(api="http://robot:1/", fault="Timed out")
    found = view(response)
    assert found.conflicts == [
        DrawnConflict("/camera", "/chatter", True, "publishes a/B, the topic is std_msgs/String")
    ]
    assert found.unreachable == {"/camera": "Timed out"}
    assert found.idle() == ["/x"]
    assert view(response, namespace="/x").conflicts == []
