"""``fibws bag record`` and ``fibws bag play`` with a hub and nodes."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click
import pytest
from bags import ros2_recordings
from bags.ros2_recordings import rows_by_rosbags
from hub_in_thread import HubThread, Publish, Run
from mcap.reader import make_reader
from node_in_thread import peer
from patience import PATIENCE
from rosbags.rosbag1 import Reader as Rosbag1Reader

import fibws
from fibws.bags import open_reader, open_writer
from fibws.cli.bag import command as bag_commands
from fibws.client.hub_client import HubClient
from fibws.errors import BagError
from fibws.msg.std_msgs import Int32

from ..terminal import ROOT, Terminal
from .conftest import SECOND, START, Entry, entries, entry, int32, write

QUICK = ("-d", "0", "-i", "--wait-for-subscribers")
IMAGE = "sensor_msgs/Image"


class Recorder:
    """A ``fibws bag record`` in a process of its own."""

    def __init__(self, url: str, path: Path, *words: str) -> None:
        self.path = path
        self.process = subprocess.Popen(
            (sys.executable, "-m", "fibws", "bag", "record", "-O", str(path), "-L", "0", *words),
            env={**os.environ, "FIBWS_HUB": url, "PYTHONUNBUFFERED": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=ROOT,
        )
        self.output = ""

    def wait_for(self, text: str) -> None:
        """Wait for a line of its output."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.output += line
            if text in line:
                return
        raise AssertionError(self.output)

    def end(self, number: signal.Signals | None = None) -> list[Entry]:
        """Wait for its end, which a signal may ask for; return what it has recorded."""
        if number is not None:
            self.process.send_signal(number)
        output, _ = self.process.communicate(timeout=PATIENCE)
        self.output += output
        assert self.process.returncode == 0, self.output
        return entries(self.path)


@contextmanager
def recorder(url: str, path: Path, *words: str) -> Iterator[Recorder]:
    """Record until the end of the block."""
    found = Recorder(url, path, *words)
    try:
        yield found
    finally:
        if found.process.poll() is None:
            found.process.kill()
        found.process.communicate()


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    """A bag of three numbers, within 20 ms."""
    return write(tmp_path / "a.bag", *((each / 100, int32("/n", each)) for each in range(3)))


# Both.


@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_recording_of_a_playback_is_equal(
    run: Run, hub: HubThread, tmp_path: Path, compression: str
) -> None:
    messages = [
        (0.0, int32("/n", 1, "/talker")),
        (0.1, int32("/n", 2, "/other")),
        (0.2, entry("/image", IMAGE, b"\x07\0\0\0" + bytes(33), "/camera")),
        (0.3, entry("/image", IMAGE, b"\x09\0\0\0" + bytes(33), "/camera")),
        (0.4, int32("/map", 3, "/map_server", latching=True)),
        (0.5, int32("/map", 4, "/other_server", latching=True)),
    ]
    source = write(tmp_path / "a.bag", *messages, compression=compression)
    option = () if compression == "none" else (f"--{compression}",)
    words = ("-l", "2", *option, "/n", "/image", "/map")
    with recorder(hub.url, tmp_path / "b.bag", *words) as recording:
        result = run("bag", "play", str(source), *QUICK)
        assert result.exit_code == 0, result.output
        found = recording.end()
    expected = [each for _, each in messages]
    assert sorted(found) == sorted(expected)
    assert [each for each in found if each.callerid == "/camera"] == expected[2:4]
    with open_reader(tmp_path / "b.bag") as reader:
        assert reader.compression == compression


@pytest.mark.parametrize("kind", ["mcap-none", "sqlite3-none"])
@pytest.mark.long
def test_recording_of_ros_2_is_played_as_one_of_ros_1(
    run: Run, hub: HubThread, tmp_path: Path, kind: str
) -> None:
    folder = tmp_path / "walk"
    ros2_recordings.write(folder, ros2_recordings.KINDS[kind], latched=True)
    expected = [(topic, type_, data) for topic, type_, _, data in rows_by_rosbags(folder)]
    topics = sorted({topic for topic, *_ in expected})
    with recorder(hub.url, tmp_path / "b.bag", "-l", "20", *topics) as recording:
        result = run("bag", "play", str(folder), *QUICK)
        assert result.exit_code == 0, result.output
        found = recording.end()
    assert sorted((each.topic, each.type, each.data) for each in found) == sorted(expected)
    assert all(each.latching for each in found)


