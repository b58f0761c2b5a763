"""Start-up time of commands: modules that they must not load, and time beside a bare script."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage

import pytest
from hub_in_thread import HubThread, Publish
from patience import PATIENCE

SLOW = {"asyncio", "cbor2", "fibws.hub", "fibws.interfaces", "fibws.msg", "fibws.node.node"}
SLOW |= {"multiprocessing", "pydantic", "pydantic_core", "rich", "ssl", "unittest", "yaml"}
OWN = ("fibws.cli", "fibws.client", "fibws.protocol", "fibws.values")
"""The packages of fibws that tools load beside its own modules."""
MORE_THAN_BARE = {"click", "difflib", "encodings", "gettext", "lazy_loader", "stringprep"}
MORE_THAN_BARE |= {"unicodedata"}
"""What ``fibws topic echo`` loads beside fibws and what a bare script does."""
MAX_RATIO = 1.3
"""Maximum ratio of the CPU times of ``fibws topic echo -n 1`` and a bare script."""
ROUNDS = 7

BARE = """
import asyncio, json, sys, websockets

async def main():
    async with websockets.connect(sys.argv[1]) as websocket:
        await websocket.send(json.dumps({"op": "subscribe", "topic": "/number"}))
        print(json.loads(await websocket.recv())["msg"])

asyncio.run(main())
print(json.dumps(sorted(sys.modules)))
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


# Measuring coverage loads modules and takes time.
ENVIRONMENT = {name: value for name, value in os.environ.items() if not name.startswith("COV")}
ENVIRONMENT.pop("PYTHONDONTWRITEBYTECODE", None)


def loaded(*words: str) -> set[str]:
    """Return the modules that ``fibws`` has loaded at its end."""
    script = [sys.executable, "-c", LOADED, json.dumps(words)]
    return set(json.loads(output(script).splitlines()[-1]))


@pytest.mark.parametrize("words", [["--help"], ["topic", "--help"], ["topic", "echo", "--help"]])
def test_help_loads_no_slow_modules(words: list[str]) -> None:
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
def test_command_loads_no_slow_modules(hub: HubThread, publish: Publish, words: list[str]) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    found = loaded(*words, "--hub", hub.url)
    assert "websockets" in found
    assert not found & SLOW


def test_echo_loads_little_more_than_a_bare_script(hub: HubThread, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    found = loaded("topic", "echo", "-n", "1", "/number", "--hub", hub.url)
    bare = json.loads(output([sys.executable, "-c", BARE, hub.url]).splitlines()[-1])
    more = {name for name in found - set(bare) if not name.startswith("fibws")}
    assert {name.partition(".")[0] for name in more} <= MORE_THAN_BARE
    own = {name for name in found if name.count(".") > 1}
    assert all(name.startswith(OWN) for name in own if name.startswith("fibws.")), own


@pytest.mark.slow  # It measures CPU time, which caches and other load lengthen.
def test_echo_is_not_much_slower_than_a_bare_script(
    hub: HubThread, publish: Publish, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # An installed package is compiled; a checkout may not be.
    monkeypatch.setitem(ENVIRONMENT, "PYTHONPYCACHEPREFIX", str(tmp_path))
    publish("/number", "std_msgs/Int32", {"data": 8})
    echo = ["-m", "fibws", "topic", "echo", "-n", "1", "/number", "--hub", hub.url]
    # In pairs, so that other load and the processor's clock affect both.
    ratios = []
    for _ in range(ROUNDS):
        mine = cpu_time([sys.executable, *echo])
        ratios.append(mine / cpu_time([sys.executable, "-c", BARE, hub.url]))
    assert statistics.median(ratios) <= MAX_RATIO, ratios


def cpu_time(script: list[str]) -> float:
    """Return the CPU seconds of a script."""
    before = getrusage(RUSAGE_CHILDREN)  # os.times() counts hundredths of a second.
    output(script)
    after = getrusage(RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def output(script: list[str]) -> str:
    ended = subprocess.run(
        script, capture_output=True, text=True, check=True, timeout=PATIENCE, env=ENVIRONMENT
    )
    return ended.stdout
