"""topic_tools' programs, which pass on messages of any type."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Point
from fibws.msg.std_msgs import Float64, Header, Int32, String
from fibws.srv.topic_tools import (
    DemuxAdd,
    DemuxList,
    DemuxSelect,
    MuxAdd,
    MuxDelete,
    MuxList,
    MuxSelect,
)

RUN = ("fibws", "run", "topic_tools")


@pytest.fixture
async def node(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("test", hub=hub.url) as node:
        yield node


async def has_subscriber(publisher: fibws.Publisher[Int32, ...]) -> None:
    """Wait until a topic has a subscriber."""
    async for names in publisher.peers.changes():
        if names:
            return


async def test_relay_passes_on_latched_messages_of_any_type(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    words = await node.advertise("/robot/words", String, latch=True)
    await words.publish(String("hello"))
    await start(*RUN, "relay", "/robot/words", FIBWS_HUB=hub.url)
    subscription = node.subscribe("/robot/words_relay", String, headers=True)
    assert (await anext(subscription)).data == "hello"
    assert subscription.connection_header["latching"] == "1"


async def test_drop_leaves_out_the_first_of_each_number(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    numbers = await node.advertise("/numbers", Int32, queue_size=100, peers=True)
    found = node.subscribe("/some", Int32, queue_size=None)
    await start(*RUN, "drop", "/numbers", "2", "3", "/some", FIBWS_HUB=hub.url)
    await has_subscriber(numbers)
    for number in range(9):
        await numbers.publish(Int32(number))
    assert [(await anext(found)).data for _ in range(3)] == [2, 5, 8]


async def test_throttle_passes_on_the_first_message(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    numbers = await node.advertise("/numbers", Int32, latch=True)
    await numbers.publish(Int32(7))
    found = node.subscribe("/numbers_throttle", Int32)
    await start(*RUN, "throttle", "bytes", "/numbers", "100", "1", FIBWS_HUB=hub.url)
    assert (await anext(found)).data == 7


@pytest.mark.long
async def test_delay_publishes_in_order_later(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    numbers = await node.advertise("/numbers", Int32, queue_size=100, peers=True)
    found = node.subscribe("/numbers_delay", Int32, queue_size=None)
    await start(*RUN, "delay", "/numbers", "0.2", FIBWS_HUB=hub.url)
    await has_subscriber(numbers)
    before = node.now().to_sec()
    for number in range(3):
        await numbers.publish(Int32(number))
    assert [(await anext(found)).data for _ in range(3)] == [0, 1, 2]
    assert node.now().to_sec() - before >= 0.2


async def test_mux_passes_on_the_selected_topic(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    first = await node.advertise("/first", Int32, latch=True)
    second = await node.advertise("/second", Int32, latch=True)
    await first.publish(Int32(1))
    await second.publish(Int32(2))
    selected = node.subscribe("/mux/selected", String)
    found = node.subscribe("/chosen", Int32)
    await start(*RUN, "mux", "/chosen", "/first", "/second", FIBWS_HUB=hub.url)
    assert (await anext(selected)).data == "/first"
    assert (await anext(found)).data == 1
    await node.wait_for_service("/mux/list", timeout=60)
    assert (await node.call("/mux/select", MuxSelect, {"topic": "/second"})).prev_topic == "/first"
    assert (await anext(selected)).data == "/second"
    assert (await anext(found)).data == 2
    await node.call("/mux/add", MuxAdd, {"topic": "third"})
    await node.call("/mux/delete", MuxDelete, {"topic": "/first"})
    assert (await node.call("/mux/list", MuxList)).topics == ["/second", "/third"]
    for name, topic in (("Select", "/nothing"), ("Delete", "/second"), ("Add", "/third")):
        with pytest.raises(fibws.ServiceError, match=topic):
            await node.call(f"/mux/{name.lower()}", f"topic_tools/Mux{name}", {"topic": topic})
    await node.call("/mux/select", MuxSelect, {"topic": "__none"})
    assert (await anext(selected)).data == "__none"


@pytest.mark.long
async def test_mux_is_changed_by_commands(hub: HubServer, start: Start, node: fibws.Node) -> None:
    selected = node.subscribe("/mux/selected", String)
    await start(*RUN, "mux", "/chosen", "/first", FIBWS_HUB=hub.url)
    assert (await anext(selected)).data == "/first"
    for words, texts in (
        (("mux_add", "mux", "/second"), ['Adding "/second" to mux "mux"']),
        (("mux_list", "mux"), ['Listing topics from mux "mux"', "['/first', '/second']"]),
    ):
        program = await start(*RUN, *words, FIBWS_HUB=hub.url)
        code, out, _ = await program.end()
        service = words[0].partition("_")[2]
        assert (code, out.splitlines()) == (0, [f'Waiting for service "mux/{service}"', *texts])
    program = await start(*RUN, "mux_select", "mux", "/third", FIBWS_HUB=hub.url)
    code, _, err = await program.end()
    assert code == 1
    assert "unknown topic /third" in err


async def test_transform_publishes_what_an_expression_gives(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    point = await node.advertise("/pen/point", Point, latch=True)
    await point.publish(Point(3.0, 4.0, 0.0))
    arguments = ("/pen/point/x", "/doubled", "std_msgs/Float64", "math.fabs(-2 * m)")
    await start(*RUN, "transform", *arguments, "--import", "math", FIBWS_HUB=hub.url)
    assert (await anext(node.subscribe("/doubled", Float64))).data == 6.0
    arguments = ("pen/point", "/turned", "geometry_msgs/Point", "[-m.y, m.x, 0]")
    await start(*RUN, "transform", *arguments, "--latch", "--wait-for-start", FIBWS_HUB=hub.url)
    assert await anext(node.subscribe("/turned", Point)) == Point(-4.0, 3.0, 0.0)


async def test_relay_field_fills_fields_with_expressions(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    words = await node.advertise("/words", String, latch=True)
    await words.publish(String("map"))
    arguments = ("/words", "/heads", "std_msgs/Header", "{seq: 7, stamp: now, frame_id: m.data}")
    await start(*RUN, "relay_field", *arguments, FIBWS_HUB=hub.url)
    header = await anext(node.subscribe("/heads", Header))
    assert header.frame_id == "map"
    assert header.stamp.secs > 0


async def test_demux_passes_messages_on_to_the_selected_topic(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    numbers = await node.advertise("/numbers", Int32, peers=True)
    selected = node.subscribe("/demux/selected", String)
    first, second = node.subscribe("/first", Int32), node.subscribe("/second", Int32)
    await start(*RUN, "demux", "/numbers", "/first", "/second", FIBWS_HUB=hub.url)
    assert (await anext(selected)).data == "/first"
    await has_subscriber(numbers)
    await numbers.publish(Int32(1))
    assert (await anext(first)).data == 1
    await node.wait_for_service("/demux/list", timeout=60)
    before = await node.call("/demux/select", DemuxSelect, {"topic": "/second"})
    assert before.prev_topic == "/first"
    await numbers.publish(Int32(2))
    assert (await anext(second)).data == 2
    await node.call("/demux/select", DemuxSelect, {"topic": "__none"})
    await node.call("/demux/add", DemuxAdd, {"topic": "/third"})
    assert (await node.call("/demux/list", DemuxList)).topics == ["/first", "/second", "/third"]
    await node.call("/demux/select", DemuxSelect, {"topic": "/first"})
    await numbers.publish(Int32(3))
    assert (await anext(first)).data == 3


LAZY = """
import rospy
from std_msgs.msg import Int32
from topic_tools import LazyTransport

