"""fibws on a Python that lacks what Windows lacks.

It cannot show how Windows treats paths, sockets and terminals: only the workflow on GitHub does.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from .requirements import ROOT

POSIX_MODULES = ("fcntl", "grp", "pty", "pwd", "readline", "resource", "syslog", "termios", "tty")
WITHOUT_POSIX = f"""
import asyncio, contextlib, functools, importlib, os, pkgutil, signal, socket, subprocess, sys
import tempfile, types, uuid
import click.testing, ifaddr, pydantic.main, rich.console, websockets.asyncio.client, yaml

def no_handler(*_):
    raise NotImplementedError

socket.socketpair = functools.partial(socket.socketpair, socket.AF_UNIX)  # as without AF_UNIX
for name in {POSIX_MODULES}:
    sys.modules[name] = None
for module, names in (
    (os, "fork forkpty getuid geteuid getgid getegid getpgid killpg setsid openpty "
         "sched_getaffinity posix_fallocate pread pwrite O_CLOEXEC O_NONBLOCK O_DIRECTORY"),
    (signal, "SIGHUP SIGKILL SIGQUIT SIGUSR1 SIGUSR2 SIGALRM SIGCHLD SIGTSTP SIGCONT SIGWINCH "
             "pthread_sigmask pthread_kill pause setitimer"),
    (socket, "AF_UNIX SO_REUSEPORT send_fds recv_fds if_nameindex"),
):
    for name in names.split():
        with contextlib.suppress(AttributeError):
            delattr(module, name)
asyncio.SelectorEventLoop.add_signal_handler = no_handler
asyncio.SelectorEventLoop.remove_signal_handler = no_handler
sys.modules["msvcrt"] = types.ModuleType("msvcrt")
signal.CTRL_BREAK_EVENT, signal.SIGBREAK = signal.SIGTERM, signal.SIGINT
subprocess.CREATE_NEW_PROCESS_GROUP = 0x200
sys.platform = "win32"
"""
"""Takes away what is missing on Windows. The libraries above have their own ways there."""
IMPORTS = """
import fibws
for module in pkgutil.walk_packages(fibws.__path__, "fibws."):
    name = module.name
    if not name.startswith(("fibws.ros1.python", "fibws.ros1.fallback")):
        if not name.endswith("__main__"):
            try:
                importlib.import_module(name)
            except ModuleNotFoundError as error:
                assert error.name not in sys.stdlib_module_names, (name, error)
print("done")
"""
HUB_AND_NODE = """
import fibws
from fibws.hub import Hub, Settings

async def main():
    async with Hub(Settings(port=0)) as hub, fibws.Node("talker", hub=hub.url) as node:
        publisher = await node.advertise("/word", "std_msgs/String", latch=True)
        await publisher.publish(data="heard")
        print((await node.wait_for_message("/word", "std_msgs/String")).data)

fibws.run(main())
"""
TOOLS = """
from click.testing import CliRunner
from fibws.cli.commands import command
from fibws.testing import HubThread

with HubThread() as hub:
    for words in (["--help"], ["topic", "list"], ["node", "list"], ["doctor"]):
        result = CliRunner().invoke(command, words, env={"FIBWS_HUB": hub.url})
        assert result.exit_code == 0, (words, result.output, result.exception)
print("done")
"""


@pytest.mark.parametrize(
    ("program", "printed"),
    [(IMPORTS, "done"), (HUB_AND_NODE, "heard"), (TOOLS, "done")],
    ids=["imports", "hub and node", "tools"],
)
def test_nothing_needs_what_windows_lacks(program: str, printed: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_POSIX + program], cwd=ROOT, capture_output=True, text=True
    )
    assert done.stdout.splitlines()[-1:] == [printed], done.stderr


def unguarded_imports(path: Path) -> Iterator[str]:
    """Yield the POSIX modules that a module imports as soon as it is imported itself."""
    for statement in ast.parse(path.read_text("utf-8")).body:
        match statement:
            case ast.Import(names=names):
                yield from (each.name for each in names if each.name in POSIX_MODULES)
            case ast.ImportFrom(module=str(module)) if module in POSIX_MODULES:
                yield module


def test_modules_of_posix_are_imported_with_a_guard() -> None:
    found = {
        path.relative_to(ROOT).as_posix(): names
        for path in (ROOT / "fibws").rglob("*.py")
        if (names := list(unguarded_imports(path)))
    }
    assert found == {}
