"""Tests about Windows that run on other systems."""

from __future__ import annotations

import ast
import asyncio
import os
import shlex
import signal
import subprocess
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from patience import PATIENCE

from fibws.hub import Settings
from fibws.hub.ros1 import nodes
from fibws.hub.server import HubServer

from .on_windows import MODULES
from .requirements import ROOT

if sys.platform == "win32":
    pytest.skip("Windows need not be simulated here", allow_module_level=True)

PROGRAM = Path(__file__).with_name("on_windows.py")


async def start(*arguments: str, **environment: str) -> Process:
    variables = {name: value for name, value in os.environ.items() if "FIBWS" not in name}
    return await asyncio.create_subprocess_exec(
        *(sys.executable, str(PROGRAM), *arguments),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=PIPE,
        stderr=PIPE,
        env={**variables, **environment},
    )


async def line_of(process: Process) -> str:
    """Return a program's next line; fail with its errors if it ends before that."""
    assert process.stdout is not None and process.stderr is not None
    async with asyncio.timeout(PATIENCE):
        line = await process.stdout.readline()
        assert line, (await process.stderr.read()).decode()
        return line.decode()


async def output_of(*arguments: str, **environment: str) -> str:
    """Return what a program prints; fail with its errors if it fails."""
    process = await start(*arguments, **environment)
    async with asyncio.timeout(PATIENCE):
        output, errors = await process.communicate()
    assert process.returncode == 0, errors.decode()
    return output.decode()


@asynccontextmanager
async def stopped_by_ctrl_c(process: Process) -> AsyncIterator[None]:
    """Send a program Ctrl-C at the end, and fail unless it ends without an error."""
    try:
        yield
        process.send_signal(signal.SIGINT)
        async with asyncio.timeout(PATIENCE):
            _, errors = await process.communicate()
        assert process.returncode == 0, errors.decode()
        assert b"Traceback" not in errors
    finally:
        with suppress(ProcessLookupError):
            process.kill()
        await process.wait()


