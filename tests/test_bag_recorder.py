"""Recording: the buffer, the writing thread, files and their splits, faults, crashes."""

from __future__ import annotations

import io
import logging
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from patience import PATIENCE

from fibws.bag_recorder import (
    MESSAGE_COST,
    Origin,
    Recorder,
    RecordingOptions,
    RecordingState,
    size_text,
)
from fibws.bags import open_reader, open_writer, reindex
from fibws.bags.bag_writer import BagWriter
from fibws.bags.connection import Connection
from fibws.errors import BagError

SECOND = 10**9
START = 1_700_000_000 * SECOND
LOG = logging.getLogger("test_bag_recorder")


def origin(topic: str = "/n", callerid: str = "/talker", *, latching: bool = False) -> Origin:
    md5sum = "da5909fbe378aeaf85e547e830cc1bb7"
    return Origin(topic, "std_msgs/Int32", md5sum, "int32 data\n", callerid, latching)


def number(value: int) -> bytes:
    return value.to_bytes(4, "little")


class Recording:
    """A recorder in a folder, whose clock a test sets."""

    def __init__(self, folder: Path, **options: Any) -> None:
        self.now = START
        self.files: list[Path] = []
        self.ended = threading.Event()
        open_ = options.pop("open_", open_writer)
        settings = {"path": str(folder / "a.bag"), "dated": False, "min_space": 0, **options}
        self.recorder = Recorder(
            RecordingOptions(**settings),
            lambda: self.now,
            LOG,
            on_file=self.files.append,
            on_end=self.ended.set,
            open_=open_,
        )
        self.recorder.start()

    def put(self, value: int, seconds: float = 0.0, source: Origin | None = None) -> None:
        stream = self.recorder.stream(source or origin())
        self.recorder.put(stream, START + round(seconds * SECOND), number(value))

    def wait_until(self, is_reached: Callable[[RecordingState], bool]) -> RecordingState:
        deadline = time.monotonic() + PATIENCE
        while not is_reached(state := self.recorder.state()):
            assert time.monotonic() < deadline, state
            time.sleep(0.005)
        return state


@pytest.fixture
def record(tmp_path: Path) -> Iterator[Callable[..., Recording]]:
    made: list[Recording] = []

    def record(**options: Any) -> Recording:
        made.append(Recording(tmp_path, **options))
        return made[-1]

    yield record
    for each in made:
        each.recorder.stop()
        for path in each.files:
            if path.exists():
                with open_reader(path) as bag:
                    assert [each for each in bag.faults() if "years later" not in each] == []


def values(path: Path) -> list[int]:
    with open_reader(path) as bag:
        return [int.from_bytes(data, "little") for _, _, data in bag.messages()]


# Messages.


