"""All processes of a launch: started in their order, watched, and ended in the order's reverse."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fibws.command_names import command_name
from fibws.processes import start_error
from fibws.ros1.launch.command import Start
from fibws.ros1.launch.log import Log
from fibws.ros1.launch.model import Node
from fibws.ros1.launch.process import Ask, Process
from fibws.ros1.launch.screen import Screen

WAIT_INTERRUPT, WAIT_TERMINATE = 15.0, 2.0
"""Seconds that a process has to end after the one and the other, as for roslaunch."""
SHORTEST_DELAY = 0.1
"""Seconds before a process starts again: one that fails at once must not keep a machine busy."""
RULE = "=" * 80


@dataclass
class Job:
    """A node, or the hub, and its process.

    Attributes:
        screen: whether what it prints is shown, and not only kept in ``log``.
        respawn_delay: seconds between its end and its next start; None if there is none.
        required: whether all ends when it ends.
        is_core: whether it ends when all others have, and does not count for there being any.
    """

    process: Process
    log: Log | None = None
    screen: bool = False
    respawn_delay: float | None = None
    required: bool = False
    is_core: bool = False
    watch: asyncio.Task[None] = field(init=False, repr=False)


class Runner:
    """Runs the processes of a launch, one after the other started.

    Args:
        screen: where all is shown.
        folder: for what processes print that is not shown.
        wait_interrupt: seconds until one that was interrupted is terminated.
        wait_terminate: seconds from then until it is killed.
    """

    def __init__(
        self,
        screen: Screen,
        folder: Path,
        *,
        wait_interrupt: float = WAIT_INTERRUPT,
        wait_terminate: float = WAIT_TERMINATE,
    ) -> None:
        self._screen = screen
        self._folder = folder
        self._waits = ((Ask.TERMINATE, wait_interrupt), (Ask.KILL, wait_terminate))
        self._jobs: list[Job] = []
        self._stopping = asyncio.Event()
        self._hurry = asyncio.Event()
        self._urgency = 0
        self._count = 0
        self.has_failed = False
        """Whether a process could not be started, or has ended with an error by itself."""

    @property
    def is_stopping(self) -> bool:
        """Whether all is to end."""
        return self._stopping.is_set()

    def stop(self) -> None:
        """Have all end; called again, do not wait any longer for those that take their time."""
        if not self._stopping.is_set():
            self._stopping.set()
        else:
            self._urgency += 1
            self._hurry.set()
            self._hurry = asyncio.Event()  # for the next time

    def obey_signals(self, on_signal: Callable[[], None]) -> None:
        """Stop on Ctrl-C, SIGTERM, and when the terminal is closed."""

        def stop() -> None:
            on_signal()
            self.stop()

        for name in ("SIGINT", "SIGTERM", "SIGHUP"):
            # On Windows an event loop handles no signals: there Ctrl-C cancels its task.
            with suppress(NotImplementedError, AttributeError):
                asyncio.get_running_loop().add_signal_handler(getattr(signal, name), stop)

    async def start_node(self, node: Node, start: Start, *, screen: bool) -> None:
        """Start a node; if that cannot be done, it is said and counted as a failure."""
        self._count += 1
        name = f"{node.resolved.lstrip('/')}-{self._count}"
        log = Log(self._folder / f"{name.replace('/', '-')}.log")
        job = Job(
            Process(name, start, lambda line, is_error: self._heard(job, line, is_error)),
            log,
            screen=screen,
            respawn_delay=node.respawn_delay if node.respawn else None,
            required=node.required,
        )
        if await self._begin(job):
            self.add(job)
        else:
            self.fail(node)

    def fail(self, node: Node) -> None:
        """Take note that a node cannot be started."""
        self.has_failed = True
        if node.required:
            self._screen.complain(f"REQUIRED process [{node.name}] cannot be started!")
            self.stop()

    def add(self, job: Job) -> None:
        """Watch a job whose process was started."""
        self._jobs.append(job)
        job.watch = asyncio.create_task(self._watch(job), name=job.process.name)

    async def run(self) -> None:
        """Wait until there is nothing left to run, or all is to end; then end all."""
        nodes = [job.watch for job in self._jobs if not job.is_core]
        stopping = asyncio.create_task(self._stopping.wait())
        try:
            if nodes and not self.is_stopping:
                everything = asyncio.create_task(asyncio.wait(nodes))
                waits: list[asyncio.Future[Any]] = [stopping, everything]
                await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
                everything.cancel()
                if not self.is_stopping:
                    self._say_all_have_ended()
            if any(job.is_core for job in self._jobs):
                await stopping
        finally:
            stopping.cancel()
            await self.shut_down()

    async def shut_down(self) -> None:
        """End all that runs: the nodes, the latest first, and then the hub."""
        self._stopping.set()
        for is_core in (False, True):
            jobs = [job for job in reversed(self._jobs) if job.is_core is is_core]
            urgency = self._urgency
            for job in jobs:
                if job.process.is_running:
                    self._screen.say(f"[{job.process.name}] killing on exit")
                    job.process.ask(Ask.INTERRUPT)
            await asyncio.gather(*(self._urge(job, urgency) for job in jobs))
            await asyncio.gather(*(job.watch for job in jobs), return_exceptions=True)

    async def _urge(self, job: Job, urgency: int) -> None:
        """Wait for a process that was interrupted, and ask ever more urgently.

        Args:
            job: whose process it is.
            urgency: how urgent it was when it was interrupted.
        """
        for level, (how, seconds) in enumerate(self._waits, urgency):
            hurry = asyncio.create_task(self._hurried(level))
            await asyncio.wait(
                [job.watch, hurry], timeout=seconds, return_when=asyncio.FIRST_COMPLETED
            )
            hurry.cancel()
            if not job.process.is_running:
                return
            signal_ = "SIGTERM" if how is Ask.TERMINATE else "SIGKILL"
            self._screen.complain(f"[{job.process.name}] escalating to {signal_}")
            job.process.ask(how)

    async def _hurried(self, level: int) -> None:
        """Wait until it is more urgent than that."""
        while self._urgency <= level:
            await self._hurry.wait()

    async def _begin(self, job: Job) -> bool:
        process = job.process
        try:
            await process.begin()
        except OSError as error:
            command = process.start.command
            why = _why(start_error(error, command[0]))
            self._screen.complain(f"[{process.name}] cannot be started: {why}: {' '.join(command)}")
            return False
        self._screen.say(f"process[{process.name}]: started with pid [{process.pid}]", bold=True)
        return True

    async def _watch(self, job: Job) -> None:
        """Wait for a process's end, as often as it is started."""
        try:
            while True:
                await job.process.end()
                if self.is_stopping:
                    return
                self._ended(job)
                if job.respawn_delay is None or not await self._respawn(job, job.respawn_delay):
                    return
        finally:
            if job.log is not None:
                job.log.close()

    async def _respawn(self, job: Job, delay: float) -> bool:
        with suppress(TimeoutError):
            async with asyncio.timeout(max(delay, SHORTEST_DELAY)):
                await self._stopping.wait()
        if self.is_stopping:
            return False
        self._screen.say(f"[{job.process.name}] restarting process")
        if await self._begin(job):
            return True
        self.has_failed = True
        return False

    def _ended(self, job: Job) -> None:
        """Say how a process has ended by itself."""
        process = job.process
        if process.exit_code == 0:
            text = "process has finished cleanly"
        else:
            command = " ".join(process.start.command)
            text = (
                f"process has died [pid {process.pid}, exit code {process.exit_code}, "
                f"cmd {command}]."
            )
            self.has_failed = self.has_failed or job.respawn_delay is None
        if job.log is not None and job.log.path.exists():
            text += f"\nlog file: {job.log.path}"
        if job.required:
            self._screen.complain(
                f"{RULE}\nREQUIRED process [{process.name}] has died!\n{text}\n"
                f"Initiating shutdown!\n{RULE}"
            )
            self.stop()
        elif process.exit_code == 0:
            self._screen.say(f"[{process.name}] {text}", bold=True)
        else:
            self._screen.complain(f"[{process.name}] {text}")

    def _heard(self, job: Job, line: str, is_error: bool) -> None:
        if job.log is not None and not job.screen:
            try:
                job.log.write(line)
            except OSError as error:
                self._screen.complain(f"[{job.process.name}] cannot be logged: {_why(error)}")
                job.screen, job.log = True, None
        # What goes wrong is shown wherever the rest goes; not so what ending in haste makes Python
        # say, be it in the midst of its own start.
        if job.screen or (is_error and not self.is_stopping):
            self._screen.show(job.process.name, line, is_error=is_error)

    def _say_all_have_ended(self) -> None:
        if any(job.is_core for job in self._jobs):
            self._screen.say("all nodes have ended; the hub stays until Ctrl-C")
        else:
            launch = command_name("launch")
            self._screen.say(f"all processes on machine have died, {launch} will exit")


def _why(error: OSError) -> str:
    return error.strerror or str(error)
