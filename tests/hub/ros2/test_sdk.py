"""Programs of ROBOTIS's zenoh-ros2-sdk, which knows nothing of fibws, on the hub."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Any, NamedTuple

import pytest
from patience import PATIENCE
from websockets.asyncio.client import connect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Point, Pose
from fibws.msg.std_msgs import String
from fibws.srv.example_interfaces import AddTwoInts

from ..federation.conftest import until
from .peer import reaching

sdk: Any = pytest.importorskip("zenoh_ros2_sdk")

TYPE, DEFINITION = "std_msgs/msg/String", "string data"
ADD: dict[str, Any] = {
    "srv_type": "example_interfaces/srv/AddTwoInts",
    "request_definition": "int64 a\nint64 b",
    "response_definition": "int64 sum",
}


class Sdk(NamedTuple):
    """Starts publishers, subscribers, servers and clients."""

    address: dict[str, Any]
    open: list[Any]

    async def start(self, kind: str, **arguments: Any) -> Any:
        made = await asyncio.to_thread(getattr(sdk, kind), **arguments, **self.address)
        self.open.append(made)
        return made


@pytest.fixture
async def robotis(hub: HubServer, endpoint: str) -> AsyncIterator[Sdk]:
    from zenoh_ros2_sdk.session import ZenohSession

    address = {"router_ip": "127.0.0.1", "router_port": int(endpoint.rpartition(":")[2])}
    found = Sdk(address, [])
    yield found
    for each in found.open:
        await asyncio.to_thread(each.close)
    session, ZenohSession._instance = ZenohSession._instance, None  # There is one in a process.
    if session is not None:
        await asyncio.to_thread(session.session.close)


async def matched(declared: Any) -> None:
    """Wait until zenoh knows a subscriber of a publisher, or an answerer of a querier."""
    import zenoh

    loop, found = asyncio.get_running_loop(), asyncio.Event()

    def note(status: Any) -> None:
        if status.matching:
            loop.call_soon_threadsafe(found.set)

    handler = zenoh.handlers.Callback(note, indirect=False)
    listener = await asyncio.to_thread(declared.declare_matching_listener, handler)
    note(declared.matching_status)
    await found.wait()
    await asyncio.to_thread(listener.undeclare)


async def test_topics_pass_in_both_directions(
    hub: HubServer, robotis: Sdk, node: fibws.Node
) -> None:
    loop = asyncio.get_running_loop()
    received: asyncio.Queue[str] = asyncio.Queue()
    talker = await robotis.start(
        "ROS2Publisher",
        topic="/chatter",
        msg_type=TYPE,
        msg_definition=DEFINITION,
        node_name="talker",
    )
    await robotis.start(
        "ROS2Subscriber",
        topic="/replies",
        msg_type=TYPE,
        callback=lambda msg: loop.call_soon_threadsafe(received.put_nowait, msg.data),
        msg_definition=DEFINITION,
        node_name="listener",
    )
    async with node.subscribe("/chatter", String) as messages, connect(hub.url) as page:
        await page.send(json.dumps({"op": "subscribe", "topic": "/chatter"}))
        await page.send(
            json.dumps({"op": "advertise", "topic": "/replies", "type": "std_msgs/String"})
        )
        await until(lambda: "/talker" in hub.graph.topic("/chatter").sources, hub)
        await until(lambda: "/listener" in hub.graph.topic("/replies").subscribers(), hub)
        async with asyncio.timeout(PATIENCE):
            await matched(talker.pub)
            for text in ("hello", "grüß dich"):
                await asyncio.to_thread(talker.publish, data=text)
                assert (await anext(messages)).data == text
                assert json.loads(await page.recv())["msg"] == {"data": text}
                msg = {"op": "publish", "topic": "/replies", "msg": {"data": f"{text} to you"}}
                await page.send(json.dumps(msg))
                assert await received.get() == f"{text} to you"


async def test_services_pass_in_both_directions(
    hub: HubServer, robotis: Sdk, node: fibws.Node
) -> None:
    server: Any = await robotis.start(
        "ROS2ServiceServer",
        service_name="/theirs",
        callback=lambda request: server.response_msg_class(sum=request.a + request.b),
        node_name="adder",
        **ADD,
    )
    await until(lambda: "/theirs" in hub.graph.services, hub)
    response = await node.call("/theirs", AddTwoInts, {"a": 40, "b": 2}, timeout=PATIENCE)
    assert response.sum == 42

    await node.service(
        "/ours", AddTwoInts, lambda request: AddTwoInts.Response(sum=request.a - request.b)
    )
    client = await robotis.start(
        "ROS2ServiceClient", service_name="/ours", node_name="client", **ADD
    )
    async with asyncio.timeout(PATIENCE):
        await matched(client.querier)
    found = await asyncio.to_thread(client.call, a=40, b=2)
    assert found.sum == 38


async def test_nested_messages_pass(hub: HubServer, robotis: Sdk, node: fibws.Node) -> None:
    loop = asyncio.get_running_loop()
    received: asyncio.Queue[Any] = asyncio.Queue()
    definition = """geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
"""
    from rosbags.typesys import Stores, get_typestore

    store: Any = get_typestore(Stores.ROS2_JAZZY)
    await robotis.start(
        "ROS2Subscriber",
        topic="/pose",
        msg_type="geometry_msgs/msg/Pose",
        callback=lambda msg: loop.call_soon_threadsafe(received.put_nowait, msg),
        msg_definition=definition,
        node_name="listener",
        type_hash=store.hash_rihs01("geometry_msgs/msg/Pose"),
    )
    publisher = await node.advertise("/pose", Pose, peers=True)
    await reaching(publisher, "/listener")
    await publisher.publish(Pose(position=Point(x=1.0, y=2.0, z=3.0)))
    async with asyncio.timeout(PATIENCE):
        found = await received.get()
    assert (found.position.x, found.position.z, found.orientation.w) == (1.0, 3.0, 0.0)
