"""``fibws bag`` and ``fibws topic echo -b`` with recordings of ROS 2."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import pytest
import yaml
from bags import ros2_recordings
from click.testing import CliRunner, Result
from hub_in_thread import HubThread, Run
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.typesys import get_types_from_msg

from fibws.bags import open_reader
from fibws.bags.connection import Connection
from fibws.bags.mcap_files import McapWriter
from fibws.cli.commands import command
from fibws.interfaces import Interfaces

Tool: TypeAlias = Callable[..., Result]
KINDS = [each for each in ros2_recordings.KINDS if not each.endswith("storage")]
MARKER = "visualization_msgs/msg/Marker"
NOT_CONVERTED = [
    ("/wide", "wstring"),
    ("/idl", "ros2idl"),
    ("/json", "json"),
    ("Marker", "texture"),
]
"""What is said of the topics of `mixed`."""
HEAD = b"\0\1\0\0"


@pytest.fixture
def fibws() -> Tool:
    """Run a command without a hub."""

    def run(*words: str | Path) -> Result:
        return CliRunner().invoke(command, list(map(str, words)), prog_name="fibws")

    return run


@pytest.fixture(params=KINDS)
def folder(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A folder of rosbag2 with three files and 150 messages."""
    path = tmp_path / "walk"
    ros2_recordings.write_split(path, ros2_recordings.KINDS[request.param])
    return path


def connection(topic: str, type_: str, definition: str, **others: Any) -> Connection:
    fields = {"message_definition": definition.encode()}
    options = {"encoding": "cdr", "definition_format": "ros2msg", **others}
    return Connection(1, topic, type_, "", definition, "", False, fields, **options)


@pytest.fixture
def mixed(tmp_path: Path) -> Path:
    """A file with a topic that can be read, one of other fields than ROS 1's, and three others."""
    path = tmp_path / "mixed.mcap"
    marker = "int32 id\nstring texture_resource"
    with McapWriter(str(path), profile="ros2") as writer:
        for each, data in (
            (connection("/n", "std_msgs/msg/Int32", "int32 data"), HEAD + b"\7\0\0\0"),
            (connection("/marker", MARKER, marker), HEAD + b"\1\0\0\0\2\0\0\0a\0"),
            (connection("/wide", "my_msgs/msg/Wide", "wstring text"), HEAD + bytes(4)),
            (connection("/idl", "my_msgs/msg/Idl", "", definition_format="ros2idl"), HEAD),
            (connection("/json", "my_msgs/msg/Json", "", encoding="json"), b"{}"),
        ):
            writer.write(writer.copy_connection(each), 1, data)
    return path


def test_info_shows_the_encoding(fibws: Tool, folder: Path) -> None:
    result = fibws("bag", "info", folder)
    assert result.exit_code == 0, result.output
    lines = [line.split() for line in result.output.splitlines()]
    assert ["encoding:", "cdr", "(ROS", "2)"] in lines
    assert ["messages:", "150"] in lines
    assert "differences" not in result.output
    found = json.loads(fibws("bag", "info", "--json", folder).output)
    assert (found["encodings"], "differences" in found) == (["cdr"], False)
    assert yaml.safe_load(fibws("bag", "info", "-y", folder).output) == found


def test_info_lists_what_cannot_be_converted(fibws: Tool, mixed: Path) -> None:
    text = fibws("bag", "info", mixed).output
    assert "encoding:" in text and "cdr (ROS 2), json" in text
    found = json.loads(fibws("bag", "info", "--json", mixed).output)
    assert found["encodings"] == ["cdr", "json"]
    assert yaml.safe_load(fibws("bag", "info", "-y", mixed).output) == found
    for facts in NOT_CONVERTED:
        assert any(all(fact in each for fact in facts) for each in found["differences"])
        assert all(fact in text for fact in facts)
    assert len(found["differences"]) == 4


def test_check_reads_all_messages(fibws: Tool, folder: Path) -> None:
    result = fibws("bag", "check", folder)
    assert (result.exit_code, result.output) == (0, "Bag file does not need any migrations.\n")


@pytest.mark.parametrize("command", ["reindex", "compress", "decompress"])
def test_file_of_sqlite_is_not_rewritten(fibws: Tool, tmp_path: Path, command: str) -> None:
    path = tmp_path / "walk" / "walk.db3"
    ros2_recordings.write(path.parent, ros2_recordings.KINDS["sqlite3-none"])
    before = path.read_bytes()
    result = fibws("bag", command, path)
    assert result.exit_code == 1
    advice = re.findall(r"fibws (bag filter .*)", result.output)[0].split()
    assert path.read_bytes() == before
    assert fibws(*advice, "-q").exit_code == 0
    with open_reader(path.with_suffix(".mcap")) as reader:
        assert reader.message_count == 100


