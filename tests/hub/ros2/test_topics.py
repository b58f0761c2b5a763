"""Topics across both worlds, with a program that speaks rmw_zenoh's layout."""

from __future__ import annotations

import asyncio
import os
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub
from patience import PATIENCE

import fibws
from fibws.hub.graph.nodes import DistantNode
from fibws.hub.graph.topic import SinkReport
from fibws.hub.server import HubServer
from fibws.msg.sensor_msgs import Image
from fibws.msg.std_msgs import Header, Int32, String

from ..federation.conftest import until
from .conftest import StartPeer, StartRos2Hub
from .peer import STRING, STRING_HASH, Entity, Peer, cdr_string, reaching, text_of


def sources(hub: HubServer, topic: str) -> set[str]:
    found = hub.graph.topics.get(topic)
    return set(found.sources) if found is not None else set()


def subscribers(hub: HubServer, topic: str) -> set[str]:
    found = hub.graph.topics.get(topic)
    return set(found.subscribers()) if found is not None else set()


def ros2_nodes(hub: HubServer) -> set[str]:
    return {name for name, node in hub.graph.nodes.items() if isinstance(node, DistantNode)}


async def tokens_of(peer: Peer, hub: HubServer) -> tuple[set[str], asyncio.Event]:
    """Return the tokens of a hub, without the ids, and what is set when they change."""
    tokens: set[str] = set()
    changed = asyncio.Event()
    assert hub.ros2 is not None
    own = hub.ros2.network.session_id

    def note(text: str, is_alive: bool) -> None:
        parts = text.split("/")
        if parts[2] == own:
            (tokens.add if is_alive else tokens.discard)("/".join(parts[5:]))
            changed.set()

    await peer.tokens(note)
    return tokens, changed


async def until_tokens(changed: asyncio.Event, condition: Any) -> None:
    async with asyncio.timeout(PATIENCE):
        while not condition():
            changed.clear()
            await changed.wait()


async def test_nodes_with_tokens_are_nodes_of_the_graph_until_they_leave(
    hub: HubServer, start_peer: StartPeer
) -> None:
    peer = await start_peer()
    await peer.declare("NN", "/robot/camera")
    await peer.publisher("/robot/camera", "/robot/name")
    await peer.subscriber("/robot/camera", "/command")
    await until(lambda: subscribers(hub, "/command") == {"/robot/camera"}, hub)
    assert ros2_nodes(hub) == {"/robot/camera"}
    assert sources(hub, "/robot/name") == {"/robot/camera"}
    assert hub.graph.topics["/robot/name"].type.name == "std_msgs/String"  # type: ignore[union-attr]
    await asyncio.to_thread(peer.session.close)
    await until(lambda: not ros2_nodes(hub), hub)
    await until(lambda: not sources(hub, "/robot/name"), hub)
    await until(lambda: not subscribers(hub, "/command"), hub)


async def test_node_without_tokens_leaves_and_other_nodes_of_the_session_stay(
    hub: HubServer, peer: Peer
) -> None:
    first = await peer.declare("NN", "/first")
    await peer.declare("NN", "/second")
    publisher = await peer.publisher("/first", "/name")
    await until(lambda: ros2_nodes(hub) == {"/first", "/second"}, hub)
    await first.close()
    await publisher.close()
    await until(lambda: ros2_nodes(hub) == {"/second"}, hub)
    await until(lambda: not sources(hub, "/name"), hub)


