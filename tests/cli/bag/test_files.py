"""``fibws bag info``, ``check``, ``filter``, ``compress``, ``decompress`` and ``reindex``."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import pytest
import yaml
from bags.test_mcap_files import write as write_with_attachment
from click.testing import CliRunner, Result

from fibws.bags import open_reader, open_writer
from fibws.cli.commands import command
from fibws.exit_signals import exit_signals
from fibws.interfaces import Interfaces
from fibws.interfaces.serialization import Serializers

Tool: TypeAlias = Callable[..., Result]
INTERFACES = Interfaces()
SERIALIZERS = Serializers(INTERFACES)
SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND


@pytest.fixture
def bag() -> Tool:
    """Run ``fibws bag`` without a hub."""

    def run(*words: str | Path) -> Result:
        return CliRunner().invoke(command, ["bag", *map(str, words)], prog_name="fibws")

    return run


@pytest.fixture(params=["bag", "mcap"])
def path(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A bag of ten seconds: numbers at 10 Hz of two nodes, and a path."""
    path = tmp_path / f"lab.{request.param}"
    with open_writer(path, chunk_size=2000) as writer:

        def add(topic: str, type_: str, callerid: str) -> Callable[[int, object], None]:
            texts = INTERFACES.md5(type_), INTERFACES.full_text(type_)
            connection = writer.connection(topic, type_, *texts, callerid=callerid, latching=True)
            serializer = SERIALIZERS.of(type_)
            return lambda time, values: writer.write(connection, time, serializer.serialize(values))  # type: ignore[arg-type]

        nodes = [add("/number", "std_msgs/Int32", name) for name in ("/one", "/two")]
        pose = add("/pose", "geometry_msgs/PointStamped", "/robot")
        for number in range(100):
            time = START + number * SECOND // 10
            nodes[number % 2](time, {"data": number})
            if number % 50 == 0:
                stamp = {"secs": 5 + number, "nsecs": 500_000_000}
                header = {"seq": 0, "stamp": stamp, "frame_id": "map"}
                pose(time, {"header": header, "point": {"x": float(number), "y": 0.0, "z": 0.0}})
    return path


def numbers(path: Path) -> list[int]:
    with open_reader(path) as reader:
        found = reader.messages({"/number"})
        return [int.from_bytes(data, "little") for _, _, data in found]


# info


def test_info_of_a_bag(bag: Tool, path: Path) -> None:
    result = bag("info", path)
    assert result.exit_code == 0, result.output
    rows = dict(line.split(":", 1) for line in result.output.splitlines() if line[0] != " ")
    assert rows["duration"].strip() == "9.9s"
    assert rows["start"].endswith("(1700000000.00)")
    assert rows["messages"].strip() == "102"
    assert rows["types"].strip().startswith("geometry_msgs/PointStamped [c63aecb41bfdfd6b7e1fac37c")
    assert (
        rows["topics"].strip()
        == "/number   100 msgs    : std_msgs/Int32             (2 connections)"
    )
    assert "@ 10.0 Hz" in bag("info", "--freq", path).output


def test_info_for_programs(bag: Tool, path: Path) -> None:
    found = yaml.safe_load(bag("info", "--yaml", "--freq", path).output)
    assert found == json.loads(bag("info", "--json", "--freq", path).output)
    assert found["topics"][0] == {
        "topic": "/number",
        "type": "std_msgs/Int32",
        "messages": 100,
        "connections": 2,
        "frequency": 10.0,
    }
    assert (found["messages"], found["indexed"], found["duration"]) == (102, True, 9.9)


@pytest.mark.parametrize(
    ("key", "text"),
    [
        ("duration", "9.9\n"),
        ("topics[1].messages", "2\n"),
        ("topics[1]", "topic: /pose\ntype: geometry_msgs/PointStamped\nmessages: 2\n"),
        ("indexed", "True\n"),
    ],
)
def test_info_of_a_key(bag: Tool, path: Path, key: str, text: str) -> None:
    assert bag("info", "-y", "-k", key, path).output == text


def test_info_of_an_unknown_key_names_the_nearest(bag: Tool, path: Path) -> None:
    result = bag("info", "-y", "-k", "messges", path)
    assert result.exit_code == 2
    assert "messages" in result.output
    assert bag("info", "-k", "messages", path).exit_code == 2


def test_info_of_several_bags(bag: Tool, path: Path) -> None:
    assert bag("info", path, path).output.count("messages:") == 2
    assert "\n---\n" in bag("info", path, path).output


