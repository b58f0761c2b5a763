"""ROS 2 programs that send nonsense or too much harm nobody; and rights."""

from __future__ import annotations

import asyncio
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import zenoh
from conftest import StartHub
from hub_reload import reloaded
from patience import PATIENCE

import fibws
from fibws.access.rights import Rights
from fibws.access.token_file import TokenFile
from fibws.errors import HubError, ServiceError
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Float64MultiArray, String
from fibws.srv.example_interfaces import AddTwoInts

from ..federation.conftest import until
from ..zenoh_endpoints import zenoh_config
from .conftest import StartRos2Hub
from .peer import ADD, ADD_HASH, STRING, STRING_HASH, Peer, cdr_string, reaching, text_of
from .test_services import adder, request
from .test_topics import flowing, ros2_nodes, sources, subscribers, tokens_of, until_tokens

NONSENSE = [
    (cdr_string("x"), b""),
    (cdr_string("x"), b"short"),
    (cdr_string("x"), bytes(77)),
    (cdr_string("x"), bytes(16) + b"\x08" + bytes(16)),
    (b"", None),
    (b"\x00\x01", None),
    (b"\x00\x01\x00\x00\xff\xff\xff\xff", None),
    (b"\x00\x00\x00\x00\x00\x00\x00\x02x\x00", None),
    (cdr_string("x") + bytes(20), None),
    (b"\x00\x01\x00\x00\x01\x00\x00\x00x", None),
]


async def test_invalid_messages_are_counted_and_the_next_ones_arrive(
    hub: HubServer, peer: Peer, node: fibws.Node, caplog: pytest.LogCaptureFixture
) -> None:
    talker = await peer.publisher("/talker", "/chatter")
    async with node.subscribe("/chatter", String) as messages, asyncio.timeout(PATIENCE):
        await flowing(talker)
        for data, attachment in NONSENSE:
            await talker.publish(data, attachment)
        await asyncio.to_thread(talker.declared.put, cdr_string("no attachment"))
        await talker.publish(cdr_string("good"))
        assert (await anext(messages)).data == "good"
    assert hub.ros2 is not None
    assert hub.ros2.network.faults == len(NONSENSE) + 1
    assert sum("faults so far" in each.message for each in caplog.records) == 2  # 1 and 10.


async def test_invalid_tokens_are_counted_and_the_next_ones_are_read(
    hub: HubServer, peer: Peer, caplog: pytest.LogCaptureFixture
) -> None:
    declare = peer.session.liveliness().declare_token
    texts = [
        "@ros2_lv/0/x",
        "@ros2_lv/0/ab/0/0/NN/%/%/9lives",
        "@ros2_lv/0/ab/0/0/ZZ/%/%/node",
        "@ros2_lv/0/ab/0/1/MP/%/%/node",
        f"@ros2_lv/0/ab/0/1/MP/%/%/node/%chatter/{STRING}/RIHS01_xyz/::,10:,:,:,,",
        f"@ros2_lv/0/ab/0/1/MP/%/%/node/%chatter/{STRING}/{STRING_HASH}/nonsense",
        f"@ros2_lv/0/ab/0/1/MP/%/%/node/%chatter/{STRING}/{STRING_HASH}/::,{'9' * 400}:,:,:,,",
        f"@ros2_lv/0/ab/0/1/MP/%/%/{'n' * 3000}/%chatter/{STRING}/{STRING_HASH}/::,1:,:,:,,",
        "@ros2_lv/0/ab/0/0/NN/%/%/ünïcode",
    ]
    tokens = [await asyncio.to_thread(declare, text) for text in texts]
    await peer.declare("NN", "/good")
    await until(lambda: ros2_nodes(hub) == {"/good"}, hub)
    for token in tokens:
        await asyncio.to_thread(token.undeclare)
    await peer.declare("NN", "/better")
    await until(lambda: ros2_nodes(hub) == {"/good", "/better"}, hub)
    assert "invalid token" in caplog.text


