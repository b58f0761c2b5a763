"""Recordings of ROS 2, written and compared by rosbags: files and folders with messages in CDR."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from rosbags.rosbag2 import CompressionMode

from fibws.bags import open_reader, open_writer
from fibws.bags.ros2_messages import with_encoding
from fibws.errors import BagFormatError, UnsupportedBag
from fibws.interfaces import Interfaces

from . import ros2_recordings
from .ros2_recordings import KINDS, Kind, Row, rows_by_rosbags

INTERFACES = Interfaces()
each_kind = pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)


def rows(path: Path) -> list[Row]:
    with with_encoding(open_reader(path), "ros1") as reader:
        assert not reader.not_converted
        return [(each.topic, each.type, time, data) for each, time, data in reader.messages()]


@each_kind
def test_folder_is_read_as_by_rosbags(tmp_path: Path, kind: Kind) -> None:
    folder = tmp_path / "walk"
    ros2_recordings.write(folder, kind)
    found = rows(folder)
    assert found == rows_by_rosbags(folder)
    assert len(found) == 100


@each_kind
def test_files_of_a_folder_are_read_as_one_bag(tmp_path: Path, kind: Kind) -> None:
    folder = tmp_path / "walk"
    ros2_recordings.write_split(folder, kind)
    found = rows(folder)
    assert found == sorted(rows_by_rosbags(folder), key=lambda row: row[2])
    with open_reader(folder) as reader:
        assert (reader.message_count, len(reader.connections)) == (150, 5)
        assert list(reader.faults()) == []
        assert len(reader.times(reader.connections[:1])) == 30
    if kind[1] is not CompressionMode.MESSAGE:  # Only metadata.yaml tells that messages are packed.
        (folder / "metadata.yaml").unlink()
        assert rows(folder) == found


def test_bags_in_a_folder_of_other_files_are_said_to_be_left_out(tmp_path: Path) -> None:
    folder = tmp_path / "walk"
    ros2_recordings.write(folder, ros2_recordings.MCAP)
    (folder / "other.bag").touch()
    with open_reader(folder) as reader:
        assert reader.notices == ()  # metadata.yaml says what belongs to it.
    (folder / "metadata.yaml").unlink()
    with open_reader(folder) as reader:
        [notice] = reader.notices
        assert str(folder / "other.bag") in notice


@each_kind
def test_file_of_a_folder_is_read_alone(tmp_path: Path, kind: Kind) -> None:
    folder = tmp_path / "walk"
    ros2_recordings.write(folder, kind)
    [path] = ros2_recordings.files(folder)
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


def test_folder_of_another_storage_is_an_error(tmp_path: Path) -> None:
    text = "rosbag2_bagfile_information: {storage_identifier: tape, relative_file_paths: [a]}"
    (tmp_path / "metadata.yaml").write_text(text)
    with pytest.raises(UnsupportedBag, match=r"tape.*mcap or sqlite3"):
        open_reader(tmp_path)


@pytest.fixture
def database(tmp_path: Path) -> Path:
    """A .db3 file of 100 messages."""
    ros2_recordings.write(tmp_path / "walk", KINDS["sqlite3-none"], latched=True)
    return tmp_path / "walk" / "walk.db3"


def change(path: Path, *statements: str) -> None:
    """Change a database."""
    with closing(sqlite3.connect(path)) as connection, connection:
        for each in statements:
            connection.execute(each)


def test_sqlite_without_definitions_has_those_of_ros_1(database: Path) -> None:
    """Releases before Iron have recorded none."""
    expected = rows_by_rosbags(database.parent)
    change(database, "DROP TABLE message_definitions")
    with with_encoding(open_reader(database), "ros1") as reader:
        found = [(each.topic, each.type, time, data) for each, time, data in reader.messages()]
        assert all(each.latching for each in reader.connections if each.encoding == "ros1")
        [fault] = reader.not_converted.values()
        assert "/battery" in fault and "no definition" in fault
    assert [row for row in found if row[0] != "/battery"] == [
        row for row in expected if row[0] != "/battery"
    ]


def test_sqlite_without_definitions_is_not_converted_if_messages_do_not_fit(database: Path) -> None:
    change(
        database,
        "DROP TABLE message_definitions",
        "UPDATE topics SET type = 'visualization_msgs/msg/Marker' WHERE name = '/camera_info'",
    )
    with with_encoding(open_reader(database), "ros1") as reader:
        faults = list(reader.not_converted.values())
    assert len(faults) == 2
    assert any("/camera_info" in each and "do not fit" in each for each in faults)


def test_file_of_sqlite_is_left_as_it_is(database: Path) -> None:
    before, names = database.read_bytes(), sorted(database.parent.iterdir())
    with open_reader(database) as reader:
        assert len(list(reader.messages())) == reader.message_count == 100
        assert sorted(database.parent.iterdir()) == names
    assert database.read_bytes() == before


def test_copy_of_a_compressed_file_is_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ros2_recordings.write(tmp_path / "walk", KINDS["sqlite3-file"])
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(temporary))
    with open_reader(tmp_path / "walk") as reader:
        assert len(list(temporary.iterdir())) == 1
        assert reader.message_count == 100
    assert not list(temporary.iterdir())


def test_messages_of_unknown_topics_are_left_out_and_found(database: Path) -> None:
    change(database, "DELETE FROM topics WHERE name = '/number'")
    with open_reader(database) as reader:
        assert reader.message_count == len(list(reader.messages())) == 80
        [fault] = reader.faults()
    assert "does not list: 20" in fault


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
    with pytest.raises(BagFormatError, match=r"without \.mcap or \.db3 files$"):
        open_reader(tmp_path)
    (tmp_path / "lab.bag").touch()
    with pytest.raises(BagFormatError, match=r"such as .*lab\.bag$"):
        open_reader(tmp_path)
