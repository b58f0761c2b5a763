"""Bags of fibws in the libraries by which Foxglove reads bags, which also parse every message."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from bags import recordings

HERE = Path(__file__).parent
BAGS = [("none", "bag"), ("bz2", "bag"), ("lz4", "bag")]
BAGS += [("none", "mcap"), ("lz4", "mcap"), ("zstd", "mcap")]


@pytest.mark.npm
@pytest.mark.usefixtures("npm_packages")
def test_messages_are_those_of_the_recording(tmp_path: Path) -> None:
    paths = [tmp_path / f"{compression}.{suffix}" for compression, suffix in BAGS]
    for path in paths:
        recordings.write(path, path.stem)
    words = ["node", "--no-warnings", str(HERE / "bags.mjs"), *map(str, paths)]
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    lines = done.stdout.splitlines()
    for path, line in zip(paths, lines, strict=True):
        found = [(*each[:5], int(each[5]), bytes.fromhex(each[6])) for each in json.loads(line)]
        assert sorted(found) == sorted(recordings.expected()), path.name
