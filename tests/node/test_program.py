"""Running programs of nodes: Ctrl-C, SIGTERM, errors, and closed pipes."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import subprocess
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

import fibws
from fibws.node import program
from fibws.testing import HubThread

from .stubborn import Stubborn

TALKER = """
import sys

import fibws


async def main() -> None:
    async with fibws.Node(sys.argv[1]) as node:
        print("ready", flush=True)
        try:
            async for _ in node.rate(1000):
                if len(sys.argv) > 2:
                    print("x" * 1000, flush=True)
        finally:
            print("leaving", flush=True)


fibws.run(main())
"""


@pytest.fixture
def hub() -> Iterator[HubThread]:
    with HubThread() as hub:
        yield hub


@contextmanager
def talker(hub: HubThread, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """A running program, which has printed that it is connected."""
    with subprocess.Popen(
        [sys.executable, "-W", "error", "-c", TALKER, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "FIBWS_HUB": hub.url},
    ) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
            yield process
        finally:
            process.kill()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signal_ends_a_program_with_exit_code_0(hub: HubThread, number: signal.Signals) -> None:
    with talker(hub, "talker") as process:
        process.send_signal(number)
        assert process.communicate(timeout=60) == ("leaving\n", "")
        assert process.returncode == 0


def test_replaced_node_ends_its_program_with_one_line(hub: HubThread) -> None:
    with talker(hub, "talker") as older, talker(hub, "talker"):
        out, error = older.communicate(timeout=60)
        assert out == "leaving\n"
        assert error.count("\n") == 1 and "/talker" in error
        assert older.returncode == 1


def test_closed_pipe_ends_a_program_quietly(hub: HubThread) -> None:
    with talker(hub, "talker", "prints much") as process:
        assert process.stdout is not None and process.stderr is not None
        process.stdout.close()
        assert process.wait(60) == 0
        assert process.stderr.read() == ""


async def value(result: object) -> object:
    return result


async def fail(error: BaseException) -> None:
    raise error


def test_result_is_returned() -> None:
    assert fibws.run(value(8)) == 8


def test_other_errors_keep_their_traceback() -> None:
    with pytest.raises(ZeroDivisionError):
        fibws.run(fail(ZeroDivisionError()))
    with pytest.raises(fibws.OperationRejected):
        fibws.run(fail(fibws.OperationRejected("no right")))


def test_cancellation_by_the_program_itself_is_raised() -> None:
    with pytest.raises(asyncio.CancelledError):
        fibws.run(fail(asyncio.CancelledError()))


def test_program_runs_in_another_thread() -> None:
    results: list[object] = []
    thread = threading.Thread(target=lambda: results.append(fibws.run(value(8))))
    thread.start()
    thread.join(60)
    assert results == [8]


@pytest.mark.parametrize("count", [1, program.MOST_NAMED + 2])
def test_task_that_swallows_each_cancellation_is_named_and_left_behind(
    count: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(program, "PATIENCE", 0.01)

    async def main() -> int:
        handlers = [Stubborn() for _ in range(count)]
        main.tasks = [asyncio.ensure_future(each(None)) for each in handlers]  # type: ignore[attr-defined]
        for each in handlers:
            await each.begun.wait()
        return 8

    assert fibws.run(main()) == 8
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == min(count, program.MOST_NAMED + 1)
    assert re.search(r"Stubborn\.__call__ \(.*stubborn\.py:\d+\)", lines[0])
    if count > 1:
        assert "2 more" in lines[-1]


def test_what_a_program_waits_for_after_a_signal_is_named() -> None:
    text = """
import asyncio

import fibws
from fibws.node import program

program.PATIENCE = 0.01


async def park() -> None:
    parked.set()
    await asyncio.sleep(1000)


async def main() -> None:
    global parked
    parked = asyncio.Event()
    print("ready", flush=True)
    try:
        await asyncio.Event().wait()
    finally:
        await park()


fibws.run(main())
"""
    with subprocess.Popen(
        [sys.executable, "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.readline() == "ready\n"
        process.terminate()
        named = process.stderr.readline()
        process.kill()
    assert "main" in named and "<string>:12" in named and "Ctrl-C" in named


def test_second_signal_ends_a_program_that_does_not_end() -> None:
    text = """
import asyncio

import fibws
from fibws import exit_signals

exit_signals.REPEAT = 0.0


async def main() -> None:
    print("ready", flush=True)
    try:
        await asyncio.Event().wait()
    finally:
        print("cleaning up", flush=True)
        await asyncio.Event().wait()


fibws.run(main())
"""
    with subprocess.Popen(
        [sys.executable, "-c", text], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.terminate()
        assert process.stdout.readline() == "cleaning up\n"
        process.terminate()
        assert process.wait(60) == -signal.SIGTERM


async def test_running_loop_is_named_with_what_to_write() -> None:
    async def work() -> None:
        pass

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(RuntimeError, match=r"write await work\(\) in place"):
            fibws.run(work())
        with pytest.raises(RuntimeError, match=r"write await \.\.\. in place"):
            fibws.run(fibws.Node("talker").spin())


def test_missing_parentheses_are_named() -> None:
    async def work() -> None:
        pass

    with pytest.raises(TypeError, match=r"write fibws\.run\(work\(\)\)"):
        fibws.run(work)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="takes a coroutine, got 5"):
        fibws.run(5)  # type: ignore[arg-type]
