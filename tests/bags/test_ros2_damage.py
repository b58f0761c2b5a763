"""Recordings of ROS 2 that are damaged, or made to do harm."""

from __future__ import annotations

import sqlite3
import tracemalloc
from contextlib import closing
from pathlib import Path

import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st
from random_inputs import examples
from work import executed_lines

from fibws.bags import compression, open_reader, rosbag2
from fibws.bags.connection import Connection
from fibws.bags.mcap_files import McapWriter
from fibws.bags.ros2_messages import as_ros1, as_ros2, with_encoding
from fibws.errors import BagError, BagFormatError, InvalidMessage

from . import ros2_recordings

HEAD = b"\0\1\0\0"
LARGE = 5_000_000
"""More memory, in bytes, than anything here may need."""


def connection(
    definition: str, type_: str = "my_msgs/msg/It", format_: str = "ros2msg"
) -> Connection:
    fields = {"message_definition": definition.encode()}
    return Connection(1, "/it", type_, "", definition, "", False, fields, "cdr", format_)


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Recordings of each kind."""
    found = {}
    for name, kind in ros2_recordings.KINDS.items():
        found[name] = tmp_path_factory.mktemp("bags") / "walk"
        ros2_recordings.write(found[name], kind, end=8)
    return found


@pytest.mark.parametrize(
    ("each", "fault"),
    [
        (connection("wstring text"), "wstring"),
        (connection("Nothing it"), "unknown type Nothing"),
        (connection("It it"), "contains itself"),
        (connection("string[0] it"), "without bytes"),
        (connection("?"), "expected a field"),
        (connection("int32 a", "5"), "5"),
        (connection("int32 a", format_="ros2idl"), "expected a definition in ros2msg, got ros2idl"),
        (connection("int32 a", format_=""), "got no definition"),
    ],
)
def test_what_cannot_be_converted_says_why(each: Connection, fault: str) -> None:
    with pytest.raises(BagError, match=fault) as caught:
        as_ros1(each)
    assert "/it" in str(caught.value)


@pytest.mark.parametrize(
    ("definition", "data"),
    [
        ("std_msgs/Empty[200] it", bytes(20)),
        ("std_msgs/Empty[] it", b"\xff\xff\xff\x7f" + bytes(20)),
        ("A[] it\n" + "=" * 80 + "\nMSG: my_msgs/A\nstring[] it", b"\xff\xff\0\0" * 200),
        ("string[65000] it", bytes(20)),
        ("float64[] it", b"\xff\xff\xff\xff" + bytes(20)),
        ("string it", b"\xff\xff\xff\xff" + bytes(20)),
    ],
)
def test_sizes_are_compared_with_the_bytes_that_are_there(definition: str, data: bytes) -> None:
    converted = as_ros1(connection(definition))

    def convert() -> None:
        with pytest.raises(InvalidMessage):
            converted.convert(HEAD + data)

    tracemalloc.start()
    try:
        assert executed_lines(convert) < 10_000
        assert tracemalloc.get_traced_memory()[1] < LARGE
    finally:
        tracemalloc.stop()


NESTED = f"A[200] it\n{'=' * 80}\nMSG: my_msgs/A\nstd_msgs/Empty[200] it"


@pytest.mark.parametrize("definition", ["std_msgs/Empty[999999999] it", NESTED])
def test_elements_without_bytes_are_bounded(definition: str) -> None:
    """Each has a byte in CDR, and none in ROS 1."""
    each = connection(definition)
    with pytest.raises(BagError, match="without fields"):
        as_ros1(each)
    ros1 = f"{definition}\n{'=' * 80}\nMSG: std_msgs/Empty\n"
    with pytest.raises(BagError, match="without fields"):
        as_ros2(Connection(1, "/it", "my_msgs/It", "*", ros1))


@examples(1)
@given(data=st.data())
def test_damaged_message_is_read_or_an_error(data: st.DataObject) -> None:
    kinds = ros2_recordings.messages(data.draw(st.integers(0, 9)))
    _, type_, message = kinds[data.draw(st.integers(0, len(kinds) - 1))]
    content = bytearray(bytes(ros2_recordings.STORE.serialize_cdr(message, type_)))
    place = data.draw(st.integers(0, len(content) - 1))
    kind = data.draw(st.sampled_from(["flip", "number", "cut", "insert"]))
    if kind == "flip":
        content[place] ^= 1 << data.draw(st.integers(0, 7))
    elif kind == "number":
        content[place : place + 4] = data.draw(
            st.sampled_from([b"\xff" * 4, bytes(4), b"\1\0\0\0"])
        )
    elif kind == "cut":
        del content[place:]
    else:
        content[place:place] = data.draw(st.binary(max_size=20))
    converted = as_ros1(connection(ros2_recordings.definition(type_), type_))
    tracemalloc.start()
    try:
        try:
            found = converted.convert(bytes(content))
        except InvalidMessage as error:
            assert "\n" not in str(error)
        else:
            assert len(found) < 4 * len(content)
        assert tracemalloc.get_traced_memory()[1] < LARGE
    finally:
        tracemalloc.stop()


@examples(1)
@given(data=st.data())
def test_damaged_folder_gives_an_error_of_its_own(
    folders: dict[str, Path],
    tmp_path_factory: pytest.TempPathFactory,
    data: st.DataObject,
) -> None:
    source = folders[data.draw(st.sampled_from(sorted(folders)))]
    folder = tmp_path_factory.mktemp("damaged")
    paths = sorted(source.iterdir())
    damaged = data.draw(st.sampled_from(paths))
    for path in paths:
        content = bytearray(path.read_bytes())
        if path == damaged:
            place = data.draw(st.integers(0, len(content) - 1))
            if data.draw(st.booleans()):
                content[place] ^= 1 << data.draw(st.integers(0, 7))
            else:
                content[place : place + 4] = data.draw(st.binary(max_size=8))
        (folder / path.name).write_bytes(content)
    tracemalloc.start()
    try:
        for allow in (False, True):
            try:
                with with_encoding(open_reader(folder, allow_unindexed=allow), "ros1") as bag:
                    for _ in bag.messages():
                        pass
                    assert all("\n" not in fault for fault in bag.faults())
            except (BagError, FileNotFoundError) as error:  # A damaged name of a file.
                assert "\n" not in str(error)
        assert tracemalloc.get_traced_memory()[1] < 4 * LARGE
    finally:
        tracemalloc.stop()


def test_message_that_is_invalid_names_file_and_topic(tmp_path: Path) -> None:
    path = tmp_path / "it.mcap"
    with McapWriter(str(path), profile="ros2") as writer:
        own = writer.copy_connection(connection("string text"))
        writer.write(own, 5, HEAD + b"\xff\0\0\0a")
    with (
        with_encoding(open_reader(path), "ros1") as reader,
        pytest.raises(BagFormatError, match="invalid message on /it") as caught,
    ):
        list(reader.messages())
    assert str(path) in str(caught.value)


def test_bomb_of_a_message_is_rejected_early(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compression, "MAX_SIZE", 100_000)
    with McapWriter(str(tmp_path / "it.mcap"), profile="ros2") as writer:
        own = writer.copy_connection(connection("string text"))
        writer.write(own, 5, zstandard.compress(bytes(50_000_000)))
    (tmp_path / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  relative_file_paths: [it.mcap]\n"
        "  compression_mode: MESSAGE\n  compression_format: zstd\n"
    )
    tracemalloc.start()
    try:
        with open_reader(tmp_path) as reader, pytest.raises(BagFormatError, match="uncompressed"):
            list(reader.messages())
        assert tracemalloc.get_traced_memory()[1] < LARGE
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "name", ["storage_identifier", "relative_file_paths", "compression_mode", "compression_format"]
)
def test_bomb_of_metadata_costs_nothing(tmp_path: Path, name: str) -> None:
    """Each line has the one before twice."""
    lines = ["a0: &a0 [x, x]"]
    lines += [f"a{number}: &a{number} [*a{number - 1}, *a{number - 1}]" for number in range(1, 60)]
    text = "\n".join([*lines, f"rosbag2_bagfile_information: {{{name}: [*a59]}}", ""])
    (tmp_path / "metadata.yaml").write_text(text)
    with pytest.raises(BagFormatError, match=name):
        open_reader(tmp_path)


ENDLESS = "WITH RECURSIVE a(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM a) SELECT n"
TOPICS = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format)"
MESSAGES = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data)"
TOPIC = "INSERT INTO topics VALUES (1, '/it', 'std_msgs/msg/Int32', 'cdr')"


@pytest.mark.parametrize(
    ("statements", "fault"),
    [
        ((), "no table topics"),
        ((TOPICS,), "no table messages"),
        ((f"CREATE VIEW topics AS {ENDLESS} FROM a", MESSAGES), "topics must be a table"),
        (
            (
                *(TOPICS, TOPIC),
                f"CREATE VIEW messages AS {ENDLESS}, 1 topic_id, 1 timestamp, x'' data FROM a",
            ),
            "messages must be a table",
        ),
        (
            (
                TOPICS,
                f"{MESSAGES[:-5]}data BLOB GENERATED ALWAYS AS (zeroblob(1000000000)) VIRTUAL)",
            ),
            "computed columns",
        ),
        ((TOPICS, "CREATE TABLE messages(id TEXT PRIMARY KEY) WITHOUT ROWID"), "no such column"),
        ((TOPICS, MESSAGES, "INSERT INTO topics VALUES (1, 5, 6, 7)"), "invalid row"),
        ((TOPICS, MESSAGES, TOPIC, "INSERT INTO messages VALUES (1, 1, 'x', x'')"), "in row 1"),
        ((TOPICS, MESSAGES, TOPIC, "INSERT INTO messages VALUES (1, 1, -5, x'')"), "in row 1"),
        ((TOPICS, MESSAGES, TOPIC, "INSERT INTO messages VALUES (1, 1, 5, NULL)"), "in row 1"),
        ((TOPICS, MESSAGES, TOPIC, "INSERT INTO messages VALUES (1, 1, 5, 'x')"), "in row 1"),
    ],
)
def test_database_that_does_harm_or_is_another_one_is_an_error(
    tmp_path: Path, statements: tuple[str, ...], fault: str
) -> None:
    path = tmp_path / "it.db3"
    with closing(sqlite3.connect(path)) as database, database:
        database.execute("CREATE TABLE other(a)")
        for each in statements:
            database.execute(each)
    tracemalloc.start()
    try:
        with pytest.raises(BagFormatError, match=fault) as caught, open_reader(path) as reader:
            list(reader.messages())
        assert str(path) in str(caught.value)
        assert tracemalloc.get_traced_memory()[1] < LARGE
    finally:
        tracemalloc.stop()


def test_bomb_of_a_file_is_rejected_early(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rosbag2, "MAX_FILE", 1_000_000)
    path = tmp_path / "it.mcap.zstd"
    path.write_bytes(zstandard.compress(bytes(50_000_000)))
    with pytest.raises(BagFormatError, match="decompresses to more than 1000000 bytes"):
        open_reader(path)
    path.write_bytes(path.read_bytes()[:20])
    with pytest.raises(BagFormatError):
        open_reader(path)
