"""What is recorded in the end is what was published, except for what was told as dropped.

Splits, full disks, and many topics; other programs read the files.
"""

from __future__ import annotations

import asyncio
import json
import os
import re
import signal
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from bags.test_other_programs import PYTHON, in_python, needs_ros
from hub_in_thread import HubThread, Publish, Run
from mcap.reader import make_reader
from patience import PATIENCE
from rosbags.rosbag1 import Reader as Rosbag1Reader

import fibws
from fibws import Time
from fibws.bags import open_reader
from fibws.client.hub_client import HubClient
from fibws.hub import Settings
from fibws.hub.recording import STATE
from fibws.hub.server import HubServer
from fibws.msg.fibws_msgs import RecordingState
from fibws.msg.rosgraph_msgs import Clock
from fibws.msg.std_msgs import Int32

from .test_record_and_play import Recorder, numbers, recorder, wait_for_subscriber

SIZE = 100_000
"""Bytes of a message that fills files."""
BLOBS = 60
VALID = "Bag file does not need any migrations.\n"
TOPICS, ROUNDS, RATE = 500, 200, 200

each_suffix = pytest.mark.parametrize("suffix", ["bag", "mcap"])


def publish_blobs(client: HubClient, begin: int = 0) -> None:
    """Publish messages of `SIZE` bytes, which begin with their numbers, and wait for the hub."""
    for number in range(begin, begin + BLOBS):
        text = str(number).ljust(SIZE, ".")
        client.send({"op": "publish", "topic": "/blob", "msg": {"data": text}})
    client.call("/rosapi/get_time")


def blobs(path: Path) -> list[int]:
    """Return the numbers of /blob in a bag, as other programs read them."""
    if path.suffix == ".bag":
        with Rosbag1Reader(path) as bag:
            found = [data for each, _, data in bag.messages() if each.topic == "/blob"]
    else:
        with path.open("rb") as file:
            messages = make_reader(file, validate_crcs=True).iter_messages(topics=["/blob"])
            found = [message.data for _, _, message in messages]
    return [int(data[4:12].rstrip(b".")) for data in found]


def check(run: Run, *paths: Path) -> None:
    for path in paths:
        result = run("bag", "check", str(path))
        assert (result.exit_code, result.output) == (0, VALID)


# Splits.


@each_suffix
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL], ids=["SIGINT", "SIGKILL"])
def test_files_of_a_split_have_all_messages_once(
    run: Run,
    hub: HubThread,
    client: HubClient,
    tmp_path: Path,
    publish: Publish,
    suffix: str,
    end: signal.Signals,
) -> None:
    publish("/map", "std_msgs/Int32", {"data": 1})
    client.send({"op": "advertise", "topic": "/blob", "type": "std_msgs/String"})
    client.call("/rosapi/get_time")
    name = tmp_path / f"b.{suffix}"
    words = ("--split", "--size", "1", "--repeat-latched", "-x", "/rosout", "-a")
    with recorder(hub.url, name, *words) as recording:
        for topic in ("/map", "/blob"):
            wait_for_subscriber(hub.url, topic)
        publish_blobs(client)
        while sum(map(count, parts(tmp_path))) < BLOBS:
            assert recording.process.poll() is None
        if end == signal.SIGKILL:
            recording.process.kill()
            recording.process.wait(PATIENCE)
            [active] = tmp_path.glob("*.active")
            assert run("bag", "reindex", "-q", str(active)).exit_code == 0
            active.rename(str(active).removesuffix(".active"))
            for copy in tmp_path.glob("*.orig.active"):
                copy.unlink()
        else:
            recording.process.send_signal(end)
            recording.process.communicate(timeout=PATIENCE)
            assert recording.process.returncode == 0
    found = parts(tmp_path)
    assert len(found) >= 3
    check(run, *found)
    assert [number for path in found for number in blobs(path)] == list(range(BLOBS))
    for path in found:
        with open_reader(path) as bag:
            # The last one may have been killed before its first message was written.
            topics = [each.topic for each, _, _ in bag.messages()]
            assert topics[:1] == ["/map"] or (not topics and path == found[-1])


def parts(folder: Path) -> list[Path]:
    """Return the files of a split in their order."""
    found = [each for each in folder.iterdir() if ".orig" not in each.name]
    return sorted(found, key=lambda path: int(re.findall(r"_(\d+)\.", path.name)[0]))


