"""ROS 1 nodes in the graph: their names, their ends, and a hub that is restarted."""

from __future__ import annotations

import asyncio
import errno
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import StartHub

import fibws
from fibws.errors import HubError, NodeReplaced
from fibws.files import replace_file
from fibws.hub import kept_file
from fibws.hub.foreign import worklist
from fibws.hub.ros1 import nodes as module
from fibws.hub.ros1 import state
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32

from .conftest import StartPeer
from .peer import Peer


async def until(condition: Callable[[], object]) -> None:
    """Let others run until a condition holds."""
    async with asyncio.timeout(60):
        while not condition():  # noqa: ASYNC110, nothing reports it
            await asyncio.sleep(0.001)


def known(hub: HubServer) -> dict[str, module.Ros1Node]:
    assert hub.ros1 is not None
    return hub.ros1.nodes.by_name


# Names.


async def test_newer_node_of_a_name_ends_the_older_one(
    hub: HubServer, start_peer: StartPeer
) -> None:
    older, newer = await start_peer("/talker"), await start_peer("/talker")
    await older.advertise("/old")
    await newer.advertise("/new")
    [reason] = await older.called("shutdown")
    assert "new node registered with same name" in reason
    assert known(hub)["/talker"].api == newer.api
    assert "/old" not in hub.graph.topics


async def test_process_that_has_taken_an_address_is_not_ended(
    hub: HubServer, start_peer: StartPeer
) -> None:
    older = await start_peer("/talker", pid=1)
    await older.advertise("/old")
    await until(lambda: known(hub)["/talker"].pid == 1)
    older.pid = 2  # Another program has its port now.
    newer = await start_peer("/talker")
    await newer.advertise("/new")
    other = await start_peer("/other")
    await other.advertise("/more")
    await until(lambda: known(hub)["/other"].pid)
    assert older.calls_of("shutdown") == 0


async def test_ros1_node_takes_the_name_of_a_client(hub: HubServer, start_peer: StartPeer) -> None:
    async with fibws.Node("talker", hub=hub.url) as client:
        talker = await start_peer("/talker")
        await talker.advertise("/count")
        with pytest.raises(NodeReplaced):
            await client.spin()
    assert known(hub)["/talker"].api == talker.api


async def test_client_takes_the_name_of_a_ros1_node(hub: HubServer, start_peer: StartPeer) -> None:
    talker = await start_peer("/talker")
    await talker.advertise("/count")
    async with fibws.Node("talker", hub=hub.url) as client:
        await talker.called("shutdown")
        assert known(hub) == {}
        code, _, uri = await talker.ask("lookupNode", "/talker")
        assert (code, uri.endswith("/node/talker")) == (1, True)
        await talker.call("shutdown", "enough", uri=uri)
        with pytest.raises(fibws.NodeError):
            await client.spin()


async def test_names_of_the_hub_are_not_taken(hub: HubServer, start_peer: StartPeer) -> None:
    peer = await start_peer("/rosapi")
    await peer.advertise("/count")
    assert known(hub) == {}
    assert "/rosapi/get_time" in hub.graph.services


# Registrations.


async def test_what_a_node_has_left_is_removed_in_slices(
    hub: HubServer, start_peer: StartPeer, monkeypatch: pytest.MonkeyPatch
) -> None:
    peer, reader = await start_peer("/peer"), await start_peer("/reader")
    topics = [f"/topic_{each}" for each in range(5)]
    for topic in topics:
        await peer.advertise(topic)
        await peer.subscribe(topic)
        await reader.subscribe(topic)
    assert hub.ros1 is not None
    nodes = hub.ros1.nodes
    monkeypatch.setattr(worklist, "TURN", -1.0)  # Each slice is over after one step.
    nodes.remove(known(hub)["/peer"])
    assert "/peer" not in hub.graph.nodes
    assert [topic for topic in topics if hub.graph.topics[topic].sources] == topics[1:]
    # They are no others' sources meanwhile, and a node of the same name may use another type.
    assert not any(nodes.topics.has_own_sources(topic) for topic in topics)
    nodes.topics.remove_subscriber(nodes.topics.subscribers(topics[-1])[-1])
    nodes.add_publisher("/peer", topics[-1], "std_msgs/String", peer.api, "localhost")
    await until(lambda: not nodes._left)
    assert [topic for topic in topics if hub.graph.topics[topic].sources] == topics[-1:]
    assert [*hub.graph.topics[topics[-1]].subscribers()] == []
    type_ = hub.graph.topics[topics[-1]].type
    assert type_ is not None
    assert type_.name == "std_msgs/String"
    assert [each.node.name for each in nodes.topics.publishers(topics[-1])] == ["/peer"]