def test_many_publishers_of_a_topic_share_a_node(
    run: Run, hub: HubThread, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.cli.bag.play.MOST_NODES", 2)
    numbers = [int32("/n", number, f"/talker{number % 5}") for number in range(20)]
    source = write(tmp_path / "a.bag", *((each.data[0] / 100, each) for each in numbers))
    with recorder(hub.url, tmp_path / "b.bag", "-l", "20", "/n") as recording:
        result = run("bag", "play", str(source), *QUICK)
        assert result.exit_code == 0, result.output
        found = recording.end()
    assert sorted(found) == sorted(numbers)


def test_unknown_types_are_played_and_recorded(run: Run, hub: HubThread, tmp_path: Path) -> None:
    with open_writer(tmp_path / "a.bag") as bag:
        definition = "uint8 apples\nHeader header\n"
        connection = bag.connection("/tree", "orchard/Tree", "*", definition, callerid="/farmer")
        bag.write(connection, START, bytes(17))
    with recorder(hub.url, tmp_path / "b.bag", "-l", "1", "/tree") as recording:
        result = run("bag", "play", str(tmp_path / "a.bag"), *QUICK)
        assert result.exit_code == 0, result.output
        [found] = recording.end()
    assert found[:2] == ("/tree", "orchard/Tree")
    assert found.data == bytes(17)
    with open_reader(tmp_path / "b.bag") as reader:
        assert reader.connections[0].definition.startswith("uint8 apples")


# Recording.


def test_all_topics_and_new_ones_are_recorded_until_ctrl_c(
    hub: HubThread, tmp_path: Path, publish: Publish
) -> None:
    publish("/map", "std_msgs/Int32", {"data": 1})
    with recorder(hub.url, tmp_path / "b.bag", "-a", "-x", "/rosout.*") as recording:
        recording.wait_for("Subscribing to /map")
        publish("/late", "std_msgs/Int32", {"data": 2})
        publish("/rosout_not", "std_msgs/Int32", {"data": 3})
        recording.wait_for("Subscribing to /late")
        found = recording.end(signal.SIGINT)
    assert [(each.topic, each.latching, each.data[0]) for each in found if each.latching] == [
        ("/map", True, 1),
        ("/late", True, 2),
    ]
    assert "/rosout_not" not in {each.topic for each in found}


@pytest.mark.parametrize("clock", [[20, 6], [6], []])
@pytest.mark.long
def test_latched_messages_have_the_time_of_the_beginning(
    hub: HubThread, tmp_path: Path, publish: Publish, client: HubClient, clock: list[int]
) -> None:
    """They were published before the recording, by a clock that may have been set back since."""
    publish("/map", "std_msgs/Int32", {"data": 1})
    client.call("/rosapi/set_param", {"name": "/use_sim_time", "value": "true"})
    for seconds in clock:
        publish("/clock", "rosgraph_msgs/Clock", {"clock": {"secs": seconds, "nsecs": 0}})
        publish("/map", "std_msgs/Int32", {"data": 1})
        client.call("/rosapi/get_time")
    try:
        with recorder(hub.url, tmp_path / "b.bag", "-a") as recording:
            recording.wait_for("Subscribing to /map")
            wait_for_subscriber(hub.url, "/map")
            for seconds in (7, 8):
                publish("/clock", "rosgraph_msgs/Clock", {"clock": {"secs": seconds, "nsecs": 0}})
                publish("/n", "std_msgs/Int32", {"data": seconds})
            recording.wait_for("Subscribing to /n")
            recording.end(signal.SIGINT)
    finally:
        client.call("/rosapi/set_param", {"name": "/use_sim_time", "value": "false"})
    with open_reader(tmp_path / "b.bag") as bag:
        first = {each.topic: time for each, time, _ in reversed(list(bag.messages()))}
        assert first["/map"] == (clock[-1] if clock else 7) * SECOND == bag.start
        assert {each.type for each in bag.connections} >= {"std_msgs/Int32", "rosgraph_msgs/Clock"}
        assert "*" not in {each.type for each in bag.connections}


def test_latched_message_after_time_was_set_back_has_the_new_time(
    hub: HubThread, tmp_path: Path, publish: Publish, client: HubClient
) -> None:
    client.call("/rosapi/set_param", {"name": "/use_sim_time", "value": "true"})
    publish("/clock", "rosgraph_msgs/Clock", {"clock": {"secs": 20, "nsecs": 0}})
    client.call("/rosapi/get_time")
    try:
        with recorder(hub.url, tmp_path / "b.bag", "-a") as recording:
            recording.wait_for("Recording to")
            wait_for_subscriber(hub.url, "/clock")
            publish("/clock", "rosgraph_msgs/Clock", {"clock": {"secs": 5, "nsecs": 0}})
            publish("/late", "std_msgs/Int32", {"data": 1})
            recording.wait_for("Subscribing to /late")
            wait_for_subscriber(hub.url, "/late")
            recording.end(signal.SIGINT)
    finally:
        client.call("/rosapi/set_param", {"name": "/use_sim_time", "value": "false"})
    with open_reader(tmp_path / "b.bag") as bag:
        assert [time for _, time, _ in bag.messages(["/late"])] == [5 * SECOND]


def test_two_signals_at_once_complete_the_bag(
    hub: HubThread, tmp_path: Path, publish: Publish
) -> None:
    """``timeout -s INT`` sends one to the recorder, and one to its group."""
    publish("/map", "std_msgs/Int32", {"data": 1})
    with recorder(hub.url, tmp_path / "b.bag", "/map") as recording:
        recording.wait_for("Recording to")
        wait_for_subscriber(hub.url, "/map")
        recording.process.send_signal(signal.SIGINT)
        found = recording.end(signal.SIGINT)
    assert [each.topic for each in found] == ["/map"]


def test_topic_that_nobody_publishes_is_told_and_the_end_says_what_was_recorded(
    hub: HubThread, tmp_path: Path, publish: Publish
) -> None:
    publish("/scan", "std_msgs/Int32", {"data": 1})
    path = tmp_path / "b.bag"
    with recorder(hub.url, path, "/scann", "/scan") as recording:
        wait_for_subscriber(hub.url, "/scan")
        recording.wait_for("Recording to")
        recording.end(signal.SIGINT)
        expected = "topic [/scann] does not appear to be published yet; did you mean /scan?"
        assert expected in recording.output
        assert "[/scan] does not" not in recording.output
        assert re.search(rf"\n1 message, \d\.\d KB in {path}\n", recording.output)


@pytest.mark.parametrize("words", [("-a",), ("-a", "-q")])
def test_all_topics_are_those_that_can_be_played(
    run: Run, hub: HubThread, tmp_path: Path, publish: Publish, words: tuple[str, ...]
) -> None:
    publish("/scan", "std_msgs/Int32", {"data": 1})
    path = tmp_path / "b.bag"
    with recorder(hub.url, path, *words) as recording:
        wait_for_subscriber(hub.url, "/scan")
        topics = {each.topic for each in recording.end(signal.SIGINT)}
        assert topics >= {"/scan"}
        assert topics <= {"/scan", "/rosout"}
        assert ("KB in" in recording.output) == ("-q" not in words)


@pytest.mark.parametrize(
    ("suffix", "words", "end"),
    [
        ("bag", (), signal.SIGINT),
        ("bag", (), signal.SIGTERM),
        ("bag", ("-j",), signal.SIGINT),
        ("bag", ("--lz4",), signal.SIGKILL),
        ("mcap", (), signal.SIGINT),
        ("mcap", (), signal.SIGKILL),
        ("mcap", ("--lz4",), signal.SIGTERM),
        ("mcap", ("--zstd",), signal.SIGINT),
    ],
)
@pytest.mark.long
def test_what_is_recorded_can_be_read_by_all(
    run: Run,
    hub: HubThread,
    client: HubClient,
    tmp_path: Path,
    suffix: str,
    words: tuple[str, ...],
    end: signal.Signals,
) -> None:
    """All messages are there, `check` finds no fault, and neither do other programs."""
    path = tmp_path / f"b.{suffix}"
    active = tmp_path / f"b.{suffix}.active"
    client.send({"op": "advertise", "topic": "/n", "type": "std_msgs/Int32"})
    client.call("/rosapi/get_time")
    with recorder(hub.url, path, "-a", *words) as recording:
        recording.wait_for("Subscribing to /n")
        wait_for_subscriber(hub.url, "/n")
        for number in range(200):
            client.send({"op": "publish", "topic": "/n", "msg": {"data": number}})
        client.call("/rosapi/get_time")
        if end == signal.SIGKILL:
            while len(numbers(active)) < 200:
                assert recording.process.poll() is None
            recording.process.kill()
            recording.process.wait(PATIENCE)
            assert run("bag", "reindex", "-q", str(active)).exit_code == 0
            active.rename(path)
        else:
            recording.end(end)
    result = run("bag", "check", str(path))
    assert (result.exit_code, result.output) == (0, "Bag file does not need any migrations.\n")
    assert numbers(path) == list(range(200))
    if suffix == "bag":
        with Rosbag1Reader(path) as bag:
            found = [data for each, _, data in bag.messages() if each.topic == "/n"]
    else:
        with path.open("rb") as file:
            messages = make_reader(file, validate_crcs=True).iter_messages(topics=["/n"])
            found = [message.data for _, _, message in messages]
    assert [int.from_bytes(data, "little") for data in found] == list(range(200))


def numbers(path: Path) -> list[int]:
    """Return the numbers of /n in a bag, which may be incomplete."""
    try:
        with open_reader(path, allow_unindexed=True) as bag:
            return [int.from_bytes(data, "little") for _, _, data in bag.messages(["/n"])]
    except (BagError, OSError):
        return []


def wait_for_subscriber(url: str, topic: str) -> None:
    with HubClient("look", url) as client:
        while not client.call("/rosapi/subscribers", {"topic": topic})["subscribers"]:
            client.process(0.01)


def test_regular_expressions_match_whole_names(
    hub: HubThread, tmp_path: Path, publish: Publish
) -> None:
    for name in ("/camera1/info", "/camera2/info", "/camera1/info/more"):
        publish(name, "std_msgs/Int32", {"data": 1})
    with recorder(hub.url, tmp_path / "b.bag", "-e", "/camera./info", "-l", "1") as recording:
        found = recording.end()
    assert {each.topic for each in found} == {"/camera1/info", "/camera2/info"}


def test_topics_of_a_node_are_recorded(hub: HubThread, tmp_path: Path, publish: Publish) -> None:
    publish("/n", "std_msgs/Int32", {"data": 1})
    publish("/m", "std_msgs/Int32", {"data": 1})

    async def listen(node: fibws.Node) -> None:
        node.subscribe("/n", Int32)

    with recorder(hub.url, tmp_path / "b.bag", "--node", "listner", "-x", "/m") as recording:
        recording.wait_for("node [/listner] is not there yet")
        assert "--exclude is for -a and -e only" in recording.output
    with (
        peer(hub.url, "listener", listen),
        recorder(hub.url, tmp_path / "b.bag", "--node", "/listener") as recording,
    ):
        recording.wait_for("Subscribing to /n")
        assert "not there yet" not in recording.output
        found = recording.end(signal.SIGINT)
    assert [each.topic for each in found] == ["/n"]
    assert "/m" not in recording.output


@pytest.mark.long
def test_begin_is_published_and_names_are_remapped(
    hub: HubThread, tmp_path: Path, client: HubClient
) -> None:
    client.subscribe_raw("/begin_write", lambda message: begun.append(bytes(message.data)))
    begun: list[bytes] = []
    with recorder(hub.url, tmp_path / "b.bag", "-p", "-q", "chatter", "chatter:=/n") as recording:
        while not begun:
            client.process(0.01)
        assert str(tmp_path / "b.bag").encode() in begun[0]
        wait_for_subscriber(hub.url, "/n")
        assert recording.end(signal.SIGTERM) == []


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ((), "must specify a topic"),
        (("-o", "a", "-O", "b", "/n"), "both prefix and name"),
        (("--split", "/n"), "maximum duration or size"),
        (("--max-splits", "2", "/n"), "--split"),
        (("-j", "--lz4", "/n"), "one type of compression"),
        (("--lz4", "--zstd", "-O", "a.mcap", "/n"), "one type of compression"),
        (("-j", "-O", "a.mcap", "/n"), "--bz2 does not exist for .mcap"),
        (("--zstd", "/n"), "--zstd does not exist for .bag"),
        (("-O", "a.db3", "/n"), "expected a name that ends in .bag or .mcap"),
        (("-x", "(", "-a"), "regular expression"),
        (("-e", "("), "regular expression"),
        (("--duration", "5x", "/n"), "5m"),
        (("-L", "1T", "/n"), "1G"),
    ],
)
def test_wrong_options_are_explained(run: Run, words: tuple[str, ...], text: str) -> None:
    result = run("bag", "record", *words)
    assert result.exit_code == 2
    assert text in result.output


