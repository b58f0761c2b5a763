"""Hubs that join others: one graph, whose messages, calls and goals cross the links."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Sequence
from typing import Any

import pytest
import websockets
from patience import PATIENCE

import fibws
from fibws.hub.federation import precedence
from fibws.hub.federation.connections import Join as Joining
from fibws.hub.federation.records import Kind
from fibws.hub.federation.remote_nodes import RemoteNode
from fibws.hub.foreign.worklist import Worklist
from fibws.hub.graph.publication import Publication
from fibws.hub.server import HubServer
from fibws.hub.websocket.turns import Turns
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.std_msgs import Int32, String
from fibws.srv.example_interfaces import AddTwoInts
from fibws.srv.fibws_msgs import PingNode
from fibws.srv.sensor_msgs import SetCameraInfo

from ..graph.recorder import Recorder
from .conftest import Join, Reachable, StartNode, until

BOTH = pytest.mark.parametrize("join", ["websocket", "zenoh"], indirect=True)
"""Runs a test with hubs that are joined by WebSockets, and with hubs on a zenoh network."""


async def take(subscription: fibws.Subscription[Int32], count: int) -> list[int]:
    """Return the next numbers of a subscription."""
    found: list[int] = []
    async with asyncio.timeout(PATIENCE):
        async for message in subscription:
            found.append(message.data)
            if len(found) == count:
                return found
    raise AssertionError("the subscription has ended")


async def peers(end: fibws.Publisher[Any, ...] | fibws.Subscription[Any], count: int) -> None:
    """Wait until a publisher has subscribers, or a subscription publishers."""
    async with asyncio.timeout(PATIENCE):
        async for names in end.peers.changes():
            if len(names) >= count:
                return


def remote_nodes(hub: HubServer) -> dict[str, str]:
    """Return the nodes of other hubs, with the names of their hubs."""
    nodes = hub.graph.nodes.items()
    return {name: node.hub.name for name, node in nodes if isinstance(node, RemoteNode)}


async def exchange(hubs: Sequence[Reachable], start_node: StartNode, count: int = 200) -> None:
    """Publish on every hub and subscribe on every hub; check that each message arrives once."""
    publishers, subscriptions = [], []
    for number, hub in enumerate(hubs):
        node = await start_node(f"node_{number}", hub)
        publishers.append(await node.advertise("numbers", Int32, queue_size=10_000, peers=True))
        subscriptions.append(node.subscribe("numbers", Int32, queue_size=10_000, peers=True))
    for publisher in publishers:
        await peers(publisher, len(hubs))
    for subscription in subscriptions:
        await peers(subscription, len(hubs))
    for number in range(count):
        for index, publisher in enumerate(publishers):
            await publisher.publish(data=index * 1_000_000 + number)
    for subscription in subscriptions:
        found = await take(subscription, count * len(hubs))
        for index in range(len(hubs)):
            of_one = [each % 1_000_000 for each in found if each // 1_000_000 == index]
            assert of_one == list(range(count))
    for subscription in subscriptions:
        assert subscription.dropped == 0


async def test_message_passes_from_joining_hub_to_joined_hub(
    join: Join, start_node: StartNode
) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud)
    talker, listener = await start_node("talker", robot), await start_node("listener", cloud)
    publisher = await talker.advertise("chatter", String, peers=True)
    subscription = listener.subscribe("chatter", String)
    await peers(publisher, 1)
    await publisher.publish(data="hello")
    async with asyncio.timeout(PATIENCE):
        assert (await anext(aiter(subscription))).data == "hello"
    assert remote_nodes(cloud) == {"/talker": "robot"}
    assert remote_nodes(robot) == {"/listener": "cloud"}


@BOTH
async def test_messages_of_a_line_arrive_once_and_in_order(
    join: Join, start_node: StartNode
) -> None:
    first = await join("first")
    second = await join("second", first)
    third = await join("third", second)
    await exchange([first, second, third], start_node)


@BOTH
async def test_messages_of_a_triangle_arrive_once_and_in_order(
    join: Join, start_node: StartNode
) -> None:
    first = await join("first")
    second = await join("second", first)
    third = await join("third", first, second)
    await exchange([first, second, third], start_node)


async def test_messages_of_a_star_arrive_once_and_in_order(
    join: Join, start_node: StartNode
) -> None:
    center = await join("center")
    others = [await join(f"hub{number}", center) for number in range(4)]
    await exchange([center, *others], start_node, 50)


async def test_two_hubs_that_join_each_other_have_no_duplicates(
    join: Join, start_node: StartNode
) -> None:
    first = await join("first")
    second = await join("second", first)
    back = Joining(second.url, first.federation, first.settings)
    back.start()
    await until(lambda: len(first.federation.peers) == 2, first)
    await exchange([first, second], start_node)
    await back.close()


async def test_names_of_a_robot_lie_below_its_prefix(join: Join, start_node: StartNode) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud, join_prefix="/robot7")
    talker, viewer = await start_node("talker", robot), await start_node("viewer", cloud)
    scan = await talker.advertise("scan", String, peers=True)
    scans = viewer.subscribe("/robot7/scan", String)
    command = await viewer.advertise("/robot7/cmd_vel", String, peers=True)
    other = await viewer.advertise("/fleet", String)
    commands = talker.subscribe("cmd_vel", String)
    await peers(scan, 1)
    await peers(command, 1)
    await scan.publish(data="from the robot")
    await command.publish(data="to the robot")
    await other.publish(data="not for the robot")
    async with asyncio.timeout(PATIENCE):
        assert (await anext(aiter(scans))).data == "from the robot"
        assert (await anext(aiter(commands))).data == "to the robot"
    assert remote_nodes(cloud) == {"/robot7/talker": "robot"}
    assert remote_nodes(robot) == {"/cloud/viewer": "cloud"}
    assert "/fleet" not in robot.graph.topics


async def test_robots_do_not_see_each_other(join: Join, start_node: StartNode) -> None:
    cloud = await join("cloud")
    one = await join("one", cloud, join_prefix="/one")
    two = await join("two", cloud, join_prefix="/two")
    await (await start_node("talker", one)).advertise("scan", String)
    await (await start_node("talker", two)).advertise("scan", String)
    await until(lambda: {"/one/scan", "/two/scan"} <= cloud.graph.topics.keys(), cloud)
    assert remote_nodes(cloud) == {"/one/talker": "one", "/two/talker": "two"}
    assert remote_nodes(one) == remote_nodes(two) == {}


async def test_only_exported_and_imported_names_cross(join: Join, start_node: StartNode) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud, join_export=("/scan",), join_import=("/cmd_vel",))
    talker, viewer = await start_node("talker", robot), await start_node("viewer", cloud)
    await talker.advertise("scan", String)
    await talker.advertise("secret", String)
    talker.subscribe("cmd_vel", String)
    await viewer.advertise("cmd_vel", String)
    await viewer.advertise("noise", String)
    await (await start_node("hidden", robot)).advertise("secret", String)
    await until(lambda: "/cmd_vel" in robot.graph.topics, robot)
    await until(lambda: "/scan" in cloud.graph.topics, cloud)
    assert remote_nodes(cloud) == {"/talker": "robot"}
    assert list(cloud.graph.topics["/cmd_vel"].subscribers()) == ["/talker"]
    assert "/secret" not in cloud.graph.topics
    assert "/noise" not in robot.graph.topics


@BOTH
async def test_latched_message_reaches_a_late_subscriber_on_another_hub(
    join: Join, start_node: StartNode
) -> None:
    first = await join("first")
    second = await join("second", first)
    third = await join("third", second)
    talker, listener = await start_node("talker", first), await start_node("listener", third)
    publisher = await talker.advertise("map", String, latch=True)
    await publisher.publish(data="old")
    await publisher.publish(data="new")
    message = await listener.wait_for_message("map", String, timeout=PATIENCE)
    assert message.data == "new"
    again = await start_node("again", third)
    message = await again.wait_for_message("map", String, timeout=PATIENCE)
    assert message.data == "new"


@BOTH
async def test_messages_that_nobody_wants_do_not_cross(join: Join, start_node: StartNode) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud)
    talker, local = await start_node("talker", robot), await start_node("local", robot)
    publisher = await talker.advertise("camera", String, peers=True)
    subscription = local.subscribe("camera", String)
    await peers(publisher, 1)
    for _ in range(10):
        await publisher.publish(data="x" * 1000)
    async with asyncio.timeout(PATIENCE):
        for _ in range(10):
            await anext(aiter(subscription))
    await until(lambda: "/camera" in cloud.graph.topics, cloud)
    assert robot.federation.peers[0].traffic.messages_sent == 0


async def test_service_of_another_hub_is_called(join: Join, start_node: StartNode) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud, join_prefix="/robot7")
    server, client = await start_node("server", robot), await start_node("client", cloud)
    await server.service("add", AddTwoInts, lambda request: {"sum": request.a + request.b})
    await client.wait_for_service("/robot7/add", timeout=PATIENCE)
    response = await client.call("/robot7/add", AddTwoInts, {"a": 2, "b": 3})
    assert response.sum == 5


async def test_request_with_too_many_values_for_json_reaches_its_server(
    join: Join, start_node: StartNode, monkeypatch: pytest.MonkeyPatch
) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud)
    server, client = await start_node("server", robot), await start_node("client", cloud)
    await server.service("set", SetCameraInfo, lambda request: (True, str(request.camera_info.D)))
    await client.wait_for_service("set", timeout=PATIENCE)
    monkeypatch.setattr("fibws.hub.graph.types.FEWEST_BYTES", 0)
    monkeypatch.setattr("fibws.interfaces.serialization.MOST_WEIGHT", 0)
    response = await client.call("set", SetCameraInfo, {"camera_info": {"D": [0.5] * 2}})
    assert response.status_message == "[0.5, 0.5]"


@BOTH
async def test_error_of_a_remote_service_reaches_the_caller(
    join: Join, start_node: StartNode
) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud)
    server, client = await start_node("server", robot), await start_node("client", cloud)

    def fail(request: AddTwoInts.Request) -> AddTwoInts.Response:
        raise ValueError("no battery")

    await server.service("add", AddTwoInts, fail)
    await client.wait_for_service("add", timeout=PATIENCE)
    with pytest.raises(fibws.ServiceError, match="no battery"):
        await client.call("add", AddTwoInts)


@BOTH
async def test_call_fails_when_the_hub_of_the_service_is_lost(
    join: Join, start_node: StartNode
) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud)
    server, client = await start_node("server", robot), await start_node("client", cloud)
    called = asyncio.Event()

    async def wait(request: AddTwoInts.Request) -> AddTwoInts.Response:
        called.set()
        await asyncio.Event().wait()
        return AddTwoInts.Response()

    await server.service("add", AddTwoInts, wait)
    await client.wait_for_service("add", timeout=PATIENCE)
    call = asyncio.create_task(client.call("add", AddTwoInts))
    await called.wait()
    for peer in cloud.federation.peers:
        await peer.backplane.close()
    with pytest.raises(fibws.ServiceError, match="is lost"):
        await asyncio.wait_for(call, PATIENCE)


@BOTH
async def test_newest_service_of_two_hubs_is_called(join: Join, start_node: StartNode) -> None:
    first = await join("first")
    second = await join("second", first)
    old, new = await start_node("old", first), await start_node("new", second)
    client = await start_node("client", first)
    await old.service("add", AddTwoInts, lambda request: {"sum": 1})
    await until(lambda: "/add" in second.graph.services, second)
    await new.service("add", AddTwoInts, lambda request: {"sum": 2})
    await until(lambda: first.graph.services["/add"].node == "/new", first)
    assert (await client.call("add", AddTwoInts)).sum == 2
    assert second.graph.services["/add"].node == "/new"


@BOTH
@pytest.mark.parametrize("over", ["topics", "operations"])
async def test_goal_is_executed_on_another_hub(
    join: Join, start_node: StartNode, over: fibws.Over
) -> None:
    from fibws.action.action_tutorials_interfaces import Fibonacci

    cloud = await join("cloud")
    robot = await join("robot", cloud)
    server, client = await start_node("server", robot), await start_node("client", cloud)

    async def execute(goal: fibws.ServerGoal) -> Fibonacci.Result:
        sequence = [0, 1]
        for _ in range(goal.request.order - 1):
            sequence.append(sequence[-1] + sequence[-2])
            await goal.publish_feedback({"partial_sequence": sequence})
        return Fibonacci.Result(sequence=sequence)

    await server.action_server("fibonacci", Fibonacci, execute, over=over)
    actions = client.action_client("fibonacci", Fibonacci, over=over)
    async with asyncio.timeout(PATIENCE):
        await actions.wait_for_server()
        goal = await actions.send({"order": 5})
        feedback = [len(each.partial_sequence) async for each in goal.feedback()]
        result = await goal.result()
    assert list(result.sequence) == [0, 1, 1, 2, 3, 5]
    assert feedback[-1] == 6


@BOTH
async def test_definition_that_one_hub_lacks_comes_from_the_other(
    join: Join, start_node: StartNode
) -> None:
    first = await join("first")
    second = await join("second", first)
    talker = await start_node("talker", first)
    definition = "int32 left\nint32 right\n"
    publisher = await talker.advertise_serialized(
        "wheels", "my_msgs/Wheels", definition=definition, latch=True
    )
    publisher._send(publisher._encode_serialized(bytes([1, 0, 0, 0, 2, 0, 0, 0])))
    arrived: asyncio.Queue[Publication] = asyncio.Queue()
    recorder = Recorder("/recorder")
    recorder.receive = arrived.put_nowait  # type: ignore[method-assign, assignment]
    await until(lambda: "/wheels" in second.graph.topics, second)
    second.graph.subscribe(second.graph.topic("/wheels"), recorder)
    publication = await asyncio.wait_for(arrived.get(), PATIENCE)
    assert publication.values() == {"left": 1, "right": 2}
    second.graph.unsubscribe(second.graph.topic("/wheels"), recorder)


async def test_conflict_of_types_is_listed_on_both_hubs(join: Join, start_node: StartNode) -> None:
    first, second = await join("first"), await join("second")
    await (await start_node("one", first)).advertise("data", Int32)
    await (await start_node("two", second)).advertise("data", String)
    third = await join("third", first, second)
    await until(lambda: _conflicts(third) or _conflicts(second) or _conflicts(first), third, first)
    assert _conflicts(third) in (["/one"], ["/two"])


@BOTH
@pytest.mark.parametrize("first_type", [Int32, String])
async def test_messages_of_each_type_pass_between_hubs_in_a_conflict(
    join: Join, start_node: StartNode, first_type: Any
) -> None:
    first = await join("first")
    second = await join("second", first)
    other_type: Any = String if first_type is Int32 else Int32
    values: Any = {Int32: 5, String: "five"}
    near, wrong = await start_node("near", first), await start_node("wrong", first)
    far = await start_node("far", second)
    await wrong.advertise("data", first_type)
    publisher = await near.advertise("data", other_type, latch=True)
    await publisher.publish(data=values[other_type])
    messages = far.subscribe("data", other_type)
    assert (await asyncio.wait_for(anext(messages), PATIENCE)).data == values[other_type]
    assert "/near" in _conflicts(first)
    back = await (await start_node("back", second)).advertise("data", other_type, latch=True)
    await back.publish(data=values[other_type])
    listener = await start_node("listener", first)
    received = listener.subscribe("data", other_type)
    for _ in range(2):
        assert (await asyncio.wait_for(anext(received), PATIENCE)).data == values[other_type]


def _conflicts(hub: HubServer) -> list[str]:
    topic = hub.graph.topics.get("/data")
    return [each.node for each in hub.graph.view("/x").conflicts(topic)] if topic else []


@BOTH
async def test_older_node_survives_when_hubs_meet(
    join: Join, start_node: StartNode, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(precedence, "SAME_AGE", 1)  # Hubs of one machine have one clock.
    first = await join("first")
    older = await start_node("robot", first)
    await until(lambda: "/robot" in first.graph.nodes, first)
    second = await join("second")
    younger = await start_node("robot", second)
    third = await join("third", first, second)
    with pytest.raises(fibws.NodeReplaced):
        await asyncio.wait_for(younger.spin(), PATIENCE)
    await until(lambda: remote_nodes(second).get("/robot") == "first", second)
    await until(lambda: remote_nodes(third).get("/robot") == "first", third)
    await older.graph.nodes()


@BOTH
async def test_new_node_replaces_a_node_of_another_hub(join: Join, start_node: StartNode) -> None:
    first = await join("first")
    second = await join("second", first)
    older = await start_node("robot", first)
    await until(lambda: "/robot" in second.graph.nodes, second)
    await start_node("robot", second)
    with pytest.raises(fibws.NodeReplaced):
        await asyncio.wait_for(older.spin(), PATIENCE)
    await until(lambda: remote_nodes(first) == {"/robot": "second"}, first)


@BOTH
async def test_node_of_another_hub_is_pinged_and_killed(join: Join, start_node: StartNode) -> None:
    first = await join("first")
    second = await join("second", first)
    third = await join("third", second)
    node, operator = await start_node("robot", third), await start_node("operator", first)
    await until(lambda: "/robot" in first.graph.nodes, first)
    answer = await operator.call("/rosapi/ping_node", "fibws_msgs/PingNode", {"node": "/robot"})
    assert answer.success, answer.message
    answer = await operator.call("/rosapi/kill_node", "fibws_msgs/KillNode", {"node": "/robot"})
    assert answer.success, answer.message
    with pytest.raises(fibws.NodeKilled):
        await asyncio.wait_for(node.spin(), PATIENCE)


@pytest.mark.parametrize("verb", ["ping", "kill"])
async def test_node_behind_a_full_link_is_reported(
    join: Join, start_node: StartNode, monkeypatch: pytest.MonkeyPatch, verb: str
) -> None:
    monkeypatch.setattr(Turns, "is_over", lambda turns: False)
    limit = 100_000
    cloud = await join("cloud", max_queued_bytes=limit)
    robot = await join("robot", cloud)
    node = await start_node("robot", robot)
    await node.service("greet", PingNode, lambda request: {})
    await until(lambda: "/greet" in cloud.graph.services, cloud)
    # A request that fills the link, and the question behind it before anything is sent.
    fill = {"service": "/greet", "args": {"node": "x" * (limit - 4)}}
    ask = {"service": f"/rosapi/{verb}_node", "args": {"node": "/robot"}, "id": "ask"}
    text = "".join(json.dumps({"op": "call_service", **each}) for each in (fill, ask))
    async with websockets.connect(cloud.url) as client, asyncio.timeout(PATIENCE):
        await client.send(text)
        responses = [json.loads(await client.recv()) for _ in range(2)]
    [answer] = [each["values"] for each in responses if each.get("id") == "ask"]
    assert answer["success"] is False
    assert "too much waits for hub robot" in answer["message"]


async def test_nodes_on_both_sides_of_a_prefix_are_pinged(
    join: Join, start_node: StartNode
) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud, join_prefix="/robot7")
    talker, viewer = await start_node("talker", robot), await start_node("viewer", cloud)
    viewer.subscribe("/robot7/scan", String)
    await until(lambda: "/cloud/viewer" in robot.graph.nodes, robot)
    await until(lambda: "/robot7/talker" in cloud.graph.nodes, cloud)
    for node, name in ((viewer, "/robot7/talker"), (talker, "/cloud/viewer")):
        answer = await node.call("/rosapi/ping_node", "fibws_msgs/PingNode", {"node": name})
        assert answer.success, answer.message


@BOTH
async def test_nodes_of_a_lost_hub_leave(join: Join, start_node: StartNode) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud)
    talker = await start_node("talker", robot)
    await talker.advertise("chatter", String)
    await talker.service("add", AddTwoInts, lambda request: {"sum": 0})
    await until(lambda: "/add" in cloud.graph.services, cloud)
    await robot.close()
    await until(lambda: not remote_nodes(cloud), cloud)
    await until(lambda: "/chatter" not in cloud.graph.topics, cloud)
    await until(lambda: "/add" not in cloud.graph.services, cloud)


async def test_what_a_lost_hub_has_left_is_removed_one_by_one(
    join: Join, start_node: StartNode, monkeypatch: pytest.MonkeyPatch
) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud)
    node = await start_node("node", robot)
    topics = {f"/topic_{each}" for each in range(30)}
    for topic in topics:
        await node.advertise(topic, String)
        node.subscribe(topic, String)
        await node.service(f"{topic}/add", AddTwoInts, lambda request: {"sum": 0})
    await until(lambda: f"{max(topics)}/add" in cloud.graph.services, cloud)
    await until(lambda: topics <= cloud.graph.topics.keys(), cloud)
    changes, step = [0], Worklist._run_one

    def count(work: Worklist[Kind]) -> bool:
        before = cloud.graph.revision
        found = step(work)
        changes.append(cloud.graph.revision - before)
        return found

    monkeypatch.setattr(Worklist, "_run_one", count)
    await robot.close()
    await until(lambda: not topics & cloud.graph.topics.keys(), cloud)
    await until(lambda: not any(name.endswith("/add") for name in cloud.graph.services), cloud)
    assert max(changes) < 10
    assert not cloud.graph._left


async def test_hub_cannot_join_itself(join: Join) -> None:
    cloud = await join("cloud")
    joining = Joining(cloud.url, cloud.federation, cloud.settings)
    faults: asyncio.Queue[str] = asyncio.Queue()
    joining.on_fault = faults.put_nowait
    joining.start()
    assert "itself" in await asyncio.wait_for(faults.get(), PATIENCE)
    await joining.close()
    assert not cloud.federation.peers


async def test_log_of_other_hubs_arrives_while_somebody_reads_it(
    join: Join, start_node: StartNode
) -> None:
    cloud = await join("cloud")
    robot = await join("robot", cloud, join_prefix="/robot7")
    desk = await join("desk", cloud)
    speakers = [await start_node("talker", robot), await start_node("worker", desk)]
    await until(lambda: {"/robot7/talker", "/worker"} <= {*cloud.graph.nodes}, cloud)
    node = await start_node("reader", cloud)
    reader = node.subscribe("/rosout_agg", Log)
    names: set[str] = set()

    async def read() -> None:
        async for line in reader:
            names.add(line.name)
            if names == {"/robot7/talker", "/worker"}:
                return

    reading = asyncio.create_task(read())
    async with asyncio.timeout(PATIENCE):
        while not reading.done():
            for speaker in speakers:  # Lines are lost until the subscription is known there.
                speaker.log.info("here")
                await speaker.flush()
            await node.flush()
    reader.close()
    logs = [hub.graph.topic("/rosout") for hub in (robot, desk)]
    await until(lambda: all(len(log.sinks()) == 1 for log in logs), robot, desk)