class Twice(LazyTransport):
    def __init__(self):
        super().__init__()
        self.out = self.advertise("twice", Int32, queue_size=10)
    def subscribe(self):
        self.sub = rospy.Subscriber("numbers", Int32, lambda m: self.out.publish(2 * m.data))
    def unsubscribe(self):
        self.sub.unregister()

rospy.init_node("twice")
Twice()
rospy.spin()
"""


async def test_lazy_transport_subscribes_while_it_is_needed(
    hub: HubServer, start: Start, node: fibws.Node, tmp_path: Path
) -> None:
    script = tmp_path / "twice.py"
    script.write_text(LAZY)
    numbers = await node.advertise("/numbers", Int32, peers=True)
    await start("fibws.rospy", str(script), FIBWS_HUB=hub.url)
    found = node.subscribe("/twice", Int32)
    changes = numbers.peers.changes()
    async for names in changes:
        if names:
            break
    await numbers.publish(Int32(4))
    assert (await anext(found)).data == 8
    found.close()
    async for names in changes:
        if not names:
            break


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["relay"], "usage: relay IN_TOPIC [OUT_TOPIC]"),
        (["throttle", "messages", "/a", "fast"], "expected a number, got 'fast'"),
        (["throttle", "lines", "/a", "1"], "expected messages or bytes"),
        (["drop", "/a", "3", "2"], "got 3 and 2"),
        (["drop", "/a", "0", "0"], "Y from 1 on"),
        (["mux", "/a"], "at least one input"),
        (["demux", "/a"], "at least one output"),
        (["transform", "/a", "/b", "std_msgs/Int8", "m"], "ERROR: Wrong input topic"),
        (["transform", "/rosout", "/b", "nothing/X", "m"], "unknown type of the output: nothing/X"),
    ],
)
@pytest.mark.long
async def test_wrong_arguments_are_errors(
    hub: HubServer, start: Start, words: list[str], text: str
) -> None:
    program = await start(*RUN, *words, FIBWS_HUB=hub.url)
    code, _, err = await program.end()
    assert code == 1
    assert text in err