def test_check_names_a_damaged_message(fibws: Tool, tmp_path: Path) -> None:
    path = tmp_path / "it.mcap"
    with McapWriter(str(path), profile="ros2") as writer:
        own = writer.copy_connection(connection("/n", "std_msgs/msg/Int32", "int32 data"))
        writer.write(own, 1, HEAD + b"\7")
    result = fibws("bag", "check", path)
    assert result.exit_code == 1
    assert "invalid message on /n" in result.output


def test_check_says_what_is_not_checked(fibws: Tool, mixed: Path) -> None:
    result = fibws("bag", "check", mixed)
    assert result.exit_code == 0, result.output
    for topic in ("/wide", "/idl", "/json"):
        assert f"Not checked: messages of {topic} " in result.output
    assert f" * From: {MARKER.replace('/msg/', '/')} [" in result.output


def test_echo_prints_messages(fibws: Tool, folder: Path) -> None:
    result = fibws("topic", "echo", "-b", folder, "-n", "2", "/point")
    assert result.exit_code == 0, result.output
    found = list(yaml.safe_load_all(result.output))
    assert found[1]["point"] == {"x": 1 / 8, "y": -1.5, "z": 0.0}
    assert found[1]["header"]["stamp"] == {"secs": 1, "nsecs": 5}
    result = fibws("topic", "echo", "-b", folder, "-n", "1", "/camera_info/K[0]")
    assert result.output.startswith("1.0")


def test_echo_of_what_cannot_be_read_says_why(fibws: Tool, mixed: Path) -> None:
    result = fibws("topic", "echo", "-b", mixed, "/wide")
    assert result.exit_code == 1
    assert "/wide" in result.output and "wstring" in result.output


def test_echo_of_all_topics_takes_no_topic(fibws: Tool, mixed: Path) -> None:
    result = fibws("topic", "echo", "-b", mixed, "-a", "/n")
    assert result.exit_code == 2
    assert "/n" in result.output


@pytest.mark.long
def test_filter_converts_to_bag_and_back(fibws: Tool, folder: Path, tmp_path: Path) -> None:
    bag, back = tmp_path / "walk.bag", tmp_path / "back.mcap"
    result = fibws("bag", "filter", "-q", folder, bag, "True")
    assert (result.exit_code, result.output) == (0, "")
    with AnyReader([bag]) as reader:  # Of rosbags.
        found = [(each.topic, each.msgtype, data) for each, _, data in reader.messages()]
    assert found == [
        (topic, type_.replace("/", "/msg/"), data)
        for topic, type_, _, data in sorted(
            ros2_recordings.rows_by_rosbags(folder), key=lambda row: row[2]
        )
    ]
    assert fibws("bag", "filter", "-q", bag, back, "--encoding", "cdr").exit_code == 0
    with open_reader(folder) as one, open_reader(back) as other:
        assert [(each.topic, each.type, time, data) for each, time, data in one.messages()] == [
            (each.topic, each.type, time, data) for each, time, data in other.messages()
        ]
    with back.open("rb") as file:
        mcap = make_reader(file)
        assert mcap.get_header().profile == "ros2"
        for schema, channel, _ in mcap.iter_messages():
            assert schema is not None
            assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
            parsed = get_types_from_msg(schema.data.decode(), schema.name)
            assert schema.name in parsed


def test_filter_by_fields_copies_messages_as_they_are(
    fibws: Tool, folder: Path, tmp_path: Path
) -> None:
    target = tmp_path / "part.mcap"
    words = ("topic == '/number' and m.data < -25",)
    assert fibws("bag", "filter", "-q", folder, target, *words).exit_code == 0
    with open_reader(target) as reader:
        found = [(each.encoding, data) for each, _, data in reader.messages()]
    assert found == [
        ("cdr", HEAD + (-number).to_bytes(4, "little", signed=True)) for number in range(26, 30)
    ]
    with target.open("rb") as file:
        assert make_reader(file).get_header().profile == "ros2"


def test_filter_to_bag_lists_what_does_not_fit(fibws: Tool, mixed: Path, tmp_path: Path) -> None:
    target = tmp_path / "it.bag"
    result = fibws("bag", "filter", "-q", mixed, target, "True")
    assert result.exit_code == 0, result.output
    warnings = [each for each in result.output.splitlines() if each.startswith("Warning: ")]
    for facts in NOT_CONVERTED:
        assert any(all(fact in each for fact in facts) for each in warnings)
    with open_reader(target) as reader:
        assert sorted(each.topic for each in reader.connections) == ["/marker", "/n"]


