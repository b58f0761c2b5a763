"""Type the commands of docs/tutorial.md into shells, and compare the output with the page."""

from __future__ import annotations

import os
import re
import shutil
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import NamedTuple

import pytest
from cli.terminal import ROOT, Terminal
from patience import PATIENCE
from ports import port as port

TUTORIAL = (ROOT / "docs" / "tutorial.md").read_text("utf-8")
WITHOUT_BASH = TUTORIAL.index("## Without bash")
PROMPT = "ready> "
CTRL_C = "\x03"

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no bash and no zsh")
SHELLS = [
    pytest.param(
        name,
        marks=pytest.mark.skipif(
            shutil.which(name, path=os.defpath) is None, reason=f"{name} is not installed"
        ),
    )
    for name in ("bash", "zsh")
]


class Step(NamedTuple):
    """One thing that a reader does or sees."""

    verb: str
    where: str
    """A terminal's number, or a file's path."""
    text: str = ""
    returns: bool = False
    """Whether the shell is ready for another command after this one, without Ctrl-C."""


def steps(document: str) -> list[Step]:
    """Return the steps of a document in order."""
    found: list[Step] = []
    follower: dict[str, str] = {}
    """The next verb at each terminal."""
    for step in reversed(list(_steps(document))):
        returns = step.verb == "type" and follower.get(step.where) == "type"
        found.append(step._replace(returns=returns))
        if step.verb in ("type", "end"):
            follower[step.where] = step.verb
    return found[::-1]


def _steps(document: str) -> Iterator[Step]:
    end = 0
    for found in re.finditer(
        r"^```(?P<language>\w+)(?: (?P<terminal>\d))?\n(?P<text>.*?)^```$"
        r"|<!-- Ctrl-C (?P<ended>\d) -->",
        document,
        re.MULTILINE | re.DOTALL,
    ):
        before = document[end : found.start()].strip().split("\n\n")[-1].replace("\n", " ")
        end = found.end()
        if found["ended"]:
            yield Step("end", found["ended"])
        elif found["terminal"]:
            yield Step(
                "type" if found["language"] == "console" else "see",
                found["terminal"],
                found["text"],
            )
        elif place := re.search(r"At the end of `([^`]+)`", before):
            yield Step("append", place[1], found["text"])
        elif place := re.search(r"In `([^`]+)`, before `<export>`", before):
            yield Step("insert", place[1], found["text"])
        else:
            yield Step("write", re.findall(r"`([\w/.]+\.\w+)`", before)[-1], found["text"])


class Screen(Terminal):
    """A terminal whose shell has job control, so that Ctrl-C ends the program in the foreground."""

    def __init__(self, *words: str, **environment: str) -> None:
        take = "import fcntl, os, sys, termios; fcntl.ioctl(0, termios.TIOCSCTTY, 0)"
        run = "os.execv(sys.argv[1], sys.argv[1:])"
        super().__init__(sys.executable, "-S", "-c", f"{take}; {run}", *words, **environment)

    def close(self) -> None:
        """End the program in the foreground, the shell, and the terminal."""
        foreground = os.tcgetpgrp(self._master)
        if foreground > 1:
            with suppress(ProcessLookupError):
                os.killpg(foreground, signal.SIGKILL)
        super().close()

    def wait_for_match(self, pattern: str) -> str:
        """Read until the output matches, and return the match; next time continue behind it."""
        deadline = time.monotonic() + PATIENCE
        while (found := re.search(pattern.encode(), self._unread)) is None:
            rest = deadline - time.monotonic()
            assert rest > 0 and self._read(rest), f"no {pattern!r} in {self._unread.decode()}"
        self._unread = self._unread[found.end() :]
        return found[0].decode()


