"""Settings that cannot be fulfilled: the start fails, and the error names the option."""

from __future__ import annotations

import asyncio
import dataclasses
import gc
import itertools
import os
import re
import socket
import threading
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import suppress
from pathlib import Path
from typing import Any, get_type_hints

import pytest
from certificates import Authority
from certificates import authority as authority
from conftest import SETTINGS, Faults

from fibws.errors import FibwsError, HubError
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.tls import CA

from .raw_client import timers, until

TLS = {"self_signed": True}
ROS1 = {"ros1": 0}
ZENOH = {"zenoh_listen": ("tcp/127.0.0.1:0",)}

FILES: dict[str, dict[str, Any]] = {
    "cert": {"key": Path("/dev/null")},
    "key": {},
    "client_ca": TLS,
    "tokens": {},
    "jwt_key": {},
    "ros1_state": ROS1,
    "zenoh_config": ZENOH,
    "record": {},
    "params": {},
    "interfaces": {},
}
"""The settings that name a file or a folder, and the settings that they need besides."""
CREATED = {"record", "ros1_state"}
FOLDERS = {"record", "interfaces"}

ENDPOINTS = ("zenoh_listen", "zenoh", "ros2", "ros2_connect")
TEXTS: dict[str, list[Any]] = {
    "host": ["nowhere.invalid", "a b", "203.0.113.1"],
    "port": [65536],
    "url_path": ["a b"],
    "trusted_proxy": ["proxy"],
    "allow_origin": ["lab.example"],
    "ros1": [65536],
    "ros1_host": ["a b", "http://robot", "robot:11311", "[::1"],
    "ros1_allow": ["robot"],
    "join": ["http://robot", "ws://a b", "ws://robot:65536", "ws://", "", "ws://robot?token=a%20b"],
    **{name: ["", "x", "tcp/robot", "tcp/robot:65536", "udp/:1", "no/x:1"] for name in ENDPOINTS},
}
"""Invalid values of the settings that name a host, a URL, an origin, an endpoint or a port."""


async def refused(**settings: Any) -> str:
    """Start a hub, and return the error's text."""
    with pytest.raises(FibwsError) as caught:
        async with HubServer(Settings(**{**SETTINGS, **settings})):
            pass
    return str(caught.value)


def argument(name: str) -> str:
    return f"Settings({name}=...)"


def with_path(name: str, path: Path, authority: Authority) -> dict[str, Any]:
    if name == "key":
        return {"key": path, "cert": authority.issue("hub")[0]}
    return FILES[name] | {name: (path,) if name == "interfaces" else path}


def below_a_file(folder: Path) -> Path:
    (folder / "file").write_text("a file\n")
    return folder / "file" / "below"


def missing(folder: Path) -> Path:
    return folder / "missing"


def of_the_other_kind(folder: Path) -> Path:
    (folder / "file").write_text("a file\n")
    return folder


def invalid(folder: Path) -> Path:
    (folder / "file").write_text("not what it should be\n")
    return folder / "file"


CASES = [
    *((name, missing) for name in FILES if name not in CREATED),
    *((name, below_a_file) for name in FILES),
    *((name, of_the_other_kind) for name in FILES if name not in FOLDERS),
    *((name, invalid) for name in FILES),
]


