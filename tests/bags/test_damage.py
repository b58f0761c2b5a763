"""Bags that were cut off, damaged, or made to do harm."""

from __future__ import annotations

import bz2
import contextlib
import random
import struct
import subprocess
import sys
import tracemalloc
from pathlib import Path
from time import process_time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_inputs import examples, times

from fibws.bags import ChunkInfo, bag_format, open_reader, open_writer, reader, reindex
from fibws.bags.bag_writer import BagWriter
from fibws.bags.compression import MAX_START
from fibws.errors import BagError, BagFormatError, BagNotIndexed

from .test_bags import FORMATS, add, contents, each_suffix, every_format, write_numbers

LARGE = 3_000_000
"""More memory, in bytes, than anything here may need."""
MOST_RESTORED = 5 * MAX_START // 2
"""What restoring a damaged chunk may need, in bytes: its messages, and where each of them is."""


@pytest.fixture(scope="module")
def bags(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], Path]:
    """A bag of each format with small chunks."""
    folder = tmp_path_factory.mktemp("bags")
    paths = {each: folder / f"{each[1]}.{each[0]}" for each in FORMATS}
    for (_, compression), path in paths.items():
        write_numbers(path, compression)
    return paths


def chunk_end(chunk: ChunkInfo) -> int:
    """Return where a chunk ends, or some bytes after it."""
    return chunk.position + 100 + chunk.compressed_size


@every_format
def test_reindex_restores_complete_chunks_of_a_cut_bag(
    bags: dict[tuple[str, str], Path], tmp_path: Path, suffix: str, compression: str
) -> None:
    path = bags[suffix, compression]
    content = path.read_bytes()
    with open_reader(path) as bag:
        messages = contents(bag)
        chunks = bag.chunks
    seeded = random.Random(suffix + compression)
    places = [seeded.randrange(5000, len(content)) for _ in range(times(0.1))]
    places += [chunk.position + shift for chunk in chunks[1:3] for shift in (-1, 0, 1, 30)]
    cut, restored = tmp_path / f"cut.{suffix}", tmp_path / f"restored.{suffix}"
    for place in places:
        cut.write_bytes(content[:place])
        found = reindex(cut, restored)
        with open_reader(restored) as bag:
            after = contents(bag)
        assert after == messages[: len(after)]
        assert found.messages == len(after)
        last = max((chunk.end for chunk in chunks if chunk_end(chunk) <= place), default=-1)
        assert len(after) >= sum(time <= last for *_, time, _ in messages)
        with open_reader(cut, allow_unindexed=True) as bag:
            assert contents(bag) == after
    assert len(after) > 0


@every_format
def test_reindex_of_a_complete_bag_changes_nothing(
    bags: dict[tuple[str, str], Path], tmp_path: Path, suffix: str, compression: str
) -> None:
    path = bags[suffix, compression]
    before = path.read_bytes()
    restored = tmp_path / f"restored.{suffix}"
    assert reindex(path, restored) == (1000, 0, 0)
    assert path.read_bytes() == before
    with open_reader(path) as one, open_reader(restored) as other:
        assert contents(one) == contents(other)
        assert one.compression == other.compression


@every_format
@pytest.mark.parametrize("number", [0, 1])
def test_reindex_goes_on_after_damage(
    bags: dict[tuple[str, str], Path], tmp_path: Path, suffix: str, compression: str, number: int
) -> None:
    # The first chunk has the connections, which the end of the bag has, too.
    content = bytearray(bags[suffix, compression].read_bytes())
    with open_reader(bags[suffix, compression]) as bag:
        messages = contents(bag)
        chunk, next_chunk = bag.chunks[number : number + 2]
    content[chunk.position : next_chunk.position - 20] = bytes(
        next_chunk.position - 20 - chunk.position
    )
    damaged, restored = tmp_path / f"damaged.{suffix}", tmp_path / f"restored.{suffix}"
    damaged.write_bytes(content)
    found = reindex(damaged, restored)
    with open_reader(restored) as bag:
        assert contents(bag) == [
            each for each in messages if not chunk.start <= each[5] <= chunk.end
        ]
    assert 0 < found.lost < len(content) // 2