def count(path: Path) -> int:
    """Return how many messages of /blob are in a file, which may be incomplete or renamed."""
    try:
        with open_reader(path, allow_unindexed=True) as bag:
            return sum(1 for _ in bag.messages(["/blob"]))
    except (OSError, fibws.FibwsError):
        return 0


# ROS's rosbag.

READ = """
import sys, rosbag
for path in sys.argv[1:]:
    with rosbag.Bag(path) as bag:
        for topic, message, time in bag.read_messages(["/n"]):
            print(message.data)
"""


@pytest.mark.parametrize("words", [(), ("-j",), ("--lz4",)], ids=["none", "bz2", "lz4"])
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
@pytest.mark.parametrize("mark", [pytest.param(None, marks=needs_ros(PYTHON))], ids=["real"])
def test_rosbag_of_ros_reads_recordings(
    run: Run,
    hub: HubThread,
    client: HubClient,
    tmp_path: Path,
    words: tuple[str, ...],
    end: signal.Signals,
    mark: None,
) -> None:
    path, active = tmp_path / "b.bag", tmp_path / "b.bag.active"
    client.send({"op": "advertise", "topic": "/n", "type": "std_msgs/Int32"})
    client.call("/rosapi/get_time")
    with recorder(hub.url, path, "-a", "-x", "/rosout", *words) as recording:
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
    assert list(map(int, in_python(READ, path).split())) == list(range(200))
    checked = subprocess.run(
        [PYTHON, "-c", "import sys, rosbag; rosbag.rosbagmain(sys.argv)", "check", str(path)],
        env={**os.environ, "PYTHONPATH": ""},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "does not need any migrations" in checked.stdout


# A full disk.


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 2 MiB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    if (
        os.geteuid()
        or subprocess.run(
            ["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", folder], check=False
        ).returncode
    ):
        pytest.skip("only root can mount a file system")
    yield folder
    subprocess.run(["umount", folder], check=True)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("suffix", "words"), [("bag", ()), ("bag", ("--split", "--size", "1")), ("mcap", ())]
)
def test_recording_that_fills_a_disk_is_complete_up_to_then(
    run: Run,
    hub: HubThread,
    client: HubClient,
    tmp_path: Path,
    small_disk: Path,
    suffix: str,
    words: tuple[str, ...],
) -> None:
    """Only root can mount a small disk: the test is left out of the landing."""
    client.send({"op": "advertise", "topic": "/blob", "type": "std_msgs/String"})
    client.call("/rosapi/get_time")
    with recorder(hub.url, small_disk / f"b.{suffix}", *words, "/blob") as recording:
        wait_for_subscriber(hub.url, "/blob")
        publish_blobs(client)
        output, _ = recording.process.communicate(timeout=PATIENCE)
        assert recording.process.returncode == 1
    output = recording.output + output
    assert "No space left on device" in output
    found = sorted(small_disk.iterdir())
    if any(path.suffix == ".active" for path in found):
        # As the advice says: the index did not fit.
        [advice] = re.findall(r"bag reindex --output-dir DIR (\S+)", output)
        restored = tmp_path / "restored"
        assert run("bag", "reindex", "-q", "--output-dir", str(restored), advice).exit_code == 0
        [path] = restored.iterdir()
        found[-1] = path.rename(tmp_path / f"restored.{suffix}")
    check(run, *found)
    recorded = [number for path in found for number in blobs(path)]
    assert recorded == list(range(len(recorded)))
    assert len(recorded) > 10
    result = run("bag", "record", "-L", "0", "-O", f"{small_disk}/again.{suffix}", "/blob")
    assert result.exit_code == 1
    assert not list(small_disk.glob("again*"))


# The last minutes of a hub.