class Reader:
    """Someone who follows the tutorial in a folder, in terminals with one kind of shell."""

    def __init__(self, folder: Path, open_terminal: Callable[[], Screen], port: int) -> None:
        self._folder = folder
        self.workspace = folder / "ros_workspace"
        self._open_terminal = open_terminal
        self._port = port
        self._terminals: dict[str, Screen] = {}
        self._busy = ""
        """The terminal whose last command ends by itself, and may still run."""

    def follow(self, step: Step) -> None:
        if self._busy and self._busy != step.where:
            self.leave(self._busy)  # Other steps may need what the command does.
            self._busy = ""
        getattr(self, step.verb)(step.where, step.text)
        if step.verb == "type":
            self._busy = step.where if step.returns else ""

    def type(self, number: str, text: str) -> None:
        for line in text.splitlines():
            self._prompted(number).type(f"{line}\n")

    def end(self, number: str, _: str = "") -> None:
        self._terminals[number].type(CTRL_C)
        self.leave(number)

    def see(self, number: str, text: str) -> None:
        lines = [self._pattern(line) for line in text.splitlines()]
        terminal = self._terminals[number]
        found = terminal.wait_for_match(r"\s*\n".join(lines))
        heard = [int(number) for number in re.findall(r"(?:heard|data:|value:) (\d+)", found)]
        assert set(heard) <= set(FIBONACCI), f"not Fibonacci numbers: {heard}"
        for index, value in re.findall(r"index: (\d+)\s+value: (\d+)", found):
            assert FIBONACCI[int(index)] == int(value)

    def write(self, path: str, text: str) -> None:
        file = self._file(path)
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, "utf-8")

    def append(self, path: str, text: str) -> None:
        file = self._file(path)
        file.write_text(file.read_text("utf-8") + text, "utf-8")

    def insert(self, path: str, text: str) -> None:
        file = self._file(path)
        before, mark, behind = file.read_text("utf-8").partition("  <export>")
        assert mark, f"{path} has no <export>"
        file.write_text(before + text + mark + behind, "utf-8")

    def leave(self, number: str) -> None:
        """Wait until a terminal is ready for the next command."""
        self._prompted(number).type("\n")

    def _prompted(self, number: str) -> Screen:
        if number not in self._terminals:
            terminal = self._terminals[number] = self._open_terminal()
            terminal.wait_for(PROMPT)
            terminal.type(f"cd '{self._folder}'\n")
        self._terminals[number].wait_for(PROMPT)
        return self._terminals[number]

    def _file(self, path: str) -> Path:
        return (self.workspace if path.startswith("src/") else self.workspace / "src") / path

    def _pattern(self, line: str) -> str:
        """Return the pattern of a line of the document, in which times and numbers vary."""
        pattern = re.escape(line.replace("9090", str(self._port)))
        pattern = re.sub(r"\d{10}\\\.\d{6}", r"\\d{10}\\.\\d{6}", pattern)
        pattern = re.sub(r"_\d+_\d{13}", r"_\\d+_\\d{13}", pattern)
        return re.sub(r"(heard|data:|index:|value:)\\ \d+", r"\1\\ \\d+", pattern)


def fibonacci(count: int) -> list[int]:
    numbers = [0, 1]
    while len(numbers) < count:
        numbers.append(sum(numbers[-2:]))
    return numbers


FIBONACCI = fibonacci(94)
"""Those that fit a uint64."""


@pytest.fixture
def tools(tmp_path: Path) -> Path:
    """Return a folder with the programs of a reader who has fibws and no ROS."""
    folder = tmp_path / "tools"
    folder.mkdir()
    for name, words in (("python", ""), ("fibws", " -m fibws")):
        (folder / name).write_text(f'#!/bin/sh\nexec "{sys.executable}"{words} "$@"\n')
        (folder / name).chmod(0o755)
    for name in ("sh", "bash", "zsh", "env", "mkdir", "chmod", "ls"):
        if where := shutil.which(name, path=os.defpath):
            (folder / name).symlink_to(where)
    return folder


@pytest.fixture
def reader_with(tmp_path: Path, tools: Path, port: int) -> Iterator[Callable[[str], Reader]]:
    """Return a function that makes a reader who uses a shell."""
    options = {"bash": ["--norc", "--noprofile", "-i"], "zsh": ["-f", "-i"], "sh": ["-i"]}
    environment = {
        "PATH": str(tools),
        "PYTHONPATH": str(ROOT),
        "FIBWS_HUB": f"ws://127.0.0.1:{port}",
        "HOME": str(tmp_path),
        "TERM": "dumb",
        "PS1": PROMPT,
        **dict.fromkeys(("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"), ""),
    }
    with ExitStack() as stack:

        def with_shell(shell: str) -> Reader:
            def open_terminal() -> Screen:
                program = str(tools / shell)
                terminal = Screen(program, *options[shell], SHELL=program, **environment)
                stack.callback(terminal.close)
                return terminal

            folder = tmp_path / "a home"
            folder.mkdir()
            return Reader(folder, open_terminal, port)

        yield with_shell


@pytest.mark.tutorial
@pytest.mark.parametrize("shell", SHELLS)
def test_tutorial_works_as_written(shell: str, reader_with: Callable[[str], Reader]) -> None:
    reader = reader_with(shell)
    for step in steps(TUTORIAL[:WITHOUT_BASH].replace("setup.bash", f"setup.{shell}")):
        reader.follow(step)


@pytest.mark.tutorial
def test_tutorial_works_without_bash(reader_with: Callable[[str], Reader]) -> None:
    reader = reader_with("sh")
    reader.workspace = reader.workspace.with_name("other_workspace")
    first, *others = steps(TUTORIAL[WITHOUT_BASH:])
    reader.follow(first)
    nodes = [step for step in steps(TUTORIAL) if step.verb in ("write", "append")][:3]
    assert [Path(node.where).name for node in nodes] == [
        *("fibonacci_broadcaster_node.py", "fibonacci_listener_node.py", "CMakeLists.txt")
    ]
    for node in nodes:
        reader.follow(node)
    for path in reader.workspace.glob("src/fibonacci/src/*.py"):
        path.chmod(0o755)  # Windows has no such permission.
    for step in others:
        reader.follow(step)


def test_tutorial_has_steps_of_each_kind() -> None:
    found = steps(TUTORIAL)
    assert {step.verb for step in found} == {"type", "see", "write", "append", "insert", "end"}
    assert len(found) == TUTORIAL.count("\n```") / 2 + TUTORIAL.count("<!-- Ctrl-C")
