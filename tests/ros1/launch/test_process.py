"""A process: its output and its end."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from fibws.ros1.launch.node_command import NodeCommand
from fibws.ros1.launch.process import LONGEST_LINE, Process, Signal


class Output:
    """The lines that a process prints."""

    def __init__(self) -> None:
        self.lines: list[tuple[str, bool]] = []
        self._queue = asyncio.Queue[str]()

    def __call__(self, line: str, is_error: bool) -> None:
        self.lines.append((line, is_error))
        self._queue.put_nowait(line)

    async def next(self) -> str:
        async with asyncio.timeout(60):
            return await self._queue.get()


class Processes:
    """Creates processes, and ends them after the test."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._created: list[Process] = []

    def make(self, script: str, output: Output, *inherited: str) -> Process:
        node = NodeCommand([sys.executable, "-u", "-c", script], dict(os.environ), self._folder)
        process = Process("p-1", node, output, inherited=set(inherited))
        self._created.append(process)
        return process

    async def stop(self) -> None:
        for process in self._created:
            if process.is_running:
                process.send(Signal.KILL)
                await process.wait()


@pytest.fixture
async def processes(tmp_path: Path) -> AsyncIterator[Processes]:
    processes = Processes(tmp_path / "made" / "if_need_be")
    yield processes
    await processes.stop()


async def test_output_is_received_line_by_line(processes: Processes) -> None:
    output = Output()
    process = processes.make(
        "import sys; print('a'); print('grün\\r'); sys.stdout.flush(); "
        "sys.stderr.write('e\\nno end'); sys.stdout.buffer.write(b'\\xff\\n'); sys.exit(3)",
        output,
    )
    assert (process.pid, process.is_running) == (0, False)
    await process.start()
    assert process.pid > 0
    assert await process.wait() == 3
    assert (process.exit_code, process.is_running) == (3, False)
    assert [line for line, is_error in output.lines if not is_error] == ["a", "grün", "\ufffd"]
    assert [line for line, is_error in output.lines if is_error] == ["e", "no end"]


async def test_long_line_is_split(processes: Processes) -> None:
    output = Output()
    process = processes.make(f"print('x' * {LONGEST_LINE * 3}, end='')", output)
    await process.start()
    await process.wait()
    assert "".join(line for line, _ in output.lines) == "x" * LONGEST_LINE * 3
    assert all(len(line) <= 2 * LONGEST_LINE for line, _ in output.lines)


async def test_inherited_streams_are_those_of_this_process(
    processes: Processes, capfd: pytest.CaptureFixture[str]
) -> None:
    script = "import sys; print('out'); print('err', file=sys.stderr)"
    for inherited, lines in (
        (["stdout"], [("err", True)]),
        (["stderr"], [("out", False)]),
        (["stdout", "stderr"], []),
    ):
        output = Output()
        process = processes.make(script, output, *inherited)
        await process.start()
        assert await process.wait() == 0
        assert output.lines == lines
        shown = capfd.readouterr()
        assert (shown.out, shown.err) == tuple(
            f"{name[3:]}\n" if name in inherited else "" for name in ("stdout", "stderr")
        )


async def test_process_runs_in_its_folder_without_input(
    processes: Processes, tmp_path: Path
) -> None:
    output = Output()
    process = processes.make("import os, sys; print(os.getcwd(), repr(sys.stdin.read()))", output)
    await process.start()
    await process.wait()
    assert output.lines == [(f"{tmp_path / 'made' / 'if_need_be'} ''", False)]


async def test_impossible_folder_is_replaced_by_the_current_one(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    output = Output()
    script = "import os; print(os.getcwd())"
    process = Processes(tmp_path / "file" / "in").make(script, output)
    await process.start()
    await process.wait()
    assert output.lines == [(os.getcwd(), False)]


async def test_process_can_be_started_again(processes: Processes) -> None:
    output = Output()
    process = processes.make("print('a')", output)
    for _ in range(2):
        await process.start()
        assert process.exit_code is None
        await process.wait()
    assert output.lines == [("a", False)] * 2


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals")
@pytest.mark.parametrize(
    ("signal_", "code"),
    [
        (Signal.INTERRUPT, -signal.SIGINT),
        (Signal.TERMINATE, -signal.SIGTERM),
        (Signal.KILL, -signal.Signals(9)),
    ],
)
async def test_signals_end_a_process(signal_: Signal, code: int, processes: Processes) -> None:
    output = Output()
    process = processes.make(
        "import signal; signal.signal(signal.SIGINT, signal.SIG_DFL); print('up'); signal.pause()",
        output,
    )
    process.send(signal_)
    await process.start()
    await output.next()
    process.send(signal_)
    assert await process.wait() == code
    process.send(signal_)


async def test_end_does_not_wait_for_children(processes: Processes) -> None:
    output = Output()
    process = processes.make(
        "import subprocess, sys; child = subprocess.Popen([sys.executable, '-c', "
        "'import signal; signal.pause()'], start_new_session=True); print(child.pid)",
        output,
    )
    await process.start()
    async with asyncio.timeout(60):
        await process.wait()
    os.kill(int(output.lines[0][0]), signal.SIGKILL)


async def test_missing_program_raises(tmp_path: Path) -> None:
    process = Process("p", NodeCommand(["no_such_program"], {}, tmp_path), Output())
    with pytest.raises(FileNotFoundError):
        await process.start()
