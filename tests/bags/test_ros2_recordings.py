"""Recordings of ROS 2, written and compared by rosbags: files and folders with messages in CDR."""

from __future__ import annotations

from pathlib import Path

import pytest
from rosbags.rosbag2 import CompressionMode

from fibws.bags import open_reader, open_writer
from fibws.bags.ros2_messages import with_encoding
from fibws.errors import BagFormatError, UnsupportedBag
from fibws.interfaces import Interfaces

from . import ros2_recordings
from .ros2_recordings import Row, rows_by_rosbags

INTERFACES = Interfaces()
MODES = [CompressionMode.NONE, CompressionMode.STORAGE, CompressionMode.FILE]
MODES.append(CompressionMode.MESSAGE)

each_mode = pytest.mark.parametrize("mode", MODES, ids=[each.name for each in MODES])


def rows(path: Path) -> list[Row]:
    with with_encoding(open_reader(path), "ros1") as reader:
        assert not reader.not_converted
        return [(each.topic, each.type, time, data) for each, time, data in reader.messages()]


@each_mode
def test_folder_is_read_as_by_rosbags(tmp_path: Path, mode: CompressionMode) -> None:
    folder = tmp_path / "walk"
    ros2_recordings.write(folder, mode)
    found = rows(folder)
    assert found == rows_by_rosbags(folder)
    assert len(found) == 100


@each_mode
def test_files_of_a_folder_are_read_as_one_bag(tmp_path: Path, mode: CompressionMode) -> None:
    folder = tmp_path / "walk"
    ros2_recordings.write_split(folder, mode)
    found = rows(folder)
    assert found == sorted(rows_by_rosbags(folder), key=lambda row: row[2])
    with open_reader(folder) as reader:
        assert (reader.message_count, len(reader.connections)) == (150, 5)
        assert list(reader.faults()) == []
        assert len(reader.times(reader.connections[:1])) == 30
    if mode is not CompressionMode.MESSAGE:  # Only metadata.yaml tells that messages are packed.
        (folder / "metadata.yaml").unlink()
        assert rows(folder) == found


@each_mode
def test_file_of_a_folder_is_read_alone(tmp_path: Path, mode: CompressionMode) -> None:
    folder = tmp_path / "walk"
    ros2_recordings.write(folder, mode)
    [path] = folder.glob("*.mcap*")
    assert rows(path) == rows_by_rosbags(folder)


def test_types_that_ros_1_has_with_these_fields_are_those_of_ros_1(tmp_path: Path) -> None:
    ros2_recordings.write(tmp_path / "walk", latched=True)
    with with_encoding(open_reader(tmp_path / "walk"), "ros1") as reader:
        found = {each.topic: each for each in reader.connections}
    for name in ("std_msgs/Int32", "geometry_msgs/PointStamped", "sensor_msgs/CameraInfo"):
        [connection] = [each for each in found.values() if each.type == name]
        assert connection.md5sum == INTERFACES.md5(name)
        assert (connection.encoding, connection.definition_format) == ("ros1", "ros1msg")
        assert connection.latching
    assert "uint32 seq" in found["/battery"].definition


def test_conversion_to_bag_and_back_keeps_all(tmp_path: Path) -> None:
    folder, bag, back = tmp_path / "walk", tmp_path / "walk.bag", tmp_path / "back.mcap"
    ros2_recordings.write(folder)
    for source, target, encoding in ((folder, bag, "ros1"), (bag, back, "cdr")):
        with (
            with_encoding(open_reader(source), encoding) as reader,
            open_writer(target, profile="ros2") as writer,
        ):
            assert not reader.not_converted
            own = {each.id: writer.copy_connection(each) for each in reader.connections}
            for connection, time, data in reader.messages():
                writer.write(own[connection.id], time, data)
    with open_reader(folder) as one, open_reader(back) as other:
        assert [
            (each.topic, each.type, each.encoding, time, data)
            for each, time, data in one.messages()
        ] == [
            (each.topic, each.type, each.encoding, time, data)
            for each, time, data in other.messages()
        ]


def test_folder_of_another_storage_says_how_to_convert_it(tmp_path: Path) -> None:
    text = "rosbag2_bagfile_information: {storage_identifier: sqlite3, relative_file_paths: [a]}"
    (tmp_path / "metadata.yaml").write_text(text)
    with pytest.raises(UnsupportedBag, match=r"sqlite3.*rosbags-convert"):
        open_reader(tmp_path)


def test_folder_names_only_files_in_it(tmp_path: Path) -> None:
    folder = tmp_path / "walk"
    ros2_recordings.write(folder)
    metadata = folder / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace("walk.mcap", "../../etc/walk.mcap"))
    assert len(rows(folder)) == 100


@pytest.mark.parametrize(
    "text", ["", "[", "a: b", "rosbag2_bagfile_information: 5", "[" * 5000, "\0", "&a [*a]"]
)
def test_invalid_metadata_is_an_error(tmp_path: Path, text: str) -> None:
    (tmp_path / "metadata.yaml").write_text(text)
    with pytest.raises(BagFormatError, match=r"metadata\.yaml"):
        open_reader(tmp_path)


def test_folder_without_files_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(BagFormatError, match=r"without \.mcap files$"):
        open_reader(tmp_path)
    (tmp_path / "lab.bag").touch()
    with pytest.raises(BagFormatError, match=r"such as .*lab\.bag$"):
        open_reader(tmp_path)
