"""Bags of fibws in other programs, and theirs in fibws: rosbags, mcap, and ROS's in two languages.

Foxglove's libraries are in tests/clients/test_bags.py.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from mcap.reader import make_reader
from mcap_ros1.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Writer as RosbagsWriter

from fibws.bags import open_reader, open_writer, reindex
from fibws.bags.reader import Reader
from fibws.cli.commands import command

from . import recordings
from .recordings import Found

PYTHON = "/usr/bin/python3"
"""Debian's, which its ROS packages are installed for."""
CPP = Path("/usr/lib/rosbag/encrypt")
"""A program in C++ that copies bags; without a key, it does nothing else."""
COMPRESSIONS = ["none", "bz2", "lz4"]

each_compression = pytest.mark.parametrize("compression", COMPRESSIONS)


def full_text(type_: str) -> str:
    return recordings.INTERFACES.full_text(type_)


# rosbags and mcap


@each_compression
def test_rosbags_reads_ours(tmp_path: Path, compression: str) -> None:
    path = tmp_path / "it.bag"
    recordings.write(path, compression)
    with AnyReader([path]) as reader:
        found: list[Any] = []
        for connection, time, data in reader.messages():
            ext: Any = connection.ext
            type_ = connection.msgtype.replace("/msg/", "/")
            publisher = (ext.callerid or "", bool(ext.latching))
            found.append((connection.topic, type_, connection.digest, *publisher, time, data))
            reader.deserialize(data, connection.msgtype)
    assert sorted(found) == sorted(recordings.expected())


