"""Recording within the hub: which topics, their publishers, the services, the rights."""

from __future__ import annotations

import asyncio
import re
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from patience import PATIENCE

import fibws
from fibws.bags import open_reader
from fibws.bags.bag_writer import BagWriter
from fibws.errors import ServiceError, SettingError
from fibws.hub import Settings
from fibws.hub.recording import NODE, STATE
from fibws.hub.server import RECORDING_TIMEOUT, HubServer
from fibws.msg.fibws_msgs import PlaybackState, RecordingState
from fibws.msg.geometry_msgs import PointStamped
from fibws.msg.rosgraph_msgs import Clock, Log
from fibws.msg.std_msgs import Int32, String
from fibws.names import HUB_TOPICS
from fibws.srv.fibws_msgs import GetRecording
from fibws.srv.std_srvs import Trigger

from .token_clients import entry


def settings(folder: Path, **others: Any) -> Settings:
    return Settings(port=0, close_timeout=0.1, record=folder, record_min_space=0, **others)


def files(folder: Path) -> list[Path]:
    return sorted(folder.iterdir())


def recorded(folder: Path) -> list[tuple[str, str, str, bool]]:
    """Return the connections of all bags in a folder, without the hub's log."""
    found = []
    for path in files(folder):
        with open_reader(path) as bag:
            found += [
                (each.topic, each.type, each.callerid, each.latching)
                for each in bag.connections
                if each.topic != "/rosout"
            ]
    return found


async def state_when(
    node: fibws.Node, is_reached: Callable[[RecordingState], bool]
) -> RecordingState:
    """Wait for a state of the recording, and return it."""
    async with asyncio.timeout(PATIENCE):
        async for state in node.subscribe(STATE, RecordingState, queue_size=None):
            if is_reached(state):
                return state
    raise AssertionError


async def test_all_topics_are_recorded_from_their_first_message(tmp_path: Path) -> None:
    async with HubServer(settings(tmp_path)) as hub, fibws.Node("talker", hub=hub.url) as node:
        for number in range(3):
            numbers = await node.advertise(f"/numbers{number}", Int32)
            await numbers.publish(number)
        latched = await node.advertise("/map", String, latch=True)
        await latched.publish("here")
        points = await node.advertise("/points", PointStamped)
        await points.publish()
        state = await node.advertise("/player/playback", PlaybackState)
        await state.publish()
    assert recorded(tmp_path) == [
        *((f"/numbers{number}", "std_msgs/Int32", "/talker", False) for number in range(3)),
        ("/map", "std_msgs/String", "/talker", True),
        ("/points", "geometry_msgs/PointStamped", "/talker", False),
    ]
    [path] = files(tmp_path)
    with open_reader(path) as bag:
        assert [data for _, _, data in bag.messages(["/map"])] == [b"\x04\0\0\0here"]
        assert bag.connections[-1].definition.startswith("Header header")


async def test_log_is_recorded_with_its_own_definition(tmp_path: Path) -> None:
    header = tmp_path / "share" / "std_msgs" / "msg" / "Header.msg"
    header.parent.mkdir(parents=True)
    header.write_text("builtin_interfaces/Time stamp\nstring frame_id\n")
    bags = tmp_path / "bags"
    async with (
        HubServer(settings(bags, interfaces=[tmp_path / "share"])) as hub,
        fibws.Node("talker", hub=hub.url) as node,
    ):
        lines = node.subscribe("/rosout", Log)
        node.log.error("too fast")
        async with asyncio.timeout(PATIENCE):
            while (await anext(lines)).msg != "too fast":
                pass
    [path] = files(bags)
    with open_reader(path) as bag:
        texts = [each.definition for each in bag.connections if each.topic == "/rosout"]
        assert texts
        assert all("uint32 seq" in text for text in texts)
        found = [data for _, _, data in bag.messages(["/rosout"])]
        assert any(b"too fast" in data for data in found)


