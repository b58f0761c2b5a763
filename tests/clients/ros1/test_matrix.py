"""Peers of both worlds, each with each other: topics, services, parameters and actions.

Those of ROS 1 find each other by the hub, which is their master, and exchange messages without it;
all others pass messages through it.
"""

from __future__ import annotations

import asyncio
import base64
import json
import math
import os
import subprocess
import sys
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any

import pytest
from patience import PATIENCE

import fibws.ros1
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.interfaces.serialization import Serializers
from fibws.msg import default_interfaces

HERE = Path(__file__).parent
GOAL_PATIENCE, TRIES = 15, 10
LOSING = {"real_rospy", "roscpp"}
"""ROS's own actionlib loses feedback and results at random, even within one process, and more under
load: such a goal is sent again."""

REAL_PYTHON = "/usr/bin/python3"
ROSPY = Path(fibws.ros1.__file__).parent / "python"
LIBRARIES = (
    "actionlib roscpp rosconsole roscpp_serialization rostime xmlrpcpp boost_system boost_thread "
    "cpp_common pthread"
).split()
PEERS = ("fibws", "rospy", "real_rospy", "roscpp", "roslib", "foxglove")
SERVING = PEERS[:-1]
"""The peers with services and actions."""

PARAMETERS = {"int": 7, "float": 0.5, "text": "ä", "list": [1, 2.5, "x"], "flag": True}
VALUES: dict[str, tuple[str, dict[str, Any]]] = {
    "ints": (
        "std_msgs/Int64MultiArray",
        {
            "layout": {
                "dim": [
                    {"label": "ä", "size": 2, "stride": 2**32 - 1},
                    {"label": "", "size": 0, "stride": 1},
                ],
                "data_offset": 3,
            },
            "data": [-(2**63), 2**63 - 1, 0, 2**53 + 1],
        },
    ),
    "floats": (
        "std_msgs/Float64MultiArray",
        {
            "layout": {"dim": [], "data_offset": 0},
            "data": [math.nan, math.inf, -math.inf, -0.0, 0.1, 5e-324],
        },
    ),
    "image": (
        "sensor_msgs/CompressedImage",
        {
            "header": {
                "seq": 0,
                "stamp": {"secs": 4_000_000_000, "nsecs": 999_999_999},
                "frame_id": "map",
            },
            "format": "jpeg",
            "data": base64.b64encode(bytes(range(256))).decode(),
        },
    ),
}
JSON_FLOATS = [math.nan, math.nan, math.nan, 0.0, 0.1, 5e-324]
"""What is left of the floats where JSON has been on the way."""


def serialized(kind: str, sender: str) -> bytes:
    """Return a message's bytes; `Header.seq` is 0, since publishers count it."""
    type_, values = VALUES[kind]
    if kind == "floats" and sender == "roslib":
        values = {**values, "data": JSON_FLOATS}
    return Serializers(default_interfaces()).of(type_).serialize(values)


def same(kind: str, sender: str, found: Any) -> bool:
    """Return whether a peer got a message as it was sent."""
    if isinstance(found, str):
        data = bytes.fromhex(found)
        if kind == "image":
            data = bytes(4) + data[4:]
        return data == serialized(kind, sender)
    values = VALUES[kind][1]
    match kind:
        case "ints":
            numbers = [float(number) for number in values["data"]]
            received = [float(each) for each in found["data"]]
            return bool(received == numbers and found["layout"] == values["layout"])
        case "floats":
            return bool(found["data"] == [None, None, None, 0, 0.1, 5e-324])
        case _:
            header = {**values["header"], "seq": found["header"]["seq"]}
            return bool(found == {**values, "header": header})


