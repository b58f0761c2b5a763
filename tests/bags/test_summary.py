"""Summaries of bags. tests/bags/test_other_programs.py compares them with ROS's."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from fibws.bags import open_reader, open_writer, summary

from .test_bags import add, write_numbers


def text_of(path: Path, *, frequencies: bool = False) -> dict[str, str]:
    with open_reader(path) as bag:
        lines = summary.text(bag, "my.bag", frequencies=frequencies).splitlines()
    return {name: rest.strip() for name, _, rest in (line.partition(":") for line in lines)}


def test_compressed_bag(tmp_path: Path) -> None:
    path = tmp_path / "it.bag"
    write_numbers(path, "bz2")
    rows = text_of(path, frequencies=True)
    assert rows["path"] == "my.bag"
    assert rows["compression"].startswith("bz2 [6/6 chunks; ")
    assert rows["uncompressed"].endswith("KB/s")
    assert rows["compressed"].endswith("%)")
    assert "@ 5.0 Hz" in rows["topics"]
    with open_reader(path) as bag:
        found = summary.as_dict(bag, None)
        assert found["uncompressed"] == sum(chunk.size for chunk in bag.chunks)
        assert found["compressed"] < found["uncompressed"]
        assert yaml.safe_load(summary.as_yaml(found)) == found


def test_bag_without_messages(tmp_path: Path) -> None:
    path = tmp_path / "it.bag"
    open_writer(path).close()
    rows = text_of(path)
    assert rows.keys() == {"path", "version", "size"}
    with open_reader(path) as bag:
        assert summary.as_dict(bag, None) == {"version": 2.0, "size": 4117, "indexed": False}


def test_times_are_rounded_one_way(tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    with open_writer(path) as writer:
        connection = writer.connection("/a", "std_msgs/Int32", "*", "int32 data")
        writer.write(connection, 1_700_000_002_999_000_000, bytes(4))
    with open_reader(path) as bag:
        text = summary.text(bag, None)
    assert re.search(r"start: +\S+ \d+ \d+ \d\d:\d\d:23\.00 \(1700000003\.00\)\n", text), text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        *((0, "0.0s"), (59.94, "59.9s"), (60, "1:00s (60s)"), (3661, "1hr 1:01s (3661s)")),
        (250_000, "2.9 days (250000s)"),
        (1_700_000_003, "53.9 years: messages have times of different clocks"),
    ],
)
def test_duration(tmp_path: Path, seconds: float, text: str) -> None:
    path = tmp_path / "it.bag"
    with open_writer(path, "bz2") as writer:
        publisher = add(writer, "/a")
        for time in (0, round(seconds * 1e9)):
            writer.write(publisher, time, b"1234")
    rows = text_of(path, frequencies=True)
    assert rows["duration"] == text
    assert ("@" in rows["uncompressed"]) == (seconds > 0)


@pytest.mark.parametrize(
    ("size", "text"),
    [(0, "0.0 KB"), (1500, "1.5 KB"), (5 * 2**20, "5.0 MB"), (3 * 2**30, "3.0 GB")],
)
def test_size(size: int, text: str) -> None:
    assert summary.size_text(size) == text
    assert summary.size_text(2**60) == "1048576.0 TB"
