"""Reading and writing of bags: what is written is read, in the order of time."""

from __future__ import annotations

import re
import subprocess
import sys
import tracemalloc
from pathlib import Path
from time import process_time
from typing import Any

import pytest

from fibws.bags import (
    Connection,
    Reader,
    Writer,
    open_reader,
    open_writer,
    reader,
    reindex,
    summary,
)
from fibws.bags.bag_writer import BagWriter
from fibws.bags.mcap_files import McapWriter
from fibws.errors import BagError, BagFormatError, BagNotIndexed, UnsupportedBag

SECOND = 1_000_000_000
FORMATS = [("bag", "none"), ("bag", "bz2"), ("bag", "lz4")]
FORMATS += [("mcap", "none"), ("mcap", "lz4"), ("mcap", "zstd")]
every_format = pytest.mark.parametrize(("suffix", "compression"), FORMATS)
each_suffix = pytest.mark.parametrize("suffix", ["bag", "mcap"])

INT32 = ("std_msgs/Int32", "da5909fbe378aeaf85e547e830cc1bb7", "int32 data")


def add(writer: Writer, topic: str, callerid: str = "", *, latching: bool = False) -> Connection:
    return writer.connection(topic, *INT32, callerid=callerid, latching=latching)


def contents(bag: Reader) -> list[tuple[str, str, str, str, bool, int, bytes]]:
    return [
        (each.topic, each.type, each.md5sum, each.callerid, each.latching, time, data)
        for each, time, data in bag.messages()
    ]


def write_numbers(path: Path, compression: str = "none", *, count: int = 1000) -> None:
    """Write numbers of two publishers, one of them latching, in chunks of a few hundred."""
    with open_writer(path, compression, 10_000) as writer:
        publishers = [add(writer, "/a", "/talker"), add(writer, "/b", "/map", latching=True)]
        for number in range(count):
            time = number * SECOND // 10
            writer.write(publishers[number % 2], time, number.to_bytes(4, "little"))


def test_compression_of_many_chunks_is_found_in_little_time(tmp_path: Path) -> None:
    path = tmp_path / "it.bag"
    write_numbers(path, "bz2", count=10)
    with open_reader(path) as bag:
        bag.chunks *= 20_000
        begin = process_time()
        assert bag.compression == "bz2"
    assert process_time() - begin < 1


