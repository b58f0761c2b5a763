"""The processes of a launch: a monitor that starts, watches and ends them in a thread."""

from __future__ import annotations

import asyncio
import os
import sys
import time
from collections.abc import Coroutine, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Event, Thread
from typing import Any, TypeVar

from fibws.ros1.launch import model
from fibws.ros1.launch import process as processes
from fibws.ros1.launch.node_command import log_folder
from fibws.ros1.launch.output import Screen, Terminal
from fibws.ros1.launch.runner import Job, Runner
from fibws.ros1.launch.session import LaunchSession
from fibws.ros1.workspace.packages import Packages
from roslaunch.core import RLException

__all__ = ["Process", "ProcessListener", "ProcessMonitor"]

POLL = 0.1
"""Seconds between two looks at the processes; Ctrl-C ends the wait at once."""

_Result = TypeVar("_Result")


class ProcessListener:
    """Is told about processes that end by themselves; scripts override it."""

    def process_died(self, process_name: str, exit_code: int | None) -> None:
        """Take the name and the exit code of a process that has ended."""


class Process:
    """A node's process."""

    def __init__(self, monitor: ProcessMonitor, job: Job, node: model.LaunchNode) -> None:
        self.name = job.process.name
        self.package = node.package
        self.required = node.required
        self.respawn = node.respawn
        self._monitor = monitor
        self._job = job

    @property
    def pid(self) -> int:
        """Its process ID."""
        return self._job.process.pid

    @property
    def exit_code(self) -> int | None:
        """Its exit code after its end; -2 if it was ended by signal 2."""
        return self._job.process.exit_code

    def is_alive(self) -> bool:
        """Return whether it runs."""
        return self._job.process.is_running

    def is_over(self) -> bool:
        """Return whether it has ended and will not be started again."""
        return self._job.watch.done()

    def stop(self, errors: list[str] | None = None) -> None:
        """End it, by SIGINT and then by stronger signals, and wait for that."""
        if not self._monitor.is_shutdown:
            self._monitor.call(self._monitor.runner.end(self._job))


class ProcessMonitor:
    """Starts, watches and ends processes, in an event loop in a thread.

    Args:
        sigint_timeout: seconds after SIGINT until a process gets SIGTERM.
        sigterm_timeout: seconds after SIGTERM until it is killed.
    """

    def __init__(self, *, sigint_timeout: float, sigterm_timeout: float) -> None:
        started = f"{time.strftime('%Y-%m-%d_%H-%M-%S')}-{os.getpid()}"
        self.folder: Path = log_folder(os.environ) / started
        """The folder of log files."""
        self.runner = Runner(
            Screen(_show),
            Terminal(is_shared=False),
            self.folder,
            sigint_timeout=sigint_timeout,
            sigterm_timeout=sigterm_timeout,
        )
        self.runner.on_end = self._on_end
        self.is_shutdown = False
        self.procs: list[Process] = []
        """Its processes, also those that have ended."""
        self._listeners: list[ProcessListener] = []
        self._is_over = Event()
        self._loop = asyncio.new_event_loop()
        self._thread = Thread(target=self._loop.run_forever, name="roslaunch", daemon=True)
        self._thread.start()
        self._ending = asyncio.run_coroutine_threadsafe(self._end(), self._loop)

    def call(self, coroutine: Coroutine[Any, Any, _Result]) -> _Result:
        """Run a coroutine in the event loop, and return its result."""
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result()

    def session(
        self,
        launches: Sequence[model.Launch],
        packages: Packages,
        url: str,
        *,
        has_default_url: bool,
    ) -> LaunchSession:
        """Return a session of launch files, whose processes these are."""
        return LaunchSession(
            "roslaunch",
            launches,
            packages,
            url,
            Screen(_show),
            self.runner,
            has_default_url=has_default_url,
        )

    def launch(
        self, node: model.LaunchNode, session: LaunchSession, *, screen: bool
    ) -> Process | None:
        """Start a node; if that is impossible, say why and return None.

        Raises:
            RLException: `shutdown` was called.
        """
        if self.is_shutdown:
            raise RLException("this launch has ended")
        job = self.call(session.start_node(node, screen=screen))
        if job is None:
            return None
        process = Process(self, job, node)
        self.procs.append(process)
        return process

    def add_process_listener(self, l: ProcessListener) -> None:  # noqa: E741 - as in ROS
        """Report processes that end by themselves to a listener from now on."""
        self._listeners.append(l)

    def get_active_names(self) -> list[str]:
        """Return the names of the processes that run."""
        return [each.name for each in self.procs if each.is_alive()]

    def has_process(self, name: str) -> bool:
        """Return whether a process of this name runs."""
        return name in self.get_active_names()

    def get_process(self, name: str) -> Process | None:
        """Return the process of a name, or None."""
        return next((each for each in self.procs if each.name == name), None)

    def kill_process(self, name: str) -> bool:
        """End the process of a name; return False if there is none."""
        process = self.get_process(name)
        if process is None or not process.is_alive():
            return False
        process.stop()
        return True

    def wait(self, *, for_processes: bool) -> None:
        """Wait until `shutdown`, or the end of a required process.

        Args:
            for_processes: whether to return as soon as all processes have ended, too.
        """
        while not self._is_over.wait(POLL):
            if for_processes and all(each.is_over() for each in self.procs):
                return

    def shutdown(self) -> None:
        """End all processes, the latest first, and wait for that; further calls do nothing.

        Ctrl-C meanwhile sends the next signal without waiting.
        """
        if self.is_shutdown:
            return
        self.is_shutdown = True
        while not self._ending.done():
            self._loop.call_soon_threadsafe(self.runner.stop)
            with suppress(KeyboardInterrupt):
                self._ending.result()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    async def _end(self) -> None:
        await self.runner.stopping()
        await self.runner.shut_down()
        self._is_over.set()

    def _on_end(self, process: processes.Process) -> None:
        for each in self._listeners:
            # A listener may end the launch, and wait for that.
            arguments = (process.name, process.exit_code)
            Thread(target=each.process_died, args=arguments, daemon=True).start()


def _show(line: str, is_error: bool) -> None:
    print(line, file=sys.stderr if is_error else sys.stdout, flush=True)
