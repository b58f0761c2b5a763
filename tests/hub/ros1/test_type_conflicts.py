"""Topics with two types, of which ROS 1 nodes and the hub's clients use their own."""

from __future__ import annotations

import struct
from typing import Any

import pytest

import fibws
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32, String

from .conftest import StartPeer
from .peer import MD5_OF_INT32

pytestmark = pytest.mark.both_loops


def int32(number: int) -> bytes:
    return struct.pack("<i", number)


@pytest.mark.parametrize("wrong", ["advertise", "subscribe"])
async def test_ros1_publisher_reaches_the_clients_of_its_type(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node, wrong: str
) -> None:
    made: Any = getattr(node, wrong)("/count", String)
    if wrong == "advertise":
        await made
    await node.flush()
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    async with fibws.Node("page", hub=hub.url) as page:
        messages = page.subscribe("/count", Int32)
        (await talker.linked()).send(int32(3))
        assert (await anext(messages)).data == 3


async def test_no_link_is_opened_for_subscribers_of_another_type(
    start_peer: StartPeer, node: fibws.Node
) -> None:
    node.subscribe("/count", String)
    await node.flush()
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    await talker.advertise("/other")
    node.subscribe("/other", Int32)
    assert (await talker.linked()).header["topic"] == "/other"
    assert talker.links.empty()


async def test_ros1_subscriber_is_told_of_the_publishers_of_its_type(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    wrong = await node.advertise("/count", String)
    listener = await start_peer("/listener")
    assert await listener.subscribe("/count") == []
    async with fibws.Node("page", hub=hub.url) as page:
        publisher = await page.advertise("/count", Int32, latch=True)
        topic, apis = await listener.called("publisherUpdate")
        assert (topic, len(apis)) == ("/count", 1)
        link = await listener.connect("/count", type="std_msgs/Int32", md5sum=MD5_OF_INT32)
        await wrong.publish("no")
        await node.flush()
        await publisher.publish(5)
        assert await link.receive() == int32(5)
    assert await listener.called("publisherUpdate") == ["/count", []]


async def test_ros1_nodes_of_two_types_are_shown_and_both_are_registered(
    hub: HubServer, start_peer: StartPeer
) -> None:
    talker, other = await start_peer("/talker"), await start_peer("/other")
    await talker.advertise("/count")
    await other.subscribe("/count", "std_msgs/String")
    [conflict] = hub.graph.view("/x").conflicts(hub.graph.topics["/count"])
    assert (conflict.node, conflict.type) == ("/other", "std_msgs/String")
    publishers, subscribers, _ = await other.call("getSystemState")
    assert ["/count", ["/talker"]] in publishers
    assert ["/count", ["/other"]] in subscribers


async def test_ros1_subscriber_gets_the_messages_of_its_definition(
    hub: HubServer, start_peer: StartPeer
) -> None:
    graph = hub.graph
    first, second = (
        graph.advertise(graph.topic("/a"), node, "my_msgs/Thing", definition)
        for node, definition in (("/first", "int8 x"), ("/second", "int32 x"))
    )
    listener = await start_peer("/listener")
    assert len(await listener.subscribe("/a", "my_msgs/Thing")) == 1
    assert second.type.md5sum
    link = await listener.connect("/a", type="my_msgs/Thing", md5sum=second.type.md5sum)
    first.publish({"x": 1})
    second.publish({"x": 2})
    assert await link.receive() == int32(2)
    for source in (first, second):
        graph.remove_source(source)