@each_compression
def test_those_of_rosbags_are_read(tmp_path: Path, compression: str) -> None:
    path = tmp_path / "it.bag"
    writer = RosbagsWriter(path)
    if compression != "none":
        writer.set_compression(RosbagsWriter.CompressionFormat[compression.upper()])
    writer.chunk_threshold = 20_000
    with writer:
        connections = [
            writer.add_connection(
                topic,
                type_.replace("/", "/msg/"),
                msgdef=full_text(type_),
                md5sum=recordings.INTERFACES.md5(type_),
                callerid=callerid or None,
                latching=int(latching) if callerid else None,
            )
            for topic, type_, callerid, latching in recordings.PUBLISHERS
        ]
        for which, time, data in recordings.messages():
            writer.write(connections[which], time, data)
    assert recordings.read(path) == recordings.expected()
    with open_reader(path) as bag:
        assert bag.compression == compression
    content = path.read_bytes()
    restored = tmp_path / "restored.bag"
    append(path)
    assert reindex(path, restored) == (401, 0, 0)
    with AnyReader([path]) as reader:
        assert len(list(reader.messages())) == 401
    path.write_bytes(content[: len(content) * 2 // 3])
    assert 100 < reindex(path, restored).messages < 400
    assert set(recordings.read(restored)) < set(recordings.expected())


@pytest.mark.parametrize("compression", ["none", "lz4", "zstd"])
def test_mcap_library_reads_ours(tmp_path: Path, compression: str) -> None:
    path = tmp_path / "it.mcap"
    recordings.write(path, compression)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros1"
        found = []
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            assert schema is not None and channel.message_encoding == "ros1"
            assert decoded is not None
            metadata = channel.metadata
            publisher = (metadata.get("callerid", ""), metadata.get("latching") == "1")
            kind = (channel.topic, schema.name, metadata["md5sum"])
            found.append((*kind, *publisher, message.log_time, message.data))
    assert found == recordings.expected()


def append(path: Path) -> None:
    """Append a message to a bag with numbers, as a script does."""
    import rosbag
    import rospy

    with rosbag.Bag(path) as bag:
        [*_, (topic, message, _)] = bag.read_messages("/number")
    with rosbag.Bag(path, "a") as bag:
        bag.write(topic, message, rospy.Time(1_800_000_000))


# ROS in Python and C++

WRITE_IN_PYTHON = """
import json, os, sys
import genpy.dynamic, rosbag, rospy
publishers, messages = json.load(sys.stdin)
classes = [genpy.dynamic.generate_dynamic(each[1], each[3])[each[1]] for each in publishers]
headers = []
for topic, type_, md5sum, definition, callerid, latching in publishers:
    header = {"topic": topic, "type": type_, "md5sum": md5sum, "message_definition": definition}
    if callerid:
        header.update(callerid=callerid, latching="1" if latching else "0")
    headers.append(header)
bags = []
for compression in "none", "bz2", "lz4":
    for state in "closed", "open":
        path = os.path.join(sys.argv[1], compression + "-" + state + ".bag")
        bag = rosbag.Bag(path, "w", compression=compression, chunk_threshold=20000)
        for which, time, data in messages:
            topic, type_, md5sum = publishers[which][:3]
            raw = type_, bytes.fromhex(data), md5sum, classes[which]
            stamp = rospy.Time(*divmod(time, 10**9))
            bag.write(topic, raw, stamp, raw=True, connection_header=headers[which])
        if state == "closed":
            bag.close()
        else:
            bag._file.flush()
            bags.append(bag)
os._exit(0)
"""
READ_IN_PYTHON = """
import json, sys, rosbag
for path in sys.argv[1:]:
    print(json.dumps([
        [topic, raw[0], raw[2], header.get("callerid", b"").decode(),
         header.get("latching") == b"1", t.to_nsec(), raw[1].hex()]
        for topic, raw, t, header
        in rosbag.Bag(path).read_messages(raw=True, return_connection_header=True)
    ]))
"""
APPEND_IN_PYTHON = """
import sys, rosbag, rospy
for topic, raw, _ in rosbag.Bag(sys.argv[1]).read_messages("/number", raw=True):
    pass
with rosbag.Bag(sys.argv[1], "a") as bag:
    bag.write(topic, raw, rospy.Time(1800000000), raw=True)
"""
INFO_IN_PYTHON = """
import json, sys, rosbag
for words in json.loads(sys.argv[1]):
    rosbag.rosbagmain(["rosbag", "info", *words])
    print("END")
"""


def needs_ros(path: str | Path) -> list[pytest.MarkDecorator]:
    missing = not Path(path).exists()
    reason = f"{path} (Debian: librosbag4d, python3-rosbag) is not installed"
    return [pytest.mark.real_ros, pytest.mark.skipif(missing, reason=reason)]


def in_python(program: str, *words: str | Path, input: str = "") -> str:
    """Run a program with Debian's rosbag; return what it prints."""
    done = subprocess.run(
        [PYTHON, "-c", program, *map(str, words)],
        env={**os.environ, "PYTHONPATH": ""},
        input=input,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def found_in_python(*paths: Path) -> list[list[Found]]:
    """Return the messages of bags, as ROS reads them."""
    return [
        [(*each[:5], each[5], bytes.fromhex(each[6])) for each in json.loads(line)]
        for line in in_python(READ_IN_PYTHON, *paths).splitlines()
    ]


@pytest.fixture(scope="module")
def theirs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of bags by ROS in Python, each with and without having been closed."""
    folder = tmp_path_factory.mktemp("theirs")
    publishers = [
        (topic, type_, recordings.INTERFACES.md5(type_), full_text(type_), callerid, latching)
        for topic, type_, callerid, latching in recordings.PUBLISHERS
    ]
    messages = [(which, time, data.hex()) for which, time, data in recordings.messages()]
    in_python(WRITE_IN_PYTHON, folder, input=json.dumps([publishers, messages]))
    return folder


def expected_of_ros() -> list[Found]:
    """Return the messages of the recording; ROS in Python has one connection for each topic."""
    return [
        (*each[:3], "/talker", *each[4:]) if each[3] == "/other" else each
        for each in recordings.expected()
    ]


class TestPython:
    pytestmark = needs_ros("/usr/lib/python3/dist-packages/rosbag/bag.py")

    def test_it_reads_ours(self, tmp_path: Path) -> None:
        paths = [tmp_path / f"{compression}.bag" for compression in COMPRESSIONS]
        for path, compression in zip(paths, COMPRESSIONS, strict=True):
            recordings.write(path, compression)
        cut, restored = tmp_path / "cut.bag", tmp_path / "restored.bag"
        content = paths[-1].read_bytes()
        cut.write_bytes(content[: len(content) // 2])
        reindex(cut, restored)
        *found, after = found_in_python(*paths, restored)
        for each in found:
            assert sorted(each) == sorted(recordings.expected())
        assert after == recordings.read(restored)
        assert len(after) > 100

    @each_compression
    def test_its_bags_are_read(self, theirs: Path, compression: str) -> None:
        path = theirs / f"{compression}-closed.bag"
        assert recordings.read(path) == expected_of_ros()
        with open_reader(path) as bag:
            assert bag.compression == compression

    def test_its_bags_that_were_not_closed_are_restored(self, theirs: Path, tmp_path: Path) -> None:
        restored = [tmp_path / f"{compression}.bag" for compression in COMPRESSIONS]
        for path in restored:
            found = reindex(theirs / f"{path.stem}-open.bag", path)
            assert found.messages > 300
            if path.stem == "none":  # The last chunk was not complete, but all of it was there.
                assert found.messages == 400
        for path, messages in zip(restored, found_in_python(*restored), strict=True):
            assert set(messages) <= set(expected_of_ros())
            assert sorted(messages) == sorted(recordings.read(path))

    def test_its_bag_can_be_appended_to(self, theirs: Path, tmp_path: Path) -> None:
        path, restored = tmp_path / "it.bag", tmp_path / "restored.bag"
        path.write_bytes((theirs / "bz2-closed.bag").read_bytes())
        append(path)
        reindex(path, restored)
        for found in found_in_python(path, restored):
            assert len(found) == 401
            assert found[-1][0] == "/number" and found[-1][5] == 1_800_000_000 * 10**9

    def test_it_appends_to_ours(self, tmp_path: Path) -> None:
        path, restored = tmp_path / "it.bag", tmp_path / "restored.bag"
        recordings.write(path, "lz4")
        in_python(APPEND_IN_PYTHON, path)
        reindex(path, restored)
        for each in (path, restored):
            found = recordings.read(each)
            assert found[:-1] == recordings.expected()
            assert found[-1][0] == "/number" and found[-1][5] == 1_800_000_000 * 10**9

    def test_info_is_the_same(self, theirs: Path) -> None:
        options = [[], ["--freq"], ["-y"], ["-y", "--freq"], ["-y", "-k", "topics"]]
        words = [
            [*each, str(theirs / f"{compression}-closed.bag")]
            for compression in COMPRESSIONS
            for each in options
        ]
        texts = in_python(INFO_IN_PYTHON, json.dumps(words)).split("END\n")
        for each, text in zip(words, texts, strict=False):
            ours = CliRunner().invoke(command, ["bag", "info", *each], prog_name="fibws")
            assert comparable(ours.output) == comparable(text)


def comparable(info: str) -> list[str]:
    """Leave out times: theirs are those of the first and the last chunk, which overlap."""
    info = re.sub(r"(?m)^(start|end|duration): .*$", r"\1", info)
    return [line.rstrip() for line in re.sub(r" @ +[\d.]+ KB/s", " @ RATE", info).splitlines()]


class TestCpp:
    pytestmark = needs_ros(CPP)

    @staticmethod
    def copy(source: Path, target: Path, compression: str) -> None:
        """Copy a bag by ROS's library in C++."""
        options = [] if compression == "none" else [f"--{compression}"]
        words = ["-q", "-p", "rosbag/NoEncryptor", *options, "-o", str(target), str(source)]
        subprocess.run([str(CPP), *words], check=True, capture_output=True)

    @each_compression
    def test_it_reads_ours_and_its_bags_are_read(self, tmp_path: Path, compression: str) -> None:
        ours, theirs = tmp_path / "ours.bag", tmp_path / "theirs.bag"
        recordings.write(ours, compression)
        for method in COMPRESSIONS:
            self.copy(ours, theirs, method)
            assert sorted(recordings.read(theirs)) == sorted(recordings.expected())
            with open_reader(theirs) as bag:
                assert bag.compression == method

    @each_compression
    def test_its_bags_that_were_cut_are_restored(self, tmp_path: Path, compression: str) -> None:
        ours, theirs, restored = (tmp_path / f"{name}.bag" for name in ("ours", "theirs", "back"))
        recordings.write(ours, "none")
        self.copy(ours, theirs, compression)
        content = theirs.read_bytes()
        with open_reader(theirs) as bag:
            chunks = [(each.position, sum(each.counts.values())) for each in bag.chunks]
            end = chunk_data_end(bag)
        for place in (end, end + 10, len(content) - 1):
            theirs.write_bytes(content[:place])
            assert reindex(theirs, restored).messages == sum(count for _, count in chunks)
            assert sorted(recordings.read(restored)) == sorted(recordings.expected())
            self.copy(restored, theirs, "none")
            assert sorted(recordings.read(theirs)) == sorted(recordings.expected())


def chunk_data_end(bag: Reader) -> int:
    """Return where the data of the last chunk ends, before its index."""
    assert isinstance(bag.size, int)
    last = bag.chunks[-1]
    header = len("compression=") + len(last.compression) + 4 + 8 + 13 + 4
    return last.position + header + 4 + last.compressed_size


def test_our_bags_are_read_by_ourselves(tmp_path: Path) -> None:
    # The lists above are worth as much as this one.
    path = tmp_path / "it.bag"
    recordings.write(path, "none")
    assert recordings.read(path) == recordings.expected()
    assert len(recordings.expected()) == 400
    with open_writer(tmp_path / "copy.mcap") as writer, open_reader(path) as bag:
        copies = {each.id: writer.copy_connection(each) for each in bag.connections}
        for connection, time, data in bag.messages():
            writer.write(copies[connection.id], time, data)
    assert recordings.read(tmp_path / "copy.mcap") == recordings.expected()