def test_file_that_is_no_bag_is_an_error_in_one_line(bag: Tool, tmp_path: Path) -> None:
    path = tmp_path / "it.bag"
    for name in ("info", "check", "compress", "decompress", "reindex"):
        for content in (None, "hello", ""):
            if content is not None:
                path.write_text(content)
            result = bag(name, path)
            assert result.exit_code == 1
            assert result.output.count("\n") == 1
            assert result.output.startswith("Error: ") and str(path) in result.output
            assert not path.exists() or path.read_text() == content
        path.unlink()
    assert bag("filter", path, tmp_path / "other.bag", "True").output.startswith("Error: ")
    assert not list(tmp_path.iterdir())


# check


def test_check_of_known_types(bag: Tool, path: Path) -> None:
    result = bag("check", path)
    assert (result.exit_code, result.output) == (0, "Bag file does not need any migrations.\n")


def test_check_lists_changed_and_unknown_types(bag: Tool, tmp_path: Path) -> None:
    path = tmp_path / "old.bag"
    with open_writer(path) as writer:
        for type_ in ("std_msgs/Int32", "no_such_pkg/Thing"):
            connection = writer.connection("/a", type_, "0" * 32, "int32 older")
            writer.write(connection, START, b"1234")
    lines = bag("check", path).output.splitlines()
    assert lines[1:] == [
        f" * From: no_such_pkg/Thing [{'0' * 32}]",
        "   To:   Unknown",
        f" * From: std_msgs/Int32 [{'0' * 32}]",
        "   To:   std_msgs/Int32 [da5909fbe378aeaf85e547e830cc1bb7]",
    ]


def test_check_finds_messages_that_do_not_fit(bag: Tool, tmp_path: Path) -> None:
    path = tmp_path / "bad.bag"
    with open_writer(path) as writer:
        writer.write(writer.connection("/a", "std_msgs/Int32", "*", "int32 data"), START, b"12345")
    result = bag("check", path)
    assert result.exit_code == 1
    assert "/a" in result.output and "1 bytes too many" in result.output


def test_check_finds_all_faults(bag: Tool, tmp_path: Path) -> None:
    path = tmp_path / "bad.bag"
    with open_writer(path) as writer:
        writer.connection("/odd", "std_msgs/Odd", "0" * 32, "no_such_pkg/Thing it")
        for topic in ("/a", "/b"):
            connection = writer.connection(topic, "std_msgs/Int32", "*", "int32 data")
            for data in (b"12345", b"123", b"1234"):
                writer.write(connection, 0, data)
    result = bag("check", path)
    assert result.exit_code == 1
    for topic in ("/odd", "/a", "/b"):
        assert f"{topic}" in result.output
    assert "with the time 0: 3" in result.output
    assert len(result.output.splitlines()) == 5


# filter


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("topic == '/number' and m.data >= 97", [97, 98, 99]),
        ("topic != '/pose' and t.secs < 1700000001 and t.nsecs >= 800000000", [8, 9]),
        ("topic == '/number' and t.to_sec() > 1700000009.85", [99]),
        ("topic in ('/number', '/x') and m.data % 40 == 0", [0, 40, 80]),
        ("topic == '/pose' and m.header.stamp.to_sec() == 55.5", []),
        (
            "topic == '/number' and str(m.data).startswith('9') and m.data > 50",
            list(range(90, 100)),
        ),
    ],
)
def test_filter_by_an_expression(
    bag: Tool, path: Path, expression: str, expected: list[int]
) -> None:
    target = path.with_name("part.bag")
    result = bag("filter", path, target, expression)
    assert result.exit_code == 0, result.output
    assert numbers(target) == expected
    with open_reader(target) as reader:
        poses = reader.message_count - len(expected)
        assert poses == ("55.5" in expression)
        assert all(each.callerid and each.latching for each in reader.connections)


def test_filter_by_bytes(bag: Tool, tmp_path: Path) -> None:
    path, target = tmp_path / "it.bag", tmp_path / "part.bag"
    texts = (
        INTERFACES.md5("std_msgs/UInt8MultiArray"),
        INTERFACES.full_text("std_msgs/UInt8MultiArray"),
    )
    with open_writer(path) as writer:
        bytes_ = writer.connection("/bytes", "std_msgs/UInt8MultiArray", *texts)
        for number in range(10):
            writer.write(bytes_, START, bytes(8) + bytes([number, 0, 0, 0]) + bytes(range(number)))
    expression = "len(m.data) > 4 and m.data[4] == 4 and sum(m.data) <= 15 and 5 not in m.data[:5]"
    result = bag("filter", path, target, expression)
    assert result.exit_code == 0, result.output
    with open_reader(target) as reader:
        assert [len(data) - 12 for _, _, data in reader.messages()] == [5, 6]