def test_reindex_reports_messages_that_may_be_wrong(
    bags: dict[tuple[str, str], Path], tmp_path: Path
) -> None:
    path = bags["mcap", "none"]
    content = bytearray(path.read_bytes())
    with open_reader(path) as bag:
        chunk = bag.chunks[1]
    damaged, restored = tmp_path / "damaged.mcap", tmp_path / "restored.mcap"
    content[chunk.position + 200] ^= 1  # In a message, or in its definition.
    damaged.write_bytes(content)
    with open_reader(damaged) as bag, pytest.raises(BagFormatError, match=f"reindex {damaged}"):
        list(bag.messages())
    assert reindex(damaged, restored) == (1000, 0, 1)
    middle = chunk.position + chunk.compressed_size // 2
    content[middle : middle + 200] = b"\xff" * 200  # Also the length of a record.
    damaged.write_bytes(content)
    found = reindex(damaged, restored)
    assert 0 < found.messages < 1000
    assert (found.lost > 0, found.damaged) == (True, 1)


@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_wrong_length_of_a_chunk_costs_only_its_messages(
    bags: dict[tuple[str, str], Path], tmp_path: Path, compression: str
) -> None:
    content = bytearray(bags["bag", compression].read_bytes())
    with open_reader(bags["bag", compression]) as bag:
        messages = contents(bag)
        chunk, last = bag.chunks[1], bag.chunks[-1]
    place = content.index(b"size=", chunk.position) + 9
    length = last.position - place  # It ends in the middle of the last but one.
    content[place : place + 4] = length.to_bytes(4, "little")
    damaged, restored = tmp_path / "damaged.bag", tmp_path / "restored.bag"
    damaged.write_bytes(content)
    reindex(damaged, restored)
    with open_reader(restored) as bag:
        after = contents(bag)
    assert [each for each in messages if not chunk.start <= each[5] <= chunk.end] == [
        each for each in after if not chunk.start <= each[5] <= chunk.end
    ]


@each_suffix
def test_many_false_chunks_take_little_time(tmp_path: Path, suffix: str) -> None:
    # Each claims all of the file after it. A search that began anew at each would take minutes.
    path, restored = tmp_path / f"it.{suffix}", tmp_path / f"restored.{suffix}"
    write_numbers(path, count=10)
    content = path.read_bytes()
    if suffix == "bag":
        fields = {"compression": b"bz2", "size": struct.pack("<I", 2**20)}
        false = bag_format.pack_record(bag_format.CHUNK, fields, b"")[:-4] + b"\xff\xff\xff\x0f"
    else:
        size = 2**28
        start = struct.pack("<QQQIIQ", 0, 0, size, 0, 0, size)
        false = struct.pack("<BQ", 6, len(start) + size) + start
    path.write_bytes(content[:4200] + false * 20_000)
    begin = process_time()
    with contextlib.suppress(BagError):
        reindex(path, restored)
    assert process_time() - begin < 30


def test_chunk_that_a_recorder_had_not_finished_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    # As roscpp's recorder leaves it: the header of the chunk was written without its size.
    path, restored = tmp_path / "it.bag", tmp_path / "restored.bag"
    write_numbers(path, count=100)
    content = path.read_bytes()
    with open_reader(path) as bag:
        [chunk] = bag.chunks
        messages = contents(bag)
    record = bag_format.pack_record(
        bag_format.CHUNK, {"compression": b"none", "size": bytes(4)}, b""
    )
    begin = chunk.position + len(record)
    header = content[: chunk.position]
    place = header.index(b"index_pos=") + 10
    header = header[:place] + bytes(8) + header[place + 8 :]
    path.write_bytes(header + record + content[begin : begin + chunk.size - 10])
    assert reindex(path, restored).messages == 99
    with open_reader(restored) as bag:
        assert contents(bag) == messages[:99]


