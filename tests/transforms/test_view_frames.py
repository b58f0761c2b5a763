"""Listings of all frames, and the program view_frames."""

from __future__ import annotations

import asyncio
import os
import shutil
import sys
from pathlib import Path

import pytest
import yaml
from patience import PATIENCE
from running_programs import ROOT

import fibws
from fibws.hub.server import HubServer
from fibws.programs.view_frames import ask, draw
from fibws.tf.buffer import Buffer
from fibws.tf.history import Sample
from fibws.tf.listing import as_dot, as_yaml
from fibws.tf.transform import Transform

from .conftest import Publish

SECOND = 1_000_000_000


@pytest.fixture
def buffer() -> Buffer:
    buffer = Buffer()
    for at in (1, 3):
        buffer.insert("odom", Sample(at * SECOND, "map", Transform()), authority="/wheels")
    buffer.insert("camera", Sample(9, "odom", Transform()), static=True)
    return buffer


def test_yaml_is_that_of_tf2(buffer: Buffer) -> None:
    assert as_yaml(Buffer()) == "{}"
    assert yaml.safe_load(as_yaml(buffer)) == {
        "odom": {
            "parent": "map",
            "broadcaster": "/wheels",
            "rate": 1.0,
            "most_recent_transform": 3.0,
            "oldest_transform": 1.0,
            "buffer_length": 2.0,
        },
        "camera": {
            "parent": "odom",
            "broadcaster": "no recorded authority",
            "rate": 10000.0,
            "most_recent_transform": 0.0,
            "oldest_transform": 0.0,
            "buffer_length": 0.0,
        },
    }


def test_graph_is_that_of_tf(buffer: Buffer) -> None:
    assert as_dot(Buffer()) == 'digraph G {\n"no tf data recieved"}'
    assert as_dot(buffer).splitlines()[1] == (
        '"map" -> "odom"[label="Broadcaster: /wheels\\nAverage rate: 1.000 Hz\\n'
        'Most recent transform: 3.000 \\nBuffer length: 2.000 sec\\n"];'
    )
    with_time = as_dot(buffer, 5.0)
    assert "( 2.000 sec old)" in with_time
    assert '"Recorded at time: 5.000"' in with_time
    assert '}->"map";' in with_time


def test_names_are_escaped_in_graphs() -> None:
    buffer = Buffer()
    buffer.insert('a"b', Sample(1, "c\\", Transform()))
    assert '"c\\\\" -> "a\\"b"' in as_dot(buffer)


async def test_files_are_written(
    buffer: Buffer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    dot = tmp_path / "dot"
    dot.write_text('#!/bin/sh\ncp "$2" "$4"\n')
    dot.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/bin:/usr/bin")
    graph = as_dot(buffer)
    assert [path.name for path in await draw(graph, tmp_path)] == ["frames.gv", "frames.pdf"]
    assert (tmp_path / "frames.pdf").read_text() == graph
    dot.write_text("#!/bin/sh\nexit 1\n")
    assert [path.name for path in await draw(graph, tmp_path)] == ["frames.gv"]


async def test_graph_is_written_without_graphviz(
    buffer: Buffer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert [path.name for path in await draw(as_dot(buffer), tmp_path)] == ["frames.gv"]


@pytest.mark.skipif(shutil.which("dot") is None, reason="needs graphviz")
async def test_graph_is_valid(buffer: Buffer, tmp_path: Path) -> None:
    await draw(as_dot(buffer, 5.0), tmp_path)
    assert (tmp_path / "frames.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.long
async def test_program_draws_the_frames(
    hub: HubServer, publish: Publish, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    await publish(("camera", "base", 2.0), static=True)
    process = await asyncio.create_subprocess_exec(
        *(
            sys.executable,
            "-m",
            "fibws.programs.view_frames",
            "--duration",
            "0.5",
            "--hub",
            hub.url,
        ),
        cwd=tmp_path,
        env={**os.environ, "PATH": str(tmp_path), "PYTHONPATH": str(ROOT)},
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.PIPE,
    )
    async with asyncio.timeout(PATIENCE):
        out, err = await process.communicate()
    assert out.decode().splitlines() == [
        "Listening to /tf for 0.500000 seconds",
        "Done Listening",
        "frames.gv generated",
    ]
    assert b"apt install graphviz" in err
    graph = (tmp_path / "frames.gv").read_text("utf-8")
    assert '"base" -> "camera"[label="Broadcaster: /client\\n' in graph


async def test_node_is_asked_for_its_frames(hub: HubServer) -> None:
    async with fibws.Node("robot", hub=hub.url) as robot, fibws.Node("test", hub=hub.url) as node:
        await robot.service(
            "~tf_frames", "tf/FrameGraph", lambda request: {"dot_graph": "digraph G {}"}
        )
        assert await ask(node, "robot") == "digraph G {}"
        with pytest.raises(fibws.FibwsError, match="/nobody/tf_frames"):
            await ask(node, "nobody")