def test_filter_by_topics_and_times(bag: Tool, path: Path) -> None:
    target = path.with_name(f"part{path.suffix}")
    result = bag("filter", path, target, "--topic", "/number", "--start", "1", "--end", "1.5", "-q")
    assert (result.exit_code, result.output) == (0, "")
    assert numbers(target) == [10, 11, 12, 13, 14, 15]


def test_filter_says_how_many_messages_passed(bag: Tool, path: Path) -> None:
    target = path.with_name(f"part{path.suffix}")
    result = bag("filter", path, target, "topic == '/number' and m.data < 3")
    assert f"{target}: 3 of 102 messages" in result.stderr
    assert str(target) not in bag("filter", path, target, "True", "-q").stderr


def test_filter_says_that_attachments_are_not_copied(bag: Tool, tmp_path: Path) -> None:
    source, target = tmp_path / "it.mcap", tmp_path / "part.mcap"
    write_with_attachment(source)
    result = bag("filter", source, target, "True")
    assert result.exit_code == 0
    assert "has 2 other records (attachments, metadata)" in result.stderr


@pytest.mark.parametrize("number", [each for each in exit_signals() if each != signal.SIGINT])
@pytest.mark.parametrize("words", [("filter", "{bag}", "{new}", "True"), ("compress", "{bag}")])
def test_signal_leaves_the_folder_as_it_was(
    bag: Tool,
    path: Path,
    words: tuple[str, ...],
    number: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = {each: each.read_bytes() for each in path.parent.iterdir()}

    def run(*arguments: object, **others: object) -> None:
        signal.raise_signal(number)
        raise AssertionError("it went on")

    monkeypatch.setattr("fibws.cli.bag.filtering.Copy.run", run)
    monkeypatch.setattr("fibws.cli.bag.rewriting.rewrite_mcap", run)
    new = path.with_name(f"new{path.suffix}")
    result = bag(*(each.format(bag=path, new=new) for each in words))
    assert result.exit_code == 128 + number
    assert {each: each.read_bytes() for each in path.parent.iterdir()} == before
    assert signal.getsignal(number) == signal.SIG_DFL


def test_filter_changes_the_format(bag: Tool, path: Path) -> None:
    target = path.with_name("other.mcap" if path.suffix == ".bag" else "other.bag")
    assert bag("filter", path, target, "True").exit_code == 0
    assert numbers(target) == numbers(path)
    with open_reader(path) as one, open_reader(target) as other:
        mine, theirs = (
            sorted((each.callerid, each.md5sum, each.definition) for each in reader.connections)
            for reader in (one, other)
        )
        assert mine == theirs


def test_filter_prints_an_expression(bag: Tool, path: Path) -> None:
    target = path.with_name("part.bag")
    result = bag("filter", path, target, "t.secs == 1700000000", "-q", "-p", "topic + str(t.nsecs)")
    assert result.output.splitlines()[:2] == ["MATCH /number0", "MATCH /pose0"]
    assert "NO MATCH /number100000000" in result.output


@pytest.mark.parametrize(
    ("words", "fact"),
    [
        (("m.date > 5",), "data"),
        (("True", "-p", "m.date"), "--print failed"),
        (("__import__('os')",), "__import__"),
        (("topic ==",), "invalid syntax"),
        (("open('/etc/passwd')",), "open"),
        ((), "--topic"),
        (("--topic", "/numbr"), "/number"),
        (("t > 5",), "t.to_sec()"),
        (("--start", "1000000"), "--start must be within"),
        (("--start", "2", "--end", "1"), "--end must not be before --start"),
    ],
)
def test_filter_that_fails_leaves_the_target(
    bag: Tool, path: Path, words: tuple[str, ...], fact: str
) -> None:
    target = path.with_name("part.bag")
    target.write_text("precious")
    result = bag("filter", path, target, *words)
    assert result.exit_code == 2
    assert fact in result.output.partition("Error: ")[2]
    assert target.read_text() == "precious"
    assert sorted(each.name for each in path.parent.iterdir()) == sorted([path.name, "part.bag"])


def test_filter_of_a_bag_to_itself_is_refused(bag: Tool, path: Path) -> None:
    before = path.read_bytes()
    assert bag("filter", path, path, "True").exit_code == 2
    assert path.read_bytes() == before


@pytest.mark.parametrize("name", ["part.db3", "part.csv"])
def test_filter_to_a_format_that_is_not_written_is_refused(
    bag: Tool, path: Path, name: str
) -> None:
    target = path.with_name(name)
    result = bag("filter", path, target, "True")
    assert result.exit_code == 2
    assert ".mcap" in result.output
    assert not target.exists()


def test_filter_to_a_folder_is_refused(bag: Tool, path: Path, tmp_path: Path) -> None:
    result = bag("filter", path, tmp_path, "True")
    assert result.exit_code == 2
    assert f"{tmp_path} is a folder" in result.output


def test_filter_that_lets_nothing_pass_says_so(bag: Tool, path: Path, tmp_path: Path) -> None:
    target = tmp_path / "part.bag"
    result = bag("filter", "-q", path, target, "topic == '/numbr'")
    assert result.exit_code == 0
    fact = f"{target} is empty: the bag has no topic /numbr; did you mean /number?"
    assert result.output == f"Warning: no message passed the filter, {fact}\n"
    result = bag("filter", "-q", path, target, "topic == '/number' and m.data > 1000")
    assert result.output == f"Warning: no message passed the filter, {target} is empty\n"


def test_errors_name_the_file_that_was_given(bag: Tool, path: Path, tmp_path: Path) -> None:
    missing = tmp_path / "missing" / "part.bag"
    result = bag("filter", "-q", path, missing, "True")
    assert result.exit_code == 1
    assert result.output == f"Error: {missing}: No such file or directory\n"
    result = bag("compress", "-q", "--zstd" if path.suffix == ".bag" else "-j", path)
    assert result.exit_code == 1
    assert "compression" in result.output and "/." not in result.output


def test_bag_that_its_recorder_left_is_named(bag: Tool, path: Path) -> None:
    active = path.rename(f"{path}.active")
    os.truncate(active, active.stat().st_size // 2)
    for words in (("info",), ("check",), ("play", "--hub", "ws://127.0.0.1:9")):
        result = bag(*words, path)
        assert result.exit_code == 1
        assert f"{path} was not closed by its recorder" in result.output
        assert f"bag reindex {active}" in result.output


def test_complete_bag_of_another_name_is_named(bag: Tool, path: Path) -> None:
    active = path.rename(f"{path}.active")
    result = bag("info", path)
    assert result.exit_code == 1
    assert f"{active} is complete" in result.output and "reindex" not in result.output


@pytest.mark.parametrize("suffix", ["bag", "mcap"])
def test_bag_that_is_written_is_not_said_to_need_an_index(
    bag: Tool, tmp_path: Path, suffix: str
) -> None:
    path, active = tmp_path / f"a.{suffix}", tmp_path / f"a.{suffix}.active"
    with open_writer(active) as writer:
        connection = writer.connection("/n", "std_msgs/Int32", "0" * 32, "int32 data")
        writer.write(connection, 1, bytes(4))
        writer.flush()
        for command in ("info", "check", "play"):
            for name in (path, active):
                result = bag(command, name)
                assert result.exit_code == 1
                assert f"{active}" in result.output and "being written by" in result.output
                assert "reindex" not in result.output


@pytest.mark.parametrize("name", ["info", "check"])
def test_bags_after_one_that_cannot_be_read_are_inspected(
    bag: Tool, path: Path, tmp_path: Path, name: str
) -> None:
    other = tmp_path / "other.bag"
    other.write_bytes(path.read_bytes())
    path.write_bytes(b"")
    result = bag(name, tmp_path / "none.bag", path, other)
    assert result.exit_code == 1
    assert f"Error: {path}: the file is empty" in result.output
    assert "none.bag: No such file" in result.output
    assert ("messages: " if name == "info" else "does not need") in result.output


def test_check_reads_several_bags(bag: Tool, path: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.bag"
    with open_writer(bad) as writer:
        writer.write(writer.connection("/a", "std_msgs/Int32", "*", "int32 data"), START, b"12345")
    result = bag("check", bad, path)
    assert result.exit_code == 1
    assert f"{bad}: " in result.output
    last = result.output.splitlines()[-2:]
    assert last == [f"{path}:", "Bag file does not need any migrations."]
    assert bag("check", path, "rules.bmr").exit_code == 2


def test_reindex_says_how_many_messages_are_restored(bag: Tool, path: Path) -> None:
    assert f"{path}: 102 messages restored" in bag("reindex", path).output
    assert bag("reindex", "-q", "-f", path).output == ""


# compress, decompress


def test_compression_that_a_format_lacks_is_an_error(bag: Tool, path: Path) -> None:
    """Each error names the bag."""
    method = "zstd" if path.suffix == ".bag" else "bz2"
    result = bag("compress", f"--{method}", path)
    assert result.exit_code == 1
    assert f"{path}: compression '{method}' does not exist in" in result.output


def test_compress_and_decompress(bag: Tool, path: Path) -> None:
    before = numbers(path)
    backup = path.with_name(f"lab.orig{path.suffix}")
    path.chmod(0o640)
    for words in (("compress",), ("compress", "--lz4"), ("decompress",)):
        assert bag(*words, "-f", path).exit_code == 0
        assert numbers(path) == before
        assert path.stat().st_mode & 0o777 == 0o640
    with open_reader(path) as reader, open_reader(backup) as old:
        assert (reader.compression, old.compression) == ("none", "lz4")
        assert {each.callerid for each in reader.connections} == {"/one", "/two", "/robot"}


def test_compress_and_decompress_go_back_and_forth_and_keep_the_original(
    bag: Tool, path: Path
) -> None:
    original, before = path.read_bytes(), numbers(path)
    backup = path.with_name(f"lab.orig{path.suffix}")
    for words in (("compress", "--lz4"), ("decompress",), ("compress", "--lz4")):
        assert bag(*words, path).exit_code == 0
        assert backup.read_bytes() == original
        assert numbers(path) == before
        with open_reader(path) as reader:
            assert reader.compression == ("lz4" if "--lz4" in words else "none")


def test_reindex_does_not_overwrite_the_original(bag: Tool, path: Path) -> None:
    backup = path.with_name(f"lab.orig{path.suffix}")
    backup.write_text("precious")
    before = path.read_bytes()
    result = bag("reindex", path)
    assert result.exit_code == 1
    assert str(backup) in result.output and "--force" in result.output
    assert (path.read_bytes(), backup.read_text()) == (before, "precious")


@pytest.mark.parametrize("shift", [0, 60])
def test_damaged_bag_is_not_compressed_without_what_was_lost(
    bag: Tool, tmp_path: Path, shift: int
) -> None:
    """The head of a chunk is damaged, or its data, which has a checksum."""
    path = tmp_path / "lab.mcap"
    with open_writer(path, chunk_size=100) as writer:
        connection = writer.connection("/n", "std_msgs/Int32", "0" * 32, "int32 data")
        for number in range(100):
            writer.write(connection, number, bytes(4))
    with open_reader(path) as reader:
        place = reader.chunks[1].position + shift
    content = bytearray(path.read_bytes())
    content[place : place + 9] = b"\xff" * 9
    path.write_bytes(content)
    result = bag("compress", path)
    assert result.exit_code == 1
    assert f"Error: {path}" in result.output
    assert path.read_bytes() == content


def test_output_directory(bag: Tool, path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "small"
    folder.mkdir()
    before = path.read_bytes()
    assert bag("compress", "--lz4", "--output-dir", folder, path).exit_code == 0
    assert path.read_bytes() == before
    with open_reader(folder / path.name) as reader:
        assert reader.compression == "lz4"


def test_other_bags_are_written_after_one_that_fails(bag: Tool, path: Path) -> None:
    result = bag("compress", "--lz4", path.with_name("missing.bag"), path)
    assert result.exit_code == 1
    assert "missing.bag" in result.output
    with open_reader(path) as reader:
        assert reader.compression == "lz4"


# reindex


@pytest.mark.parametrize("command", ["reindex", "compress", "decompress"])
@pytest.mark.parametrize("suffix", ["bag", "mcap"])
def test_bag_that_is_written_is_not_changed(
    bag: Tool, tmp_path: Path, command: str, suffix: str
) -> None:
    active = tmp_path / f"a.{suffix}.active"
    with open_writer(active) as writer:
        connection = writer.connection("/n", "std_msgs/Int32", "0" * 32, "int32 data")
        writer.write(connection, 1, bytes(4))
        writer.flush()
        before = active.read_bytes()
        result = bag(command, "-q", str(active))
        assert result.exit_code == 1
        assert f"Error: {active}: being written by " in result.output
        assert active.read_bytes() == before
        assert list(tmp_path.iterdir()) == [active]
    assert bag(command, "-q", str(active)).exit_code == 0


def test_reindex_restores_a_cut_bag(bag: Tool, path: Path) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    assert "bag reindex" in bag("info", path).output
    result = bag("reindex", path)
    assert result.exit_code == 0
    assert "could not be read" in result.output
    found = numbers(path)
    assert found == list(range(len(found))) and len(found) > 20
    assert path.with_name(f"lab.orig{path.suffix}").read_bytes() == content[: len(content) // 2]