def messages() -> dict[str, Any]:
    """Return what the peers read: the messages in several forms, and parameters."""
    interfaces = default_interfaces()
    found: dict[str, Any] = {"parameters": PARAMETERS, "serving": SERVING}
    for kind, (type_, values) in VALUES.items():
        in_json = dict(values)
        if kind == "ints":
            in_json["data"] = [str(number) for number in values["data"]]
        elif kind == "floats":
            in_json["data"] = [None, None, None, 0, 0.1, 5e-324]
        found[kind] = {
            "type": type_,
            "md5sum": interfaces.md5(type_),
            "definition": interfaces.full_text(type_),
            "bytes": serialized(kind, "").hex(),
            "json": in_json,
        }
    return found


def build(folder: Path) -> Path:
    """Compile the peer in roscpp."""
    program = folder / "roscpp_peer"
    flags = [f"-l{library}" for library in LIBRARIES]
    source = HERE / "roscpp_peer.cpp"
    subprocess.run(["g++", "-O0", source, "-o", program, *flags], check=True)
    return program


class Peers:
    """The peers' programs, and what they have seen.

    Args:
        folder: for files of theirs.
    """

    def __init__(self, folder: Path, hub: str, master: str) -> None:
        self._folder = folder
        self._environment = {
            key: value
            for key, value in os.environ.items()
            if not key.startswith(("PYTHON", "ROS", "FIBWS"))
        } | {
            "FIBWS_HUB": hub,
            "ROS_MASTER_URI": master,
            "ROS_IP": "127.0.0.1",
            "ROS_LOG_DIR": str(folder),
        }
        self._processes: dict[str, asyncio.subprocess.Process] = {}
        self._watching: list[asyncio.Task[None]] = []
        self._seen: set[tuple[str, str, str]] = set()
        self._failed: set[tuple[str, str, str]] = set()
        """The goals whose feedback or result was not as it should be."""
        self._news = asyncio.Event()
        self.wrong: list[str] = []
        self.complaints: list[str] = []

    async def start(self, stack: AsyncExitStack) -> None:
        path = self._folder / "messages.json"
        path.write_text(json.dumps(messages()))
        everybody = ",".join(PEERS)
        commands: dict[str, list[Any]] = {
            "fibws": [sys.executable, HERE / "fibws_peer.py", "fibws", everybody, path],
            "rospy": [sys.executable, HERE / "rospy_peer.py", "rospy", everybody, path],
            "real_rospy": [REAL_PYTHON, HERE / "rospy_peer.py", "real_rospy", everybody, path],
            "roslib": ["node", HERE / "roslib_peer.mjs", "roslib", everybody, path],
            "foxglove": ["node", HERE / "foxglove_peer.mjs", "foxglove", everybody, path],
            "roscpp": [
                *(await asyncio.to_thread(build, self._folder), "roscpp", everybody),
                ",".join(SERVING),
                *(f"{kind}={serialized(kind, '').hex()}" for kind in VALUES),
            ],
        }
        for name, command in commands.items():
            environment = dict(self._environment)
            if name == "rospy":
                environment["PYTHONPATH"] = str(ROSPY)
            process = await asyncio.create_subprocess_exec(
                *command,
                env=environment,
                stdin=asyncio.subprocess.PIPE,
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.PIPE,
                limit=2**20,
            )
            complaints = asyncio.create_task(self._complain(name, process))
            stack.push_async_callback(self._end, process, complaints)
            self._processes[name] = process
        async with asyncio.timeout(PATIENCE):
            await asyncio.gather(*map(self._ready, self._processes.values()))
        for name, process in self._processes.items():
            self._watching.append(asyncio.create_task(self._watch(name, process)))
            self._tell(name, "go")

    async def finish(self) -> list[str]:
        """Wait until everything has been seen; return what was not."""
        missing = await self._wait_for(expected())
        for goals in rounds():
            missing |= await self._act(goals)
        return sorted(" ".join(each) for each in missing)

    async def _act(self, goals: set[tuple[str, str, str]]) -> set[tuple[str, str, str]]:
        """Let peers send goals to each other; return those that were not executed."""
        for _ in range(TRIES):
            missing = goals - self._seen
            self._failed.clear()
            for peer, _, server in missing:
                self._tell(peer, server)
            missing = await self._wait_for(missing, GOAL_PATIENCE)
            for _, _, server in missing:
                self._tell(server, "finish")  # Its feedback is lost.
            if not any(LOSING & {peer, server} for peer, _, server in missing):
                return missing
        return missing

    async def _wait_for(
        self, wanted: set[tuple[str, str, str]], patience: float = PATIENCE
    ) -> set[tuple[str, str, str]]:
        """Wait until the peers have seen something; return what they have not."""
        try:
            async with asyncio.timeout(patience):
                while not wanted <= self._seen | self._failed:
                    self._news.clear()
                    await self._news.wait()
        except TimeoutError:
            pass
        return wanted - self._seen

    def _tell(self, peer: str, line: str) -> None:
        stdin = self._processes[peer].stdin
        assert stdin is not None
        stdin.write(f"{line}\n".encode())

    async def _ready(self, process: asyncio.subprocess.Process) -> None:
        assert process.stdout is not None
        line = await process.stdout.readline()
        assert line == b"ready\n", (line, self.complaints)

    async def _watch(self, peer: str, process: asyncio.subprocess.Process) -> None:
        assert process.stdout is not None
        async for line in process.stdout:
            try:
                seen = json.loads(line)
                what, of, value = seen["saw"], seen["of"], seen["value"]
            except (ValueError, TypeError):
                self.complaints.append(f"{peer}: {line.decode()}")
                continue
            if what == "feedback":
                # Now the result cannot overtake it, which comes on another connection.
                self._tell(of, "finish")
            elif is_right(what, of, value):
                self._seen.add((peer, what, of))
            elif what == "action":
                self._failed.add((peer, what, of))
            else:
                self.wrong.append(f"{peer} got from {of}: {what} {value}")
            self._news.set()

    async def _complain(self, peer: str, process: asyncio.subprocess.Process) -> None:
        assert process.stderr is not None
        async for line in process.stderr:
            self.complaints.append(f"{peer}: {line.decode()}")

    async def _end(
        self, process: asyncio.subprocess.Process, complaints: asyncio.Task[None]
    ) -> None:
        if process.returncode is None:
            process.kill()
        await process.wait()
        await complaints