def test_messages_are_recorded_with_their_publishers(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record()
    latched = origin("/map", "/map_server", latching=True)
    recording.put(1)
    recording.put(2, 1.5, origin(callerid="/other"))
    recording.put(3, 2.5, latched)
    recording.recorder.stop()
    with open_reader(tmp_path / "a.bag") as bag:
        found = [
            (each.topic, each.type, each.callerid, each.latching, time - START, data)
            for each, time, data in bag.messages()
        ]
    assert found == [
        ("/n", "std_msgs/Int32", "/talker", False, 0, number(1)),
        ("/n", "std_msgs/Int32", "/other", False, 1.5 * SECOND, number(2)),
        ("/map", "std_msgs/Int32", "/map_server", True, 2.5 * SECOND, number(3)),
    ]
    state = recording.recorder.state()
    assert (state.is_recording, state.messages, state.dropped, state.files) == (False, 3, 0, 1)


@pytest.mark.parametrize("suffix", [".bag", ".mcap"])
@pytest.mark.parametrize("compression", ["none", "lz4"])
def test_suffix_chooses_the_format(
    record: Callable[..., Recording], tmp_path: Path, suffix: str, compression: str
) -> None:
    path = tmp_path / f"b{suffix}"
    recording = record(path=str(path), compression=compression)
    for value in range(100):
        recording.put(value)
    recording.recorder.stop()
    assert values(path) == list(range(100))
    assert path.read_bytes()[:5] == (b"#ROSB" if suffix == ".bag" else b"\x89MCAP")


def test_limit_counts_the_messages_of_each_topic(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(limit=2)
    for value in range(5):
        recording.put(value, 0, origin(callerid=f"/talker{value}"))
    recording.put(9, 1, origin("/m"))
    assert recording.recorder.is_complete("/n")
    assert not recording.recorder.is_complete("/m")
    recording.recorder.stop()
    assert values(tmp_path / "a.bag") == [0, 1, 9]


# The disk.


class HangingDisk:
    """Opens bags whose writing waits while `hangs` is cleared."""

    def __init__(self) -> None:
        self.works = threading.Event()

    def open(self, *arguments: Any, **options: Any) -> BagWriter:
        works = self.works

        class Hanging(BagWriter):
            def write(self, *arguments: Any) -> None:
                assert works.wait(PATIENCE)
                super().write(*arguments)

        return Hanging(*arguments, **options)


def test_oldest_messages_are_dropped_and_counted_while_the_disk_hangs(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    disk = HangingDisk()
    size = 10 * (4 + MESSAGE_COST)
    recording = record(buffer_size=size, open_=disk.open)
    recording.put(0)
    recording.wait_until(lambda state: state.buffered == 0)  # The thread hangs with the first.
    for value in range(1, 101):
        recording.put(value)
    state = recording.recorder.state()
    assert state.dropped == 90
    assert state.buffered <= size
    disk.works.set()
    recording.recorder.stop()
    assert values(tmp_path / "a.bag") == [0, *range(91, 101)]
    assert recording.recorder.state().dropped == 90


@pytest.mark.parametrize("suffix", ["bag", "mcap"])
def test_state_does_not_wait_for_a_disk_that_hangs(
    record: Callable[..., Recording],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    suffix: str,
) -> None:
    hangs, works, has_answered = threading.Event(), threading.Event(), threading.Event()

    class Hanging(io.FileIO):
        def write(self, data: Any, /) -> int:
            hangs.set()
            assert works.wait(PATIENCE)
            return super().write(data)

    for module in ("bag_writer", "mcap_files"):
        monkeypatch.setattr(f"fibws.bags.{module}.open_to_write", lambda path: Hanging(path, "w+b"))
    recording = record(path=str(tmp_path / f"a.{suffix}"), chunk_size=100_000)
    recording.recorder.put(recording.recorder.stream(origin()), START, bytes(200_000))
    assert hangs.wait(PATIENCE)

    def ask() -> None:
        recording.recorder.state()
        has_answered.set()

    try:
        threading.Thread(target=ask, daemon=True).start()
        assert has_answered.wait(PATIENCE / 10)
    finally:
        works.set()
    recording.recorder.stop()
    size = (tmp_path / f"a.{suffix}").stat().st_size
    assert recording.recorder.state().bytes == size > 200_000


def test_size_of_compressed_files_only_grows(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(compression="bz2")
    recording.put(0)
    recording.wait_until(lambda state: state.messages == 1)
    for _ in range(2000):
        recording.put(0)
    before = recording.wait_until(lambda state: state.messages == 2001)
    recording.recorder.stop()
    size = (tmp_path / "a.bag").stat().st_size
    assert before.bytes <= recording.recorder.state().bytes == size


@pytest.mark.parametrize("has_room_for_index", [True, False])
def test_full_disk_ends_the_recording_and_is_reported(
    record: Callable[..., Recording],
    tmp_path: Path,
    caplog: pytest.LogCaptureFixture,
    *,
    has_room_for_index: bool,
) -> None:
    class Full(BagWriter):
        def flush(self) -> None:
            if self.chunks:
                raise OSError(28, "No space left on device")
            super().flush()

        def _write_end(self) -> None:
            if not has_room_for_index:
                raise OSError(28, "No space left on device")
            super()._write_end()

    recording = record(open_=Full, repeat_latched=True, split=True, max_size=2**20)
    recording.put(1)
    recording.wait_until(lambda state: state.messages == 1)
    while not (tmp_path / "a_0.bag.active").stat().st_size > 4200:
        recording.wait_until(lambda state: True)
    recording.put(2)
    assert recording.ended.wait(PATIENCE)
    recording.put(3)
    state = recording.recorder.state()
    assert not state.is_recording
    assert state.fault.startswith("No space left on device: cannot write")
    assert (state.messages, state.dropped) == (1, 1)
    if has_room_for_index:
        assert values(tmp_path / "a_0.bag") == [1]
        assert "a_0.bag' is complete" in caplog.text
        assert "reindex" not in caplog.text
    else:
        active = tmp_path / "a_0.bag.active"
        assert f"bag reindex --output-dir DIR {active}" in caplog.text
        assert reindex(active, tmp_path / "b.bag").messages == 1


@pytest.mark.parametrize("ends_by_stop", [True, False])
def test_index_that_does_not_fit_at_the_end_of_a_file_is_reported(
    record: Callable[..., Recording],
    tmp_path: Path,
    caplog: pytest.LogCaptureFixture,
    *,
    ends_by_stop: bool,
) -> None:
    class Full(BagWriter):
        def _write_end(self) -> None:
            raise OSError(28, "No space left on device")

    recording = record(open_=Full, split=True, max_size=5000)
    recording.put(1)
    recording.wait_until(lambda state: state.messages == 1)
    if ends_by_stop:
        recording.recorder.stop()
    else:
        while recording.recorder.state().is_recording:
            recording.put(2)
    assert recording.ended.wait(PATIENCE)
    active = tmp_path / "a_0.bag.active"
    assert f"bag reindex --output-dir DIR {active}" in caplog.text
    state = recording.recorder.state()
    assert reindex(active, tmp_path / "b.bag").messages == state.messages


@pytest.mark.parametrize("free", [0, 4096])
def test_recording_does_not_begin_on_a_full_disk(
    record: Callable[..., Recording], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, free: int
) -> None:
    usage = type("Usage", (), {"free": free})()
    monkeypatch.setattr("fibws.bag_recorder.shutil.disk_usage", lambda folder: usage)
    recording = record()
    assert recording.ended.wait(PATIENCE)
    assert recording.recorder.state().fault.startswith("No space left on device: ")
    assert not list(tmp_path.iterdir())


def test_file_that_cannot_be_begun_is_not_left(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    class Full(BagWriter):
        def _write_all(self, data: bytes | bytearray) -> None:
            raise OSError(28, "No space left on device")

    recording = record(open_=lambda path, **options: Full(str(path), **options))
    assert recording.ended.wait(PATIENCE)
    assert "No space left on device" in recording.recorder.state().fault
    assert not list(tmp_path.iterdir())


def test_disk_with_too_little_space_is_not_written_to(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(min_space=2**60)
    assert recording.ended.wait(PATIENCE)
    assert "--min-space" in recording.recorder.state().fault
    assert not list(tmp_path.iterdir())


def test_folder_that_cannot_be_created_ends_the_recording(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    recording = record(path=f"{tmp_path}/file/a.bag")
    assert recording.ended.wait(PATIENCE)
    assert "file/a.bag" in recording.recorder.state().fault


def test_recording_goes_on_when_the_disk_has_space_again(
    record: Callable[..., Recording], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.bag_recorder.DISK_INTERVAL", 0.0)
    free = [2**40]
    usage = type("Usage", (), {"free": property(lambda self: free[0])})()
    monkeypatch.setattr("fibws.bag_recorder.shutil.disk_usage", lambda folder: usage)
    recording = record(min_space=2**30)
    recording.put(1)
    recording.wait_until(lambda state: state.messages == 1)
    free[0] = 0
    recording.wait_until(lambda state: "space" in state.fault)
    recording.put(2)
    recording.wait_until(lambda state: state.dropped == 1)
    free[0] = 2**40
    recording.wait_until(lambda state: not state.fault)
    recording.put(3)
    recording.recorder.stop()
    assert values(tmp_path / "a.bag") == [1, 3]


def test_message_that_bags_cannot_hold_is_left_out(
    record: Callable[..., Recording], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    recording = record()
    recording.put(1)
    recording.put(2, 2**32)
    recording.put(3)
    recording.recorder.stop()
    assert values(tmp_path / "a.bag") == [1, 3]
    assert recording.recorder.state().dropped == 1
    assert "/n" in caplog.text


def test_publisher_that_bags_cannot_hold_is_left_out(
    record: Callable[..., Recording], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    def open_(path: Path, **options: Any) -> BagWriter:
        writer = BagWriter(str(path), **options)
        make = writer.connection

        def connection(topic: str, *arguments: Any, **fields: Any) -> Connection:
            if topic == "/odd":
                raise BagError("too many connections")
            return make(topic, *arguments, **fields)

        writer.connection = connection  # type: ignore[method-assign]
        return writer

    recording = record(open_=open_)
    recording.put(1)
    recording.put(2, 0, origin("/odd"))
    recording.put(3)
    recording.recorder.stop()
    assert values(tmp_path / "a.bag") == [1, 3]
    assert recording.recorder.state().dropped == 1
    assert "/odd is not recorded: too many connections" in caplog.text


def test_publisher_of_an_unknown_type_is_left_out(
    record: Callable[..., Recording], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    recording = record()
    recording.put(1, 0, Origin("/odd", "*", "*", "", "", latching=False))
    recording.put(2)
    recording.recorder.stop()
    assert values(tmp_path / "a.bag") == [2]
    assert "the type of /odd is unknown" in caplog.text


def test_file_of_a_crashed_recorder_is_not_overwritten(
    record: Callable[..., Recording], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "a.bag.active").write_bytes(b"left")
    recording = record()
    recording.put(1)
    recording.recorder.stop()
    assert values(tmp_path / "a.bag") == [1]
    [left] = tmp_path.glob("a.bag.*.active")
    assert left.read_bytes() == b"left"
    assert f"bag reindex {left}" in caplog.text


def test_repaired_file_of_a_crashed_recorder_is_kept_without_advice(
    record: Callable[..., Recording], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    open_writer(tmp_path / "a.bag.active").close()
    recording = record()
    recording.put(1)
    recording.recorder.stop()
    [left] = tmp_path.glob("a.bag.*.active")
    assert left.name in caplog.text and "reindex" not in caplog.text


@pytest.mark.parametrize("suffix", ["bag", "mcap"])
def test_file_that_another_recorder_writes_stays_its_own(
    record: Callable[..., Recording], tmp_path: Path, suffix: str
) -> None:
    path = tmp_path / f"a.{suffix}"
    first = record(path=str(path))
    first.put(1)
    first.wait_until(lambda state: state.messages == 1)
    second = record(path=str(path))
    assert second.ended.wait(PATIENCE)
    assert "being written by" in second.recorder.state().fault
    first.put(2)
    first.recorder.stop()
    assert values(path) == [1, 2]


# Simulated time.


@pytest.mark.parametrize("suffix", ["bag", "mcap"])
def test_nothing_is_recorded_before_simulated_time_begins(
    record: Callable[..., Recording], tmp_path: Path, caplog: pytest.LogCaptureFixture, suffix: str
) -> None:
    recording = record(path=str(tmp_path / f"a.{suffix}"), limit=3)
    recording.now = 0
    latched = origin("/map", "/map_server", latching=True)
    early = -START / SECOND
    for value, source in ((1, None), (2, latched), (3, None), (4, latched)):
        recording.put(value, early, source)
    while "before the first message of /clock" not in caplog.text:
        recording.wait_until(lambda state: True)
    recording.put(5, 7)
    recording.put(6, 8)
    recording.put(7, 9, latched)
    recording.recorder.stop()
    with open_reader(tmp_path / f"a.{suffix}") as bag:
        found = [
            (each.topic, (time - START) // SECOND, data[0]) for each, time, data in bag.messages()
        ]
    assert found == [("/map", 7, 4), ("/n", 7, 5), ("/n", 8, 6), ("/map", 9, 7)]
    assert recording.recorder.state().dropped == 0


def test_latched_messages_are_recorded_when_the_clock_begins_though_nothing_else_comes(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record()
    recording.now = 0
    recording.put(1, -START / SECOND, origin("/map", latching=True))
    recording.now = START + SECOND
    recording.wait_until(lambda state: state.messages == 1)
    recording.recorder.stop()
    with open_reader(tmp_path / "a.bag") as bag:
        assert bag.start == bag.end == START + SECOND


def test_room_for_latched_messages_before_simulated_time_is_bounded(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(buffer_size=MESSAGE_COST + 100)
    recording.now = 0
    for value in range(4):
        stream = recording.recorder.stream(origin(f"/map{value}", latching=True))
        recording.recorder.put(stream, 0, bytes(100))
        recording.wait_until(lambda state: not state.buffered)
    recording.now = START
    recording.recorder.stop()
    with open_reader(tmp_path / "a.bag") as bag:
        assert [each.topic for each, _, _ in bag.messages()] == ["/map2", "/map3"]
    assert recording.recorder.state().dropped == 2


# Files.


def test_file_is_active_until_it_is_complete(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record()
    recording.put(1)
    recording.wait_until(lambda state: state.messages == 1)
    assert [each.name for each in tmp_path.iterdir()] == ["a.bag.active"]
    recording.recorder.stop()
    assert [each.name for each in tmp_path.iterdir()] == ["a.bag"]
    assert recording.files == [tmp_path / "a.bag"]


def test_split_by_duration_begins_files_by_the_times_of_messages(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(split=True, max_duration=10 * SECOND)
    recording.wait_until(lambda state: state.files == 1)
    for value, seconds in enumerate((0, 9.9, 10.1, 45, 49)):
        recording.put(value, seconds)
    recording.recorder.stop()
    names = sorted(each.name for each in tmp_path.iterdir())
    assert names == ["a_0.bag", "a_1.bag", "a_2.bag"]
    assert [values(tmp_path / name) for name in names] == [[0, 1], [2], [3, 4]]


def test_split_by_duration_follows_a_clock_that_is_set(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(split=True, max_duration=SECOND)
    recording.wait_until(lambda state: state.files == 1)
    for value, seconds in enumerate((0, -1e9, 0.5 - 1e9, 1.5 - 1e9, 1e9 - 0.5, 1e9)):
        recording.put(value, seconds)
    recording.recorder.stop()
    names = [f"a_{number}.bag" for number in range(3)]
    assert sorted(each.name for each in tmp_path.iterdir()) == names
    assert [values(tmp_path / name) for name in names] == [[1, 2, 0], [3], [4, 5]]


def test_split_by_publishers_bounds_them_in_each_file(
    record: Callable[..., Recording], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.bag_recorder.MAX_CONNECTIONS", 2)
    recording = record(split=True)
    for value in range(4):
        recording.put(value, 0, origin(callerid=f"/talker_{value}"))
        count = 1 + (value + 1) // 2
        recording.wait_until(lambda state, count=count: state.files == count)  # type: ignore[misc]
    recording.recorder.stop()
    assert [values(tmp_path / f"a_{number}.bag") for number in range(3)] == [[0, 1], [2, 3], []]


def test_split_by_size_keeps_the_newest_files(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(split=True, max_size=6000, chunk_size=500, max_splits=2)
    for value in range(300):
        recording.put(value)
    recording.recorder.stop()
    names = sorted((each.name for each in tmp_path.iterdir()), key=lambda name: int(name[2:-4]))
    assert len(names) == 2
    assert recording.recorder.state().files > 2
    assert [each for name in names for each in values(tmp_path / name)][-1] == 299


def test_latched_messages_are_repeated_in_each_file(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(split=True, max_duration=10 * SECOND, repeat_latched=True)
    recording.wait_until(lambda state: state.files == 1)
    latched = origin("/map", latching=True)
    recording.put(100, 1, latched)
    recording.put(101, 2, latched)
    recording.put(1, 3)
    recording.put(2, 11)
    recording.recorder.stop()
    assert values(tmp_path / "a_0.bag") == [100, 101, 1]
    assert values(tmp_path / "a_1.bag") == [101, 2]


@pytest.mark.parametrize("suffix", ["bag", "mcap"])
def test_repeated_messages_are_in_the_file_before_another_message_comes(
    record: Callable[..., Recording], tmp_path: Path, suffix: str
) -> None:
    path = str(tmp_path / f"a.{suffix}")
    recording = record(path=path, split=True, max_size=1, repeat_latched=True)
    recording.put(1, source=origin("/map", latching=True))
    recording.wait_until(lambda state: state.files == 2)
    active, copy = tmp_path / f"a_1.{suffix}.active", tmp_path / f"copy.{suffix}"
    deadline = time.monotonic() + PATIENCE
    while True:  # As after a kill.
        copy.write_bytes(active.read_bytes())
        with open_reader(copy, allow_unindexed=True) as bag:
            if [each[0].topic for each in bag.messages()] == ["/map"]:
                break
        assert time.monotonic() < deadline


@pytest.mark.long
def test_oldest_latched_messages_are_not_repeated_if_there_is_no_room(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    size = 2 * (4 + MESSAGE_COST)
    recording = record(split=True, max_duration=10 * SECOND, repeat_latched=True, buffer_size=size)
    recording.wait_until(lambda state: state.files == 1)
    latched = [origin(f"/{number}", latching=True) for number in range(100)]
    for value, each in enumerate([*latched, latched[50]]):
        recording.put(value, 1, each)
        recording.wait_until(lambda state: state.buffered == 0)
    recording.put(1000, 11)
    recording.recorder.stop()
    most = size // 4
    expected = [each for each in range(101 - most - 1, 101) if each != 50]
    assert values(tmp_path / "a_1.bag") == [*expected[-most:], 1000]


def test_latched_message_is_not_repeated_after_its_publisher_is_forgotten(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(split=True, max_duration=10 * SECOND, repeat_latched=True)
    recording.wait_until(lambda state: state.files == 1)
    latched = origin("/map", latching=True)
    recording.put(100, 1, latched)
    recording.recorder.forget(recording.recorder.stream(latched))
    recording.put(101, 1, latched)
    recording.wait_until(lambda state: state.messages == 2)
    recording.recorder.forget(recording.recorder.stream(latched))
    assert not recording.recorder._streams
    recorder = recording.recorder
    recording.wait_until(lambda _: not (recorder._latched or recorder._forgotten))
    recording.put(1, 11)
    recording.recorder.stop()
    assert values(tmp_path / "a_0.bag") == [100, 101]
    assert values(tmp_path / "a_1.bag") == [1]


@pytest.mark.parametrize("limits", [{"max_size": 5000}, {"max_duration": SECOND}])
def test_recording_ends_by_itself_at_its_limit(
    record: Callable[..., Recording], tmp_path: Path, limits: dict[str, int]
) -> None:
    recording = record(**limits)
    recording.wait_until(lambda state: state.files == 1)
    for value in range(200):
        recording.put(value, value / 10)
    assert recording.ended.wait(PATIENCE)
    found = values(tmp_path / "a.bag")
    assert found == list(range(len(found)))
    assert 10 <= len(found) < 200


def test_duration_ends_without_messages(record: Callable[..., Recording], tmp_path: Path) -> None:
    recording = record(max_duration=SECOND)
    recording.wait_until(lambda state: state.files == 1)
    recording.now += 2 * SECOND
    assert recording.ended.wait(PATIENCE)
    assert values(tmp_path / "a.bag") == []


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"path": "walk", "dated": False}, "walk.bag"),
        ({"path": "walk.bag", "dated": False}, "walk.bag"),
        ({"path": "walk.mcap", "dated": False, "split": True}, "walk_3.mcap"),
        ({"path": ""}, "{date}.bag"),
        ({"path": "/data/walk.bag"}, "/data/walk_{date}.bag"),
        ({"path": "/data/", "split": True}, "/data/{date}_3.bag"),
        ({"path": "/data/.mcap"}, "/data/{date}.mcap"),
    ],
)
def test_names_are_those_of_rosbag(options: dict[str, Any], name: str) -> None:
    date = time.strftime("%Y-%m-%d-%H-%M-%S", time.localtime(1_700_000_000))
    assert RecordingOptions(**options).file(3, 1_700_000_000) == Path(name.format(date=date))


def test_recordings_of_one_second_have_different_names(
    record: Callable[..., Recording], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.bag_recorder.time.time", lambda: 1_700_000_000.0)
    for _ in range(2):
        recording = record(path=f"{tmp_path}/", dated=True)
        recording.recorder.stop()
    assert len(list(tmp_path.iterdir())) == 2


def test_sizes_are_written_with_units() -> None:
    assert [size_text(each) for each in (512, 2048, 1.5 * 2**20, 2**30)] == [
        *("512", "2k", "1.5M", "1G")
    ]


# Crashes.

CRASHING = """
import logging, sys, time
from fibws.bag_recorder import Origin, Recorder, RecordingOptions

options = RecordingOptions(path=sys.argv[1], dated=False, min_space=0, compression=sys.argv[2])
recorder = Recorder(options, time.time_ns, logging.getLogger())
recorder.start()
stream = recorder.stream(Origin("/n", "std_msgs/Int32", "*", "int32 data", "/n", False))
while True:
    now = time.time_ns()
    recorder.put(stream, now, bytes(4))
    sys.stdout.write(f"{now}\\n")
    sys.stdout.flush()
    time.sleep(0.0005)
"""


def test_signal_that_ends_the_process_at_once_leaves_advice(tmp_path: Path) -> None:
    program = f"""
import logging, signal, sys, threading, time
from fibws.bag_recorder import Recorder, RecordingOptions
from fibws.exit_signals import end_at_once

begun = threading.Event()
options = RecordingOptions(path={str(tmp_path / "a.bag")!r}, dated=False, min_space=0)
recorder = Recorder(
    options, time.time_ns, logging.getLogger(), on_file=lambda path: begun.set()
)
recorder.start()
begun.wait()
end_at_once(signal.SIGINT)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == -signal.SIGINT
    active = tmp_path / "a.bag.active"
    text = f"{active} was not completed. To restore it: fibws bag reindex {active}\n"
    assert done.stderr == text


@pytest.mark.slow  # It measures seconds of another process, which a busy machine lengthens.
@pytest.mark.parametrize("compression", ["none", "bz2"])
def test_kill_loses_at_most_the_last_second(tmp_path: Path, compression: str) -> None:
    path = tmp_path / "a.bag"
    words = (sys.executable, "-c", CRASHING, str(path), compression)
    with subprocess.Popen(words, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        put = [int(process.stdout.readline())]
        while put[-1] - put[0] < 1.4 * SECOND:
            put.append(int(process.stdout.readline()))
        process.send_signal(signal.SIGKILL)
        put += map(int, process.stdout.read().splitlines())
    active = path.with_name("a.bag.active")
    reindex(active, path)
    with open_reader(path) as bag:
        found = [time for _, time, _ in bag.messages()]
    assert found == put[: len(found)]
    assert put[-1] - found[-1] < SECOND
