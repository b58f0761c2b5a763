"""The processes of a launch: started in order, watched, and ended in reverse order."""

from __future__ import annotations

import asyncio
import os
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fibws.command_names import command_name
from fibws.errors import HubError
from fibws.exit_signals import ExitSignals
from fibws.processes import start_error
from fibws.ros1.launch.model import LaunchNode
from fibws.ros1.launch.node_command import NodeCommand
from fibws.ros1.launch.output import LogFile, Screen, Terminal
from fibws.ros1.launch.process import Process, Signal

SIGINT_TIMEOUT, SIGTERM_TIMEOUT = 15.0, 2.0
"""Seconds until the next, more urgent signal, as in roslaunch."""
SHORTEST_DELAY = 0.1
"""Least seconds before a restart; a process that fails at once must not keep a machine busy."""
HUB_START_TIMEOUT = 30.0
"""Seconds in which a hub must be ready."""
POLL_INTERVAL = 0.02
"""Seconds between two looks at a hub's URL file."""
RULE = "=" * 80


@dataclass
class Job:
    """A node or the hub, and its process.

    Attributes:
        screen: whether its output is shown, and not only logged.
        respawn_delay: seconds from its end to its next start; None for no restart.
        required: whether its end ends the launch.
        is_hub: whether it is the hub, which ends after all nodes.
        is_ending: whether its end is wanted.
    """

    process: Process
    log: LogFile | None = None
    screen: bool = False
    respawn_delay: float | None = None
    required: bool = False
    is_hub: bool = False
    is_ending: bool = False
    watch: asyncio.Task[None] = field(init=False, repr=False)