def test_filter_to_bag_of_nothing_that_fits_is_an_error(
    fibws: Tool, mixed: Path, tmp_path: Path
) -> None:
    target = tmp_path / "it.bag"
    result = fibws("bag", "filter", mixed, target, "--topic", "/wide")
    assert result.exit_code == 1
    assert "wstring" in result.output
    assert not target.exists()


def test_cdr_needs_an_mcap_file(fibws: Tool, mixed: Path, tmp_path: Path) -> None:
    result = fibws("bag", "filter", mixed, tmp_path / "it.bag", "True", "--encoding", "cdr")
    assert result.exit_code == 2
    assert ".mcap" in result.output


def test_play_of_what_cannot_be_read_fails_without_a_hub(fibws: Tool, mixed: Path) -> None:
    result = fibws("bag", "play", "--hub", "ws://127.0.0.1:9", mixed, "--topics", "/wide", "/json")
    assert result.exit_code == 1
    assert "nothing can be played" in result.output and "wstring" in result.output


def test_play_leaves_out_what_cannot_be_read(run: Run, hub: HubThread, mixed: Path) -> None:
    result = run("bag", "play", str(mixed), "-d", "0", "-i")
    assert result.exit_code == 0, result.output
    for topic, reason in (("/wide", "wstring"), ("/idl", "ros2idl"), ("/json", "json")):
        assert re.search(f"{topic} is not played: .*{reason}", result.output)
    for topic in ("/n", "/marker"):  # The hub knows ROS 1's Marker, which is another type.
        assert f"{topic} is not played" not in result.output


def test_play_of_an_unknown_topic_fails_without_a_hub(fibws: Tool, folder: Path) -> None:
    result = fibws("bag", "play", "--hub", "ws://127.0.0.1:9", folder, "--topics", "/pont")
    assert result.exit_code == 2
    assert "did you mean /point?" in result.output


@pytest.mark.parametrize("name", ["compress", "decompress", "reindex"])
def test_folder_is_not_rewritten(fibws: Tool, tmp_path: Path, name: str) -> None:
    ros2_recordings.write(tmp_path / "walk", end=1)
    result = fibws("bag", name, tmp_path / "walk")
    assert result.exit_code == 1
    assert result.output.startswith("Error: ")
    assert f"name the files in it: {tmp_path / 'walk' / 'walk.mcap'}" in result.output


def test_folder_of_sqlite_is_not_rewritten_but_converted(fibws: Tool, tmp_path: Path) -> None:
    folder = tmp_path / "walk"
    ros2_recordings.write(folder, ros2_recordings.KINDS["sqlite3-none"], end=1)
    result = fibws("bag", "compress", folder)
    assert result.exit_code == 1
    advice = re.findall(r"fibws (bag filter .*)", result.output)[0].split()
    assert fibws(*advice, "-q").exit_code == 0
    with open_reader(tmp_path / "walk.mcap") as reader:
        assert reader.message_count == 5


def test_folder_of_a_killed_recorder_is_read_after_reindex(fibws: Tool, tmp_path: Path) -> None:
    """What was kept of the old file is not read once more."""
    folder = tmp_path / "walk"
    ros2_recordings.write(folder)
    (folder / "metadata.yaml").unlink()
    path = folder / "walk.mcap"
    path.write_bytes(path.read_bytes()[:-100])
    result = fibws("bag", "info", folder)
    assert result.exit_code == 1
    advice = re.findall(r"fibws (bag reindex .*)", result.output)[0].split()
    assert fibws(*advice, "-q").exit_code == 0
    assert len(list(folder.iterdir())) == 2
    assert fibws("bag", "compress", "-q", path).exit_code == 0
    with open_reader(folder) as reader:
        assert reader.message_count == 100
    path.unlink()
    assert fibws("bag", "info", folder).exit_code == 1  # The original is the only file now.


def test_types_are_those_of_the_installed_ros_1(fibws: Tool, folder: Path, tmp_path: Path) -> None:
    bag, interfaces = tmp_path / "walk.bag", Interfaces()
    assert fibws("bag", "filter", "-q", folder, bag, "True").exit_code == 0
    with open_reader(bag) as reader:
        md5sums = {each.type: each.md5sum for each in reader.connections}
    for name in ("sensor_msgs/CameraInfo", "geometry_msgs/PointStamped", "std_msgs/Empty"):
        assert md5sums[name] == interfaces.md5(name)