class RecordingHub:
    """A ``fibws hub --record`` in a process of its own, with files of 1 MB."""

    def __init__(self, folder: Path, suffix: str) -> None:
        words = ["--port", "0", "--record-size", "1", "--record-min-space", "0"]
        if suffix == "mcap":
            words.append("--record-mcap")
        self.process = subprocess.Popen(
            (sys.executable, "-m", "fibws", "hub", "--record", str(folder), *words),
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.output = ""
        self.url = self.wait_for(r"listens at (ws://[^;]+);")

    def wait_for(self, pattern: str) -> str:
        """Wait for a line of its output; return what the pattern's group matches."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.output += line
            if found := re.search(pattern, line):
                return found[1]
        raise AssertionError(self.output)

    def end(self, number: signal.Signals) -> str:
        """Send a signal, and wait for the end; return all of its output."""
        self.process.send_signal(number)
        output, _ = self.process.communicate(timeout=PATIENCE)
        return self.output + output


@contextmanager
def recording_hub(folder: Path, suffix: str) -> Iterator[RecordingHub]:
    hub = RecordingHub(folder, suffix)
    try:
        yield hub
    finally:
        if hub.process.poll() is None:
            hub.process.kill()
        hub.process.communicate()


def publish_to(hub: RecordingHub, begin: int) -> None:
    """Publish messages as `publish_blobs`, by a node that leaves them to the hub."""
    with HubClient("pub", hub.url) as client:
        client.send({"op": "advertise", "topic": "/map", "type": "std_msgs/Int32", "latch": True})
        client.send({"op": "publish", "topic": "/map", "msg": {"data": begin}})
        client.send({"op": "advertise", "topic": "/blob", "type": "std_msgs/String"})
        publish_blobs(client, begin)


@pytest.mark.long
@each_suffix
def test_recordings_of_a_hub_that_was_killed_have_all_messages(
    run: Run, tmp_path: Path, suffix: str
) -> None:
    """Also if it begins again in the same folder, whose files it leaves as they are."""
    folder = tmp_path / "rec"
    for begin, end in ((0, signal.SIGKILL), (BLOBS, signal.SIGKILL), (2 * BLOBS, signal.SIGTERM)):
        with recording_hub(folder, suffix) as hub:
            publish_to(hub, begin)
            while sum(map(count, folder.iterdir())) < begin + BLOBS:
                assert hub.process.poll() is None
            hub.end(end)
            assert hub.process.returncode == (0 if end == signal.SIGTERM else -end)
    left = sorted(map(str, folder.glob("*.active")))
    assert len(left) == 2
    assert run("bag", "reindex", "-q", "--output-dir", f"{tmp_path}/restored", *left).exit_code == 0
    restored = [
        path.rename(path.with_suffix("")) for path in (tmp_path / "restored").glob("*.active")
    ]
    found = sorted([*folder.glob(f"*.{suffix}"), *restored], key=lambda path: path.name)
    check(run, *found)
    assert sorted(number for path in found for number in blobs(path)) == list(range(3 * BLOBS))


@pytest.mark.slow
@each_suffix
def test_hub_goes_on_when_its_recording_has_filled_the_disk(
    run: Run, small_disk: Path, suffix: str
) -> None:
    """Only root can mount a small disk: the test is left out of the landing."""
    with recording_hub(small_disk, suffix) as hub:
        publish_to(hub, 0)
        hub.wait_for("(No space left on device)")
        hub.wait_for("(complete up to then|To restore)")
        publish_to(hub, BLOBS)
        output = hub.end(signal.SIGKILL)
    with recording_hub(small_disk, suffix) as hub:
        publish_to(hub, 2 * BLOBS)
        if "No space left on device" not in hub.output:  # It may have had room for a file.
            hub.wait_for("(No space left on device)")
        output += hub.end(signal.SIGTERM)
        assert hub.process.returncode == 0
    found = sorted(small_disk.iterdir())
    left = [path for path in found if path.suffix == ".active"]  # Their indexes did not fit.
    assert list(map(str, left)) == re.findall(r"bag reindex --output-dir DIR (\S+)", output)
    for path in left:
        restored = small_disk.with_name("restored") / path.name
        words = ("--output-dir", str(restored.parent), str(path))
        assert run("bag", "reindex", "-q", *words).exit_code == 0
        found[found.index(path)] = restored.rename(restored.with_suffix(""))
    check(run, *found)
    recorded = [number for path in found for number in blobs(path)]
    first = [number for number in recorded if number < BLOBS]
    assert len(first) > 10
    assert recorded == [*first, *range(2 * BLOBS, 2 * BLOBS + len(recorded) - len(first))]
    assert first == list(range(len(first)))


# Many topics.

SECOND = 10**9
START = 1_700_000_000 * SECOND
CLOCKS = ["live", "simulated", "looping", "late"]
"""The times of messages: real ones, or those of a clock that runs, starts again, or begins late."""
LATE = ROUNDS // 4
"""The round in which a late clock begins."""
LOOP = ROUNDS // 3
"""The rounds after which a looping clock starts again."""


def load(number: int) -> str:
    return f"/load/{number}"


def time_of(clock: str, number: int) -> int:
    """Return the simulated time of a round in ns; 0 before a late clock has begun."""
    if clock == "late" and number < LATE:
        return 0
    return START + (number % LOOP if clock == "looping" else number) * SECOND // RATE


def begin_clock(url: str, clock: str) -> None:
    """Let the hub have a clock, before the nodes that follow it start."""
    with HubClient("simulator", url) as client:
        client.call(
            "/rosapi/set_param", {"name": "/use_sim_time", "value": str(clock != "live").lower()}
        )
        if clock in ("simulated", "looping"):
            client.send({"op": "advertise", "topic": "/clock", "type": "rosgraph_msgs/Clock"})
            msg = {"clock": {"secs": START // SECOND, "nsecs": 0}}
            client.send({"op": "publish", "topic": "/clock", "msg": msg})
            client.call("/rosapi/get_time")


async def publish_load(url: str, clock: str = "live") -> int:
    """Publish numbers on `TOPICS` topics once all are subscribed.

    Half of the topics appear while the recording runs, every tenth is latched from before.

    Returns:
        How many messages were sent that should be recorded, without those of /clock.
    """
    async with fibws.Node("load", hub=url) as node:
        ticks = await node.advertise("/clock", Clock)

        async def tick(number: int) -> None:
            if clock != "live" and (time := time_of(clock, number)):
                await ticks.publish(Clock(clock=Time(*divmod(time, SECOND))))

        async def advertise(these: range) -> list[fibws.Publisher[Int32]]:
            return [
                await node.advertise(load(each), Int32, latch=each % 10 == 0, peers=True)
                for each in these
            ]

        publishers = await advertise(range(TOPICS // 2))
        sent = 0
        for publisher in publishers[::10]:
            await publisher.publish(0)
            sent += 1
        publishers += await advertise(range(TOPICS // 2, TOPICS))
        async with asyncio.timeout(PATIENCE):
            for publisher in publishers:
                async for names in publisher.peers.changes():
                    if names:
                        break
        loop = asyncio.get_running_loop()
        begin = loop.time()
        for number in range(ROUNDS):
            await asyncio.sleep(begin + number / RATE - loop.time())
            await tick(number)
            if clock == "late" and number == LATE:
                sent = TOPICS // 10  # The last latched message of each.
            for publisher in publishers:
                await publisher.publish(number)
                sent += 1
        await node.params.names()  # The hub has handled all messages before it.
        return sent - sum(publisher.dropped for publisher in publishers)


def check_load(
    path: Path, sent: int, told: int, clock: str = "live", *, is_cut: bool = False
) -> None:
    """See that a recording has all messages that it does not tell of, with their times.

    Args:
        is_cut: whether it ended while the last ones were on their way.
    """
    found: dict[str, list[int]] = defaultdict(list)
    with open_reader(path) as bag:
        assert list(bag.faults()) == []
        for each, time, data in bag.messages():
            if each.topic.startswith("/load/"):
                number = int.from_bytes(data, "little")
                found[each.topic].append(number)
                assert clock == "live" or time == (time_of(clock, number) or time_of(clock, LATE))
    assert len(found) == TOPICS
    check_by_others(path, found)
    recorded = sum(map(len, found.values()))
    is_early = clock == "late" and told > 0  # Some were dropped that are not to be recorded.
    assert recorded + told == sent or (is_cut and recorded + told < sent) or is_early
    if told == 0:
        first = LATE if clock == "late" else 0
        for topic, numbers in found.items():
            is_latched = int(topic.removeprefix("/load/")) % 10 == 0
            without_gaps = [*range(first, max(numbers) + 1)]
            if first and is_latched:
                without_gaps.insert(0, first - 1)
            # Some of the others are latched from before.
            assert sorted(numbers) in (without_gaps, [0, *without_gaps])


def check_by_others(path: Path, found: dict[str, list[int]]) -> None:
    """See that another program finds as many messages of each topic, and those of some topics."""
    counts: dict[str, int]
    some: dict[str, list[int]] = {load(number): [] for number in range(0, TOPICS, 25)}
    if path.suffix == ".bag":
        with Rosbag1Reader(path) as bag:
            counts = {topic: found.msgcount for topic, found in bag.topics.items()}
            # It reads a chunk again for each message where chunks overlap in time.
            wanted = [each for each in bag.connections if each.topic in some]
            for each, _, data in bag.messages(wanted):
                some[each.topic].append(int.from_bytes(data, "little"))
    else:
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            summary = reader.get_summary()
            assert summary is not None and summary.statistics is not None
            channels = {number: each.topic for number, each in summary.channels.items()}
            listed = summary.statistics.channel_message_counts
            counts = {channels[number]: count for number, count in listed.items()}
            for _, channel, message in reader.iter_messages(topics=list(some)):
                some[channel.topic].append(int.from_bytes(message.data, "little"))
    assert {topic: counts[topic] for topic in found} == {
        topic: len(numbers) for topic, numbers in found.items()
    }
    assert {topic: sorted(numbers) for topic, numbers in some.items()} == {
        topic: sorted(found[topic]) for topic in some
    }


def record_load(
    run: Run, hub: HubThread, path: Path, clock: str, end: signal.Signals
) -> tuple[int, int]:
    """Record the load; return how many messages were sent, and how many were told as dropped."""
    begin_clock(hub.url, clock)
    with recorder(hub.url, path, "-e", "/load/.*") as recording:
        recording.wait_for("Recording to")
        sent = asyncio.run(publish_load(hub.url, clock))
        told = dropped_by_hub(hub.url) if end == signal.SIGKILL else 0
        recording.process.send_signal(end)
        output, _ = recording.process.communicate(timeout=PATIENCE)
    if end == signal.SIGKILL:
        active = path.with_name(f"{path.name}.active")
        assert run("bag", "reindex", "-q", str(active)).exit_code == 0
        active.rename(path)
    else:
        assert recording.process.returncode == 0
    return sent, told + told_as_dropped(recording, output)


@pytest.mark.slow
@each_suffix
@pytest.mark.parametrize(
    ("clock", "end"),
    [
        *((clock, signal.SIGINT) for clock in CLOCKS),
        ("live", signal.SIGKILL),
        ("looping", signal.SIGKILL),
    ],
)
def test_messages_of_many_topics_are_recorded_or_told_as_dropped(
    run: Run, hub: HubThread, tmp_path: Path, suffix: str, clock: str, end: signal.Signals
) -> None:
    """500 topics at 200 Hz take more than the CPUs of many machines."""
    path = tmp_path / f"b.{suffix}"
    sent, told = record_load(run, hub, path, clock, end)
    check_load(path, sent, told, clock, is_cut=True)


COUNT = """
import json, sys, rosbag
counts = {}
with rosbag.Bag(sys.argv[1]) as bag:
    for topic, message, time in bag.read_messages():
        counts[topic] = counts.get(topic, 0) + 1
print(json.dumps(counts))
"""


@pytest.mark.slow
@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize("mark", [pytest.param(None, marks=needs_ros(PYTHON))], ids=["real"])
def test_rosbag_of_ros_reads_many_topics(
    run: Run, hub: HubThread, tmp_path: Path, clock: str, mark: None
) -> None:
    """500 topics at 200 Hz take more than the CPUs of many machines."""
    path = tmp_path / "b.bag"
    record_load(run, hub, path, clock, signal.SIGINT)
    with open_reader(path) as bag:
        counts = Counter(each.topic for each, _, _ in bag.messages())
    assert json.loads(in_python(COUNT, path)) == counts
    assert len(counts) == TOPICS


def dropped_by_hub(url: str) -> int:
    """Return how many messages the hub had no room for on their way to recorders."""
    with HubClient("look", url) as client:
        topics = client.call("/rosapi/statistics")["topics"]
    return sum(
        subscription["dropped"]
        for topic in topics
        if topic["topic"].startswith("/load/")
        for subscription in topic["subscriptions"]
    )


def told_as_dropped(recording: Recorder, output: str) -> int:
    """Return how many messages a recorder says that it, or the hub, has dropped."""
    text = recording.output + output
    by_hub = re.findall(r"hub has dropped (\d+) messages", text)
    own = re.findall(r"has dropped (\d+) messages so far", text)
    return sum(map(int, by_hub[-1:] + own[-1:]))


@pytest.mark.slow
@pytest.mark.parametrize("clock", CLOCKS)
async def test_hub_records_all_messages_of_many_topics(tmp_path: Path, clock: str) -> None:
    """500 topics at 200 Hz take more than the CPUs of many machines."""
    options = Settings(port=0, close_timeout=0.1, record=tmp_path, record_min_space=0)
    async with HubServer(options) as hub:
        await asyncio.to_thread(begin_clock, hub.url, clock)
        watcher = fibws.Node("watcher", hub=hub.url)
        async with watcher:
            states = watcher.subscribe(STATE, RecordingState)
            sent = await publish_load(hub.url, clock)
            async with asyncio.timeout(PATIENCE):
                async for state in states:
                    if state.messages + state.dropped >= sent:
                        break
    [path] = list(tmp_path.iterdir())  # noqa: ASYNC240 - nothing else runs here
    check_load(path, sent, state.dropped, clock)