def expected() -> set[tuple[str, str, str]]:
    """Return all that the peers should see: who, what, and of whom."""
    parts = [f"{what} {kind}" for what in ("latched", "plain") for kind in VALUES]
    found = {(peer, part, of) for peer in PEERS for part in parts for of in PEERS}
    found |= {(peer, "parameters", of) for peer in PEERS for of in PEERS}
    for part in ("service", "refusal"):
        found |= {(peer, part, of) for peer in SERVING for of in SERVING}
    return found


def rounds() -> list[set[tuple[str, str, str]]]:
    """Return the goals that peers send at the same time: a server has one goal at once."""
    count = len(SERVING)
    return [
        {(SERVING[i], "action", SERVING[(i + distance) % count]) for i in range(count)}
        for distance in range(count)
    ]


def is_right(what: str, of: str, value: Any) -> bool:
    """Return whether a peer saw what another one did."""
    match what.split():
        case ["parameters"]:
            return bool(value == PARAMETERS)
        case ["service"]:
            return bool(value == [True, f"from {of}, ä"])
        case ["refusal"]:
            return True
        case ["action"]:
            return bool(value == [[21], 42])
        case [_, kind]:
            return same(kind, of, value)
    return False


@pytest.mark.real_ros
@pytest.mark.npm
async def test_every_peer_reaches_every_other(tmp_path: Path) -> None:
    settings = Settings(port=0, ros1=0, ros1_host="127.0.0.1", strict_responses=True)
    async with HubServer(settings) as hub, AsyncExitStack() as stack:
        assert hub.ros1 is not None
        peers = Peers(tmp_path, hub.url, hub.ros1.uri)
        await peers.start(stack)
        faults = [f"not seen: {each}" for each in await peers.finish()]
    faults += peers.wrong
    assert not faults, "\n".join([*faults, *peers.complaints])
