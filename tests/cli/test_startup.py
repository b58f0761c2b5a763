"""Tools answer at once: what they may not load, and how long they take beside a bare script."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from hub_in_thread import HubThread, Publish

SLOW = {"asyncio", "cbor2", "fibws.hub", "fibws.interfaces", "fibws.msg", "fibws.node.node"}
SLOW |= {"multiprocessing", "pydantic", "pydantic_core", "rich", "ssl", "unittest", "yaml"}
MOST = 1.3
"""Times that ``fibws topic echo -n 1`` may take what a bare script takes."""
ROUNDS = 7
PATIENCE = 60

BARE = """
import asyncio, json, sys, websockets

async def main():
    async with websockets.connect(sys.argv[1]) as websocket:
        await websocket.send(json.dumps({"op": "subscribe", "topic": "/number"}))
        print(json.loads(await websocket.recv())["msg"])

asyncio.run(main())
"""
LOADED = """
import json, sys
from fibws.cli.commands import command
try:
    command(json.loads(sys.argv[1]))
except SystemExit:
    pass
print(json.dumps(sorted(sys.modules)))
"""


# What measures coverage loads a lot, and takes time.
ENVIRONMENT = {name: value for name, value in os.environ.items() if not name.startswith("COV")}
ENVIRONMENT.pop("PYTHONDONTWRITEBYTECODE", None)


def loaded(*words: str) -> set[str]:
    """The modules that ``fibws`` with these words has loaded at its end."""
    script = [sys.executable, "-c", LOADED, json.dumps(words)]
    return set(json.loads(output(script).splitlines()[-1]))


@pytest.mark.parametrize("words", [["--help"], ["topic", "--help"], ["topic", "echo", "--help"]])
def test_help_loads_nothing_that_takes_its_time(words: list[str]) -> None:
    assert not loaded(*words) & SLOW
    assert len(words) > 2 or not loaded(*words) & {"websockets", "socket"}


@pytest.mark.parametrize(
    "words",
    [
        ["topic", "echo", "-n", "1", "/number"],
        ["topic", "list"],
        ["topic", "info", "/number"],
        ["topic", "hz", "-n", "1", "/number"],
    ],
)
def test_a_tool_loads_nothing_that_takes_its_time(
    hub: HubThread, publish: Publish, words: list[str]
) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    found = loaded(*words, "--hub", hub.url)
    assert "websockets" in found
    assert not found & SLOW


def test_echo_takes_little_longer_than_a_bare_script(
    hub: HubThread, publish: Publish, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A checkout may not be compiled, as what is installed is.
    monkeypatch.setitem(ENVIRONMENT, "PYTHONPYCACHEPREFIX", str(tmp_path))
    publish("/number", "std_msgs/Int32", {"data": 8})
    echo = ["-m", "fibws", "topic", "echo", "-n", "1", "/number", "--hub", hub.url]
    # In turns, so that what else this machine does falls on both; the smallest are the truest.
    mine, bare = [], []
    for _ in range(ROUNDS):
        mine.append(cpu_time([sys.executable, *echo]))
        bare.append(cpu_time([sys.executable, "-c", BARE, hub.url]))
    assert min(mine) <= MOST * min(bare)


def cpu_time(script: list[str]) -> float:
    """Seconds that it works, however long it has to wait for that."""
    before = os.times()
    output(script)
    after = os.times()
    return sum(after[2:4]) - sum(before[2:4])


def output(script: list[str]) -> str:
    ended = subprocess.run(
        script, capture_output=True, text=True, check=True, timeout=PATIENCE, env=ENVIRONMENT
    )
    return ended.stdout