@every_format
def test_written_messages_are_read(tmp_path: Path, suffix: str, compression: str) -> None:
    path = tmp_path / f"it.{suffix}"
    write_numbers(path, compression)
    with open_reader(path) as bag:
        publishers = [("/a", *INT32[:2], "/talker", False), ("/b", *INT32[:2], "/map", True)]
        assert contents(bag) == [
            (*publishers[number % 2], number * SECOND // 10, number.to_bytes(4, "little"))
            for number in range(1000)
        ]
        assert [each.definition for each in bag.connections] == ["int32 data"] * 2
        assert bag.message_count == 1000
        assert (bag.start, bag.end) == (0, 999 * SECOND // 10)
        assert bag.compression == compression
        assert len(bag.chunks) > 3
        assert bag.size == path.stat().st_size


@each_suffix
def test_topics_and_times_select_messages(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"it.{suffix}"
    write_numbers(path)
    with open_reader(path) as bag:
        found = list(bag.messages({"/b"}, 40 * SECOND, 50 * SECOND))
        assert [time for _, time, _ in found] == [
            number * SECOND // 10 for number in range(401, 501, 2)
        ]
        assert {connection.topic for connection, _, _ in found} == {"/b"}
        assert not list(bag.messages({"/c"}))
        assert not list(bag.messages(start=101 * SECOND))


@each_suffix
def test_overlapping_chunks_are_read_in_order(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"it.{suffix}"
    with open_writer(path, chunk_size=5000) as writer:
        publisher = add(writer, "/a")
        # Each of the five rounds goes from the start to the end, and some go backwards.
        for round_ in range(5):
            numbers = range(round_, 1000, 5)
            for number in reversed(numbers) if round_ % 2 else numbers:
                writer.write(publisher, number, number.to_bytes(4, "little"))
    for limit in (reader.MAX_MEMORY, 12_000):  # In memory, and with a temporary file.
        monkeypatch.setattr(reader, "MAX_MEMORY", limit)
        with open_reader(path) as bag:
            found = [(time, int.from_bytes(data, "little")) for _, time, data in bag.messages()]
            assert found == [(number, number) for number in range(1000)]
            half = [time for _, time, _ in bag.messages(start=500, end=600)]
            assert half == list(range(500, 601))


@each_suffix
def test_large_bag_is_read_in_little_memory(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"it.{suffix}"
    with open_writer(path, chunk_size=100_000) as writer:
        publisher = add(writer, "/a")
        for number in range(400):
            writer.write(publisher, number, bytes(100_000))
    with open_reader(path) as bag:
        tracemalloc.start()
        try:
            assert sum(len(data) for _, _, data in bag.messages()) == 40_000_000
            assert tracemalloc.get_traced_memory()[1] < 2_000_000
        finally:
            tracemalloc.stop()


@each_suffix
def test_empty_bag(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"it.{suffix}"
    open_writer(path).close()
    with open_reader(path) as bag:
        assert (bag.message_count, bag.start, bag.end) == (0, 0, 0)
        assert bag.compression == "none"
        assert not list(bag.messages())


@each_suffix
def test_flushed_messages_can_be_read_before_the_bag_is_closed(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"it.{suffix}"
    writer = open_writer(path)
    publisher = add(writer, "/a")
    writer.write(publisher, 1, b"one.")
    writer.flush()
    writer.write(publisher, 2, b"two.")
    with pytest.raises(BagNotIndexed, match="being written by"):
        open_reader(path)
    with open_reader(path, allow_unindexed=True) as bag:
        assert not bag.is_indexed
        assert [data for _, _, data in bag.messages()] == [b"one."]
    assert writer.size >= path.stat().st_size - 100
    writer.close()
    writer.close()
    with open_reader(path) as bag:
        assert bag.is_indexed
        assert [data for _, _, data in bag.messages()] == [b"one.", b"two."]


@each_suffix
@pytest.mark.parametrize("is_closed", [True, False])
def test_type_that_the_recorder_did_not_know_is_taken_from_another_publisher(
    tmp_path: Path, suffix: str, is_closed: bool
) -> None:
    path, restored = tmp_path / f"it.{suffix}", tmp_path / f"new.{suffix}"
    writer = open_writer(path)
    unknown = [writer.connection(topic, "*", "*", "") for topic in ("/a", "/b", "/c")]
    writer.write(unknown[0], 1, bytes(4))
    writer.flush()
    writer.write(add(writer, "/a", "/talker"), 2, bytes(4))
    writer.write(writer.connection("/b", "std_msgs/UInt32", "0" * 32, "uint32 data"), 3, bytes(4))
    writer.write(add(writer, "/b"), 4, bytes(4))
    for each in unknown[1:]:
        writer.write(each, 5, bytes(4))
    if is_closed:
        writer.close()
    else:
        writer.flush()
    reindex(path, restored)
    for each_path in (path, restored):
        with open_reader(each_path, allow_unindexed=True) as bag:
            assert [(each[0], each[1], each[2]) for each in contents(bag)] == [
                ("/a", *INT32[:2]),
                ("/a", *INT32[:2]),
                ("/b", "std_msgs/UInt32", "0" * 32),
                ("/b", *INT32[:2]),
                ("/b", "*", "*"),  # It may be either.
                ("/c", "*", "*"),
            ]
            definitions = {each.definition for each in bag.connections if each.topic == "/a"}
            assert definitions == {INT32[2]}
    writer.close()


def wrong_bag(path: Path, kind: str) -> None:
    writer = BagWriter(str(path))
    connections = [add(writer, "/a"), add(writer, "/b")]
    for number in range(4):
        writer.write(connections[number % 2], (number + 1) * SECOND, bytes(4))
        if number == 1:
            if kind == "places":
                writer._indexes[0].entries[8:12] = bytes(4)
            writer.flush()
    writer.flush()
    chunk = writer.chunks[0]
    match kind:
        case "counts":
            chunk.counts[1] += 1
        case "connections":
            writer.connections.pop()
        case "times":
            chunk.start -= 1
        case "chunks":
            writer.chunks.pop()
    writer.close()


def wrong_mcap(path: Path, kind: str) -> None:
    writer = McapWriter(str(path))
    connections = [add(writer, "/a"), add(writer, "/b")]
    for number in range(4):
        writer.write(connections[number % 2], (number + 1) * SECOND, bytes(4))
        if number == 1:
            if kind == "places":
                indices = writer.mcap._Writer__chunk_builder.message_indices  # type: ignore[attr-defined]
                indices[connections[0].id].records[0] = (SECOND, 0)
            writer.flush()
    writer.flush()
    mcap: Any = writer.mcap
    match kind:
        case "counts":
            mcap._Writer__statistics.channel_message_counts[connections[1].id] += 1
        case "connections":
            del mcap._Writer__channels[connections[1].id]
        case "times":
            mcap._Writer__chunk_indices[0].message_start_time -= 1
        case "chunks":
            mcap._Writer__chunk_indices.pop()
    writer.close()


@each_suffix
@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("none", None),
        ("counts", "has [12] messages"),
        ("connections", "does not list"),
        ("times", "other times of its first and last message"),
        ("places", "other times or places"),
        ("chunks", "the index does not list it"),
    ],
)
def test_index_that_does_not_agree_with_the_file_is_found(
    tmp_path: Path, suffix: str, kind: str, text: str | None
) -> None:
    path = tmp_path / f"it.{suffix}"
    (wrong_bag if suffix == "bag" else wrong_mcap)(path, kind)
    with open_reader(path) as bag:
        faults = list(bag.faults())
    if text is None:
        assert faults == []
    else:
        assert any(re.search(text, each) for each in faults), faults


@each_suffix
def test_implausible_times_are_found(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"it.{suffix}"
    with open_writer(path) as writer:
        connection = add(writer, "/a")
        for seconds in (0, 0, 1, 2, 1_700_000_000):
            writer.write(connection, seconds * SECOND, bytes(4))
    with open_reader(path) as bag:
        assert list(bag.faults()) == [
            "the message of /a at 1700000000.000 s is 53.9 years later than the one before",
            "/a has messages with the time 0: 2",
        ]


@each_suffix
def test_missing_types_are_found(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"it.{suffix}"
    with open_writer(path) as writer:
        writer.write(writer.connection("/a", "*", "*", ""), SECOND, bytes(4))
        writer.write(add(writer, "/a"), SECOND, bytes(4))
    for each_path, count in ((path, 1), (tmp_path / f"new.{suffix}", 0)):
        with open_reader(each_path) as bag:
            assert len([each for each in bag.faults() if "/a has no type" in each]) == count
        reindex(path, tmp_path / f"new.{suffix}") if count else None


@each_suffix
def test_writer_rejects_what_bags_cannot_hold(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"it.{suffix}"
    with pytest.raises(BagError, match="zip"):
        open_writer(path, "zip")
    with open_writer(path) as writer:
        publisher = add(writer, "/a")
        writer.write(publisher, 1, b"good")
        for time in (-1, 2**64):
            with pytest.raises(BagError, match="1970"):
                writer.write(publisher, time, b"bad.")
        writer.write(publisher, 2, b"good")
    with pytest.raises(BagError, match="closed"):
        writer.write(publisher, 3, b"late")
    with open_reader(path) as bag:
        assert [data for _, _, data in bag.messages()] == [b"good", b"good"]


def test_other_encodings_are_listed_and_copied(tmp_path: Path) -> None:
    path, copy = tmp_path / "it.mcap", tmp_path / "copy.mcap"
    with McapWriter(str(path), profile="ros2") as writer:
        type_ = "nav_msgs/msg/Odometry"
        odometry = writer.connection(
            *("/odom", type_, "", "..."), encoding="cdr", definition_format="ros2msg"
        )
        writer.write(odometry, 5, b"cdr.")
    with open_reader(path) as bag:
        [connection] = bag.connections
        assert (connection.type, connection.md5sum) == ("nav_msgs/msg/Odometry", "")
        assert "types:       nav_msgs/msg/Odometry\n" in summary.text(bag, None)
        with open_writer(copy) as other:
            other.write(other.copy_connection(connection), 5, b"cdr.")
        with open_writer(tmp_path / "it.bag") as bag_writer, pytest.raises(BagError, match="cdr"):
            bag_writer.copy_connection(connection)
    with open_reader(copy) as bag:
        assert bag.connections == [connection]


def test_md5sum_that_is_missing_is_computed(tmp_path: Path) -> None:
    path = tmp_path / "it.mcap"
    with McapWriter(str(path)) as writer:
        for topic, definition in (("/a", "int32 data"), ("/b", "no definition at all")):
            number = writer.connection(topic, "std_msgs/Int32", "", definition)
            writer.write(number, 5, b"1234")
    with open_reader(path) as bag:
        assert [each.md5sum for each in bag.connections] == [INT32[1], "*"]


@pytest.mark.parametrize(
    ("content", "error", "fault"),
    [
        (b"", BagFormatError, "empty"),
        (b"hello\n", BagFormatError, "not a bag"),
        (b"#ROSBAG V1.2\nmore", UnsupportedBag, "1.2"),
        (b"#ROSBAG V2.0\n", BagFormatError, "ends at byte 13"),
        (b"#ROSBAG V2.0\n\xff\xff\xff\xffmore", BagFormatError, "header of 4294967295 bytes"),
        (b"#ROSBAG V2.0\n\xff\xff\0\0more", BagFormatError, "ends at byte 21"),
        (b"\x89MCAP0\r\n", BagNotIndexed, "end"),
    ],
)
def test_other_files_are_rejected(
    tmp_path: Path, content: bytes, error: type[BagError], fault: str
) -> None:
    path = tmp_path / "it.bag"
    path.write_bytes(content)
    with pytest.raises(error, match=fault) as caught:
        open_reader(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_file_is_reported_by_name(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"missing\.bag"):
        open_reader(tmp_path / "missing.bag")


@pytest.mark.parametrize(
    ("name", "module", "extra"),
    [("lz4.bag", "lz4.frame", "bags"), ("none.mcap", "mcap", "mcap")],
)
def test_missing_package_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, module: str, extra: str
) -> None:
    path = tmp_path / name
    write_numbers(path, path.stem)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(UnsupportedBag, match=rf"pip install 'fibws\[{extra}\]'"):
        open_writer(tmp_path / f"other{path.suffix}", path.stem)
    assert not (tmp_path / f"other{path.suffix}").exists()
    with pytest.raises(UnsupportedBag, match=extra):
        with open_reader(path) as bag:
            list(bag.messages())


def test_encrypted_bag_is_rejected(tmp_path: Path) -> None:
    path = tmp_path / "it.bag"
    write_numbers(path)
    content = path.read_bytes()
    field = b"\x20\0\0\0encryptor=rosbag/AesCbcEncryptor"
    size = int.from_bytes(content[13:17], "little")
    header = (size + len(field)).to_bytes(4, "little") + content[17 : 17 + size] + field
    path.write_bytes(content[:13] + header + content[17 + size :])
    with pytest.raises(UnsupportedBag, match="AesCbcEncryptor"):
        open_reader(path)


FULL_DISK = """
import resource, signal, sys
from fibws.bags import open_writer

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
writer = open_writer(sys.argv[1], chunk_size=5000)
publisher = writer.connection("/a", "std_msgs/Int32", "?", "int32 data")
try:
    for number in range(1000):
        writer.write(publisher, number, bytes(100))
except OSError as error:
    print(error.strerror)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs limits of a file's size")
def test_disk_that_is_full_leaves_the_chunks_before(tmp_path: Path) -> None:
    path = tmp_path / "it.bag"
    words = [sys.executable, "-c", FULL_DISK, str(path)]
    assert subprocess.run(words, check=True, capture_output=True, text=True).stdout
    with open_reader(path, allow_unindexed=True) as bag:
        times = [time for _, time, _ in bag.messages()]
        assert times == list(range(len(times)))
        assert len(times) > 50
        assert bag.size < 20_000