@pytest.mark.long
def test_all_modules_can_be_imported() -> None:
    done = subprocess.run([sys.executable, PROGRAM, "all"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.split()[0]) > 300


async def test_hub_serves_nodes_and_ends_with_ctrl_c(tmp_path: Path) -> None:
    url_file = tmp_path / "url"
    options = ("--port", "0", "--url-file", str(url_file))
    hub = await start("fibws.hub", *options)
    async with stopped_by_ctrl_c(hub):
        assert "ws://127.0.0.1:" in await line_of(hub)
        url = url_file.read_text("utf-8")
        listener = await start("fibws.listener", FIBWS_HUB=url)
        async with stopped_by_ctrl_c(listener):
            publish = ["topic", "pub", "--rate", "50", "/fibonacci", "std_msgs/Int32", "data: 8"]
            publisher = await start("fibws", *publish, FIBWS_HUB=url)
            try:
                assert "I heard 8" in await line_of(listener)
                assert "/fibonacci" in await output_of("fibws", "topic", "list", FIBWS_HUB=url)
            finally:
                publisher.kill()
                await publisher.wait()
    assert not url_file.exists()


@pytest.fixture
async def url() -> AsyncIterator[str]:
    async with HubServer(Settings(port=0)) as hub:
        yield hub.url


@pytest.mark.parametrize(
    ("command", "output"),
    [
        ("param set /speed 5", ""),
        ("topic list", "/rosout"),
        ("node list", ""),
        ("service call /rosapi/topics", "/rosout"),
        ("topic pub --once /chatter std_msgs/String data:\\ hello", ""),
        ("doctor", "hub"),
        ("graph", ""),
    ],
)
@pytest.mark.long
async def test_tools_work(url: str, command: str, output: str) -> None:
    assert output in await output_of("fibws", *shlex.split(command), FIBWS_HUB=url)


@pytest.mark.long
async def test_file_of_tokens_is_edited(tmp_path: Path) -> None:
    file = tmp_path / "tokens.toml"
    for name in ("one", "two"):
        await output_of("fibws", "token", "add", name, "--admin", "--file", str(file))
    assert (await output_of("fibws", "token", "list", "--file", str(file))).count("\n") >= 2


@pytest.mark.long
async def test_metrics_are_served_without_proc(tmp_path: Path) -> None:
    url_file = tmp_path / "url"
    hub = await start("fibws.hub", "--port", "0", "--url-file", str(url_file))
    async with stopped_by_ctrl_c(hub):
        await line_of(hub)
        host = url_file.read_text("utf-8").strip().removeprefix("ws://").rstrip("/")
        reader, writer = await asyncio.open_connection(*host.split(":"))
        writer.write(f"GET /metrics HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
        async with asyncio.timeout(PATIENCE):
            head = await reader.readuntil(b"\r\n\r\n")
        writer.close()
        await writer.wait_closed()
        assert b" 200 " in head


async def test_process_of_a_node_is_not_sent_ctrl_c(monkeypatch: pytest.MonkeyPatch) -> None:
    """On Windows, ``os.kill(pid, 0)`` does not ask whether a process runs: 0 is Ctrl-C there."""
    sent: list[int] = []
    monkeypatch.setattr(os, "kill", lambda pid, number: sent.append(number))
    node: Any = SimpleNamespace(api="http://localhost:1/", pid=os.getpid(), hub_host="localhost")
    assert not nodes._has_ended(node)
    assert sent == [0]
    monkeypatch.setattr(sys, "platform", "win32")
    assert not nodes._has_ended(node)
    assert sent == [0]


# What is only read.


def modules() -> Iterator[Path]:
    yield from sorted((ROOT / "fibws").rglob("*.py"))


def unguarded(statements: list[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield the statements that an import of a module executes on every platform."""
    for statement in statements:
        match statement:
            case ast.If() | ast.Try() | ast.TryStar():
                continue
            case ast.ClassDef(body=body) | ast.With(body=body):
                yield from unguarded(body)
        yield statement


def imports_without_a_guard(source: str) -> set[str]:
    """Return the modules that Windows lacks and that a module imports there, too."""
    found = set()
    for statement in unguarded(ast.parse(source).body):
        match statement:
            case ast.Import(names=names):
                found |= {alias.name for alias in names}
            case ast.ImportFrom(module=str(name), level=0):
                found.add(name)
    return found & {*MODULES}


@pytest.mark.long
def test_no_module_imports_what_windows_lacks() -> None:
    found = {
        path.relative_to(ROOT).as_posix(): names
        for path in modules()
        if (names := imports_without_a_guard(path.read_text("utf-8")))
    }
    assert found == {}


def test_unguarded_imports_are_found() -> None:
    guarded = "import os\nif os.name != 'nt':\n    import resource\ndef f():\n    import pty\n"
    assert imports_without_a_guard(guarded) == set()
    assert imports_without_a_guard(f"{guarded}import fcntl") == {"fcntl"}
    assert imports_without_a_guard("from pwd import getpwuid") == {"pwd"}


def test_texts_are_read_and_written_with_a_named_encoding() -> None:
    """Elsewhere it is UTF-8 anyway; on Windows it is the code page of the country."""
    rule = ["--preview", "--select", "PLW1514", "--output-format", "concise"]
    command = [
        sys.executable,
        "-m",
        "ruff",
        "check",
        "--no-cache",
        *rule,
        "fibws",
        "hatch_build.py",
    ]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.long
def test_types_are_right_on_windows() -> None:
    """mypy knows which functions and constants of Python's modules Windows lacks."""
    options = ["--platform=win32", "--no-warn-unreachable", "--cache-dir=.mypy_cache/win32"]
    command = [sys.executable, "-m", "mypy", *options, "fibws"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("name", ["con", "NUL", "aux.txt", "com1", "lpt9.log"])
def test_reserved_names_are_known(name: str) -> None:
    assert is_reserved(name)


def is_reserved(name: str) -> bool:
    """Return whether Windows cannot create a file of this name."""
    stem = name.partition(".")[0].lower()
    ports = {f"{port}{number}" for port in ("com", "lpt") for number in range(1, 10)}
    return stem in {"con", "prn", "aux", "nul"} | ports or bool({*name} & {*'<>:"|?*\\'})


def test_windows_can_check_the_repository_out() -> None:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode != 0:
        pytest.skip("not a checkout")
    files = [path for path in listed.stdout.split("\0") if path]
    assert [path for path in files if any(map(is_reserved, path.split("/")))] == []
    folded = [path.lower() for path in files]
    assert len({*folded}) == len(folded), "two files differ only in case"
    assert max(map(len, files)) < 200
