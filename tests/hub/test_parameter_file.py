"""Parameters that are read from a file at the start, and survive a restart."""

from __future__ import annotations

import asyncio
import errno
import math
import os
import threading
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
import yaml
from conftest import StartHub

import fibws
from fibws.client import hub_pages
from fibws.errors import HubError
from fibws.files import replace_file
from fibws.hub import kept_file, parameter_file
from fibws.hub.server import HubServer

from .raw_client import until


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "state" / "params.yaml"


@pytest.fixture
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Write changes at once, and again after a failure."""
    monkeypatch.setattr(parameter_file, "DELAY", 0.0)
    monkeypatch.setattr(kept_file, "SHARE", 0)
    monkeypatch.setattr(kept_file, "RETRY", 0.001)


class Disk:
    """Writes files, unless it is full; holds writes while it is slow."""

    def __init__(self) -> None:
        self.is_full = False
        self.free = threading.Event()
        self.free.set()
        self.begun = 0
        self.written: list[str] = []

    def replace_file(self, path: Path, content: bytes, **options: bool) -> None:
        self.begun += 1
        self.free.wait()
        if self.is_full:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        replace_file(path, content, **options)
        self.written.append(content.decode())


@pytest.fixture
def disk(monkeypatch: pytest.MonkeyPatch) -> Disk:
    disk = Disk()
    monkeypatch.setattr(kept_file, "replace_file", disk.replace_file)
    return disk


def write(path: Path, text: str) -> None:
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)


def read(path: Path) -> str:
    return path.read_text()


async def metrics(hub: HubServer) -> bytes:
    _, _, body = await asyncio.to_thread(hub_pages.get, hub.url, "metrics")
    return body


def saved(path: Path) -> Any:
    return yaml.safe_load(path.read_text())


def value(hub: HubServer, name: str) -> Any:
    return hub.graph.parameters.get(name)


async def test_file_is_loaded_as_by_rosparam(start_hub: StartHub, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    text = "arm:\n  joints: [1, 2.5]\n  limit: deg(180)\n---\n_ns: base\nwheels/count: 4\n"
    write(path, text)
    hub = await start_hub(params=path)
    assert value(hub, "/arm") == {"joints": [1, 2.5], "limit": math.pi}
    assert value(hub, "/base/wheels/count") == 4
    hub.graph.parameters.set("/new", 1)
    await hub.close()
    assert read(path) == text


async def test_loaded_parameters_have_effect(start_hub: StartHub, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    write(path, "use_sim_time: true\n")
    hub = await start_hub(params=path)
    assert hub.graph.clock.simulated == 0


async def test_parameters_survive_a_restart(start_hub: StartHub, path: Path) -> None:
    first = await start_hub(params=path, keep_params=True)
    async with fibws.Node("node", hub=first.url) as node:
        await node.params.set("/robot", {"name": "Grüße", "gains": [1.0, 2], "empty": {}})
        await node.params.set("/gone", 1)
        await node.params.delete("/gone")
    special = {"angle": "deg(90)", "bytes": b"\0\xff", "date": datetime(2026, 1, 31), "x": math.inf}
    first.graph.parameters.set("/special", special)
    first.graph.parameters.set("/one_value", {"a/b": 1})
    text = first.graph.parameters.text("/special")
    await first.close()
    second = await start_hub(params=path, keep_params=True)
    assert value(second, "/robot") == {"name": "Grüße", "gains": [1.0, 2], "empty": {}}
    assert not second.graph.parameters.has("/gone")
    assert second.graph.parameters.text("/special") == text
    assert second.graph.parameters.text("/one_value") == b'{"a/b":1}'


async def test_parameters_of_one_run_are_not_kept(start_hub: StartHub, path: Path) -> None:
    first = await start_hub(params=path, keep_params=True)
    first.graph.parameters.set("/roslaunch/uris/host_x__1", "http://x:1/")
    first.graph.parameters.set("/a", 1)
    await first.close()
    assert saved(path) == {"a": 1}
    write(path, "run_id: old\nroslaunch: {uris: {host_x__1: old}}\nb: 2\n")
    second = await start_hub(params=path)
    assert value(second, "/run_id") != "old"
    assert not second.graph.parameters.has("/roslaunch/uris/host_x__1")
    assert value(second, "/b") == 2


async def test_hub_that_changes_nothing_leaves_the_file(start_hub: StartHub, path: Path) -> None:
    write(path, "# a comment\na: 1\n")
    hub = await start_hub(params=path, keep_params=True)
    await hub.close()
    assert read(path) == "# a comment\na: 1\n"


@pytest.mark.usefixtures("at_once")
async def test_file_is_written_after_changes(start_hub: StartHub, path: Path, disk: Disk) -> None:
    hub = await start_hub(params=path, keep_params=True)
    hub.graph.parameters.set("/a", 1)
    await until(lambda: disk.written)
    assert saved(path) == {"a": 1}
    hub.graph.parameters.set("/a", 2)
    await until(lambda: len(disk.written) == 2)
    hub.graph.parameters.set("/a", 2)
    hub.graph.parameters.delete("/a")
    await until(lambda: len(disk.written) == 3)
    assert saved(path) == {}


@pytest.mark.usefixtures("at_once")
async def test_slow_disk_delays_nobody(start_hub: StartHub, path: Path, disk: Disk) -> None:
    hub = await start_hub(params=path, keep_params=True)
    disk.free.clear()
    try:
        hub.graph.parameters.set("/a", 0)
        await until(lambda: disk.begun)
        async with fibws.Node("node", hub=hub.url) as node:
            for number in range(1, 100):
                await node.params.set("/a", number)
        assert disk.begun == 1
    finally:
        disk.free.set()
    await hub.close()
    assert saved(path) == {"a": 99}
    assert len(disk.written) == 2


@pytest.mark.usefixtures("at_once")
async def test_full_disk_is_told_and_loses_nothing(
    start_hub: StartHub, path: Path, disk: Disk, caplog: pytest.LogCaptureFixture
) -> None:
    write(path, "a: 1\n")
    hub = await start_hub(params=path, keep_params=True)
    disk.is_full = True
    hub.graph.parameters.set("/a", 2)
    await until(lambda: disk.begun > 3)
    assert caplog.text.count(f"{path} cannot be written: {os.strerror(errno.ENOSPC)}") == 1
    assert read(path) == "a: 1\n"
    assert b"fibws_parameters_unsaved 1" in await metrics(hub)
    disk.is_full = False
    await until(lambda: disk.written)
    assert saved(path) == {"a": 2}
    await until(lambda: f"{path} is written again" in caplog.text)
    assert b"fibws_parameters_unsaved 0" in await metrics(hub)
    disk.is_full = True
    hub.graph.parameters.set("/a", 3)
    await hub.close()
    assert f"{path} lacks the last changes: {os.strerror(errno.ENOSPC)}" in caplog.text
    assert saved(path) == {"a": 2}


async def test_what_another_program_writes_is_kept(
    start_hub: StartHub, path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    hub = await start_hub(params=path, keep_params=True)
    write(path, "mine: 1\n")
    (path.parent / "params.yaml.orig").write_text("older: 1\n")
    hub.graph.parameters.set("/a", 1)
    await hub.close()
    assert saved(path) == {"a": 1}
    assert saved(path.parent / "params.yaml.orig2") == {"mine": 1}
    assert saved(path.parent / "params.yaml.orig") == {"older": 1}
    assert "params.yaml.orig2" in caplog.text


async def test_file_keeps_its_mode_and_its_link(start_hub: StartHub, tmp_path: Path) -> None:
    path, link = tmp_path / "params.yaml", tmp_path / "link.yaml"
    write(path, "")
    path.chmod(0o600)
    link.symlink_to(path)
    hub = await start_hub(params=link, keep_params=True)
    hub.graph.parameters.set("/a", 1)
    await hub.close()
    assert link.is_symlink() and saved(path) == {"a": 1}
    assert path.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("keep", [False, True])
@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("a: [1", r"line 1"),
        ("a: 1\n\0\0\0", r"line|position|character"),
        ("5", "expected an object of parameters"),
        ("a:", r"\[/a\]: null"),
        ("a: 2026-01-31", r"\[/a\]: .*date"),
        (f"a: {'x' * 2000}", "max_parameter_bytes"),
    ],
)
async def test_file_that_cannot_be_used_is_named_and_stays(
    start_hub: StartHub, tmp_path: Path, text: str, fault: str, keep: bool
) -> None:
    path = tmp_path / "params.yaml"
    write(path, text)
    with pytest.raises(HubError, match=rf"^Settings\(params=\.\.\.\): {path}: .*{fault}"):
        await start_hub(params=path, keep_params=keep, max_parameter_bytes=1500)
    assert read(path) == text


async def test_file_must_exist_unless_it_is_kept(start_hub: StartHub, path: Path) -> None:
    with pytest.raises(HubError, match=rf"params=\.\.\.\): Cannot read {path}: No such file"):
        await start_hub(params=path)
    with pytest.raises(HubError, match=r"keep_params=.* requires .*\(params="):
        await start_hub(keep_params=True)


async def test_file_belongs_to_one_hub(start_hub: StartHub, path: Path) -> None:
    first = await start_hub(params=path, keep_params=True)
    with pytest.raises(HubError, match=r"params=\.\.\.\): another hub uses .*params\.yaml"):
        await start_hub(params=path, keep_params=True)
    await first.close()
    await start_hub(params=path, keep_params=True)


async def test_newer_values_of_other_hubs_replace_loaded_ones(
    start_hub: StartHub, path: Path
) -> None:
    write(path, "fleet: {speed: 1, color: red}\n")
    os.utime(path, (1e9, 1e9))
    other = await start_hub(share_params=("/fleet",))
    other.graph.parameters.set("/fleet/speed", 2)
    hub = await start_hub(
        params=path, keep_params=True, share_params=("/fleet",), join=(other.url,)
    )
    await until(lambda: other.graph.parameters.has("/fleet/color"))
    await until(lambda: value(hub, "/fleet/speed") == 2)
    assert value(other, "/fleet") == {"speed": 2, "color": "red"}


async def test_only_loaded_values_that_have_not_changed_since_are_old(
    start_hub: StartHub, path: Path
) -> None:
    write(path, "robot: {speed: 1, color: red, gone: 1}\n")
    os.utime(path, (1e9, 1e9))
    newer = path.with_name("newer.yaml")
    write(newer, "r7: {robot: {speed: 2, color: blue}}\n")
    os.utime(newer, (1.5e9, 1.5e9))  # Later than the other file, and before today.
    other = await start_hub(params=newer)
    hub = await start_hub(params=path, join=(other.url,), join_prefix="/r7")
    hub.graph.parameters.set("/robot/speed", 3)
    hub.graph.parameters.delete("/robot/gone")
    await until(lambda: value(hub, "/robot/color") == "blue")
    await until(lambda: value(other, "/r7/robot") == {"speed": 3, "color": "blue"})