async def test_actions_and_service_introspection_are_left_out_and_faults_are_warned_of(
    hub: HubServer, peer: Peer, caplog: pytest.LogCaptureFixture
) -> None:
    fibonacci = "example_interfaces::action::dds_::Fibonacci_"
    for kind, name, type_ in (
        ("MP", "/fib/_action/feedback", f"{fibonacci}FeedbackMessage_"),
        ("MP", "/fib/_action/status", "action_msgs::msg::dds_::GoalStatusArray_"),
        ("SS", "/fib/_action/send_goal", f"{fibonacci}SendGoal_"),
        ("SC", "/fib/_action/get_result", f"{fibonacci}GetResult_"),
        ("SS", "/fib/_action/cancel_goal", "action_msgs::srv::dds_::CancelGoal_"),
        ("MP", "/fib/_action/send_goal/_service_event", f"{fibonacci}SendGoal_Event_"),
        ("MP", "/add/_service_event", "example_interfaces::srv::dds_::AddTwoInts_Event_"),
    ):
        await peer.declare(kind, "/server", name, type_, STRING_HASH)
    await peer.declare("NN", "/last")
    await until(lambda: ros2_nodes(hub) == {"/server", "/last"}, hub)
    assert "token" not in caplog.text
    assert not [name for name in hub.graph.topics if "/_" in name]
    assert not [name for name in hub.graph.services if "/_" in name]
    await peer.declare("MP", "/server", "/fault", ADD, ADD_HASH)
    await peer.declare("NN", "/later")
    await until(lambda: "/later" in ros2_nodes(hub), hub)
    assert "1 invalid tokens so far" in caplog.text
    assert "/fault" in caplog.text


