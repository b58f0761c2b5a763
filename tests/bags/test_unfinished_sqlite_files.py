"""SQLite files of ROS 2 that their recorder has not closed, or not filled."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TypeAlias

import pytest
from click.testing import CliRunner
from patience import PATIENCE

from fibws.bags import open_reader
from fibws.cli.commands import command
from fibws.errors import BagError, BagFormatError

from . import ros2_recordings

ADD = """
import sqlite3, sys
path, mode = sys.argv[1:]
database = sqlite3.connect(path, isolation_level=None)
database.execute(f"PRAGMA journal_mode = {mode}")
database.execute("PRAGMA cache_size = 1")  # It writes pages before it commits.
database.execute("BEGIN")
copied = "SELECT topic_id, timestamp + 3000000000, data FROM messages WHERE id <= ?"
database.execute(f"INSERT INTO messages(topic_id, timestamp, data) {copied}", (50,))
if mode == "WAL":
    database.execute("COMMIT")
print("written", flush=True)
sys.stdin.read()
"""
"""Adds 50 messages to 100; those of a rollback journal are not committed."""
Content: TypeAlias = dict[str, bytes]


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The content of a file with 100 messages."""
    folder = tmp_path_factory.mktemp("recording") / "walk"
    ros2_recordings.write(folder, ros2_recordings.KINDS["sqlite3-none"])
    return (folder / "walk.db3").read_bytes()


@pytest.fixture
def path(tmp_path: Path, recording: bytes) -> Path:
    """A file with 100 messages, in a folder without metadata.yaml."""
    path = tmp_path / "walk" / "walk.db3"
    path.parent.mkdir()
    path.write_bytes(recording)
    return path


