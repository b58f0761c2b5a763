"""rosbag's `Bag`, where it does more than that of ROS 1, or its errors differ."""

from __future__ import annotations

import io
import re
import shutil
from pathlib import Path
from threading import Thread
from time import time
from typing import Any

import genpy
import genpy.dynamic
import pytest
import rosbag
import rospy
from bags import ros2_recordings
from rosbag.rosbag_main import rosbagmain
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Int32, String

from fibws.bags import open_reader, open_writer

BAGS_PAGE = Path(__file__).parents[3] / "docs" / "bags.md"
INT32 = {"topic": "/a", "type": Int32._type, "md5sum": Int32._md5sum}
INT32["message_definition"] = Int32._full_text


@pytest.fixture
def path(tmp_path: Path) -> str:
    return str(tmp_path / "it.bag")


def numbers(bag: rosbag.Bag, **options: Any) -> list[int]:
    return [message.data for _, message, _ in bag.read_messages(**options)]


def test_messages_can_be_read_while_they_are_written(path: str) -> None:
    with rosbag.Bag(path, "w", chunk_threshold=100) as bag:
        for number in range(30):
            bag.write("/a", Int32(number), rospy.Time(number + 1))
            assert numbers(bag) == list(range(number + 1))
            assert bag.get_message_count() == number + 1
        assert bag.get_end_time() == 30
    with rosbag.Bag(path) as bag:
        assert numbers(bag) == list(range(30))


def test_messages_of_installed_types_have_their_classes(path: str) -> None:
    with rosbag.Bag(path, "w") as bag:
        bag.write("/a", Int32(5), rospy.Time(1))
    with rosbag.Bag(path) as bag:
        [(_, message, _)] = bag
        assert isinstance(message, Int32)
        assert message == Int32(5)


def test_message_without_a_time_has_the_current_one(path: str) -> None:
    before = time()
    with rosbag.Bag(path, "w") as bag:
        bag.write("/a", Int32(5))
    with rosbag.Bag(path) as bag:
        [(_, _, stamp)] = bag
        assert before - 1e-6 <= stamp.to_sec() <= time()


def test_unknown_type_is_made_from_the_definition_in_the_bag(path: str) -> None:
    text = "Part[] parts\n" + "=" * 80 + "\nMSG: no_such_pkg/Part\nstring name\nuint8 BIG=7"
    made = genpy.dynamic.generate_dynamic("no_such_pkg/Whole", text)
    whole, part = made["no_such_pkg/Whole"], made["no_such_pkg/Part"]
    with rosbag.Bag(path, "w") as bag:
        bag.write("/a", whole(parts=[part("one"), part("two")]), rospy.Time(1))
    with rosbag.Bag(path) as bag:
        [(_, message, _)] = bag
        assert [each.name for each in message.parts] == ["one", "two"]
        assert message.parts[0].BIG == 7
        assert message._md5sum == whole._md5sum