async def test_tokens_beyond_the_limit_are_left_out(
    hub: HubServer, peer: Peer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.hub.ros2.nodes.MOST_TOKENS", 3)
    for number in range(5):
        await peer.declare("NN", f"/node{number}")
    await until(lambda: len(ros2_nodes(hub)) == 3, hub)


async def test_messages_that_are_too_large_are_left_out(start_ros2_hub: StartRos2Hub) -> None:
    hub, endpoint = await start_ros2_hub(max_message_size=1000)
    async with Peer(endpoint) as peer, fibws.Node("ours", hub=hub.url) as node:
        talker = await peer.publisher("/talker", "/chatter")
        async with node.subscribe("/chatter", String) as messages, asyncio.timeout(PATIENCE):
            await flowing(talker)
            await talker.publish(cdr_string("x" * 2000))
            await talker.publish(cdr_string("small"))
            assert (await anext(messages)).data == "small"


async def test_burst_arrives_in_order(hub: HubServer, peer: Peer, node: fibws.Node) -> None:
    _, queue = await peer.subscriber("/listener", "/chatter")
    publisher = await node.advertise("/chatter", String, queue_size=1000, peers=True)
    await reaching(publisher, "/listener")
    for number in range(500):
        await publisher.publish(data=str(number))
    async with asyncio.timeout(PATIENCE):
        received = [await queue.get() for _ in range(500)]
    assert [text_of(each.data) for each in received] == [str(number) for number in range(500)]
    assert [each.sequence for each in received] == list(range(1, 501))
    assert len({each.gid for each in received}) == 1


async def test_large_and_small_messages_of_one_publisher_stay_in_order(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    type_ = "std_msgs::msg::dds_::Float64MultiArray_"
    from rosbags.typesys import Stores, get_typestore

    store: Any = get_typestore(Stores.ROS2_JAZZY)
    type_hash = store.hash_rihs01("std_msgs/msg/Float64MultiArray")
    _, queue = await peer.subscriber("/listener", "/numbers", type_, type_hash)
    publisher = await node.advertise("/numbers", Float64MultiArray, queue_size=100, peers=True)
    await reaching(publisher, "/listener")
    sizes = [10, 20_000, 5, 30_000, 1, 0, 9000]
    received = []
    for _ in range(3):  # zenoh's queue has room for each of them, however late it is sent.
        for size in sizes:
            await publisher.publish(Float64MultiArray(data=[1.5] * size))
        async with asyncio.timeout(PATIENCE):
            received += [await queue.get() for _ in sizes]
    decoded = [
        store.deserialize_cdr(each.data, "std_msgs/msg/Float64MultiArray") for each in received
    ]
    assert [len(each.data) for each in decoded] == sizes * 3


async def test_hub_needs_an_endpoint_that_it_can_use(start_hub: StartHub) -> None:
    with pytest.raises(HubError, match=r"ros2=\.\.\.\) must be an endpoint.*nonsense"):
        await start_hub(ros2=("nonsense",))


# Rights.


async def start_with_rights(
    start_ros2_hub: StartRos2Hub, path: Path, allow: str
) -> tuple[HubServer, str, str]:
    """Return a hub whose ROS 2 nodes have rights, their endpoint, and its operator's token."""
    admin = TokenFile(path).add("operator", Rights(admin=True))
    with path.open("a") as file:
        file.write(f"[ros2]\nallow = {{{allow}}}\n")
    return *await start_ros2_hub(tokens=path), admin


async def test_section_ros2_limits_what_ros_2_nodes_do_and_see(
    start_ros2_hub: StartRos2Hub, tmp_path: Path
) -> None:
    allow = (
        'publish = ["/scan"], subscribe = ["/cmd_vel"], call = ["/open"], provide = ["/served"],'
        ' node = ["/robot/**"]'
    )
    path = tmp_path / "tokens.toml"
    hub, endpoint, admin = await start_with_rights(start_ros2_hub, path, allow)
    async with (
        Peer(endpoint) as peer,
        fibws.Node("ours", hub=hub.url, token=admin) as node,
    ):
        tokens, changed = await tokens_of(peer, hub)
        for topic in ("/cmd_vel", "/secret"):
            await node.advertise(topic, String)
        for name in ("/open", "/closed"):
            await node.service(name, AddTwoInts, lambda request: AddTwoInts.Response(sum=7))
        await peer.declare("NN", "/stranger")
        await peer.publisher("/robot/node", "/secret")
        await peer.subscriber("/robot/node", "/secret")
        await peer.publisher("/robot/node", "/scan")
        await peer.subscriber("/robot/node", "/cmd_vel")
        await peer.server("/robot/node", "/closed_too", adder(peer.key("/closed_too")))
        await peer.server("/robot/node", "/served", adder(peer.key("/served", ADD, ADD_HASH)))
        await until(lambda: "/served" in hub.graph.services, hub)
        await until(lambda: sources(hub, "/scan") == {"/robot/node"}, hub)
        await until(lambda: subscribers(hub, "/cmd_vel") == {"/robot/node"}, hub)
        assert ros2_nodes(hub) == {"/robot/node"}
        assert sources(hub, "/secret") == {"/ours"}
        assert not subscribers(hub, "/secret")
        assert "/closed_too" not in hub.graph.services
        await until_tokens(changed, lambda: any("%open/" in token for token in tokens))
        await until_tokens(changed, lambda: any("%cmd_vel/" in token for token in tokens))
        assert not any("secret" in token or "closed" in token for token in tokens)
        attachment = bytes(16) + b"\x10" + bytes(16)
        reply = await peer.call("/open", request(1, 1), attachment)
        assert reply is not None
        assert reply.ok is not None
        assert reply.ok.payload.to_bytes()[4:] == struct.pack("<q", 7)
        response = await node.call("/served", AddTwoInts, {"a": 1, "b": 2}, timeout=PATIENCE)
        assert response.sum == 3


async def test_rights_can_change_while_nodes_are_there(
    start_ros2_hub: StartRos2Hub, tmp_path: Path
) -> None:
    path = tmp_path / "tokens.toml"
    allow = 'publish = ["/a"], node = ["/**"]'
    hub, endpoint, _ = await start_with_rights(start_ros2_hub, path, allow)
    async with Peer(endpoint) as peer:
        await peer.publisher("/talker", "/a")
        await peer.publisher("/talker", "/b")
        await until(lambda: sources(hub, "/a"), hub)
        assert not sources(hub, "/b")
        path.write_text(path.read_text().replace('publish = ["/a"]', 'publish = ["/b"]'))
        await reloaded(hub)
        await until(lambda: sources(hub, "/b") and not sources(hub, "/a"), hub)
        assert ros2_nodes(hub) == {"/talker"}


async def test_calls_end_with_the_right_to_them(
    start_ros2_hub: StartRos2Hub, tmp_path: Path
) -> None:
    path = tmp_path / "tokens.toml"
    hub, endpoint, admin = await start_with_rights(start_ros2_hub, path, 'call = ["/slow"]')
    called, ended = asyncio.Event(), asyncio.Event()

    async def wait(request: AddTwoInts.Request) -> AddTwoInts.Response:
        called.set()
        await ended.wait()
        return AddTwoInts.Response()

    async with (
        Peer(endpoint) as peer,
        fibws.Node("ours", hub=hub.url, token=admin) as node,
    ):
        tokens, changed = await tokens_of(peer, hub)
        await node.service("/slow", AddTwoInts, wait)
        await until_tokens(changed, lambda: any("%slow/" in token for token in tokens))
        attachment = bytes(16) + b"\x10" + bytes(16)
        call = asyncio.create_task(peer.call("/slow", request(1, 1), attachment))
        async with asyncio.timeout(PATIENCE):
            await called.wait()
        path.write_text(path.read_text().replace('call = ["/slow"]', 'call = ["/none"]'))
        await reloaded(hub)
        reply = await call
        assert reply is not None
        assert reply.err is not None
        assert "the call was ended" in reply.err.payload.to_string()
        ended.set()


async def test_ros_2_nodes_cannot_be_ended_from_here(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    await peer.declare("NN", "/theirs")
    await until(lambda: ros2_nodes(hub), hub)
    response = await node.call("/rosapi/kill_node", "fibws_msgs/KillNode", {"node": "/theirs"})
    assert not response.success
    assert "on its machine" in response.message
    response = await node.call("/rosapi/ping_node", "fibws_msgs/PingNode", {"node": "/theirs"})
    assert response.success
    with pytest.raises(ServiceError):
        await node.call("/nothing", AddTwoInts)


# zenoh's settings.

UNICAST = {
    "open_timeout": 60_000,
    "accept_timeout": 60_000,
    "accept_pending": 10_000,
    "max_sessions": 10_000,
}
CONGESTION = "transport/link/tx/queue/congestion_control"


async def made_config(
    start_hub: StartHub, monkeypatch: pytest.MonkeyPatch, **settings: Any
) -> Callable[[str], Any]:
    """Return what reads the settings with which a hub opens its session."""
    made: list[zenoh.Config] = []

    def refuse(config: zenoh.Config) -> None:
        made.append(config)
        raise OSError("not here")

    monkeypatch.setattr(zenoh, "open", refuse)
    with pytest.raises(HubError, match="not here"):
        await start_hub(**settings)
    return lambda key: json.loads(made[0].get_json(key))


async def test_hub_in_place_of_the_router_has_its_settings(
    start_hub: StartHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    setting = await made_config(start_hub, monkeypatch, ros2=("tcp/127.0.0.1:0",))
    unicast = setting("transport/unicast")
    assert {key: unicast[key] for key in UNICAST} == UNICAST
    assert setting("transport/link/tx/lease") == 60_000
    assert setting("transport/link/tx/keep_alive") == 2
    assert setting("routing/router/peers_failover_brokering") is False
    assert setting("timestamping/enabled") is True
    assert setting(f"{CONGESTION}/block/wait_before_close") == 5_000_000


async def test_hub_beside_the_router_has_the_settings_of_a_node(
    start_hub: StartHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    setting = await made_config(start_hub, monkeypatch, ros2_connect=("tcp/127.0.0.1:1",))
    unicast = setting("transport/unicast")
    assert {key: unicast[key] for key in UNICAST} == UNICAST
    assert setting("transport/link/tx/lease") == 60_000
    assert setting(f"{CONGESTION}/block/wait_before_close") == 60_000_000


async def test_file_of_zenoh_has_precedence(
    start_hub: StartHub, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    path = zenoh_config(
        tmp_path,
        unicast={"max_sessions": 50},
        link={"tx": {"lease": 7000, "queue": {"size": {"data": 3}}}},
    )
    setting = await made_config(
        start_hub, monkeypatch, ros2=("tcp/127.0.0.1:0",), zenoh_config=path
    )
    assert setting("transport/unicast/max_sessions") == 50
    assert setting("transport/unicast/accept_pending") == 10_000
    assert setting("transport/link/tx/lease") == 7000
    assert setting("transport/link/tx/queue/size/data") == 3
    assert setting("transport/link/tx/queue/size/control") == 16