@pytest.mark.parametrize(("name", "make"), CASES)
async def test_unusable_file_or_folder_ends_the_start(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    authority: Authority,
    name: str,
    make: Callable[[Path], Path],
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    path = make(tmp_path)
    text = await refused(**with_path(name, path, authority))
    assert text.startswith(f"{argument(name)}:")
    assert str(path) in text


@pytest.mark.parametrize(("name", "value"), [(n, v) for n, vs in TEXTS.items() for v in vs])
async def test_invalid_address_ends_the_start(name: str, value: Any) -> None:
    extra = ROS1 if name == "ros1_host" else {}
    many = isinstance(getattr(Settings(), name), tuple)
    text = await refused(**extra, **{name: (value,) if many else value})
    assert text.startswith((f"{argument(name)}:", f"{argument(name)} "))


@pytest.mark.parametrize("name", ["port", "ros1", *ENDPOINTS[::2]])
async def test_taken_port_ends_the_start(name: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        value = (f"tcp/127.0.0.1:{port}",) if name in ENDPOINTS else port
        text = await refused(**{name: value})
    assert argument(name) in text
    assert str(port) in text


def test_all_settings_with_files_and_addresses_are_tested_here() -> None:
    types = get_type_hints(Settings)
    paths = {name for name, type_ in types.items() if "Path" in str(type_)}
    assert paths == set(FILES)
    words = ("Address", "address", "URL", "Endpoint", "Port ", "origin")
    named = {each.name for each in dataclasses.fields(Settings) if is_named(each, words)}
    assert named - set(TEXTS) == set()


def is_named(setting: dataclasses.Field[Any], words: tuple[str, ...]) -> bool:
    is_text = setting.default is None or isinstance(setting.default, str | tuple)
    return is_text and any(word in setting.metadata["help"] for word in words)


async def test_state_folder_of_certificates_must_be_writable(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(below_a_file(tmp_path)))
    assert (await refused(**TLS)).startswith("Settings(self_signed=...):")


async def test_certificates_for_joining_must_be_readable(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(CA, str(missing(tmp_path)))
    text = await refused(join=("wss://robot",))
    assert text.startswith("Settings(join=...):")
    assert CA in text


async def test_recording_on_demand_needs_its_folder_at_the_start(tmp_path: Path) -> None:
    text = await refused(record=below_a_file(tmp_path), record_at_start=False)
    assert text.startswith("Settings(record=...):")


# Cancelled starts.


@pytest.fixture
async def everything(tmp_path: Path, authority: Authority) -> AsyncIterator[dict[str, Any]]:
    """The settings of a hub with all parts."""
    certificate, key = authority.issue("localhost", "127.0.0.1")
    async with HubServer(Settings(**SETTINGS)) as other:
        yield {
            **SETTINGS,
            "close_timeout": 0.1,
            "cert": certificate,
            "key": key,
            "ros1": 0,
            "ros1_state": tmp_path / "state" / "ros1.json",
            "record": tmp_path / "bags",
            "params": tmp_path / "params.yaml",
            "keep_params": True,
            "join": (other.url,),
            "zenoh_listen": ("tcp/127.0.0.1:0",),
            "ros2": ("tcp/127.0.0.1:0",),
        }


def open_files() -> set[str]:
    """Return what the file descriptors of this process are."""
    found = set()
    for each in os.listdir("/proc/self/fd"):
        with suppress(OSError):
            found.add(f"{each} {os.readlink(f'/proc/self/fd/{each}')}")
    return found


def left() -> tuple[set[str], list[str], list[str]]:
    """Return the hub's files, tasks and timers, and its threads, that are there now."""
    gc.collect()
    files = {each for each in open_files() if ".zenoh" not in each}  # Its own shared memory.
    tasks = [repr(each) for each in asyncio.all_tasks() if each is not asyncio.current_task()]
    names = [each.name for each in threading.enumerate() if not each.name.startswith("asyncio_")]
    due = [re.sub(r"when=\S+", "", repr(each)) for each in timers()]
    own = [each for each in due if not re.search("Timeout|set_result", each)]  # Those of `until`.
    return files, sorted([*tasks, *own]), sorted(names)


class Steps(Coroutine[Any, Any, Any]):
    """Runs a coroutine, and cancels its task at a certain await."""

    def __init__(self, coroutine: Coroutine[Any, Any, Any], last: int) -> None:
        self._coroutine = coroutine
        self._last = last
        self.count = 0

    def send(self, value: Any) -> Any:
        found = self._coroutine.send(value)
        self.count += 1
        if self.count == self._last:
            task = asyncio.current_task()
            assert task is not None
            task.cancel()
        return found

    def throw(self, *error: Any) -> Any:
        return self._coroutine.throw(*error)

    def close(self) -> None:
        self._coroutine.close()

    def __await__(self) -> Any:
        raise NotImplementedError


async def test_start_that_is_cancelled_at_any_await_leaves_nothing(
    everything: dict[str, Any], faults: Faults
) -> None:
    async def start() -> None:
        async with HubServer(Settings(**everything)):
            entered.append(True)

    entered: list[bool] = []
    loop = asyncio.get_running_loop()
    async with HubServer(Settings(**everything)):
        pass  # What is loaded, and which threads are made, the first time.
    before = left()
    for last in itertools.count(1):
        steps = Steps(start(), last)
        task: asyncio.Task[None] = loop.create_task(steps)
        await asyncio.wait({task})
        await until(lambda: left() == before)
        assert left() == before
        if entered:
            break
        assert task.cancelled()
    assert last > 5


@pytest.mark.parametrize(
    "failing",
    [
        "fibws.hub.federation.zenoh_backplane.ZenohBackplane._declare",
        "fibws.hub.ros2.server.Ros2.start",
        "fibws.hub.ros1.server.own_names",
        "fibws.hub.rosapi.nodes.OwnNodes.__init__",
        "fibws.hub.federation.connections.Join.start",
        "fibws.hub.server.HubServer._warn_if_public",
        "asyncio.base_events.Server.start_serving",
    ],
)
async def test_start_that_fails_leaves_nothing(
    everything: dict[str, Any], monkeypatch: pytest.MonkeyPatch, failing: str
) -> None:
    def fail(*arguments: object, **named: object) -> None:
        raise HubError("failed")

    async with HubServer(Settings(**everything)):
        pass
    before = left()
    with monkeypatch.context() as patch:
        patch.setattr(failing, fail)
        with pytest.raises(HubError, match="failed"):
            async with HubServer(Settings(**everything)):
                pass
    await until(lambda: left() == before)


async def test_each_part_ends_even_if_others_fail(
    everything: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    async def fail(self: object) -> None:
        raise HubError("failed")

    async with HubServer(Settings(**everything)):
        pass
    before = left()
    monkeypatch.setattr("fibws.hub.ros2.server.Ros2.close", fail)
    hub = HubServer(Settings(**everything))
    with pytest.raises(HubError, match="failed"):
        async with hub:
            pass
    assert hub.ros2 is not None
    await hub.ros2.network.close()
    await hub.close()
    await until(lambda: left() == before)
