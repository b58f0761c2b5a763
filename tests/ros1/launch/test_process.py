"""One process."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from fibws.ros1.launch.command import Start
from fibws.ros1.launch.process import LONGEST_LINE, Ask, Process


class Heard:
    """What a process prints, which can be waited for."""

    def __init__(self) -> None:
        self.lines: list[tuple[str, bool]] = []
        self._news = asyncio.Condition()
        self._count = asyncio.Queue[str]()

    def __call__(self, line: str, is_error: bool) -> None:
        self.lines.append((line, is_error))
        self._count.put_nowait(line)

    async def next(self) -> str:
        async with asyncio.timeout(60):
            return await self._count.get()


class Processes:
    """Starts scripts, and leaves none over."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._made: list[Process] = []

    def make(self, script: str, heard: Heard) -> Process:
        command = [sys.executable, "-u", "-c", script]
        process = Process("p-1", Start(command, dict(os.environ), self._folder), heard)
        self._made.append(process)
        return process

    async def stop(self) -> None:
        for process in self._made:
            if process.is_running:
                process.ask(Ask.KILL)
                await process.end()


@pytest.fixture
async def processes(tmp_path: Path) -> AsyncIterator[Processes]:
    processes = Processes(tmp_path / "made" / "if_need_be")
    yield processes
    await processes.stop()


async def test_what_it_prints_is_heard_line_by_line(processes: Processes) -> None:
    heard = Heard()
    process = processes.make(
        "import sys; print('a'); print('grün\\r'); sys.stdout.flush(); "
        "sys.stderr.write('e\\nno end'); sys.stdout.buffer.write(b'\\xff\\n'); sys.exit(3)",
        heard,
    )
    assert (process.pid, process.is_running) == (0, False)
    await process.begin()
    assert process.pid > 0
    assert await process.end() == 3
    assert (process.exit_code, process.is_running) == (3, False)
    assert [line for line, is_error in heard.lines if not is_error] == ["a", "grün", "\ufffd"]
    assert [line for line, is_error in heard.lines if is_error] == ["e", "no end"]


async def test_a_line_without_end_is_heard_in_parts(processes: Processes) -> None:
    heard = Heard()
    process = processes.make(f"print('x' * {LONGEST_LINE * 3}, end='')", heard)
    await process.begin()
    await process.end()
    assert "".join(line for line, _ in heard.lines) == "x" * LONGEST_LINE * 3
    assert all(len(line) <= 2 * LONGEST_LINE for line, _ in heard.lines)


async def test_it_runs_in_its_folder_with_nothing_to_read(
    processes: Processes, tmp_path: Path
) -> None:
    heard = Heard()
    process = processes.make("import os, sys; print(os.getcwd(), repr(sys.stdin.read()))", heard)
    await process.begin()
    await process.end()
    assert heard.lines == [(f"{tmp_path / 'made' / 'if_need_be'} ''", False)]


async def test_a_folder_that_cannot_be_is_done_without(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    heard = Heard()
    script = "import os; print(os.getcwd())"
    process = Processes(tmp_path / "file" / "in").make(script, heard)
    await process.begin()
    await process.end()
    assert heard.lines == [(os.getcwd(), False)]


async def test_it_can_be_started_again(processes: Processes) -> None:
    heard = Heard()
    process = processes.make("print('a')", heard)
    for _ in range(2):
        await process.begin()
        assert process.exit_code is None
        await process.end()
    assert heard.lines == [("a", False)] * 2


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals")
@pytest.mark.parametrize(
    ("how", "code"),
    [
        (Ask.INTERRUPT, -signal.SIGINT),
        (Ask.TERMINATE, -signal.SIGTERM),
        (Ask.KILL, -signal.Signals(9)),
    ],
)
async def test_it_ends_as_it_is_asked_to(how: Ask, code: int, processes: Processes) -> None:
    heard = Heard()
    process = processes.make(
        "import signal; signal.signal(signal.SIGINT, signal.SIG_DFL); print('up'); signal.pause()",
        heard,
    )
    process.ask(how)
    await process.begin()
    await heard.next()
    process.ask(how)
    assert await process.end() == code
    process.ask(how)


async def test_a_child_of_it_that_lives_on_is_not_waited_for(processes: Processes) -> None:
    heard = Heard()
    process = processes.make(
        "import subprocess, sys; child = subprocess.Popen([sys.executable, '-c', "
        "'import signal; signal.pause()'], start_new_session=True); print(child.pid)",
        heard,
    )
    await process.begin()
    async with asyncio.timeout(60):
        await process.end()
    os.kill(int(heard.lines[0][0]), signal.SIGKILL)


async def test_a_program_that_is_not_there_raises(tmp_path: Path) -> None:
    process = Process("p", Start(["no_such_program"], {}, tmp_path), Heard())
    with pytest.raises(FileNotFoundError):
        await process.begin()