RECORDER = """
import sys
from fibws.bags import open_writer

writer = open_writer(sys.argv[1], sys.argv[2], 20_000)
publisher = writer.connection("/a", "std_msgs/Int32", "*", "int32 data")
number = 0
while True:
    for _ in range(777):
        writer.write(publisher, number, number.to_bytes(4, "little"))
        number += 1
    writer.flush()
    print(number, flush=True)
"""


@every_format
def test_killed_recorder_loses_only_what_it_had_not_flushed(
    tmp_path: Path, suffix: str, compression: str
) -> None:
    path, restored = tmp_path / f"it.{suffix}", tmp_path / f"restored.{suffix}"
    seeded = random.Random(suffix + compression)
    for _ in range(times(0.05)):
        words = [sys.executable, "-c", RECORDER, str(path), compression]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            for _ in range(seeded.randrange(1, 20)):
                process.stdout.readline()
            process.kill()
            flushed = int((process.stdout.read() or "0\n").splitlines()[-1])
        found = reindex(path, restored)
        with open_reader(restored) as bag:
            assert [time for _, time, _ in bag.messages()] == list(range(found.messages))
        assert found.messages >= flushed


def bomb(tmp_path: Path, claimed: int, real: int) -> Path:
    """Write a bag whose chunk claims one size and decompresses to another one."""
    path = tmp_path / "bomb.bag"
    with open_writer(path, "bz2") as writer:
        writer.write(add(writer, "/a"), 1, b"1234")
    with open_reader(path) as bag:
        [chunk] = bag.chunks
    content = path.read_bytes()
    data = bz2.compress(bytes(real))
    record = bag_format.pack_record(
        bag_format.CHUNK, {"compression": b"bz2", "size": struct.pack("<I", claimed)}, data
    )
    place = content.index(b"index_pos=") + 10
    old = int.from_bytes(content[place : place + 8], "little")
    moved = chunk.position + len(record)
    header = content[:place] + moved.to_bytes(8, "little") + content[place + 8 : chunk.position]
    path.write_bytes(header + record + content[old:])
    return path