async def test_node_leaves_with_its_last_registration(
    hub: HubServer, start_peer: StartPeer
) -> None:
    peer = await start_peer("/peer")
    await peer.advertise("/a")
    await peer.subscribe("/b")
    assert "/peer" in hub.graph.nodes
    await peer.call("unregisterPublisher", "/a", peer.api)
    await peer.call("unregisterSubscriber", "/b", peer.api)
    assert "/peer" not in hub.graph.nodes
    assert not {"/a", "/b"} & hub.graph.topics.keys()


async def test_only_the_newest_publishers_are_told_after_a_failure(
    start_peer: StartPeer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.hub.ros1.http.FIRST_RETRY", 0.01)
    listener = await start_peer("/listener")
    await listener.subscribe("/count")
    port = listener.port
    listener.die()
    talkers = [await start_peer(f"/talker_{number}") for number in range(3)]
    for talker in talkers:
        await talker.advertise("/count")
    await listener.listen(port)
    _, apis = await listener.called("publisherUpdate")
    assert sorted(apis) == sorted(talker.api for talker in talkers)


@pytest.fixture
def quick_checks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Check nodes all the time; a hub that starts later does so."""
    monkeypatch.setattr(module, "CHECKS_AT_ONCE", 1000)
    monkeypatch.setattr(module, "CHECK_INTERVAL", 0.01)


async def test_unreachable_node_keeps_its_registrations(
    quick_checks: None, hub: HubServer, start_peer: StartPeer
) -> None:
    peer = await start_peer("/peer", pid=os.getpid())
    await peer.advertise("/a")
    await until(lambda: known(hub)["/peer"].pid)
    port = peer.port
    peer.die()
    await until(lambda: known(hub)["/peer"].fault)
    assert "/peer" in hub.graph.topics["/a"].sources
    await peer.listen(port)
    await until(lambda: not known(hub)["/peer"].fault)


async def test_node_whose_process_has_ended_is_removed(
    quick_checks: None, hub: HubServer, start_peer: StartPeer
) -> None:
    ended = await asyncio.create_subprocess_exec("true")
    await ended.wait()
    peer = await start_peer("/peer", pid=ended.pid)
    await peer.advertise("/a")
    await until(lambda: known(hub)["/peer"].pid)
    peer.die()
    await until(lambda: not known(hub))
    assert "/a" not in hub.graph.topics


async def test_invalid_process_ids_do_not_end_the_checks(
    quick_checks: None, hub: HubServer, start_peer: StartPeer
) -> None:
    odd = await start_peer("/odd")
    odd.answers["getPid"] = [1, "", "text"]
    other = await start_peer("/other")
    await odd.advertise("/a")
    await other.advertise("/b")
    assert hub.ros1 is not None
    for pid in (10**25, -1, 0):  # Python's own XML-RPC cannot send the first one.
        hub.ros1.nodes._set_pid(known(hub)["/odd"], pid)
    odd.die()
    await until(lambda: known(hub)["/odd"].fault)
    other.die()
    await until(lambda: known(hub)["/other"].fault)
    assert known(hub)["/odd"].pid is None


async def test_changes_of_parameters_are_forgotten_with_their_node(
    hub: HubServer, start_peer: StartPeer
) -> None:
    peer, other = await start_peer("/peer"), await start_peer("/other")
    await peer.advertise("/a")
    await peer.call("subscribeParam", peer.api, "/x")
    await peer.call("unregisterPublisher", "/a", peer.api)
    await other.call("subscribeParam", other.api, "/x")
    other.die()
    third = await start_peer("/third")
    await third.call("subscribeParam", third.api, "/x")
    for value in (1, 2):
        await start_peer("/setter")
        hub.graph.parameters.set("/x", value)
        assert await third.called("paramUpdate") == ["/x/", value]
    assert hub.ros1 is not None
    subscribers = hub.ros1._master._parameter_subscribers
    await until(lambda: subscribers["/x/"] == {"/third": third.api})
    assert peer.calls_of("paramUpdate") == 0


# A restart.


async def test_nodes_are_back_after_a_restart(
    start_hub: StartHub, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(state, "DELAY", 0.0)
    path = tmp_path / "folder" / "state.json"
    first = await start_hub(ros1=0, ros1_state=path)
    assert first.ros1 is not None
    async with Peer("/talker", first.ros1.uri) as talker, Peer("/gone", first.ros1.uri) as gone:
        await talker.advertise("/count")
        await talker.call("registerService", "/add", "rosrpc://127.0.0.1:1", talker.api)
        await gone.advertise("/never")
        await until(lambda: path.exists() and path.read_text().count("/gone") == 1)
        await until(lambda: path.read_text().count(f'"pid": {talker.pid}') == 2)
        await first.close()
        gone.die()
        del talker.publishes["/count"]
        talker.publishes["/since"] = {"type": "std_msgs/Int32"}
        second = await start_hub(ros1=0, ros1_state=path)
        await until(lambda: "/since" in second.graph.topics)
        await until(lambda: "/count" not in second.graph.topics)
        assert known(second)["/talker"].served == {"/add": "rosrpc://127.0.0.1:1"}
        assert "/gone" in second.graph.topics["/never"].sources
        await until(lambda: known(second)["/gone"].fault)


async def test_state_file_belongs_to_one_hub(start_hub: StartHub, tmp_path: Path) -> None:
    path = tmp_path / "state.json"
    first = await start_hub(ros1=0, ros1_state=path)
    with pytest.raises(HubError, match=r"ros1_state=.*: another hub uses .*state\.json"):
        await start_hub(ros1=0, ros1_state=path)
    await start_hub(ros1=0, ros1_state=tmp_path / "other.json")
    await first.close()
    await start_hub(ros1=0, ros1_state=path)


async def test_another_program_at_the_address_is_not_taken_for_the_node(
    start_hub: StartHub, tmp_path: Path
) -> None:
    path = tmp_path / "state.json"
    async with Peer("/other", "", pid=2) as other:
        node = {
            "name": "/talker",
            "api": other.api,
            "hub_host": "127.0.0.1",
            "pid": 1,
            "publishers": {"/count": "std_msgs/Int32"},
            "subscribers": {},
            "services": {},
        }
        path.write_text(json.dumps({"version": state.VERSION, "nodes": [node]}))
        hub = await start_hub(ros1=0, ros1_state=path)
        await until(lambda: not known(hub))
        assert "/count" not in hub.graph.topics


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        '{"x": ' * 200_000,
        '{"version": 99, "nodes": []}',
        '{"version": 1, "nodes": [{}]}',
        "\0",
    ],
)
async def test_damaged_state_file_is_ignored(
    start_hub: StartHub, tmp_path: Path, caplog: pytest.LogCaptureFixture, text: str
) -> None:
    path = tmp_path / "state.json"
    path.write_text(text)
    hub = await start_hub(ros1=0, ros1_state=path)
    assert known(hub) == {}
    assert str(path) in caplog.text


async def test_state_file_is_written_once_its_folder_is_writable(
    start_hub: StartHub,
    tmp_path: Path,
    caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(state, "DELAY", 0.0)
    monkeypatch.setattr(kept_file, "RETRY", 0.001)
    attempts = 0

    def counted(path: Path, text: bytes, **options: bool) -> None:
        nonlocal attempts
        attempts += 1
        if attempts < 4:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        replace_file(path, text, **options)

    monkeypatch.setattr(kept_file, "replace_file", counted)
    path = tmp_path / "state.json"
    hub = await start_hub(ros1=0, ros1_state=path)
    assert hub.ros1 is not None
    async with Peer("/talker", hub.ros1.uri) as talker:
        await talker.advertise("/count")
        await until(lambda: path.exists() and "/talker" in path.read_text())
    assert caplog.text.count(os.strerror(errno.ENOSPC)) == 1


async def test_state_file_that_cannot_be_written_is_reported(
    start_hub: StartHub,
    tmp_path: Path,
    caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(state, "DELAY", 0.0)
    path = tmp_path / "folder" / "state.json"
    hub = await start_hub(ros1=0, ros1_state=path)
    shutil.rmtree(path.parent)
    path.parent.touch()
    assert hub.ros1 is not None
    async with Peer("/talker", hub.ros1.uri) as talker, fibws.Node("node", hub=hub.url) as node:
        await talker.advertise("/count")
        await until(lambda: str(path) in caplog.text)
        messages = node.subscribe("/count", Int32)
        (await talker.linked()).send(bytes(4))
        assert (await anext(messages)).data == 0
