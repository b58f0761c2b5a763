"""The processes of a launch."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

from fibws.ros1.launch.model import LaunchNode
from fibws.ros1.launch.node_command import NodeCommand
from fibws.ros1.launch.output import Screen, Terminal
from fibws.ros1.launch.process import Process
from fibws.ros1.launch.runner import Job, Runner

WAIT = "import signal; signal.signal(signal.SIGINT, signal.SIG_DFL); print('up'); signal.pause()"
STUBBORN = (
    "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN); "
    "signal.signal(signal.SIGTERM, signal.SIG_IGN)\n"
    "print('up')\nwhile True: signal.pause()"
)


class Launched:
    """A runner and the lines that it shows."""

    def __init__(self, folder: Path, **waits: float) -> None:
        self.folder = folder
        self.seen: list[str] = []
        self._lines: asyncio.Queue[str] = asyncio.Queue()
        terminal = Terminal(is_shared=False)
        self.runner = Runner(Screen(self._write), terminal, folder / "log", **waits)

    def _write(self, line: str, is_error: bool) -> None:
        # Process IDs and commands differ from run to run.
        line = re.sub(r"pid \[?\d+\]?", "pid N", line)
        line = re.sub(r"cmd .*\]\.", "cmd ...].", line, flags=re.DOTALL)
        line = line.replace(str(self.folder / "log"), "LOG")
        self.seen.append(line)
        self._lines.put_nowait(line)

    async def shows(self, text: str) -> None:
        """Wait until a line has this in it."""
        async with asyncio.timeout(60):
            while text not in await self._lines.get():
                pass

    async def start(self, script: str, *, screen: bool = True, **fields: Any) -> None:
        node = LaunchNode(**{"package": "p", "type": "t", "name": "n", **fields}, file="a", line=1)
        command = NodeCommand([sys.executable, "-u", "-c", script], dict(os.environ), self.folder)
        await self.runner.start_node(node, command, screen=screen)

    async def start_hub(self, script: str) -> None:
        """Start a script as the hub."""
        job = Job(
            Process(
                "hub",
                NodeCommand([sys.executable, "-u", "-c", script], dict(os.environ), self.folder),
                lambda line, is_error: self._write(f"hub: {line}", is_error),
            ),
            required=True,
            is_hub=True,
        )
        await job.process.start()
        self.runner.add(job)

    async def run(self) -> None:
        async with asyncio.timeout(60):
            await self.runner.run()


@pytest.fixture
async def launched(tmp_path: Path) -> AsyncIterator[Launched]:
    launched = Launched(tmp_path)
    yield launched
    launched.runner.stop()
    await launched.runner.shut_down()


async def test_runner_ends_when_all_processes_have_ended(launched: Launched) -> None:
    await launched.start("print('hello')", name="a", namespace="/g")
    await launched.start("import sys; sys.exit(2)", name="b")
    await launched.run()
    assert {
        "process[g/a-1]: started with pid N",
        "[g/a-1] hello",
        "[g/a-1] process has finished cleanly",
        "process[b-2]: started with pid N",
        "[b-2] process has died [pid N, exit code 2, cmd ...].",
        "all processes on machine have died, fibws launch will exit",
    } == set(launched.seen)
    assert launched.runner.has_failed


async def test_output_is_logged_and_errors_are_shown(launched: Launched) -> None:
    await launched.start(
        "import sys; print('out', flush=True); print('err', file=sys.stderr)", screen=False
    )
    await launched.run()
    assert "[n-1] err" in launched.seen
    assert "[n-1] out" not in launched.seen
    assert "[n-1] process has finished cleanly\nlog file: LOG/n-1.log" in launched.seen
    assert sorted((launched.folder / "log/n-1.log").read_text().split()) == ["err", "out"]


async def test_errors_while_stopping_are_only_logged(launched: Launched) -> None:
    await launched.start(
        "import sys, signal\n"
        "def leave(*_): print('leaving', file=sys.stderr); sys.exit()\n"
        "signal.signal(signal.SIGINT, leave); print('ready', file=sys.stderr)\n"
        "while True: signal.pause()",
        screen=False,
    )
    await launched.shows("[n-1] ready")
    launched.runner.stop()
    await launched.run()
    assert "[n-1] leaving" not in launched.seen
    assert (launched.folder / "log/n-1.log").read_text() == "ready\nleaving\n"
    assert not launched.runner.has_failed


async def test_output_that_cannot_be_logged_is_shown(launched: Launched) -> None:
    (launched.folder / "log").touch()
    await launched.start("print('out')", screen=False)
    await launched.run()
    assert any(line.startswith("[n-1] cannot write log: ") for line in launched.seen)
    assert "[n-1] out" in launched.seen


async def test_processes_end_in_reverse_order_and_the_hub_last(launched: Launched) -> None:
    await launched.start_hub(WAIT)
    for name in ("a", "b"):
        await launched.start(WAIT, name=name)
    for _ in range(3):
        await launched.shows("up")
    launched.runner.stop()
    await launched.run()
    assert [line for line in launched.seen if "killing" in line] == [
        "[b-2] killing on exit",
        "[a-1] killing on exit",
        "[hub] killing on exit",
    ]
    assert not launched.runner.has_failed


async def test_end_of_a_required_process_ends_all(launched: Launched) -> None:
    await launched.start(WAIT, name="a")
    await launched.shows("up")
    await launched.start("import sys; sys.exit(3)", name="b", required=True)
    await launched.run()
    [text] = [line for line in launched.seen if "REQUIRED" in line]
    assert text == (
        f"{'=' * 80}\nREQUIRED process [b-2] has died!\n"
        "process has died [pid N, exit code 3, cmd ...].\n"
        f"Initiating shutdown!\n{'=' * 80}"
    )
    assert launched.seen[-1] == "[a-1] killing on exit"
    assert launched.runner.has_failed


async def test_respawn_restarts_a_process(launched: Launched) -> None:
    await launched.start("import sys; sys.exit(1)", respawn=True)
    for _ in range(2):
        await launched.shows("process has died")
        await launched.shows("[n-1] restarting process")
        await launched.shows("process[n-1]: started with pid N")
    launched.runner.stop()
    await launched.run()
    assert not launched.runner.has_failed


async def test_failed_restart_is_a_failure(launched: Launched) -> None:
    program = launched.folder / "once"
    program.write_text(f"#!{sys.executable}\nimport os\nos.remove(__file__)\n")
    program.chmod(0o755)
    command = NodeCommand([str(program)], dict(os.environ), launched.folder)
    await launched.runner.start_node(
        LaunchNode("p", "t", "n", "a", 1, respawn=True), command, screen=True
    )
    await launched.run()
    assert "[n-1] restarting process" in launched.seen
    assert launched.runner.has_failed


async def test_stop_does_not_wait_for_a_respawn_delay(launched: Launched) -> None:
    await launched.start("pass", respawn=True, respawn_delay=1000.0)
    await launched.shows("process has finished cleanly")
    launched.runner.stop()
    await launched.run()
    assert launched.seen[-1] == "[n-1] process has finished cleanly"


async def test_stubborn_process_is_killed(tmp_path: Path) -> None:
    launched = Launched(tmp_path, sigint_timeout=0.1, sigterm_timeout=0.1)
    await launched.start(STUBBORN)
    await launched.shows("up")
    launched.runner.stop()
    await launched.run()
    assert launched.seen[-3:] == [
        "[n-1] killing on exit",
        "[n-1] escalating to SIGTERM",
        "[n-1] escalating to SIGKILL",
    ]


async def test_second_stop_sends_the_next_signal_at_once(tmp_path: Path) -> None:
    launched = Launched(tmp_path, sigint_timeout=1000.0, sigterm_timeout=1000.0)
    await launched.start(STUBBORN)
    await launched.shows("up")
    launched.runner.stop()
    end = asyncio.create_task(launched.run())
    await launched.shows("killing on exit")
    launched.runner.stop()
    await launched.shows("escalating to SIGTERM")
    launched.runner.stop()
    await end
    assert launched.seen[-1] == "[n-1] escalating to SIGKILL"


async def test_signals_stop_all(launched: Launched) -> None:
    signals: list[str] = []
    launched.runner.handle_signals(lambda: signals.append("received"))
    await launched.start(WAIT)
    await launched.shows("up")
    end = asyncio.create_task(launched.run())
    os.kill(os.getpid(), signal.SIGTERM)
    await end
    assert (signals, launched.seen[-1]) == (["received"], "[n-1] killing on exit")


async def test_own_hub_runs_after_all_nodes_have_ended(launched: Launched) -> None:
    await launched.start_hub(WAIT)
    await launched.shows("up")
    await launched.start("pass")
    end = asyncio.create_task(launched.run())
    await launched.shows("all nodes have ended")
    assert not end.done()
    launched.runner.stop()
    await end
    assert launched.seen[-1] == "[hub] killing on exit"


async def test_end_of_the_hub_ends_all(launched: Launched) -> None:
    await launched.start(WAIT)
    await launched.shows("up")
    await launched.start_hub("import sys; sys.exit(1)")
    await launched.run()
    assert any("REQUIRED process [hub] has died!" in line for line in launched.seen)
    assert launched.seen[-1] == "[n-1] killing on exit"


async def test_program_that_cannot_be_started_is_a_failure(launched: Launched) -> None:
    node = LaunchNode("p", "t", "n", "a", 1)
    command = NodeCommand(["no_such_program", "x"], dict(os.environ), launched.folder)
    await launched.runner.start_node(node, command, screen=True)
    await launched.run()
    assert launched.seen == [
        "[n-1] cannot be started: No such file or directory: no_such_program x"
    ]
    assert launched.runner.has_failed
    required = LaunchNode("p", "t", "n", "a", 1, required=True)
    await launched.runner.start_node(required, command, screen=True)
    assert launched.seen[-1] == "REQUIRED process [n] cannot be started!"


async def test_without_processes_it_ends_at_once(launched: Launched) -> None:
    await launched.run()
    assert launched.seen == []