def test_bomb_of_many_chunks_of_one_time_is_rejected(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "it.bag"
    with open_writer(path, "bz2") as writer:
        connection = add(writer, "/a")
        for _ in range(20):
            for time in (1, 2):
                writer.write(connection, time, bytes(500_000))
            writer.flush()
    monkeypatch.setattr(reader, "MAX_MEMORY", 4_000_000)
    monkeypatch.setattr(reader, "MAX_FILE", 12_000_000)
    with open_reader(path) as bag, pytest.raises(BagFormatError, match="12000000") as caught:
        list(bag.messages())
    assert str(path) in str(caught.value)
    monkeypatch.setattr(reader, "MAX_FILE", 18_000_000)
    with open_reader(path) as bag:
        assert [time for _, time, _ in bag.messages()] == [1] * 20 + [2] * 20


def test_temporary_file_is_used_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "it.bag"
    with open_writer(path, "bz2") as writer:
        connection = add(writer, "/a")
        for pair in range(10):
            for times in ((0, 2), (1, 3)):
                for time in times:
                    writer.write(connection, 10 * pair + time, bytes(500_000))
                writer.flush()
    monkeypatch.setattr(reader, "MAX_MEMORY", 1_500_000)
    monkeypatch.setattr(reader, "MAX_FILE", 2_500_000)
    with open_reader(path) as bag:
        found = [time for _, time, _ in bag.messages()]
    assert found == [10 * pair + time for pair in range(10) for time in range(4)]


@each_suffix
def test_chunk_that_an_index_lists_twice_is_read_once(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"it.{suffix}"
    with open_writer(path) as writer:
        writer.write(add(writer, "/a"), 1, b"1234")
        writer.flush()
        if isinstance(writer, BagWriter):
            writer.chunks *= 2
        else:
            chunks: list[object] = vars(writer.mcap)["_Writer__chunk_indices"]
            chunks *= 2
    with pytest.raises(BagNotIndexed, match="overlap"):
        open_reader(path)
    with open_reader(path, allow_unindexed=True) as bag:
        assert [message[1:] for message in bag.messages()] == [(1, b"1234")]


@pytest.mark.parametrize("claimed", [100, 1_000_000, 2**32 - 1])
@pytest.mark.long
def test_decompression_bomb_is_rejected_early(tmp_path: Path, claimed: int) -> None:
    path = bomb(tmp_path, claimed, 50_000_000)
    tracemalloc.start()
    try:
        with (
            open_reader(path) as bag,
            pytest.raises(BagFormatError, match="uncompressed") as caught,
        ):
            list(bag.messages())
        assert tracemalloc.get_traced_memory()[1] < LARGE
    finally:
        tracemalloc.stop()
    assert str(path) in str(caught.value)


@pytest.mark.long
def test_decompression_bomb_is_restored_in_part(tmp_path: Path) -> None:
    """What it claims is not to be trusted; the memory is bounded by what is there."""
    path = bomb(tmp_path, 10**9, MOST_RESTORED)
    tracemalloc.start()
    try:
        reindex(path, tmp_path / "restored.bag")
        assert tracemalloc.get_traced_memory()[1] < MOST_RESTORED
    finally:
        tracemalloc.stop()


@each_suffix
@examples(1)
@given(data=st.data())
@pytest.mark.long
def test_damaged_bag_gives_an_error_of_its_own(
    bags: dict[tuple[str, str], Path],
    tmp_path_factory: pytest.TempPathFactory,
    suffix: str,
    data: st.DataObject,
) -> None:
    methods = [each for each in FORMATS if each[0] == suffix]
    content = bytearray(bags[data.draw(st.sampled_from(methods))].read_bytes())
    kind = data.draw(st.sampled_from(["flip", "number", "cut", "insert"]))
    # Most of a bag is messages; its start and end have what can go wrong.
    near = st.integers(0, 300) | st.integers(4096, 4500) | st.integers(0, len(content) - 1)
    place = data.draw(near | near.map(lambda each: len(content) - 1 - each))
    if kind == "flip":
        content[place] ^= 1 << data.draw(st.integers(0, 7))
    elif kind == "number":
        content[place : place + 4] = data.draw(
            st.sampled_from([b"\xff" * 4, bytes(4), b"\0\0\0\x80", b"\1\0\0\0"])
        )
    elif kind == "cut":
        del content[place:]
    else:
        content[place:place] = data.draw(st.binary(max_size=20))
    folder = tmp_path_factory.mktemp("damaged")
    path = folder / f"it.{suffix}"
    path.write_bytes(content)
    tracemalloc.start()
    try:
        for allow in (False, True):
            try:
                with open_reader(path, allow_unindexed=allow) as bag:
                    for _ in bag.messages():
                        pass
            except BagError as error:
                assert "\n" not in str(error)
        assert tracemalloc.get_traced_memory()[1] < LARGE
        try:
            reindex(path, folder / f"restored.{suffix}")
        except BagError as error:
            assert "\n" not in str(error)
        else:
            with open_reader(folder / f"restored.{suffix}") as bag:
                for _ in bag.messages():
                    pass
        # Damaged bytes of bzip2 may stand for megabytes of equal ones.
        assert tracemalloc.get_traced_memory()[1] < MOST_RESTORED
    finally:
        tracemalloc.stop()


@each_suffix
@examples(1)
@given(content=st.binary(max_size=500))
def test_random_records_give_an_error_of_its_own(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, content: bytes
) -> None:
    start = bag_format.VERSION_LINE if suffix == "bag" else b"\x89MCAP0\r\n"
    folder = tmp_path_factory.mktemp("random")
    path = folder / f"it.{suffix}"
    path.write_bytes(start + content)
    with pytest.raises(BagError):
        open_reader(path)
    try:
        reindex(path, folder / f"restored.{suffix}")
    except BagError as error:
        assert "\n" not in str(error)
