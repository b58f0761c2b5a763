"""ROS 2 nodes together with those of ROS 1, and with other hubs."""

from __future__ import annotations

import asyncio
import struct

import pytest
from conftest import StartHub
from patience import PATIENCE

import fibws
from fibws.msg.std_msgs import String

from ..federation.conftest import until
from ..ros1.peer import MD5_OF_INT32
from ..ros1.peer import Peer as Ros1Peer
from .conftest import StartRos2Hub
from .peer import Peer, cdr_string, text_of
from .test_topics import flowing, sources, subscribers

INT32 = "std_msgs::msg::dds_::Int32_"


def int32(number: int) -> bytes:
    return struct.pack("<i", number)


async def test_nodes_of_ros_1_and_ros_2_exchange_messages(
    start_ros2_hub: StartRos2Hub,
) -> None:
    from rosbags.typesys import Stores, get_typestore

    type_hash = get_typestore(Stores.ROS2_JAZZY).hash_rihs01("std_msgs/msg/Int32")
    hub, endpoint = await start_ros2_hub(ros1=0)
    assert hub.ros1 is not None
    async with (
        Ros1Peer("/talker1", hub.ros1.uri) as talker1,
        Ros1Peer("/listener1", hub.ros1.uri) as listener1,
        Peer(endpoint) as peer,
    ):
        await talker1.advertise("/up")
        _, queue = await peer.subscriber("/listener2", "/up", INT32, type_hash)
        link = await talker1.linked()
        link.send(int32(1), int32(2))
        async with asyncio.timeout(PATIENCE):
            received = [(await queue.get()).data for _ in range(2)]
        assert received == [b"\x00\x01\x00\x00" + int32(number) for number in (1, 2)]

        talker2 = await peer.publisher("/talker2", "/down", INT32, type_hash)
        await listener1.subscribe("/down")
        await flowing(talker2)
        await until(lambda: sources(hub, "/down"), hub)
        down = await listener1.connect("/down", type="std_msgs/Int32", md5sum=MD5_OF_INT32)
        await talker2.publish(b"\x00\x01\x00\x00" + int32(3))
        assert await down.receive() == int32(3)
        # The hub must not call it any more when the ROS 2 nodes leave: it ends at the same time.
        await listener1.call("unregisterSubscriber", "/down", listener1.api)
        down.close()
        link.close()


@pytest.mark.parametrize("robot", ["", "/robot7"])
async def test_other_hubs_exchange_messages_with_ros_2_nodes(
    start_hub: StartHub, start_ros2_hub: StartRos2Hub, robot: str
) -> None:
    cloud = await start_hub(hub_name="cloud")
    hub, endpoint = await start_ros2_hub(hub_name="robot", join=(cloud.url,), join_prefix=robot)
    async with Peer(endpoint) as peer, fibws.Node("viewer", hub=cloud.url) as viewer:
        # Latched, as messages may come before the link between the hubs passes any.
        talker = await peer.publisher("/talker", "/chatter", latched=True)
        await talker.publish(cdr_string("hello"))
        _, queue = await peer.subscriber("/listener", "/commands")
        async with (
            viewer.subscribe(f"{robot}/chatter", String) as messages,
            asyncio.timeout(PATIENCE),
        ):
            assert (await anext(messages)).data == "hello"
        commands = await viewer.advertise(f"{robot}/commands", String, latch=True)
        await commands.publish(data="go")
        await until(lambda: subscribers(hub, "/commands") and sources(hub, "/commands"), hub)
        async with asyncio.timeout(PATIENCE):
            assert text_of((await queue.get()).data) == "go"
        assert f"{robot}/talker" in cloud.graph.nodes
