"""All processes of a launch."""

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

from fibws.ros1.launch.command import Start
from fibws.ros1.launch.model import Node
from fibws.ros1.launch.process import Process
from fibws.ros1.launch.runner import Job, Runner
from fibws.ros1.launch.screen import Screen

WAIT = "import signal; signal.signal(signal.SIGINT, signal.SIG_DFL); print('up'); signal.pause()"
DEAF = (
    "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN); "
    "signal.signal(signal.SIGTERM, signal.SIG_IGN)\n"
    "print('up')\nwhile True: signal.pause()"
)


class Launched:
    """A runner, and what it shows."""

    def __init__(self, folder: Path, **waits: float) -> None:
        self.folder = folder
        self.seen: list[str] = []
        self._lines: asyncio.Queue[str] = asyncio.Queue()
        self.runner = Runner(Screen(self._write), folder / "log", **waits)

    def _write(self, line: str, is_error: bool) -> None:
        # Ids, and what is long, differ from run to run.
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
        node = Node(**{"package": "p", "type": "t", "name": "n", **fields}, file="a", line=1)
        start = Start([sys.executable, "-u", "-c", script], dict(os.environ), self.folder)
        await self.runner.start_node(node, start, screen=screen)

    async def core(self, script: str) -> None:
        """Start what counts for the hub."""
        job = Job(
            Process(
                "hub",
                Start([sys.executable, "-u", "-c", script], dict(os.environ), self.folder),
                lambda line, is_error: self._write(f"hub: {line}", is_error),
            ),
            required=True,
            is_core=True,
        )
        await job.process.begin()
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


async def test_it_ends_when_all_have(launched: Launched) -> None:
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


async def test_what_is_not_shown_is_kept_but_for_what_goes_wrong(launched: Launched) -> None:
    await launched.start(
        "import sys; print('out', flush=True); print('err', file=sys.stderr)", screen=False
    )
    await launched.run()
    assert "[n-1] err" in launched.seen
    assert "[n-1] out" not in launched.seen
    assert "[n-1] process has finished cleanly\nlog file: LOG/n-1.log" in launched.seen
    assert sorted((launched.folder / "log/n-1.log").read_text().split()) == ["err", "out"]


async def test_what_ending_makes_a_node_say_is_kept_but_not_shown(launched: Launched) -> None:
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


async def test_what_cannot_be_kept_is_shown(launched: Launched) -> None:
    (launched.folder / "log").touch()
    await launched.start("print('out')", screen=False)
    await launched.run()
    assert any(line.startswith("[n-1] cannot be logged: ") for line in launched.seen)
    assert "[n-1] out" in launched.seen


async def test_all_end_in_reverse_order_and_the_hub_last(launched: Launched) -> None:
    await launched.core(WAIT)
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


async def test_a_process_that_is_required_ends_all(launched: Launched) -> None:
    await launched.start(WAIT, name="a")
    await launched.shows("up")
    await launched.start("import sys; sys.exit(3)", name="b", required=True)
    await launched.run()
    [said] = [line for line in launched.seen if "REQUIRED" in line]
    assert said == (
        f"{'=' * 80}\nREQUIRED process [b-2] has died!\n"
        "process has died [pid N, exit code 3, cmd ...].\n"
        f"Initiating shutdown!\n{'=' * 80}"
    )
    assert launched.seen[-1] == "[a-1] killing on exit"
    assert launched.runner.has_failed


async def test_a_process_is_started_again(launched: Launched) -> None:
    await launched.start("import sys; sys.exit(1)", respawn=True)
    for _ in range(2):
        await launched.shows("process has died")
        await launched.shows("[n-1] restarting process")
        await launched.shows("process[n-1]: started with pid N")
    launched.runner.stop()
    await launched.run()
    assert not launched.runner.has_failed


async def test_a_process_that_cannot_come_back_is_a_failure(launched: Launched) -> None:
    program = launched.folder / "once"
    program.write_text(f"#!{sys.executable}\nimport os\nos.remove(__file__)\n")
    program.chmod(0o755)
    start = Start([str(program)], dict(os.environ), launched.folder)
    await launched.runner.start_node(Node("p", "t", "n", "a", 1, respawn=True), start, screen=True)
    await launched.run()
    assert "[n-1] restarting process" in launched.seen
    assert launched.runner.has_failed


async def test_a_process_that_is_to_come_back_is_not_waited_for(launched: Launched) -> None:
    await launched.start("pass", respawn=True, respawn_delay=1000.0)
    await launched.shows("process has finished cleanly")
    launched.runner.stop()
    await launched.run()
    assert launched.seen[-1] == "[n-1] process has finished cleanly"


async def test_a_process_that_takes_its_time_is_made_to_end(tmp_path: Path) -> None:
    launched = Launched(tmp_path, wait_interrupt=0.1, wait_terminate=0.1)
    await launched.start(DEAF)
    await launched.shows("up")
    launched.runner.stop()
    await launched.run()
    assert launched.seen[-3:] == [
        "[n-1] killing on exit",
        "[n-1] escalating to SIGTERM",
        "[n-1] escalating to SIGKILL",
    ]


async def test_to_be_told_again_is_to_hurry(tmp_path: Path) -> None:
    launched = Launched(tmp_path, wait_interrupt=1000.0, wait_terminate=1000.0)
    await launched.start(DEAF)
    await launched.shows("up")
    launched.runner.stop()
    end = asyncio.create_task(launched.run())
    await launched.shows("killing on exit")
    launched.runner.stop()
    await launched.shows("escalating to SIGTERM")
    launched.runner.stop()
    await end
    assert launched.seen[-1] == "[n-1] escalating to SIGKILL"


async def test_signals_end_all(launched: Launched) -> None:
    signals: list[str] = []
    launched.runner.obey_signals(lambda: signals.append("told"))
    await launched.start(WAIT)
    await launched.shows("up")
    end = asyncio.create_task(launched.run())
    os.kill(os.getpid(), signal.SIGTERM)
    await end
    assert (signals, launched.seen[-1]) == (["told"], "[n-1] killing on exit")


async def test_with_a_hub_of_its_own_it_stays_when_all_nodes_have_ended(launched: Launched) -> None:
    await launched.core(WAIT)
    await launched.shows("up")
    await launched.start("pass")
    end = asyncio.create_task(launched.run())
    await launched.shows("all nodes have ended; the hub stays until Ctrl-C")
    assert not end.done()
    launched.runner.stop()
    await end
    assert launched.seen[-1] == "[hub] killing on exit"


async def test_a_hub_that_dies_ends_all(launched: Launched) -> None:
    await launched.start(WAIT)
    await launched.shows("up")
    await launched.core("import sys; sys.exit(1)")
    await launched.run()
    assert any("REQUIRED process [hub] has died!" in line for line in launched.seen)
    assert launched.seen[-1] == "[n-1] killing on exit"


async def test_a_program_that_cannot_be_started_is_a_failure(launched: Launched) -> None:
    node = Node("p", "t", "n", "a", 1)
    start = Start(["no_such_program", "x"], dict(os.environ), launched.folder)
    await launched.runner.start_node(node, start, screen=True)
    await launched.run()
    assert launched.seen == [
        "[n-1] cannot be started: No such file or directory: no_such_program x"
    ]
    assert launched.runner.has_failed
    required = Node("p", "t", "n", "a", 1, required=True)
    await launched.runner.start_node(required, start, screen=True)
    assert launched.seen[-1] == "REQUIRED process [n] cannot be started!"


async def test_nothing_to_run_is_done_at_once(launched: Launched) -> None:
    await launched.run()
    assert launched.seen == []