def test_recording_that_cannot_begin_fails(run: Run, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    result = run("bag", "record", "-O", f"{tmp_path}/file/a.bag", "/n")
    assert result.exit_code == 1
    assert "file/a.bag" in result.output


# Playing.


@pytest.mark.long
def test_topics_are_selected_prefixed_and_remapped(
    run: Run, hub: HubThread, tmp_path: Path
) -> None:
    bag = write(tmp_path / "a.bag", (0, int32("/a", 1)), (1, int32("/b", 2)), (2, int32("/c", 3)))
    with recorder(hub.url, tmp_path / "b.bag", "-l", "1", "/robot/a", "/d") as recording:
        words = ("--topics", "/a", "b", "--bags", str(bag), "-p", "/robot", "/robot/b:=/d")
        result = run("bag", "play", *QUICK, *words)
        assert result.exit_code == 0, result.output
        found = recording.end()
    assert sorted((each.topic, each.data[0]) for each in found) == [("/d", 2), ("/robot/a", 1)]


def test_clock_is_published_before_the_first_message(
    run: Run, hub: HubThread, bag: Path, client: HubClient
) -> None:
    order: list[str] = []
    times: list[int] = []

    def clock(message: Any) -> None:
        order.append("clock")
        seconds, nanoseconds = (int.from_bytes(message.data[i : i + 4], "little") for i in (0, 4))
        times.append(seconds * SECOND + nanoseconds)

    client.subscribe_raw("/clock", clock)
    client.subscribe_raw("/n", lambda message: order.append("n"))
    client.call("/rosapi/get_time")
    result = run("bag", "play", str(bag), "--clock", "--hz", "1000", "-d", "0.05")
    assert result.exit_code == 0, result.output
    client.call("/rosapi/get_time")
    assert order[0] == "clock"
    assert order.count("n") == 3
    assert times[0] == START
    assert times == sorted(times)
    assert times[-1] <= START + SECOND // 50


@pytest.mark.parametrize("words", [(), ("-r", "10"), ("-i",), ("-l",), ("-s", "0.01", "-l")])
@pytest.mark.long
def test_no_message_is_ahead_of_the_clock(
    hub: HubThread, tmp_path: Path, words: tuple[str, ...]
) -> None:
    """Also where many messages come between two ticks, and when time goes back."""
    messages = [(each / 1000, int32("/n", each)) for each in range(40)]
    source = write(tmp_path / "a.bag", (0, int32("/map", 0, latching=True)), *messages)
    early: list[tuple[str, int, int]] = []
    count = 0

    async def program() -> None:
        nonlocal count
        async with (
            fibws.Node("robot", hub=hub.url, use_sim_time=True) as node,
            asyncio.timeout(PATIENCE),
        ):
            done = asyncio.Event()
            loop_ended = 80 if "-l" in words else 40

            def take(message: Int32) -> None:
                nonlocal count
                time = START + message.data * SECOND // 1000
                now = node.now().to_nanoseconds()
                if now != time:
                    early.append(("/n", message.data, now - time))
                count += 1
                if count >= loop_ended:
                    done.set()

            def take_map(message: Int32) -> None:
                start = START + (SECOND // 100 if "-s" in words else 0)
                if (now := node.now().to_nanoseconds()) != start:
                    early.append(("/map", message.data, now - start))

            node.subscribe("/n", Int32)._hand_to(take)
            node.subscribe("/map", Int32)._hand_to(take_map)
            await node.flush()
            play = await asyncio.create_subprocess_exec(
                *(sys.executable, "-m", "fibws", "bag", "play", str(source), "--clock"),
                *("-d", "0", "--wait-for-subscribers", "-q", *words),
                env={**os.environ, "FIBWS_HUB": hub.url},
                cwd=ROOT,
            )
            await done.wait()
            if "-l" in words:
                play.send_signal(signal.SIGINT)
            await play.wait()

    asyncio.run(program())
    assert early == []


def test_playback_is_controlled_by_services(hub: HubThread, bag: Path) -> None:
    async def program() -> None:
        received: asyncio.Queue[int] = asyncio.Queue()
        async with fibws.Node("page", hub=hub.url, rosout=False) as node, asyncio.timeout(PATIENCE):
            numbers = node.subscribe("/n", Int32, queue_size=None)

            async def read() -> None:
                async for message in numbers:
                    received.put_nowait(message.data)

            reading = asyncio.create_task(read())
            states = node.subscribe("/player/playback", "fibws_msgs/PlaybackState")

            async def control(command: str, **fields: Any) -> Any:
                request = {"command": command, **fields}
                name = "/player/control_playback"
                return await node.call(name, "fibws_msgs/ControlPlayback", request)

            state = await anext(states)
            assert (state.status, state.bags) == (state.PAUSED, [str(bag)])
            assert state.start.to_nanoseconds() == START
            assert (await control("step")).success
            assert await received.get() == 0
            assert (await control("seek", position={"secs": 0, "nsecs": 0})).success
            assert (await control("step")).success
            assert await received.get() == 0
            assert (await control("rate", rate=0.5)).state.rate == 0.5
            assert not (await control("rate", rate=-1)).success
            assert not (await control("dance")).success
            pause = ("/player/pause_playback", "std_srvs/SetBool")
            assert not (await node.call(*pause, {"data": True})).success
            assert (await node.call(*pause, {"data": False})).success
            assert not (await control("step")).success
            assert [await received.get() for _ in range(2)] == [1, 2]
            reading.cancel()

    words = ("bag", "play", str(bag), "--pause", "-k", "-d", "0", "--node-name", "player")
    with subprocess.Popen(
        (sys.executable, "-m", "fibws", *words),
        env={**os.environ, "FIBWS_HUB": hub.url},
        stdout=subprocess.PIPE,
    ) as player:
        asyncio.run(program())
        player.send_signal(signal.SIGINT)
        player.communicate(timeout=PATIENCE)
    assert player.returncode == 0


@pytest.mark.long
def test_keys_control_the_playback(hub: HubThread, tmp_path: Path, client: HubClient) -> None:
    bag = write(tmp_path / "a.bag", (0, int32("/n", 0)), (1000, int32("/n", 1)))
    received: list[int] = []
    client.subscribe_raw("/n", lambda message: received.append(message.data[0]))
    words = ("bag", "play", str(bag), "--pause", "-d", "0", "-r", "10000")
    terminal = Terminal(sys.executable, "-m", "fibws", *words, FIBWS_HUB=hub.url)
    terminal.wait_for("Hit space to toggle paused, or 's' to step.")
    terminal.wait_for(f" [PAUSED ]  Bag Time: {START // SECOND}.000000   Duration: 0.000000 / 1000")
    terminal.type("s")
    while not received:
        client.process(0.01)
    terminal.type(" ")
    terminal.wait_for("Done.")
    assert terminal.process.wait(PATIENCE) == 0
    client.call("/rosapi/get_time")
    assert received == [0, 1]
    assert re.search(r" \[RUNNING\]  Bag Time: .* Duration: 1000\.000000 / 1000", terminal.output)


@pytest.mark.long
def test_rate_control_topic_delays_the_playback(
    hub: HubThread, tmp_path: Path, client: HubClient
) -> None:
    bag = write(tmp_path / "a.bag", (0, int32("/n", 0)), (100, int32("/n", 1)))
    received: list[int] = []
    client.subscribe_raw("/n", lambda message: received.append(message.data[0]))
    words = ("bag", "play", str(bag), "-i", "-d", "0", "--rate-control-topic", "/camera/header")
    terminal = Terminal(sys.executable, "-m", "fibws", *words, FIBWS_HUB=hub.url)
    terminal.wait_for("[DELAYED]")
    client.send({"op": "advertise", "topic": "/camera/header", "type": "sensor_msgs/TimeReference"})
    stamp = {"secs": START // SECOND + 100, "nsecs": 0}
    while len(received) < 2:
        message = {"header": {"stamp": stamp}}
        client.send({"op": "publish", "topic": "/camera/header", "msg": message})
        client.process(0.02)
    terminal.wait_for("Done.")
    assert terminal.process.wait(PATIENCE) == 0
    assert received == [0, 1]


def test_topics_of_the_hub_itself_are_left_out(run: Run, tmp_path: Path) -> None:
    bag = write(tmp_path / "a.bag", (0, int32("/client_count", 1)), (0, int32("/n", 2)))
    result = run("bag", "play", str(bag), "-i", "-d", "0")
    assert result.exit_code == 0
    assert "/client_count is not played" in result.output


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        ((), 2, "at least one bag"),
        (("missing.bag",), 1, "missing.bag"),
        (("{bag}", "-s", "100"), 2, "--start"),
        (("{bag}", "-r", "0"), 2, "--rate"),
        (("{bag}", "--topics", "/none"), 2, "no topic /none; they have /n"),
        (("{bag}", "--topics", "/n", "/none"), 2, "--topics: the bags have no topic /none"),
        (("{bag}", "--pause-topics", "/none"), 2, "--pause-topics: the bags have no topic /none"),
        (("{bag}", "/n"), 2, "no file is named /n; write --topics before topics"),
        (("--topics", "/n", "{bag}"), 2, "name it before the options"),
    ],
)
def test_wrong_arguments_of_play_are_explained(
    run: Run, bag: Path, words: tuple[str, ...], code: int, text: str
) -> None:
    result = run("bag", "play", *(each.format(bag=bag) for each in words))
    assert result.exit_code == code, result.output
    assert text in result.output


def test_bags_and_topics_are_completed(hub: HubThread, publish: Publish) -> None:
    publish("/chatter", "std_msgs/Int32", {"data": 1})

    def completed(name: str, incomplete: str) -> list[tuple[str, str]]:
        command = bag_commands.get_command(click.Context(bag_commands), name)
        assert command is not None
        [words] = [each for each in command.params if isinstance(each, click.Argument)]
        context = click.Context(command)
        context.params = {"hub": hub.url}
        return [(each.value, each.type) for each in words.shell_complete(context, incomplete)]

    assert completed("record", "/cha") == [("/chatter", "plain")]
    assert completed("play", "wa") == [("wa", "file")]