def test_type_that_changed_has_the_definition_in_the_bag(
    path: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with open_writer(path) as writer:
        old = writer.connection("/a", "std_msgs/Int32", "0" * 32, "int32 older")
        writer.write(old, 1, b"\5\0\0\0")
    with rosbag.Bag(path) as bag:
        [(_, message, _)] = bag
        assert message.older == 5
    assert "std_msgs/Int32" in capsys.readouterr().err


def test_publishers_keep_their_connections(path: str, tmp_path: Path) -> None:
    headers = [{**INT32, "callerid": name, "latching": "1"} for name in ("/one", "/two")]
    with rosbag.Bag(path, "w") as bag:
        for number in range(4):
            header = headers[number % 2]
            bag.write("/a", Int32(number), rospy.Time(number + 1), connection_header=header)
    copy = str(tmp_path / "copy.bag")
    with rosbag.Bag(path) as bag, rosbag.Bag(copy, "w") as other:
        for found in bag.read_messages(raw=True, return_connection_header=True):
            header = found.connection_header
            other.write(found.topic, found.message, found.timestamp, True, header)
    with open_reader(copy) as reader:
        publishers = [(each.callerid, each.latching) for each, _, _ in reader.messages()]
    assert publishers == [("/one", True), ("/two", True)] * 2


def test_topic_may_have_two_types(path: str) -> None:
    with rosbag.Bag(path, "w") as bag:
        bag.write("/a", Int32(1), rospy.Time(1))
        bag.write("/a", String("two"), rospy.Time(2))
    with rosbag.Bag(path) as bag:
        assert [message.data for _, message, _ in bag] == [1, "two"]


def test_appending_makes_a_bag_that_is_missing(path: str) -> None:
    for number in range(3):
        with rosbag.Bag(path, "a", compression="bz2") as bag:
            bag.write("/a", Int32(number), rospy.Time(number + 1))
    with rosbag.Bag(path) as bag:
        assert numbers(bag) == [0, 1, 2]
        assert bag.get_type_and_topic_info().topics["/a"].connections == 1


def write_unclosed(path: str) -> None:
    """Write what a program leaves that is killed."""
    with rosbag.Bag(f"{path}.other", "w") as bag:
        bag.write("/a", Int32(5), rospy.Time(1))
        bag.flush()
        shutil.copy(f"{path}.other", path)


def test_bag_that_was_not_closed(path: str) -> None:
    write_unclosed(path)
    with pytest.raises(rosbag.ROSBagUnindexedException, match="Unindexed bag"):
        rosbag.Bag(path)
    with rosbag.Bag(path, allow_unindexed=True) as unindexed:
        assert len(list(unindexed.reindex())) == 1
        assert numbers(unindexed) == [5]
    with pytest.raises(rosbag.ROSBagUnindexedException):
        rosbag.Bag(path, "a")
    with rosbag.Bag(path, "a", allow_unindexed=True) as appended:
        appended.write("/a", Int32(6), rospy.Time(2))
    with rosbag.Bag(path) as both:
        assert numbers(both) == [5, 6]


def test_reindex_in_place(path: str) -> None:
    write_unclosed(path)
    assert rosbag.bag_reindex(path) == 1
    with rosbag.Bag(path) as restored:
        assert numbers(restored) == [5]


def test_bag_that_is_written_is_not_changed(path: str) -> None:
    with rosbag.Bag(path, "w") as bag:
        bag.write("/a", Int32(5), rospy.Time(1))
        bag.flush()
        with pytest.raises(OSError, match="being written by"):
            rosbag.bag_reindex(path)
        for mode in ("w", "a"):
            with pytest.raises(OSError, match="being written by"):
                rosbag.Bag(path, mode)
    with rosbag.Bag(path) as read:
        assert numbers(read) == [5]


def test_threads_may_write(path: str) -> None:
    def write(topic: str) -> None:
        for number in range(2000):
            bag.write(topic, Int32(number), rospy.Time(1 + number))

    with rosbag.Bag(path, "w", chunk_threshold=5000) as bag:
        threads = [Thread(target=write, args=(f"/t{number}",)) for number in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    with rosbag.Bag(path) as bag:
        for number in range(3):
            assert numbers(bag, topics=f"/t{number}") == list(range(2000))


def test_properties(path: str) -> None:
    options = {"compression": "lz4", "chunk_threshold": 100}
    with rosbag.Bag(path, "w", options=options) as bag:
        assert (bag.options, bag.mode, bag.version, bag.filename) == (options, "w", 200, path)
        for number in range(20):
            bag.write("/a", Int32(number), rospy.Time(1 + number))
        assert bag.size > 4096
        bag.compression = "bz2"
        bag.chunk_threshold = 10_000
        for number in range(20, 40):
            bag.write("/a", Int32(number), rospy.Time(1 + number))
        bag.flush()
    with rosbag.Bag(path) as bag:
        assert numbers(bag) == list(range(40))
        assert bag.size == Path(path).stat().st_size
        assert bag.get_compression_info().compression == "lz4"
        assert [bag.get_start_time(), bag.get_end_time()] == [1, 40]
        bag.flush()
    with open_reader(path) as reader:
        assert {chunk.compression for chunk in reader.chunks} == {"lz4", "bz2"}


def test_selections(path: str) -> None:
    with rosbag.Bag(path, "w") as bag:
        for number in range(10):
            bag.write("/a", Int32(number), rospy.Time(1 + number))
            bag.write("/b", String(f"text {number}"), rospy.Time(1 + number, 5))
    with rosbag.Bag(path) as bag:
        assert numbers(bag, topics="/a", start_time=rospy.Time(9)) == [8, 9]
        assert numbers(bag, topics=["/a"], end_time=genpy.Time(2)) == [0, 1]

        def is_text(topic: str, type_: str, md5sum: str, text: str, header: Any) -> bool:
            return topic == "/b" and type_ == header["type"].decode() == "std_msgs/String"

        assert len(list(bag.read_messages(connection_filter=is_text))) == 10
        [*_, (topic, raw, _)] = bag.read_messages(topics=[], raw=True)
        assert (topic, raw[0], raw[1][4:], raw[4]) == ("/b", String._type, b"text 9", String)
        info = bag.get_type_and_topic_info("/a")
        assert info.topics == {"/a": ("std_msgs/Int32", 10, 1, 1.0)}
        assert info.msg_types.keys() == {"std_msgs/Int32", "std_msgs/String"}
        assert bag.get_message_count(["/a", "/b"]) == 20
        with pytest.raises(TypeError):
            bag.read_messages(start_time=5.0)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("arguments", "fact"),
    [
        (("",), "filename"),
        (("{path}", "x"), '"x"'),
        (("{path}", "w", "zip"), "none, bz2, lz4"),
        (("{path}", "w", "none", -1), "chunk_threshold"),
        (("{path}", "w", "none", 1, False, 5), "dict"),
    ],
)
def test_invalid_arguments(path: str, arguments: tuple[Any, ...], fact: str) -> None:
    with pytest.raises(ValueError, match=fact):
        rosbag.Bag(path if arguments[0] else "", *arguments[1:])
    assert not Path(path).exists()


def test_invalid_messages(path: str) -> None:
    with rosbag.Bag(path, "w") as bag:
        for topic, message, raw in (("", Int32(1), False), ("/a", None, False), ("/a", (1,), True)):
            with pytest.raises(ValueError, match=r"invalid|length"):
                bag.write(topic, message, raw=raw)
        with pytest.raises(rosbag.ROSBagException, match="no/Type"):
            bag.write("/a", ("no/Type", b"", "*", None), rospy.Time(1), raw=True)
        with pytest.raises(rosbag.ROSBagException, match="no message"):
            bag.get_start_time()
        with pytest.raises(genpy.SerializationError):
            bag.write("/a", Int32("one"), rospy.Time(1))
        bag.write("/a", (Int32._type, b"\5\0\0\0", "0" * 32, None), rospy.Time(1), raw=True)
        assert numbers(bag) == [5]
    for use in (bag.flush, bag.get_end_time, lambda: bag.size):
        with pytest.raises(ValueError, match="closed"):
            use()


@pytest.mark.parametrize(
    ("content", "fault"), [(b"", "empty file"), (b"hello", "does not appear to be a bag file")]
)
def test_file_that_is_no_bag(path: str, content: bytes, fault: str) -> None:
    Path(path).write_bytes(content)
    with pytest.raises(rosbag.ROSBagException, match=fault):
        rosbag.Bag(path)
    assert rosbag.ROSBagUnindexedException().value == "Unindexed bag"


def test_encrypted_bag(path: str) -> None:
    rosbag.Bag(path, "w").close()
    content = Path(path).read_bytes()
    field = b"\x0e\0\0\0encryptor=some"
    size = int.from_bytes(content[13:17], "little") + len(field)
    header = size.to_bytes(4, "little") + content[17 : 17 + size - len(field)] + field
    Path(path).write_bytes(content[:13] + header + content[17 + size - len(field) :])
    with pytest.raises(rosbag.ROSBagEncryptNotSupportedException, match="some"):
        rosbag.Bag(path)


def test_streams() -> None:
    class Kept(io.BytesIO):
        def close(self) -> None:
            pass

    stream = Kept()
    with rosbag.Bag(stream, "w") as bag:
        bag.write("/a", Int32(5), rospy.Time(1))
    stream.seek(0)
    with rosbag.Bag(stream) as bag:
        assert bag.filename is None
        assert numbers(bag) == [5]
    with pytest.raises(rosbag.ROSBagException, match="binary"):
        rosbag.Bag(io.StringIO(), "w")


def test_mcap(tmp_path: Path) -> None:
    path = str(tmp_path / "it.mcap")
    with rosbag.Bag(path, "w") as bag:
        bag.write("/a", Int32(5), rospy.Time(1), connection_header={**INT32, "callerid": "/one"})
        with pytest.raises(rosbag.ROSBagException, match="MCAP"):
            numbers(bag)
    with rosbag.Bag(path) as bag:
        [found] = bag.read_messages(return_connection_header=True)
        assert found.message == Int32(5)
        assert found.connection_header["callerid"] == b"/one"
        assert bag.get_message_count("/a") == 1
        assert "/a   1 msg " in str(bag)


def test_recording_of_ros_2(tmp_path: Path) -> None:
    ros2_recordings.write(tmp_path / "walk", end=5)
    with rosbag.Bag(str(tmp_path / "walk")) as bag:
        found = list(bag.read_messages(["/number", "/camera_info"]))
        types = bag.get_type_and_topic_info().msg_types
    assert [message.data for topic, message, _ in found if topic == "/number"] == [
        0,
        -1,
        -2,
        -3,
        -4,
    ]
    assert isinstance(found[1].message, CameraInfo)
    assert found[1].message.K == (1.0,) * 9
    assert types["std_msgs/Int32"] == Int32._md5sum


def test_errors_of_damaged_and_foreign_files(path: str) -> None:
    with rosbag.Bag(path, "w", compression="bz2") as bag:
        bag.write("/a", Int32(5), rospy.Time(1))
    content = bytearray(Path(path).read_bytes())
    place = content.index(b"BZh")
    content[place : place + 3] = b"???"
    Path(path).write_bytes(content)
    with rosbag.Bag(path) as bag, pytest.raises(rosbag.ROSBagFormatException, match="bz2"):
        list(bag)
    Path(path).write_bytes(b"#ROSBAG V1.2\nmore")
    with pytest.raises(rosbag.ROSBagException, match=r"1\.2"):
        rosbag.Bag(path)


def test_writing_to_a_bag_that_is_read_is_an_error(path: str) -> None:
    rosbag.Bag(path, "w").close()
    with rosbag.Bag(path) as bag, pytest.raises(io.UnsupportedOperation):
        bag.write("/a", Int32(5))


def test_program_in_the_documentation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    programs = re.findall(r"```python\n(.*?)```", BAGS_PAGE.read_text("utf-8"), re.DOTALL)
    exec(programs.pop(0), {})
    lines = capsys.readouterr().out.splitlines()
    assert lines == ["/number 97 98.0", "/number 98 99.0", "/number 99 100.0", "100 std_msgs/Int32"]
    [merge] = programs
    header = {"topic": "/number", "callerid": "/talker", "latching": "1"}
    with rosbag.Bag("lab.mcap", "w") as bag:
        bag.write("/number", Int32(-1), rospy.Time(50.5), connection_header=header)
    exec(merge, {})
    with rosbag.Bag("all.bag") as bag:
        assert numbers(bag) == [*range(50), -1, *range(50, 100)]
        found = bag.read_messages(start_time=rospy.Time(50.5), return_connection_header=True)
        assert next(iter(found)).connection_header["callerid"] == b"/talker"


def test_start_of_a_script_that_calls_rosbag(path: str) -> None:
    rosbag.Bag(path, "w").close()
    rosbagmain(["rosbag", "check", path])
    with pytest.raises(SystemExit):
        rosbagmain(["rosbag", "info", f"{path}.missing"])