@contextmanager
def recorder(path: Path, mode: str = "WAL") -> Iterator[subprocess.Popen[str]]:
    """A program that writes a file until the end of the block, where it is killed."""
    with subprocess.Popen(
        [sys.executable, "-c", ADD, str(path), mode],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "written\n"
        try:
            yield process
        finally:
            process.kill()
            process.wait(PATIENCE)


def content(folder: Path) -> Content:
    """Return the files of a folder, without the memory that programs share."""
    return {
        each.name: each.read_bytes() for each in folder.iterdir() if not each.name.endswith("-shm")
    }


def count(path: Path) -> int:
    with open_reader(path) as reader:
        assert list(reader.faults()) == []
        return reader.message_count


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no /proc/locks")
def test_file_that_is_being_written_is_read_as_of_now(path: Path) -> None:
    with recorder(path) as process:
        before = content(path.parent)
        with open_reader(path) as reader:
            assert reader.message_count == 150
            [notice] = reader.notices
            assert str(path) in notice
            if sys.platform == "linux":
                assert f"is open in process {process.pid} " in notice
        assert content(path.parent) == before
        # It writes on, and its end leaves nothing beside the file.
        _, _ = process.communicate("", timeout=PATIENCE)
        assert process.returncode == 0
    assert list(content(path.parent)) == [path.name]
    with open_reader(path) as reader:
        assert reader.notices == ()
        assert reader.message_count == 150


@pytest.mark.parametrize(
    ("mode", "expected", "has_memory"),
    [("WAL", 150, True), ("WAL", 150, False), ("DELETE", 100, False)],
)
def test_file_of_a_killed_recorder_is_read_and_left_as_it_is(
    path: Path, mode: str, expected: int, has_memory: bool
) -> None:
    with recorder(path, mode):
        pass
    if not has_memory:
        path.with_name(f"{path.name}-shm").unlink(missing_ok=True)
    before, names = content(path.parent), sorted(os.listdir(path.parent))
    assert len(before) == 2
    with open_reader(path) as reader:
        assert list(reader.faults()) == []
        assert reader.message_count == expected
        [notice] = reader.notices
        assert str(path) in notice and "was not closed" in notice
        assert ("-wal" if mode == "WAL" else "-journal") in notice
    assert content(path.parent) == before
    assert sorted(os.listdir(path.parent)) == names


def test_folder_of_a_killed_recorder_tells_of_each_file(path: Path) -> None:
    with recorder(path):
        pass
    path.with_name("other.db3").write_bytes(path.read_bytes())
    with open_reader(path.parent) as reader:
        assert reader.message_count == 250
        assert [str(path) in each for each in reader.notices] == [True]


@pytest.mark.parametrize(
    "words",
    [
        ("bag", "info", "{path}"),
        ("bag", "check", "{path}"),
        ("bag", "filter", "{path}", "{path}.bag", "True"),
        ("bag", "play", "--hub", "ws://127.0.0.1:9", "{path}", "--topics", "/none"),
        ("topic", "echo", "-b", "{path}", "-n", "1", "/number"),
    ],
)
def test_commands_say_that_a_file_was_not_closed(path: Path, words: tuple[str, ...]) -> None:
    with recorder(path):
        pass
    result = CliRunner().invoke(command, [each.format(path=path) for each in words])
    assert result.exit_code == (2 if "/none" in words else 0), result.output
    assert f"Warning: {path}" in result.output and "walk.db3-wal" in result.output
    if "filter" in words:
        assert count(path.with_name(f"{path.name}.bag")) == 150


@pytest.mark.parametrize(
    ("damage", "fault"),
    [
        (lambda data: b"", "is empty"),
        (lambda data: data[:10], "not a database"),
        (lambda data: b"x" * len(data), "not a database"),
        (lambda data: data[: len(data) // 2], "malformed"),
        (lambda data: data[:100] + bytes(len(data) - 100), "malformed"),
    ],
)
def test_damaged_file_is_an_error_that_says_why(path: Path, damage: object, fault: str) -> None:
    assert callable(damage)
    path.write_bytes(damage(path.read_bytes()))
    for place in (path, path.parent):
        with (
            pytest.raises(BagFormatError, match=fault) as caught,
            open_reader(place) as reader,
        ):
            list(reader.messages())
        assert str(path) in str(caught.value)


@pytest.mark.parametrize("name", ["a.bag", "a.mcap", "a.db3", "a"])
def test_empty_file_is_an_error_that_says_so(tmp_path: Path, name: str) -> None:
    (tmp_path / name).touch()
    with pytest.raises(BagError, match=f"{name}: the file is empty"):
        open_reader(tmp_path / name)


def test_message_that_is_larger_than_the_file_so_far_is_read(path: Path) -> None:
    """All of it is in the WAL."""
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA wal_autocheckpoint = 0")
        database.execute("UPDATE messages SET data = zeroblob(1500000) WHERE id = 1")
        files = content(path.parent)
    for name, data in files.items():
        path.with_name(name).write_bytes(data)
    assert path.stat().st_size < 2**20
    with open_reader(path) as reader:
        assert max(len(data) for _, _, data in reader.messages()) == 1_500_000


MEMORY_RECORDER = """
import sqlite3, sys
database = sqlite3.connect(sys.argv[1], isolation_level=None, timeout=0)
database.execute("PRAGMA journal_mode = MEMORY")
database.execute("PRAGMA synchronous = OFF")
database.execute("PRAGMA cache_size = 1")  # It writes pages before it commits.
copied = "SELECT topic_id, timestamp + 3000000000, data FROM messages WHERE id <= 50"
for line in sys.stdin:
    if line == "add\\n":
        database.execute("BEGIN")
        database.execute(f"INSERT INTO messages(topic_id, timestamp, data) {copied}")
        database.execute(f"INSERT INTO messages(topic_id, timestamp, data) {copied}")
    else:
        database.execute("COMMIT")
    print("done", flush=True)
"""
"""Adds 100 messages, as rosbag2's recorder does by default: without a journal on the disk."""


class MemoryRecorder:
    """A program that writes a file with its journal in memory."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def do(self, word: str) -> None:
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(f"{word}\n")
        self._process.stdin.flush()
        assert self._process.stdout.readline() == "done\n"


@pytest.fixture
def memory_recorder(path: Path) -> Iterator[MemoryRecorder]:
    with subprocess.Popen(
        [sys.executable, "-c", MEMORY_RECORDER, str(path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            yield MemoryRecorder(process)
        finally:
            process.kill()


@pytest.mark.skipif(sys.platform != "linux", reason="needs /proc/locks")
def test_changes_that_are_not_complete_are_waited_for(
    path: Path, memory_recorder: MemoryRecorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    memory_recorder.do("add")
    monkeypatch.setattr("fibws.files.sleep", lambda seconds: memory_recorder.do("commit"))
    with open_reader(path) as reader:
        assert list(reader.faults()) == []
        assert reader.message_count == 200
        [notice] = reader.notices
        assert str(path) in notice
    assert list(content(path.parent)) == [path.name]


@pytest.mark.skipif(sys.platform != "linux", reason="needs /proc/locks")
def test_file_that_is_changed_for_long_is_an_error(
    path: Path, memory_recorder: MemoryRecorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    memory_recorder.do("add")
    monkeypatch.setattr("fibws.files.sleep", lambda seconds: None)
    with pytest.raises(BagError, match=rf"{path} is being written"):
        open_reader(path)
    memory_recorder.do("commit")  # It was never disturbed.
    assert count(path) == 200


def test_file_that_changes_while_it_is_read_has_the_messages_from_before(
    path: Path, memory_recorder: MemoryRecorder
) -> None:
    with open_reader(path) as reader:
        before = [data for _, _, data in reader.messages()]
        messages = reader.messages()
        for _ in range(3):
            memory_recorder.do("add")
            memory_recorder.do("commit")
        assert [data for _, _, data in messages] == before
        assert list(reader.faults()) == []
        assert reader.message_count == len(before) == 100
    assert count(path) == 400
    assert list(content(path.parent)) == [path.name]
