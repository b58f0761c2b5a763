"""Nodes and a real hub, from end to end."""

from __future__ import annotations

import asyncio
import contextlib
import json
import math
import time
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub
from patience import PATIENCE
from ports import port as port
from rospy.msg import AnyMsg

import fibws
from fibws.errors import CallRefused, ServiceError
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.fibws_msgs import PublisherInfo, SubscriptionStatistics
from fibws.msg.geometry_msgs import Point, Pose, PoseStamped, TransformStamped, Twist, Vector3
from fibws.msg.nav_msgs import Path as NavPath
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.sensor_msgs import Image
from fibws.msg.std_msgs import Float64, Int32, String
from fibws.msg.tf import tfMessage
from fibws.msg.tf2_msgs import TFMessage
from fibws.srv.fibws_msgs import GetGraph, GetStatistics, KillNode, PingNode
from fibws.srv.nav_msgs import GetPlan, GetPlanRequest, GetPlanResponse
from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest
from fibws.srv.std_srvs import Trigger

from .conftest import Lines
from .stubborn import Stubborn


@pytest.fixture
async def real_hub() -> AsyncIterator[HubServer]:
    async with HubServer(Settings(port=0)) as hub:
        yield hub


async def test_node_may_subscribe_with_a_wrong_type_beside_the_right_one(
    real_hub: HubServer,
) -> None:
    url = real_hub.url
    async with fibws.Node("talker", hub=url) as talker, fibws.Node("ear", hub=url) as ear:
        wrong = ear.subscribe("/a", String)
        right = ear.subscribe("/a", Int32)
        probe = await ear.advertise("/probe", String)
        await probe.publish()
        publisher = await talker.advertise("/a", Int32)
        await publisher.publish(1)
        assert await anext(right) == Int32(1)
        publisher.close()
        other = await talker.advertise("/a", String)
        await other.publish("x")
        assert await anext(wrong) == String("x")