async def test_messages_pass_in_both_directions(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    talker = await peer.publisher("/talker", "/chatter")
    _, queue = await peer.subscriber("/listener", "/replies")
    replies = await node.advertise("/replies", String, peers=True)
    async with node.subscribe("/chatter", String) as messages, asyncio.timeout(PATIENCE):
        await flowing(talker)
        await reaching(replies, "/listener")
        for number in range(3):
            await talker.publish(cdr_string(f"hello {number}"))
            assert (await anext(messages)).data == f"hello {number}"
            await replies.publish(data=f"reply {number}")
            async with asyncio.timeout(PATIENCE):
                found = await queue.get()
            assert text_of(found.data) == f"reply {number}"
            assert found.sequence == number + 1
            assert found.stamp > 1_700_000_000_000_000_000


async def flowing(*publishers: Entity) -> None:
    """Wait until the hub has subscribed to ROS 2 publishers."""
    async with asyncio.timeout(PATIENCE):
        for publisher in publishers:
            await publisher.matched.wait()


async def test_messages_are_those_of_the_node_whose_gid_they_have(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    publishers = {name: await peer.publisher(name, "/name") for name in ("/a", "/b", "/c")}
    seen: asyncio.Queue[tuple[str, str]] = asyncio.Queue()

    class Sink:
        node = "/ours"

        def receive(self, publication: Any) -> None:
            seen.put_nowait((publication.node, publication.values()["data"]))

        def replay(self, publication: Any) -> None:
            pass

        def report(self) -> SinkReport:
            return SinkReport()

    topic = hub.graph.topic("/name")
    sink: Any = Sink()
    hub.graph.subscribe(topic, sink, "std_msgs/String")
    await flowing(*publishers.values())
    await until(lambda: sources(hub, "/name") == {*publishers}, hub)
    for name, publisher in publishers.items():
        await publisher.publish(cdr_string(name))
        async with asyncio.timeout(PATIENCE):
            assert await seen.get() == (name, name)
    # Some programs have random gids: they are told apart, and each is one node's.
    random = [os.urandom(16) for _ in range(2)]
    await publishers["/b"].close()
    await publishers["/c"].close()
    others = {name: await peer.publisher(name, "/name") for name in ("/d", "/e")}
    await flowing(*others.values())
    await until(lambda: sources(hub, "/name") == {"/a", *others}, hub)
    found = []
    for gid in (*random, *random):
        await others["/d"].publish(cdr_string("x"), bytes(16) + b"\x10" + gid)
        async with asyncio.timeout(PATIENCE):
            found.append((await seen.get())[0])
    assert found[:2] == found[2:]
    assert set(found) == {"/d", "/e"}
    hub.graph.unsubscribe(topic, sink)


async def test_what_comes_from_ros_2_does_not_go_back(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    talker = await peer.publisher("/talker", "/chatter")
    ours = await node.advertise("/chatter", String, peers=True)
    async with node.subscribe("/chatter", String) as messages, asyncio.timeout(PATIENCE):
        await flowing(talker)
        _, queue = await peer.subscriber("/listener", "/chatter")
        await reaching(ours, "/listener")
        await talker.publish(cdr_string("theirs"))
        assert (await anext(messages)).data == "theirs"
        await ours.publish(data="ours")
        assert (await anext(messages)).data == "ours"
        async with asyncio.timeout(PATIENCE):
            assert [text_of((await queue.get()).data) for _ in range(2)] == ["theirs", "ours"]
        await ours.publish(data="last")
        async with asyncio.timeout(PATIENCE):
            assert text_of((await queue.get()).data) == "last"


async def test_hub_subscribes_at_ros_2_only_while_somebody_needs_the_messages(
    hub: HubServer, peer: Peer, node: fibws.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.hub.ros2.topics.LINGER", 0.05)
    talker = await peer.publisher("/talker", "/chatter")
    await until(lambda: sources(hub, "/chatter"), hub)
    assert not talker.matched.is_set()
    async with asyncio.timeout(PATIENCE):
        async with node.subscribe("/chatter", String):
            await talker.matched.wait()
        await talker.unmatched.wait()


async def test_hub_publishes_at_ros_2_only_while_a_node_there_subscribes(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    peer = await start_peer()
    _, everything = await peer.subscriber("/spy", "/unrelated", key="0/chatter/**")
    publisher = await node.advertise("/chatter", String, peers=True)
    await publisher.publish(data="nobody gets this")
    listener, queue = await peer.subscriber("/listener", "/chatter")
    await reaching(publisher, "/listener")
    await publisher.publish(data="this is sent")
    async with asyncio.timeout(PATIENCE):
        assert text_of((await queue.get()).data) == "this is sent"
        assert text_of((await everything.get()).data) == "this is sent"
    await listener.close()
    await until(lambda: not subscribers(hub, "/chatter"), hub)
    await publisher.publish(data="nobody gets this either")
    await peer.subscriber("/listener", "/chatter")
    await reaching(publisher, "/listener")
    await publisher.publish(data="this again")
    async with asyncio.timeout(PATIENCE):
        assert text_of((await everything.get()).data) == "this again"


async def test_late_ros_2_subscribers_get_latched_messages(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    publisher = await node.advertise("/map", String, latch=True)
    await publisher.publish(data="old")
    await publisher.publish(data="new")
    first, second = await start_peer(), await start_peer()
    _, queue = await first.subscriber("/one", "/map", latched=True)
    async with asyncio.timeout(PATIENCE):
        assert text_of((await queue.get()).data) == "new"
    _, late = await second.subscriber("/two", "/map", latched=True)
    async with asyncio.timeout(PATIENCE):
        assert text_of((await late.get()).data) == "new"
    await publisher.publish(data="newer")
    async with asyncio.timeout(PATIENCE):
        assert text_of((await queue.get()).data) == "newer"
        assert text_of((await late.get()).data) == "newer"


async def test_late_nodes_get_latched_messages_of_ros_2(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    talker = await peer.publisher("/server", "/map", latched=True)
    await talker.publish(cdr_string("old"))
    await talker.publish(cdr_string("the map"))
    await until(lambda: sources(hub, "/map"), hub)
    for _ in range(2):
        message = await node.wait_for_message("/map", String, timeout=PATIENCE)
        assert message.data == "the map"


async def test_late_publisher_with_latched_messages_reaches_waiting_nodes(
    hub: HubServer, start_peer: StartPeer, node: fibws.Node
) -> None:
    async with node.subscribe("/map", String) as messages, asyncio.timeout(PATIENCE):
        peer = await start_peer()
        talker = await peer.publisher("/server", "/map", latched=True)
        await talker.publish(cdr_string("the map"))
        async with asyncio.timeout(PATIENCE):
            assert (await anext(messages)).data == "the map"


async def until_conflicts(hub: HubServer, topic: str, nodes: dict[str, bool]) -> None:
    """Wait for conflicts of nodes, each with whether it publishes."""
    changed = asyncio.Event()
    add = hub.graph.add_conflict

    def note(*arguments: Any) -> None:
        add(*arguments)
        changed.set()

    def found() -> dict[str, bool]:
        conflicts = hub.graph.view("/x").conflicts(hub.graph.topic(topic))
        return {each.node: each.publishes for each in conflicts}

    hub.graph.add_conflict = note  # type: ignore[assignment, method-assign]
    hub.graph.watch_topics(lambda topic: changed.set())
    await until_tokens(changed, lambda: found() == nodes)
    hub.graph.add_conflict = add  # type: ignore[method-assign]


async def test_type_with_other_fields_is_a_conflict_of_the_topic(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    wrong = f"RIHS01_{'0' * 64}"
    await peer.publisher("/talker", "/name", STRING, wrong)
    await peer.subscriber("/listener", "/name", STRING, wrong)

    await until(lambda: ros2_nodes(hub) == {"/talker", "/listener"}, hub)
    async with node.subscribe("/name", String):
        await until_conflicts(hub, "/name", {"/talker": True, "/listener": False})
        assert wrong in hub.graph.view("/x").conflicts(hub.graph.topics["/name"])[0].fault
        assert not sources(hub, "/name")
        await until(lambda: subscribers(hub, "/name") == {"/ours"}, hub)


async def test_node_of_another_type_is_a_conflict_until_the_topic_is_free(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    publisher = await node.advertise("/name", Int32)
    talker = await peer.publisher("/talker", "/name")
    await until_conflicts(hub, "/name", {"/talker": True})
    assert sources(hub, "/name") == {"/ours"}
    async with fibws.Node("page", hub=hub.url) as page, asyncio.timeout(PATIENCE):
        messages = page.subscribe("/name", String)
        await flowing(talker)
        await talker.publish(cdr_string("hello"))
        assert (await anext(messages)).data == "hello"
    publisher.close()
    await until(lambda: sources(hub, "/name") == {"/talker"}, hub)
    assert not hub.graph.view("/x").conflicts(hub.graph.topics["/name"])


async def test_ros_2_subscriber_gets_messages_of_its_type_of_a_topic_with_two(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    wrong = await node.advertise("/name", Int32)
    _, queue = await peer.subscriber("/listener", "/name")
    await until_conflicts(hub, "/name", {"/listener": False})
    async with fibws.Node("page", hub=hub.url) as page:
        publisher = await page.advertise("/name", String, peers=True)
        await reaching(publisher, "/listener")
        await wrong.publish(7)
        await publisher.publish(data="hello")
        async with asyncio.timeout(PATIENCE):
            assert text_of((await queue.get()).data) == "hello"
    assert queue.empty()


async def test_topic_of_an_unknown_type_is_shown(hub: HubServer, peer: Peer) -> None:
    await peer.publisher("/talker", "/events", "unknown_msgs::msg::dds_::Event_", STRING_HASH)
    await until(lambda: sources(hub, "/events"), hub)
    type_ = hub.graph.topics["/events"].type
    assert type_ is not None
    assert type_.name == "unknown_msgs/Event"


async def test_nodes_of_humble_have_no_hashes(hub: HubServer, peer: Peer, node: fibws.Node) -> None:
    none = "TypeHashNotSupported"
    talker = await peer.publisher("/talker", "/chatter", STRING, none)
    _, queue = await peer.subscriber("/listener", "/replies", STRING, none)
    replies = await node.advertise("/replies", String, peers=True)
    async with node.subscribe("/chatter", String) as messages, asyncio.timeout(PATIENCE):
        await flowing(talker)
        await talker.publish(cdr_string("hello"))
        assert (await anext(messages)).data == "hello"
        await reaching(replies, "/listener")
        await replies.publish(data="reply")
        async with asyncio.timeout(PATIENCE):
            assert text_of((await queue.get()).data) == "reply"


async def test_images_pass_unchanged(hub: HubServer, peer: Peer, node: fibws.Node) -> None:
    from rosbags.typesys import Stores, get_typestore

    type_ = "sensor_msgs::msg::dds_::Image_"
    store: Any = get_typestore(Stores.ROS2_JAZZY)
    type_hash = store.hash_rihs01("sensor_msgs/msg/Image")
    camera = await peer.publisher("/camera", "/image", type_, type_hash)
    _, queue = await peer.subscriber("/viewer", "/copy", type_, type_hash)
    copy = await node.advertise("/copy", Image, peers=True)
    image = Image(
        header=Header(frame_id="camera"),
        height=480,
        width=640,
        encoding="rgb8",
        step=1920,
        data=os.urandom(480 * 1920),
    )
    async with node.subscribe("/image", Image) as images:
        await flowing(camera)
        await reaching(copy, "/viewer")
        await copy.publish(image)
        async with asyncio.timeout(PATIENCE):
            received = (await queue.get()).data
        decoded = store.deserialize_cdr(received, "sensor_msgs/msg/Image")
        assert bytes(decoded.data) == image.data
        await camera.publish(received)
        found = await anext(images)
        assert (found.data, found.encoding, found.header.frame_id) == (image.data, "rgb8", "camera")


async def test_ros_2_sees_the_nodes_of_the_hub(hub: HubServer, peer: Peer) -> None:
    tokens, changed = await tokens_of(peer, hub)
    chatter = f"%chatter/{STRING}/{STRING_HASH}"
    async with fibws.Node("ours", namespace="/robot", hub=hub.url) as node:
        await node.advertise("/chatter", String, latch=True)
        async with node.subscribe("/chatter", String):
            owner = "%/%robot/ours"
            await until_tokens(changed, lambda: f"NN/{owner}" in tokens)
            await until_tokens(
                changed, lambda: any(t.startswith(f"MP/{owner}/{chatter}/:1:") for t in tokens)
            )
            await until_tokens(
                changed, lambda: any(t.startswith(f"MS/{owner}/{chatter}/::") for t in tokens)
            )
    await until_tokens(changed, lambda: not tokens)


async def test_ros_2_sees_a_subscription_of_the_hub_alone_while_it_lasts(
    start_ros2_hub: StartRos2Hub, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from rosbags.typesys import Stores, get_typestore

    monkeypatch.setattr("fibws.hub.ros2.topics.LINGER", 0.05)
    type_ = "sensor_msgs::msg::dds_::Image_"
    type_hash = get_typestore(Stores.ROS2_JAZZY).hash_rihs01("sensor_msgs/msg/Image")
    hub, endpoint = await start_ros2_hub(record=tmp_path, record_min_space=0)
    async with Peer(endpoint) as peer, fibws.Node("ours", hub=hub.url) as node:
        tokens, changed = await tokens_of(peer, hub)

        def seen() -> list[str]:
            """Return the nodes that subscribe to the images."""
            key = f"/%image/{type_}/{type_hash}/"
            return [t.split("/")[3] for t in tokens if t.startswith("MS/") and key in t]

        camera = await peer.publisher("/camera", "/image", type_, type_hash)
        await flowing(camera)  # For `--record`.
        await until_tokens(changed, lambda: seen() == ["fibws_hub"])
        assert "NN/%/%/fibws_hub" in tokens
        async with node.subscribe("/image", Image):
            await until_tokens(changed, lambda: seen() == ["ours"])
        await until_tokens(changed, lambda: seen() == ["fibws_hub"])
        await camera.close()
        await until_tokens(changed, lambda: not seen())


@pytest.mark.parametrize("domain", [0, 7])
async def test_nodes_of_other_domains_are_not_seen(
    start_ros2_hub: StartRos2Hub, domain: int
) -> None:
    hub, endpoint = await start_ros2_hub(ros2_domain=domain)
    async with Peer(endpoint, domain=1) as other, Peer(endpoint, domain=domain) as peer:
        await other.declare("NN", "/other")
        await peer.declare("NN", "/same")
        await until(lambda: ros2_nodes(hub), hub)
        assert ros2_nodes(hub) == {"/same"}


async def test_name_of_a_node_of_the_hub_is_not_taken_away(hub: HubServer, peer: Peer) -> None:
    async with fibws.Node("twin", hub=hub.url):
        await peer.publisher("/twin", "/a")
        await peer.publisher("/other", "/a")
        await until(lambda: sources(hub, "/a"), hub)
        assert sources(hub, "/a") == {"/other"}
    await until(lambda: sources(hub, "/a") == {"/other", "/twin"}, hub)
    async with fibws.Node("twin", hub=hub.url):
        await until(lambda: sources(hub, "/a") == {"/other"}, hub)
    await until(lambda: sources(hub, "/a") == {"/other", "/twin"}, hub)


async def test_hub_connects_to_a_router(start_hub: StartHub, hub: HubServer, endpoint: str) -> None:
    other = await start_hub(ros2_connect=(endpoint,))
    async with fibws.Node("here", hub=hub.url) as here, fibws.Node("there", hub=other.url) as there:
        publisher = await here.advertise("/chatter", String, latch=True)
        await publisher.publish(data="hello")
        message = await there.wait_for_message("/chatter", String, timeout=PATIENCE)
        assert message.data == "hello"
    await until(lambda: not ros2_nodes(other), other)


async def test_types_with_other_names_and_the_same_fields_pass(
    hub: HubServer, peer: Peer, node: fibws.Node
) -> None:
    from rosbags.typesys import Stores, get_typestore

    type_ = "tf2_msgs::msg::dds_::TFMessage_"
    type_hash = get_typestore(Stores.ROS2_JAZZY).hash_rihs01("tf2_msgs/msg/TFMessage")
    tokens, changed = await tokens_of(peer, hub)
    publisher = await node.advertise("/tf", "tf/tfMessage", peers=True)
    await until_tokens(changed, lambda: any(f"%tf/{type_}" in token for token in tokens))
    talker = await peer.publisher("/talker", "/tf", type_, type_hash)
    empty = b"\x00\x01\x00\x00" + bytes(4)
    async with node.subscribe("/tf", "tf/tfMessage") as messages, asyncio.timeout(PATIENCE):
        await flowing(talker)
        await until(lambda: "/talker" in sources(hub, "/tf"), hub)
        await talker.publish(empty)
        assert (await anext(messages)).transforms == []
        _, queue = await peer.subscriber("/listener", "/tf", type_, type_hash)
        await reaching(publisher, "/listener")
        await publisher.publish(transforms=[])
        assert (await queue.get()).data == empty
        assert (await anext(messages)).transforms == []
    assert not hub.graph.view("/x").conflicts(hub.graph.topics["/tf"])


async def test_node_whose_name_ros_2_does_not_allow_is_shown_with_another_one(
    hub: HubServer, peer: Peer
) -> None:
    tokens, changed = await tokens_of(peer, hub)

    class Odd:
        def replaced(self) -> None:
            pass

        def publishing(self) -> tuple[str, ...]:
            return ()

        subscribing = providing = publishing

    odd = Odd()
    hub.graph.enter(odd, "/1-a/b c")
    await until_tokens(changed, lambda: "NN/%/%_1_a/b_c" in tokens)
    hub.graph.leave(odd, "/1-a/b c")
    await until_tokens(changed, lambda: not tokens)