class Runner:
    """Runs the processes of a launch.

    Args:
        screen: where output is shown.
        terminal: the terminal that nodes share.
        folder: the folder for log files.
        sigint_timeout: seconds after SIGINT until a process gets SIGTERM.
        sigterm_timeout: seconds after SIGTERM until it is killed.
    """

    def __init__(
        self,
        screen: Screen,
        terminal: Terminal,
        folder: Path,
        *,
        sigint_timeout: float = SIGINT_TIMEOUT,
        sigterm_timeout: float = SIGTERM_TIMEOUT,
    ) -> None:
        self._screen = screen
        self._terminal = terminal
        self._folder = folder
        self._timeouts = ((Signal.TERMINATE, sigint_timeout), (Signal.KILL, sigterm_timeout))
        self._jobs: list[Job] = []
        self._stopping = asyncio.Event()
        self._hurry = asyncio.Event()
        self._urgency = 0
        self._count = 0
        self.not_started: list[str] = []
        """The global names of nodes that could not be started."""
        self.has_failed = False
        """Whether a process could not be started, or ended by itself with an error."""
        self.on_end: Callable[[Process], None] = lambda process: None
        """Called with each process that ended by itself."""

    @property
    def is_stopping(self) -> bool:
        """Whether `stop` was called."""
        return self._stopping.is_set()

    async def stopping(self) -> None:
        """Wait until `stop` is called."""
        await self._stopping.wait()

    def stop(self) -> None:
        """End all processes; another call sends the next signal without waiting."""
        if not self._stopping.is_set():
            self._stopping.set()
        else:
            self._urgency += 1
            self._hurry.set()
            self._hurry = asyncio.Event()  # for the next call

    def handle_signals(self, on_signal: Callable[[], None]) -> None:
        """Stop on Ctrl-C, on SIGTERM, and when the terminal is closed."""

        def stop(number: int) -> None:
            on_signal()
            self.stop()

        ExitSignals(stop, stop).install(asyncio.get_running_loop())

    async def start_hub(self, host: str, port: int, options: Sequence[str] = ()) -> str:
        """Start a hub, and wait until nodes can connect to it.

        Args:
            host: the address to listen on.
            port: its port; 0 for a free one.
            options: further options of the hub.

        Returns:
            Its URL.

        Raises:
            HubError: it cannot start.
        """
        log = LogFile(self._folder / "hub.log")
        last_line = "it does not respond"

        def on_line(line: str, is_error: bool) -> None:
            nonlocal last_line
            last_line = line
            with suppress(OSError):  # A hub does not need its log.
                log.write(line)

        with TemporaryDirectory(prefix="fibws-", ignore_cleanup_errors=True) as temporary:
            url_file = Path(temporary) / "url"
            command = [
                *(sys.executable, "-P", "-m", "fibws.hub", "--host", host, "--port", str(port)),
                *("--url-file", str(url_file), *options),
            ]
            environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
            process = Process("hub", NodeCommand(command, environment, Path.cwd()), on_line)
            await process.start()
            reading = asyncio.create_task(_read_url(url_file))
            tasks: list[asyncio.Task[Any]] = [reading, asyncio.create_task(process.wait())]
            try:
                await asyncio.wait(
                    tasks, timeout=HUB_START_TIMEOUT, return_when=asyncio.FIRST_COMPLETED
                )
                if not reading.done():
                    raise HubError(f"cannot start a hub: {last_line}")
            finally:
                for task in tasks:
                    task.cancel()
                if not reading.done():
                    process.send(Signal.KILL)
                    log.close()
        self.add(Job(process, log, required=True, is_hub=True))
        self._say_started(process)
        return reading.result()

    async def start_node(
        self, node: LaunchNode, command: NodeCommand, *, screen: bool
    ) -> Job | None:
        """Start a node; if that is impossible, report a failure and return None."""
        self._count += 1
        name = f"{node.resolved.lstrip('/')}-{self._count}"
        log = LogFile(self._folder / f"{name.replace('/', '-')}.log")
        job = Job(
            Process(
                name,
                command,
                lambda line, is_error: self._on_line(job, line, is_error),
                inherited=self._terminal.streams_of_node(screen=screen),
            ),
            log,
            screen=screen,
            respawn_delay=node.respawn_delay if node.respawn else None,
            required=node.required,
        )
        if await self._start(job):
            self.add(job)
            return job
        self.fail(node)
        return None

    def fail(self, node: LaunchNode) -> None:
        """Note that a node cannot be started."""
        self.has_failed = True
        self.not_started.append(node.resolved)
        if node.required:
            self._screen.error(f"REQUIRED process [{node.name}] cannot be started!")
            self.stop()

    def add(self, job: Job) -> None:
        """Watch a job with a running process."""
        self._jobs.append(job)
        job.watch = asyncio.create_task(self._watch(job), name=job.process.name)

    async def end(self, job: Job) -> None:
        """End one process, which is not started again."""
        job.is_ending = True
        job.process.send(Signal.INTERRUPT)
        await self._escalate(job, self._urgency)

    async def run(self) -> None:
        """Wait until all nodes have ended, or `stop` is called; then end everything."""
        nodes = [job.watch for job in self._jobs if not job.is_hub]
        stopping = asyncio.create_task(self._stopping.wait())
        try:
            if nodes and not self.is_stopping:
                everything = asyncio.create_task(asyncio.wait(nodes))
                waits: list[asyncio.Future[Any]] = [stopping, everything]
                await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
                everything.cancel()
            has_hub = any(job.is_hub for job in self._jobs)
            if (nodes or has_hub) and not self.is_stopping:
                self._say_all_have_ended(had_nodes=bool(nodes), has_hub=has_hub)
            if has_hub:
                await stopping
        finally:
            stopping.cancel()
            await self.shut_down()

    async def shut_down(self) -> None:
        """End all processes: the nodes, the latest first, and then the hub."""
        self._stopping.set()
        for is_hub in (False, True):
            jobs = [job for job in reversed(self._jobs) if job.is_hub is is_hub]
            urgency = self._urgency
            for job in jobs:
                if job.process.is_running:
                    self._screen.info(f"[{job.process.name}] killing on exit")
                    job.process.send(Signal.INTERRUPT)
            await asyncio.gather(*(self._escalate(job, urgency) for job in jobs))
            await asyncio.gather(*(job.watch for job in jobs), return_exceptions=True)
        self._terminal.restore()

    async def _escalate(self, job: Job, urgency: int) -> None:
        """Wait for the end of an interrupted process, and send more urgent signals in time.

        Args:
            job: the process's job.
            urgency: the urgency when it was interrupted.
        """
        for level, (signal_, seconds) in enumerate(self._timeouts, urgency):
            hurry = asyncio.create_task(self._hurried(level))
            await asyncio.wait(
                [job.watch, hurry], timeout=seconds, return_when=asyncio.FIRST_COMPLETED
            )
            hurry.cancel()
            if not job.process.is_running:
                return
            name = "SIGTERM" if signal_ is Signal.TERMINATE else "SIGKILL"
            self._screen.error(f"[{job.process.name}] escalating to {name}")
            job.process.send(signal_)

    async def _hurried(self, level: int) -> None:
        """Wait until the urgency is above a level."""
        while self._urgency <= level:
            await self._hurry.wait()

    async def _start(self, job: Job) -> bool:
        process = job.process
        try:
            await process.start()
        except OSError as error:
            command = process.command.command
            why = _text(start_error(error, command[0]))
            self._screen.error(f"[{process.name}] cannot be started: {why}: {' '.join(command)}")
            return False
        self._say_started(process)
        return True

    async def _watch(self, job: Job) -> None:
        """Wait for a process's end, after each of its starts."""
        try:
            while True:
                await job.process.wait()
                if self.is_stopping or job.is_ending:
                    return
                self._on_end(job)
                if job.respawn_delay is None or not await self._respawn(job, job.respawn_delay):
                    return
        finally:
            if job.log is not None:
                job.log.close()

    async def _respawn(self, job: Job, delay: float) -> bool:
        with suppress(TimeoutError):
            async with asyncio.timeout(max(delay, SHORTEST_DELAY)):
                await self._stopping.wait()
        if self.is_stopping or job.is_ending:
            return False
        self._screen.info(f"[{job.process.name}] restarting process")
        if await self._start(job):
            return True
        self.has_failed = True
        return False

    def _on_end(self, job: Job) -> None:
        """Report a process that ended by itself."""
        process = job.process
        self.on_end(process)
        if process.exit_code != 0 and job.screen:
            self._terminal.restore()  # Or else Ctrl-C might no longer end this launch.
        if process.exit_code == 0:
            text = "process has finished cleanly"
        else:
            text = (
                f"process has died [pid {process.pid}, exit code {process.exit_code}, "
                f"cmd {' '.join(process.command.command)}]."
            )
            self.has_failed = self.has_failed or job.respawn_delay is None
        if job.log is not None and job.log.path.exists():
            text += f"\nlog file: {job.log.path}"
        if job.required:
            self._screen.error(
                f"{RULE}\nREQUIRED process [{process.name}] has died!\n{text}\n"
                f"Initiating shutdown!\n{RULE}"
            )
            self.stop()
        elif process.exit_code == 0:
            self._screen.info(f"[{process.name}] {text}", bold=True)
        else:
            self._screen.error(f"[{process.name}] {text}")

    def _on_line(self, job: Job, line: str, is_error: bool) -> None:
        if job.log is not None and not job.screen:
            try:
                job.log.write(line)
            except OSError as error:
                self._screen.error(f"[{job.process.name}] cannot write log: {_text(error)}")
                job.screen, job.log = True, None
        # Errors are always shown, except while stopping: Python prints tracebacks when it is
        # interrupted during its start.
        if job.screen or (is_error and not self.is_stopping):
            self._screen.output(job.process.name, line, is_error=is_error)

    def _say_started(self, process: Process) -> None:
        self._screen.info(f"process[{process.name}]: started with pid [{process.pid}]", bold=True)

    def _say_all_have_ended(self, *, had_nodes: bool, has_hub: bool) -> None:
        if has_hub:
            ended = "all nodes have ended; " if had_nodes else ""
            self._screen.info(f"{ended}the hub runs until Ctrl-C")
        else:
            launch = command_name("launch")
            self._screen.info(f"all processes on machine have died, {launch} will exit")


async def _read_url(file: Path) -> str:
    """Wait for a hub's URL file; return the URL in it."""
    while True:
        if url := _url_in(file):
            return url
        await asyncio.sleep(POLL_INTERVAL)


def _url_in(file: Path) -> str:
    try:
        return file.read_text("utf-8").strip()
    except FileNotFoundError:
        return ""


def _text(error: OSError) -> str:
    return error.strerror or str(error)