async def test_node_receives_messages_of_another(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("talker", hub=url) as talker, fibws.Node("ear", hub=url) as ear:
        speeds = ear.subscribe("speed", Twist)
        lines = ear.subscribe("/rosout", Log)
        publisher = await talker.advertise("speed", Twist)
        # The hub has the subscription when it answers a later operation.
        probe = await ear.advertise("speed", Twist)
        await probe.publish()
        assert await anext(speeds) == Twist()
        await publisher.publish(linear=Vector3(1, 2, 3))
        assert await anext(speeds) == Twist(linear=Vector3(1.0, 2.0, 3.0))
        talker.log.error("too fast")
        assert (await anext(lines)).msg == "too fast"


async def test_types_with_equal_fields_are_compatible(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("talker", hub=url) as talker, fibws.Node("ear", hub=url) as ear:
        publisher = await talker.advertise("/tf", TFMessage, latch=True)
        await publisher.publish([TransformStamped(child_frame_id="arm")])
        messages = ear.subscribe("/tf", tfMessage)
        assert await anext(messages) == tfMessage([TransformStamped(child_frame_id="arm")])
        again = await ear.advertise("/tf", tfMessage)
        await again.publish()
        assert await anext(messages) == tfMessage()


async def test_every_message_arrives_once_and_in_order(real_hub: HubServer) -> None:
    count = 20_000
    async with fibws.Node("node", hub=real_hub.url) as node:
        numbers = node.subscribe("numbers", Int32, queue_size=count)
        publisher = await node.advertise("numbers", Int32)

        async def publish() -> None:
            for number in range(count):
                await publisher.publish(number)

        async with asyncio.timeout(60), asyncio.TaskGroup() as tasks:
            tasks.create_task(publish())
            for number in range(count):
                assert (await anext(numbers)).data == number


async def test_serialized_messages_arrive_with_their_publisher_time_and_type(
    real_hub: HubServer,
) -> None:
    url = real_hub.url
    arrived: asyncio.Queue[Any] = asyncio.Queue()
    async with fibws.Node("talker", hub=url) as talker, fibws.Node("recorder", hub=url) as node:
        node.subscribe_serialized("image", lambda *message: arrived.put_nowait(message))
        publisher = await talker.advertise_serialized(
            "image", Image._type, latch=True, keep_seq=True
        )
        publisher._send(publisher._encode_serialized(b"\x09\0\0\0" + bytes(33)))
        message, header, received, type_ = await arrived.get()
    assert bytes(message) == b"\x09\0\0\0" + bytes(33)
    assert json.loads(header) == {"callerid": "/talker", "latching": "1"}
    assert 0 <= time.time_ns() - received < 60e9
    assert type_.name == Image._type
    assert "uint32 height" in type_.definition


async def test_large_messages_arrive(real_hub: HubServer) -> None:
    async with fibws.Node("node", hub=real_hub.url) as node:
        images = node.subscribe("image", Image)
        publisher = await node.advertise("image", Image)
        await publisher.publish(height=2000, width=2000, step=6000, data=bytes(12_000_000))
        assert len((await anext(images)).data) == 12_000_000


@pytest.mark.parametrize("who_is_wrong", ["publisher", "subscriber"])
async def test_node_that_uses_another_type_is_warned_and_begins_once_it_fits(
    real_hub: HubServer, who_is_wrong: str
) -> None:
    async with (
        fibws.Node("wrong", hub=real_hub.url) as wrong,
        fibws.Node("node", hub=real_hub.url) as node,
        fibws.Node("late", hub=real_hub.url) as late,
    ):
        lines = Lines(wrong.log)
        if who_is_wrong == "publisher":
            stray = await wrong.advertise("numbers", Float64)
        else:
            strays = wrong.subscribe("numbers", Float64)
            await wrong.flush()
        publisher = await node.advertise("numbers", Int32, latch=True)
        await publisher.publish(5)
        assert (await anext(node.subscribe("numbers", Int32))).data == 5
        line = await lines.next()
        assert "std_msgs/Int32 (published by /node)" in line
        # Nobody has to begin again.
        if who_is_wrong == "publisher":
            floats = late.subscribe("numbers", Float64)
            await late.flush()
            await stray.publish(0.5)
            assert (await anext(floats)).data == 0.5
        else:
            await (await late.advertise("numbers", Float64)).publish(0.5)
            assert (await anext(strays)).data == 0.5


async def test_definition_of_a_custom_type_reaches_the_hub(
    real_hub: HubServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    messages = tmp_path / "orchard" / "msg"
    messages.mkdir(parents=True)
    (messages / "Tree.msg").write_text("string fruit\nuint8 apples\n")
    monkeypatch.setenv("FIBWS_INTERFACES", str(tmp_path))
    async with fibws.Node("node", hub=real_hub.url) as node:
        trees = await node.advertise("trees", "orchard/Tree")
        subscription = node.subscribe("trees", "orchard/Tree")
        with pytest.raises(fibws.InvalidMessage, match="apples"):
            await trees.publish("apple", 256)
        await trees.publish("apple", 255)
        assert (await anext(subscription)).apples == 255


async def test_wait_for_message_loses_no_message_of_another_subscription(
    real_hub: HubServer,
) -> None:
    count = 990
    async with (
        fibws.Node("talker", hub=real_hub.url) as talker,
        fibws.Node("ear", hub=real_hub.url) as ear,
        asyncio.timeout(60),
    ):
        numbers = ear.subscribe("numbers", Int32, queue_size=None)
        first = asyncio.create_task(ear.wait_for_message("numbers", Int32))
        await ear.graph.nodes()  # Both subscriptions have reached the hub.
        publisher = await talker.advertise("numbers", Int32)
        (queue,) = (each.queue for each in real_hub._connections if each.name == "/ear")
        queue.pause()  # As if the node did not read.
        for number in range(count):
            await publisher.publish(number)
        await talker.graph.nodes()
        queue.resume()
        received = [(await anext(numbers)).data]
        while received[-1] != count - 1:
            received.append((await anext(numbers)).data)
        assert received == [*range(count)]
        assert (await first).data == 0


async def test_second_node_of_the_same_name_ends_the_first(real_hub: HubServer) -> None:
    async with fibws.Node("talker", hub=real_hub.url) as first:
        async with fibws.Node("talker", hub=real_hub.url):
            with pytest.raises(fibws.NodeReplaced):
                await first.spin()


async def test_killed_node_does_not_reconnect(real_hub: HubServer) -> None:
    async with (
        fibws.Node("talker", hub=real_hub.url) as talker,
        fibws.Node("killer", hub=real_hub.url) as killer,
    ):
        lines = Lines(talker.log)
        numbers = await talker.advertise("numbers", Int32)
        ping = await killer.call("/rosapi/ping_node", PingNode, {"node": "/talker"})
        assert ping.success
        assert 0 < ping.seconds < 60
        answer = await killer.call("/rosapi/kill_node", KillNode, {"node": "/talker"})
        assert (answer.success, answer.message) == (True, "killed /talker")
        with pytest.raises(fibws.NodeKilled, match="/talker was killed"):
            await talker.spin()
        with pytest.raises(fibws.NodeKilled):
            await numbers.publish(1)
        assert "/talker" not in await killer.graph.nodes()
        assert not any("trying again" in line for line in lines.seen())
        gone = await killer.call("/rosapi/ping_node", PingNode, {"node": "/talker"})
        assert gone == PingNode.Response(success=False, message="Node /talker does not exist")


async def test_node_may_kill_itself(real_hub: HubServer) -> None:
    async with fibws.Node("tired", hub=real_hub.url) as node:
        assert (await node.call("/rosapi/kill_node", KillNode, {"node": "/tired"})).success
        with pytest.raises(fibws.NodeKilled):
            await node.spin()


async def test_node_can_read_the_graph_and_the_statistics(real_hub: HubServer) -> None:
    async with fibws.Node("node", hub=real_hub.url) as node:
        numbers = node.subscribe("numbers", Int32)
        publisher = await node.advertise("numbers", Int32)
        await publisher.publish(1)
        assert (await anext(numbers)).data == 1
        graph = await node.call("/rosapi/graph", GetGraph)
        (own,) = [each for each in graph.nodes if each.name == "/node"]
        assert own.address.startswith("127.0.0.1:")
        (topic,) = [each for each in graph.topics if each.name == "/numbers"]
        assert topic.publishers == [PublisherInfo("/node")]
        statistics = await node.call("/rosapi/statistics", GetStatistics)
        assert statistics.revision == graph.revision
        (topic_statistics,) = [each for each in statistics.topics if each.topic == "/numbers"]
        assert topic_statistics.subscriptions == [SubscriptionStatistics("/node", messages=1)]
        assert [each.node for each in statistics.clients] == ["/node"]


async def test_nodes_reconnect_soon_after_the_hub_returns(port: int) -> None:
    async with HubServer(Settings(port=port)) as hub:
        url = hub.url
        talker, ear = fibws.Node("talker", hub=url), fibws.Node("ear", hub=url)
        lines = Lines(ear.log)
        await talker.__aenter__()
        await ear.__aenter__()
        numbers = ear.subscribe("numbers", Int32)
        latched = await talker.advertise("latched", String, latch=True)
        publisher = await talker.advertise("numbers", Int32)
        await latched.publish("kept")
    assert "Lost the hub" in await lines.next()
    await publisher.publish(1)
    async with HubServer(Settings(port=port)):
        async with asyncio.timeout(PATIENCE):
            assert (await anext(ear.subscribe("latched", String))).data == "kept"
            await publisher.publish(2)
            while (await anext(numbers)).data != 2:
                pass
        await talker.__aexit__()
        await ear.__aexit__()


async def test_messages_published_without_a_hub_reach_the_subscribers(port: int) -> None:
    async with asyncio.timeout(60), contextlib.AsyncExitStack() as stack:
        async with HubServer(Settings(port=port)) as hub:
            url = hub.url
            talker = await stack.enter_async_context(fibws.Node("talker", hub=url))
            ear = await stack.enter_async_context(fibws.Node("ear", hub=url))
            lines = Lines(talker.log), Lines(ear.log)
            numbers = ear.subscribe("numbers", Int32)
            publisher = await talker.advertise("numbers", Int32, queue_size=5)
            probe = await ear.advertise("numbers", Int32)
            await probe.publish(-1)
            assert (await anext(numbers)).data == -1
        for each in lines:
            assert "Lost the hub" in await each.next()
        for number in range(8):
            await publisher.publish(number)
        assert publisher.dropped == 3
        async with HubServer(Settings(port=port)):
            async with asyncio.timeout(PATIENCE):
                kept = [(await anext(numbers)).data for _ in range(5)]
            await publisher.publish(8)
            assert [*kept, (await anext(numbers)).data] == [3, 4, 5, 6, 7, 8]
            await stack.aclose()


# Services


def add(request: AddTwoIntsRequest) -> int:
    return request.a + request.b


async def test_node_calls_a_service_of_another(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("server", hub=url) as server, fibws.Node("client", hub=url) as client:
        await server.service("add", AddTwoInts, add)
        await client.wait_for_service("add", timeout=60)
        assert await client.call("add", AddTwoInts, {"a": 1, "b": 2}) == AddTwoInts.Response(3)
        named = await client.call("/add", "rospy_tutorials/AddTwoInts", AddTwoInts.Request(3, 4))
        assert named.sum == 7
        assert await server.call("add", AddTwoInts) == AddTwoInts.Response(0)


async def test_infinity_and_nan_arrive_in_requests_and_responses(real_hub: HubServer) -> None:
    def plan(request: GetPlanRequest) -> GetPlanResponse:
        return GetPlanResponse(NavPath(poses=[request.start, request.goal]))

    url = real_hub.url
    sent = Point(math.inf, -math.inf, math.nan)
    async with fibws.Node("server", hub=url) as server, fibws.Node("client", hub=url) as client:
        await server.service("plan", GetPlan, plan)
        await client.wait_for_service("plan", timeout=60)
        request = GetPlanRequest(goal=PoseStamped(pose=Pose(position=sent)))
        found = (await client.call("plan", GetPlan, request)).plan.poses[1].pose.position
        assert repr(found) == repr(sent)


async def test_many_calls_are_handled_concurrently(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("server", hub=url) as server, fibws.Node("client", hub=url) as client:
        all_there = asyncio.Barrier(50)

        async def add_together(request: AddTwoIntsRequest) -> int:
            await all_there.wait()
            return add(request)

        await server.service("add", AddTwoInts, add_together)
        await client.wait_for_service("add", timeout=60)
        async with asyncio.timeout(60):
            calls = (client.call("add", AddTwoInts, {"a": number, "b": 1}) for number in range(50))
            sums = [response.sum for response in await asyncio.gather(*calls)]
        assert sums == list(range(1, 51))


@pytest.mark.long
async def test_thousand_calls_at_once_are_answered(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("server", hub=url) as server, fibws.Node("client", hub=url) as client:
        await server.service("add", AddTwoInts, add)
        await client.wait_for_service("add", timeout=60)
        async with asyncio.timeout(60):
            calls = (client.call("add", AddTwoInts, {"a": n, "b": 1}) for n in range(2000))
            sums = [response.sum for response in await asyncio.gather(*calls)]
        assert sums == list(range(1, 2001))


async def test_service_timeout_of_the_hub_is_raised(start_hub: StartHub) -> None:
    hub = await start_hub(service_timeout=0.01)
    async with fibws.Node("node", hub=hub.url) as node:
        await node.service("slow", Trigger, lambda request: asyncio.Event().wait())
        with pytest.raises(fibws.ServiceTimeout, match=r"did not answer within 0\.01 s"):
            await node.call("slow", Trigger)


async def test_failed_calls_raise_with_their_texts(real_hub: HubServer) -> None:
    async with fibws.Node("node", hub=real_hub.url) as node:

        def fail(request: object) -> tuple[bool, str]:
            raise ValueError("boom")

        await node.service("fail", Trigger, fail)
        with pytest.raises(
            fibws.ServiceError, match="processing request: ValueError: boom"
        ) as caught:
            await node.call("fail", Trigger)
        assert caught.value.service == "/fail"
        with pytest.raises(fibws.UnknownService, match=r"^Service /nothing does not exist$"):
            await node.call("nothing", Trigger)


@pytest.mark.parametrize(
    "text",
    [
        "Service /other does not exist",
        "Service /refuse did not answer within 60 s",
        "service [/refuse] unavailable: /node has left",
    ],
)
async def test_text_of_a_server_is_not_mistaken_for_an_error_of_the_hub(
    real_hub: HubServer, text: str
) -> None:
    async with fibws.Node("node", hub=real_hub.url) as node:

        def refuse(request: object) -> dict[str, object]:
            raise CallRefused(text)

        await node.service("refuse", Trigger, refuse)
        with pytest.raises(fibws.ServiceError) as raised:
            await node.call("refuse", Trigger)
        assert type(raised.value) is fibws.ServiceError
        assert (raised.value.code, raised.value.text) == ("server_failed", text)


async def test_node_that_loses_a_service_or_an_action_logs_a_warning(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("older", hub=url) as older, fibws.Node("newer", hub=url) as newer:
        lines = Lines(older.log)
        for node in (older, newer):
            await node.service("/add", AddTwoInts, add)
            await node.call("/add", AddTwoInts, {"a": 1, "b": 2})
        assert await lines.next() == "The hub: /add has another server now: /newer"
        for node in (older, newer):
            await node.action_server(
                "/fib", "example_interfaces/Fibonacci", lambda goal: None, over="operations"
            )
        assert await lines.next() == "The hub: /fib has another server now: /newer"


async def test_hub_knows_registrations_when_they_return(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("server", hub=url) as server, fibws.Node("client", hub=url) as client:
        for number in range(20):
            await server.service(f"add{number}", AddTwoInts, add)
            assert (await client.call(f"add{number}", AddTwoInts, {"a": 1, "b": 2})).sum == 3
        await server.advertise("numbers", Int32)
        assert await client.graph.publishers("numbers") == ["/server"]
        fibonacci = "actionlib_tutorials/Fibonacci"
        await server.action_server("topics", fibonacci, lambda goal: None)
        await server.action_server("operations", fibonacci, lambda goal: None, over="operations")
        assert await client.graph.action_servers() == ["/operations", "/topics"]
        server.subscribe("others", Int32)
        await server.flush()
        assert await client.graph.subscribers("others") == ["/server"]


async def test_refused_service_and_action_are_raised() -> None:
    async with (
        HubServer(
            Settings(port=0, max_advertisements=3)
        ) as hub,  # One more than the log's own two.
        fibws.Node("node", hub=hub.url, rosout=False) as node,
    ):
        lines = Lines(node.log)
        await node.service("/first", AddTwoInts, add)
        for _ in range(2):  # The refused one is forgotten: it is no AlreadyOffered.
            with pytest.raises(fibws.OperationRejected, match="3"):
                await node.service("/second", AddTwoInts, add)
        assert lines.seen() == []
        fibonacci = "actionlib_tutorials/Fibonacci"
        await node.action_server("/first", fibonacci, lambda goal: None)  # It has three topics.
        for _ in range(2):
            with pytest.raises(fibws.OperationRejected):
                await node.action_server("/second", fibonacci, lambda goal: None)


async def test_refused_publisher_is_raised(real_hub: HubServer) -> None:
    async with fibws.Node("node", hub=real_hub.url) as node:
        lines = Lines(node.log)
        await node.advertise("/numbers", Int32)
        with pytest.raises(fibws.OperationRejected, match="already established"):
            await node.advertise("/numbers", Float64)
        assert lines.seen() == []


async def test_refused_publisher_that_is_not_awaited_is_logged(real_hub: HubServer) -> None:
    async with fibws.Node("node", hub=real_hub.url) as node:
        lines = Lines(node.log)
        await node.advertise("/numbers", Int32)
        refused = await node.advertise("/numbers", Float64, wait=False)
        line = await lines.next()
        assert line.startswith("The hub refused the publisher of /numbers: ")
        assert "already established with type std_msgs/Int32" in line
        with pytest.raises(fibws.OperationRejected, match="already established"):
            await refused.publish(0.5)
        assert lines.seen() == []


async def test_call_fails_at_once_when_its_server_leaves(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("client", hub=url) as client:
        async with fibws.Node("server", hub=url) as server:
            asked = asyncio.Event()

            async def never(request: object) -> tuple[bool, str]:
                asked.set()
                await asyncio.Event().wait()
                return True, ""

            await server.service("never", Trigger, never)
            await client.wait_for_service("never", timeout=60)
            call = asyncio.create_task(client.call("never", Trigger))
            await asked.wait()
        async with asyncio.timeout(60):
            with pytest.raises(fibws.ServiceError, match="/server has left"):
                await call


async def test_call_to_a_slow_server_times_out_in_client_and_hub(real_hub: HubServer) -> None:
    async with fibws.Node("node", hub=real_hub.url) as node:
        may = asyncio.Event()

        async def slow(request: object) -> tuple[bool, str]:
            await may.wait()
            return True, ""

        await node.service("slow", Trigger, slow)
        with pytest.raises(fibws.ServiceTimeout, match=r"within 0\.01 s"):
            await node.call("slow", Trigger, timeout=0.01)
        may.set()
        assert (await node.call("slow", Trigger, timeout=60)).success


async def test_services_and_clients_reconnect_with_the_hub(port: int) -> None:
    async with asyncio.timeout(60), contextlib.AsyncExitStack() as stack:
        async with HubServer(Settings(port=port)) as hub:
            url = hub.url
            server = await stack.enter_async_context(fibws.Node("server", hub=url))
            client = await stack.enter_async_context(fibws.Node("client", hub=url))
            await server.service("add", AddTwoInts, add)
            await client.wait_for_service("add")
            lines = Lines(client.log)
        assert "Lost the hub" in await lines.next()
        call = asyncio.create_task(client.call("add", AddTwoInts, {"a": 1, "b": 2}))
        async with HubServer(Settings(port=port)):
            assert (await call).sum == 3
            await stack.aclose()


async def test_definition_of_a_custom_service_reaches_the_hub(
    real_hub: HubServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for kind in ("msg", "srv"):
        (tmp_path / "meadow" / kind).mkdir(parents=True)
    (tmp_path / "meadow" / "msg" / "Plot.msg").write_text("uint8 rows\n")
    (tmp_path / "meadow" / "srv" / "Mow.srv").write_text("Plot plot\n---\nuint8 hours\n")
    monkeypatch.setenv("FIBWS_INTERFACES", str(tmp_path))
    async with fibws.Node("node", hub=real_hub.url) as node:
        await node.service("mow", "meadow/Mow", lambda request: request.plot.rows * 2)
        with pytest.raises(fibws.InvalidMessage, match="rows"):
            await node.call("mow", "meadow/Mow", {"plot": {"rows": 256}})
        assert (await node.call("mow", "meadow/Mow", {"plot": {"rows": 7}})).hours == 14


# Extensions of fibws to rosbridge


async def test_header_of_a_message_names_its_publisher(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("talker", hub=url) as talker, fibws.Node("ear", hub=url) as ear:
        numbers = await talker.advertise("numbers", Int32, latch=True, headers={"user": "ann"})
        await numbers.publish(1)
        asking = ear.subscribe("numbers", Int32, headers=True)
        plain = ear.subscribe("numbers", Int32)
        for subscription in (asking, plain):
            assert (await anext(subscription)).data == 1
        header = {"callerid": "/talker", "latching": "1", "user": "ann"}
        assert asking.connection_header == header
        assert plain.connection_header == {}
        late = ear.subscribe("/talker/numbers", Int32, headers=True)
        others = await talker.advertise("~numbers", Int32)
        await others.publish(2)
        await anext(late)
        assert late.connection_header == {"callerid": "/talker", "latching": "0"}


async def test_header_of_a_request_names_its_caller(real_hub: HubServer) -> None:
    def who(request: object, header: dict[str, str]) -> tuple[bool, str]:
        return True, f"{header['callerid']} {header.get('user')}"

    url = real_hub.url
    async with fibws.Node("provider", hub=url) as provider, fibws.Node("caller", hub=url) as caller:
        await provider.service("who", Trigger, who, headers=True)
        await caller.wait_for_service("who")
        answers = [
            (await caller.call("who", Trigger, headers=headers)).message
            for headers in (None, {}, {"user": "ann"})
        ]
        assert answers == ["/caller None", "/caller None", "/caller ann"]
        # The hub's own services have no use for headers.
        await caller.call("/rosapi/statistics", GetStatistics, headers={"user": "ann"})


async def test_header_of_a_response_names_its_server(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("provider", hub=url) as provider, fibws.Node("caller", hub=url) as caller:
        await provider.service("who", Trigger, lambda request: (True, "me"))
        await caller.wait_for_service("who")
        for headers in ({}, {"user": "ann"}):
            response, header = await caller.call_with_header("who", Trigger, headers=headers)
            assert (response.message, header) == ("me", {"callerid": "/provider"})
        _, header = await caller.call_with_header("/rosapi/nodes", "rosapi/Nodes", headers={})
        assert header == {"callerid": "/rosapi"}


async def test_publishers_and_subscribers_know_each_other(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("talker", hub=url) as talker:
        numbers = await talker.advertise("numbers", Int32, peers=True)
        listeners = numbers.peers.changes()
        assert await anext(listeners) == []
        async with fibws.Node("ear", hub=url) as ear:
            subscription = ear.subscribe("numbers", Int32, peers=True)
            assert await anext(listeners) == ["/ear"]
            assert numbers.peers.names == ["/ear"]
            assert await anext(subscription.peers.changes()) == ["/talker"]
            talkers = subscription.peers.changes()
            await anext(talkers)
            async with fibws.Node("second", hub=url) as second:
                await second.advertise("numbers", Int32)
                assert await anext(talkers) == ["/second", "/talker"]
            assert await anext(talkers) == ["/talker"]
        assert await anext(listeners) == []
    with pytest.raises(StopAsyncIteration):
        await anext(listeners)
    assert subscription.peers.names == []


async def test_message_for_a_new_subscriber_reaches_only_that_one(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("talker", hub=url) as talker, fibws.Node("first", hub=url) as first:
        numbers = await talker.advertise("numbers", Int32, peers=True, latch=True)
        greeted: set[str] = set()

        async def greet(most: int) -> None:
            async for names in numbers.peers.changes():
                for name in sorted({*names} - greeted):
                    numbers._send(numbers._encode_to(name, len(greeted)))
                    greeted.add(name)
                if len(greeted) == most:
                    return

        early = first.subscribe("numbers", Int32)
        await greet(1)
        async with fibws.Node("second", hub=url) as second:
            late = second.subscribe("numbers", Int32)
            await greet(2)
            await numbers.publish(10)
            assert [(await anext(early)).data for _ in range(2)] == [0, 10]
            assert [(await anext(late)).data for _ in range(2)] == [1, 10]


async def test_peers_are_known_again_after_reconnection(port: int) -> None:
    async with HubServer(Settings(port=port)) as hub:
        node = fibws.Node("talker", hub=hub.url)
        await node.__aenter__()
        try:
            numbers = await node.advertise("numbers", Int32, peers=True)
            node.subscribe("numbers", Int32, peers=True)
            changes = numbers.peers.changes()
            while await anext(changes) != ["/talker"]:
                pass
            await hub.close()
            assert await anext(changes) == []
            async with asyncio.timeout(60), HubServer(Settings(port=port)):
                # Before the node subscribes, its publisher has no other subscribers.
                assert await anext(changes) == ["/talker"]
        finally:
            await node.__aexit__(None, None, None)


async def test_node_leaves_though_a_handler_does_not_end(real_hub: HubServer) -> None:
    handler = Stubborn()
    async with fibws.Node("caller", hub=real_hub.url) as caller, asyncio.timeout(PATIENCE):
        async with fibws.Node("server", hub=real_hub.url) as node:
            lines = Lines(node.log)
            await node.service("stop", Trigger, handler)
            call = asyncio.create_task(caller.call("stop", Trigger))
            await handler.begun.wait()
        with pytest.raises(ServiceError):
            await call
    assert "/server" not in real_hub.graph.nodes
    (line,) = [each for each in lines.seen() if "still running" in each]
    assert "handler of service /stop" in line
    await handler.ends()


async def test_unbounded_queue_loses_nothing(real_hub: HubServer) -> None:
    count = 5000
    async with fibws.Node("talker", hub=real_hub.url) as node:
        numbers = await node.advertise("numbers", Int32, queue_size=count)
        subscription = node.subscribe("numbers", Int32, queue_size=None)
        for number in range(count):
            numbers._send(numbers._encode(number))
        last = count - 1
        got: list[int] = []
        async with asyncio.timeout(60):
            while got[-1:] != [last]:
                got.append((await anext(subscription)).data)
        assert got == list(range(count))


# Serialized messages


async def test_messages_of_any_type_are_not_decoded(real_hub: HubServer) -> None:
    url = real_hub.url
    async with fibws.Node("talker", hub=url) as talker, fibws.Node("ear", hub=url) as ear:
        early = ear.subscribe("numbers", AnyMsg, headers=True)
        assert early.type == "*"
        numbers = await talker.advertise("numbers", Int32, latch=True)
        await numbers.publish(7)
        assert (await anext(early))._buff == b"\x07\x00\x00\x00"
        assert early.connection_header == {"callerid": "/talker", "latching": "1"}
        late = ear.subscribe("numbers", AnyMsg)
        assert (await anext(late))._buff == b"\x07\x00\x00\x00"
        assert early.type == late.type == "std_msgs/Int32"


async def test_infinity_and_nan_arrive_unchanged(real_hub: HubServer) -> None:
    async with fibws.Node("node", hub=real_hub.url) as node:
        floats = await node.advertise("floats", Float64, latch=True)
        subscription = node.subscribe("floats", Float64)
        for value in (math.inf, -math.inf, math.nan):
            await floats.publish(value)
        received = [(await anext(subscription)).data for _ in range(3)]
        assert received[:2] == [math.inf, -math.inf]
        assert math.isnan(received[2])


async def test_serialized_message_is_forwarded(real_hub: HubServer) -> None:
    async with fibws.Node("node", hub=real_hub.url) as node:
        numbers = await node.advertise("numbers", Int32, latch=True)
        subscription = node.subscribe("numbers", Int32)
        numbers._send(numbers._encode_serialized(b"\x07\x00\x00\x00"))
        assert (await anext(subscription)).data == 7


async def test_subscriber_may_define_a_custom_type_first(
    real_hub: HubServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "vineyard" / "msg").mkdir(parents=True)
    (tmp_path / "vineyard" / "msg" / "Tree.msg").write_text("uint8 apples\n")
    monkeypatch.setenv("FIBWS_INTERFACES", str(tmp_path))
    async with fibws.Node("node", hub=real_hub.url) as node:
        subscription = node.subscribe("trees", "vineyard/Tree")
        await node.graph.topics()
        trees = await node.advertise("trees", "vineyard/Tree", latch=True)
        await trees.publish(apples=5)
        assert (await anext(subscription)).apples == 5


async def test_type_with_another_md5_is_refused(real_hub: HubServer) -> None:
    async with fibws.Node("node", hub=real_hub.url) as node:
        subscription = node.subscribe("numbers", Int32)
        codec = node._types.codec(Int32)
        codec.md5sum = "0" * 32
        refused = node._topics.subscribe("/numbers", codec, queue_size=1)
        with pytest.raises(fibws.OperationRejected, match="md5"):
            await anext(refused)
        numbers = await node.advertise("numbers", Int32, latch=True)
        await numbers.publish(1)
        assert (await anext(subscription)).data == 1
