"""MCAP files of other writers: without chunks, without summaries, with attachments."""

from __future__ import annotations

import tracemalloc
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer

from fibws.bags import open_reader, reindex
from fibws.errors import BagFormatError, BagNotIndexed

from .test_bags import INT32, contents


def write(path: Path, *, count: int = 300, **options: Any) -> None:
    """Write numbers with the library, as other programs do."""
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE, **options)
        writer.start("ros1", "another library")
        schema = writer.register_schema(INT32[0], "ros1msg", INT32[2].encode())
        channel = writer.register_channel("/a", "ros1", schema, {"callerid": "/talker"})
        for number in range(count):
            data = number.to_bytes(4, "little")
            writer.add_message(channel, number, data, publish_time=number + 1000, sequence=number)
        writer.add_attachment(5, 6, "map.pgm", "image/x-portable-graymap", b"P5")
        writer.add_metadata("robot", {"name": "r2d2"})
        writer.finish()  # type: ignore[no-untyped-call]


EXPECTED = [
    ("/a", *INT32[:2], "/talker", False, number, number.to_bytes(4, "little"))
    for number in range(300)
]


@pytest.mark.parametrize(
    "options",
    [
        {"use_chunking": False},
        {"index_types": IndexType.NONE, "use_statistics": False},
        {
            **{"index_types": IndexType.NONE, "use_statistics": False, "repeat_schemas": False},
            **{"repeat_channels": False, "use_summary_offsets": False},
        },
    ],
    ids=["no chunks", "no index", "no summary"],
)
def test_file_without_an_index_of_its_messages(tmp_path: Path, options: dict[str, Any]) -> None:
    path, restored = tmp_path / "it.mcap", tmp_path / "restored.mcap"
    write(path, chunk_size=1000, **options)
    with pytest.raises(BagNotIndexed, match="summary"):
        open_reader(path)
    with open_reader(path, allow_unindexed=True) as bag:
        assert contents(bag) == EXPECTED
        assert bag.message_count == 300
    assert reindex(path, restored) == (300, 0, 0)
    with open_reader(restored) as bag:
        assert contents(bag) == EXPECTED


def test_messages_outside_chunks_are_read_in_parts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "it.mcap"
    write(path, use_chunking=False)
    monkeypatch.setattr("fibws.bags.mcap_files._RUN", 1000)
    with open_reader(path, allow_unindexed=True) as bag:
        assert len(bag.chunks) > 5
        assert contents(bag) == EXPECTED


def test_reindex_keeps_all_that_is_not_a_message(tmp_path: Path) -> None:
    path, restored = tmp_path / "it.mcap", tmp_path / "restored.mcap"
    write(path)
    reindex(path, restored)
    with restored.open("rb") as file:
        reader = make_reader(file)
        [attachment] = reader.iter_attachments()
        [metadata] = reader.iter_metadata()
        assert (attachment.name, attachment.data, attachment.create_time) == ("map.pgm", b"P5", 5)
        assert metadata.metadata == {"name": "r2d2"}
        messages = [message for _, _, message in reader.iter_messages()]
    assert [(each.sequence, each.publish_time) for each in messages] == [
        (number, number + 1000) for number in range(300)
    ]


@pytest.mark.parametrize("options", [{"use_statistics": False}, {"index_types": IndexType.CHUNK}])
def test_messages_are_counted_if_the_file_does_not_say_how_many(
    tmp_path: Path, options: dict[str, Any]
) -> None:
    path = tmp_path / "it.mcap"
    write(path, chunk_size=1000, **options)
    with open_reader(path) as bag:
        assert bag.is_indexed
        assert bag.message_count == 300
        assert contents(bag) == EXPECTED


def test_wrong_checksum_is_an_error(tmp_path: Path) -> None:
    path, restored = tmp_path / "it.mcap", tmp_path / "restored.mcap"
    write(path, chunk_size=1000)
    content = bytearray(path.read_bytes())
    place = content.index((7).to_bytes(4, "little"), content.index(b"/talker") + 200)
    content[place] ^= 64
    path.write_bytes(content)
    with open_reader(path) as bag, pytest.raises(BagFormatError, match="checksum"):
        list(bag.messages())
    assert reindex(path, restored).messages == 300


def test_channels_share_the_text_of_their_schema(tmp_path: Path) -> None:
    path = tmp_path / "it.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros1")
        text = b"# %b\nint32 data\n" % (b"x" * 1_000_000)
        schema = writer.register_schema("std_msgs/Int32", "ros1msg", text)
        for number in range(50):
            writer.register_channel(f"/{number}", "ros1", schema)
        writer.add_message(1, 1, b"1234", 1)
        writer.finish()  # type: ignore[no-untyped-call]
    tracemalloc.start()
    try:
        with open_reader(path) as bag:
            assert {each.md5sum for each in bag.connections} == {INT32[1]}
        assert tracemalloc.get_traced_memory()[1] < 20_000_000
    finally:
        tracemalloc.stop()
