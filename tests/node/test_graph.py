"""`fibws.Node.graph` with a real hub."""

from __future__ import annotations

from collections.abc import AsyncIterator

import pytest
from conftest import StartHub

import fibws
from fibws.msg.std_msgs import Int32
from fibws.srv.rospy_tutorials import AddTwoInts


@pytest.fixture
async def node(start_hub: StartHub) -> AsyncIterator[fibws.Node]:
    hub = await start_hub()
    async with (
        fibws.Node("talker", hub=hub.url, namespace="robot") as talker,
        fibws.Node("ear", hub=hub.url, namespace="robot") as node,
    ):
        await talker.advertise("numbers", Int32)
        await talker.service("add", AddTwoInts, lambda request: request.a + request.b)
        node.subscribe("numbers", Int32)
        # The hub answers after processing everything that the node sent before.
        await talker.graph.nodes()
        yield node


async def test_nodes_are_listed(node: fibws.Node) -> None:
    graph = node.graph
    assert graph is node.graph
    assert {"/robot/talker", "/robot/ear", "/rosapi"} <= set(await graph.nodes())
    details = await graph.node("talker")
    assert details == await graph.node("/robot/talker")
    assert details == fibws.NodeDetails(
        publishing=["/robot/numbers", "/rosout"],
        subscribing=[],
        services=[
            "/robot/add",
            "/robot/talker/get_loggers",
            "/robot/talker/set_logger_level",
        ],
    )
    assert (await graph.node("ear")).subscribing == ["/robot/numbers"]
    assert await graph.node("nobody") == fibws.NodeDetails([], [], [])


async def test_topics_are_listed(node: fibws.Node) -> None:
    graph = node.graph
    topics = await graph.topics()
    assert topics["/robot/numbers"] == "std_msgs/Int32"
    assert topics["/rosout"] == "rosgraph_msgs/Log"
    assert "/robot/numbers" in await graph.topics_of_type("std_msgs/Int32")
    assert await graph.topic_type("numbers") == "std_msgs/Int32"
    assert await graph.topic_type("nothing") is None
    assert await graph.publishers("numbers") == ["/robot/talker"]
    assert await graph.subscribers("numbers") == ["/robot/ear"]
    assert await graph.publishers("nothing") == []


async def test_services_are_listed(node: fibws.Node) -> None:
    graph = node.graph
    assert {"/robot/add", "/rosapi/services"} <= set(await graph.services())
    assert await graph.services_of_type("rospy_tutorials/AddTwoInts") == ["/robot/add"]
    assert await graph.service_type("add") == "rospy_tutorials/AddTwoInts"
    assert await graph.service_node("add") == "/robot/talker"
    assert await graph.service_type("nothing") is None
    assert await graph.service_node("nothing") is None


async def test_actions_are_listed(node: fibws.Node) -> None:
    assert await node.graph.action_servers() == []
    action = "actionlib_tutorials/FibonacciAction"
    await node.advertise("fibonacci/feedback", f"{action}Feedback")
    await node.advertise("fibonacci/result", f"{action}Result")
    await node.advertise("fibonacci/status", "actionlib_msgs/GoalStatusArray")
    node.subscribe("fibonacci/goal", f"{action}Goal")
    node.subscribe("fibonacci/cancel", "actionlib_msgs/GoalID")
    assert await node.graph.action_servers() == ["/robot/fibonacci"]


async def test_invalid_names_are_refused(node: fibws.Node) -> None:
    with pytest.raises(fibws.InvalidName):
        await node.graph.publishers("no name")