async def test_nothing_is_recorded_before_simulated_time_begins(tmp_path: Path) -> None:
    async with HubServer(settings(tmp_path)) as hub, fibws.Node("talker", hub=hub.url) as node:
        await node.params.set("/use_sim_time", True)
        latched = await node.advertise("/map", Int32, latch=True)
        numbers = await node.advertise("/numbers", Int32)
        clock = await node.advertise("/clock", Clock)
        for number in range(2):
            await latched.publish(number)
            await numbers.publish(number)
            await clock.publish(Clock(fibws.Time(7 + number)))
    [path] = files(tmp_path)
    with open_reader(path) as bag:
        found = [
            (each.topic, time // 10**9, data[0])
            for each, time, data in bag.messages(["/map", "/numbers", "/clock"])
        ]
    # A message has the time of the clock's message before it, and that one its own.
    assert found == [
        *(("/map", 7, 0), ("/clock", 7, 7), ("/map", 7, 1), ("/numbers", 7, 1), ("/clock", 8, 8)),
    ]


async def test_names_of_the_hubs_own_topics_are_known_to_recorders(tmp_path: Path) -> None:
    async with HubServer(settings(tmp_path)) as hub:
        assert hub.graph.reserved == HUB_TOPICS


async def test_topic_is_left_with_its_last_publisher(tmp_path: Path) -> None:
    async with HubServer(settings(tmp_path)) as hub, fibws.Node("talker", hub=hub.url) as node:
        numbers = await node.advertise("/numbers", Int32)
        assert hub.graph.topics["/numbers"].subscribers() == {NODE}
        numbers.close()
        await node.graph.nodes()
        assert "/numbers" not in hub.graph.topics
        again = await node.advertise("/numbers", Int32)
        await again.publish(1)
        await node.graph.nodes()
    assert [topic for topic, *_ in recorded(tmp_path)] == ["/numbers"]


async def test_both_types_of_a_topic_are_recorded(tmp_path: Path) -> None:
    async with (
        HubServer(settings(tmp_path)) as hub,
        fibws.Node("talker", hub=hub.url) as node,
        fibws.Node("other", hub=hub.url) as other,
    ):
        await (await node.advertise("/numbers", Int32)).publish(1)
        await (await other.advertise("/numbers", String)).publish("two")
        await node.graph.nodes()
        await other.graph.nodes()
    assert [topic for topic, *_ in recorded(tmp_path)] == ["/numbers", "/numbers"]


async def test_services_start_and_stop_the_recording(tmp_path: Path) -> None:
    async with (
        HubServer(settings(tmp_path, record_at_start=False)) as hub,
        fibws.Node("talker", hub=hub.url) as node,
    ):
        latched = await node.advertise("/map", String, latch=True)
        await latched.publish("here")
        assert not (await node.call(f"{NODE}/status", GetRecording)).state.recording
        assert not (await node.call(f"{NODE}/stop", Trigger)).success
        assert (await node.call(f"{NODE}/start", Trigger)).success
        assert not (await node.call(f"{NODE}/start", Trigger)).success
        await state_when(node, lambda state: state.recording and state.messages > 0)
        stopped = await node.call(f"{NODE}/stop", Trigger)
        assert stopped.success
        assert str(tmp_path) in stopped.message
        state = (await node.call(f"{NODE}/status", GetRecording)).state
        assert not state.recording
        assert [str(each) for each in files(tmp_path)] == [state.file]
        await latched.publish("not recorded")
        await node.graph.nodes()
    [path] = files(tmp_path)
    with open_reader(path) as bag:
        [(connection, time, data)] = bag.messages(["/map"])
    assert (connection.callerid, connection.latching) == ("/talker", True)
    assert data == b"\x04\0\0\0here"
    assert time >= state.since.to_nanoseconds()


async def test_recording_does_not_start_on_a_full_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    usage = type("Usage", (), {"free": 4096})()
    monkeypatch.setattr("fibws.bag_recorder.shutil.disk_usage", lambda folder: usage)
    async with (
        HubServer(settings(tmp_path, record_at_start=False)) as hub,
        fibws.Node("talker", hub=hub.url) as node,
    ):
        started = await node.call(f"{NODE}/start", Trigger)
        assert not started.success
        assert started.message.startswith("No space left on device: ")
        assert not (await node.call(f"{NODE}/status", GetRecording)).state.recording
    assert files(tmp_path) == []


async def test_failure_is_reported_and_the_hub_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Such as that of a disk that vanishes just after the start."""
    monkeypatch.setattr("fibws.hub.server.check_writable", lambda folder: None)
    (tmp_path / "file").write_text("")
    async with (
        HubServer(settings(tmp_path / "file")) as hub,
        fibws.Node("talker", hub=hub.url) as node,
    ):
        state = await state_when(node, lambda state: bool(state.fault) and not state.recording)
        assert "file" in state.fault
        assert hub.recording is not None and hub.recording.fault == state.fault
        assert hub.health()["warnings"] == [f"nothing is recorded: {state.fault}"]
        assert state.fault in hub._status()
        assert not hub._probes.is_draining
        numbers = await node.advertise("/numbers", Int32, latch=True)
        await numbers.publish(1)
        assert (await node.wait_for_message("/numbers", Int32, timeout=PATIENCE)).data == 1


async def test_types_without_known_fields_are_reported_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    async with HubServer(settings(tmp_path)) as hub:
        topic = hub.graph.topic("/odd")
        source = hub.graph.advertise(topic, "/page", "unknown_msgs/Odd")
        for _ in range(3):
            source.publish({"a": 1})
        assert caplog.text.count("/odd is not recorded") == 1
        hub.graph.remove_source(source)


async def test_publishers_that_have_left_take_no_memory(tmp_path: Path) -> None:
    async with HubServer(settings(tmp_path)) as hub:
        graph = hub.graph
        stays = graph.advertise(graph.topic("/numbers"), "/stays", "std_msgs/Int32", latch=True)
        stays.publish({"data": -1})
        for number in range(500):
            for name in ("/numbers", f"/numbers{number}"):
                topic = graph.topic(name)
                source = graph.advertise(topic, f"/node{number}", "std_msgs/Int32", latch=True)
                source.publish({"data": number})
                graph.remove_source(source)
        assert hub.recording is not None
        recorder = hub.recording._recorder
        assert recorder is not None
        for number in range(500):
            stays.set_headers({"callerid": f"/other{number}"})
            stays.publish({"data": number})
        assert len(recorder._streams) < 150
        graph.remove_source(stays)
    [path] = files(tmp_path)
    with open_reader(path) as bag:
        assert bag.message_count >= 1501


async def test_end_of_the_hub_waits_for_a_disk_that_is_slow(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whenever the hub has waited for long enough, one more message is on the disk."""
    write, wait_for, may_write = BagWriter.write, asyncio.wait_for, threading.Semaphore(0)
    rounds = 0

    def write_slowly(writer: BagWriter, *arguments: Any) -> None:
        may_write.acquire()
        write(writer, *arguments)

    def on_disk() -> int:
        assert hub.recording is not None
        return hub.recording.totals().messages

    async def wait_for_one_message(awaitable: Any, timeout: float | None) -> Any:
        nonlocal rounds
        if timeout != RECORDING_TIMEOUT:
            return await wait_for(awaitable, timeout)
        before = on_disk()
        complete = asyncio.ensure_future(awaitable)
        may_write.release()
        rounds += 1
        while not complete.done() and on_disk() == before:  # noqa: ASYNC110 - it has no event.
            await asyncio.sleep(0)
        if complete.done():
            return complete.result()
        complete.cancel()
        raise TimeoutError

    monkeypatch.setattr(BagWriter, "write", write_slowly)
    async with asyncio.timeout(PATIENCE), HubServer(settings(tmp_path)) as hub:
        source = hub.graph.advertise(hub.graph.topic("/numbers"), "/talker", "std_msgs/Int32")
        for number in range(20):
            source.publish({"data": number})
        hub.graph.remove_source(source)
        monkeypatch.setattr("fibws.hub.server.asyncio.wait_for", wait_for_one_message)
    assert rounds >= 20
    [path] = files(tmp_path)
    with open_reader(path) as bag:
        assert len(list(bag.messages(["/numbers"]))) == 20


async def test_files_are_split_and_kept_as_the_settings_say(tmp_path: Path) -> None:
    async with (
        HubServer(settings(tmp_path, record_size=1, record_files=2, record_mcap=True)) as hub,
        fibws.Node("talker", hub=hub.url) as node,
    ):
        texts = await node.advertise("/texts", String)
        for _ in range(24):
            await texts.publish("x" * 200_000)
        await state_when(node, lambda state: state.messages >= 24)
        stopped = await node.call("/hub_recorder/stop", Trigger)
        assert re.match(r"recorded \d+ messages in [3-9] files, the last one ", stopped.message)
    paths = files(tmp_path)
    assert len(paths) == 2
    assert {each.suffix for each in paths} == {".mcap"}


@pytest.mark.parametrize(
    ("module", "others"),
    [
        ("mcap", {"record_mcap": True}),
        ("lz4.frame", {"record_compression": "lz4"}),
    ],
)
async def test_hub_does_not_start_if_a_package_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str, others: dict[str, Any]
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(SettingError, match=r"record.*pip install"):
        async with HubServer(settings(tmp_path, **others)):
            pass
    assert files(tmp_path) == []


@pytest.mark.parametrize(
    ("compression", "is_mcap"), [("bz2", True), ("zstd", False), ("lz5", False)]
)
def test_compression_must_be_one_of_the_format(compression: Any, is_mcap: bool) -> None:
    with pytest.raises(SettingError, match=rf"record.compression.* must be .*got {compression}"):
        Settings(record_mcap=is_mcap, record_compression=compression)


async def test_mcap_files_are_compressed_by_zstd(tmp_path: Path) -> None:
    async with (
        HubServer(settings(tmp_path, record_mcap=True, record_compression="zstd")) as hub,
        fibws.Node("talker", hub=hub.url) as node,
    ):
        await (await node.advertise("/numbers", Int32)).publish(1)
    with open_reader(files(tmp_path)[0]) as bag:
        assert bag.compression == "zstd"


async def test_only_admins_start_and_stop(tmp_path: Path) -> None:
    tokens = tmp_path / "tokens.toml"
    tokens.write_text(entry("boss", "admin = true") + entry("ann", 'allow.call = ["/**"]'))
    folder = tmp_path / "bags"
    async with (
        HubServer(settings(folder, tokens=tokens, record_at_start=False)) as hub,
        fibws.Node("ann", hub=hub.url, token="ann", rosout=False) as ann,
        fibws.Node("boss", hub=hub.url, token="boss") as boss,
    ):
        for verb in ("start", "stop"):
            with pytest.raises(ServiceError, match="admin"):
                await ann.call(f"{NODE}/{verb}", Trigger)
        assert not (await ann.call(f"{NODE}/status", GetRecording)).state.recording
        assert (await boss.call(f"{NODE}/start", Trigger)).success
        assert (await boss.call(f"{NODE}/stop", Trigger)).success


async def test_nobody_takes_the_recorders_name(tmp_path: Path) -> None:
    async with HubServer(settings(tmp_path)) as hub:
        with pytest.raises(fibws.FibwsError, match="hub's own"):
            async with fibws.Node(NODE[1:], hub=hub.url):
                pass
