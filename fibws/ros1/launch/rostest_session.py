"""The run of one <test>: a hub and the nodes of its launch file, then the test's program."""

from __future__ import annotations

import asyncio
import shlex
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from fibws.client.hub_client import HubClient
from fibws.client.parameters import HubParameters
from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.model import Launch, LaunchNode
from fibws.ros1.launch.node_command import node_command
from fibws.ros1.launch.output import Screen
from fibws.ros1.launch.process import Process
from fibws.ros1.launch.runner import Job
from fibws.ros1.launch.session import LaunchConsole, Options, Run
from fibws.ros1.launch.test_results import Case, Outcome, read_results
from fibws.ros1.workspace.packages import Packages

NEW_HUB = "ws://127.0.0.1:0"
"""The URL that stands for a new hub on a free port."""
KEPT = ("/run_id", "/rosdistro", "/rosversion")
"""The parameters that --clear keeps, as in rostest."""


def run_test(
    test: LaunchNode,
    launch: Launch,
    packages: Packages,
    *,
    url: str,
    file: Path,
    text: bool,
    clear: bool,
    console: LaunchConsole,
    report: Callable[[str], object],
) -> Outcome:
    """Run one test, again if it fails and its ``retry`` allows it.

    Args:
        test: the test.
        launch: the content of its launch file, whose nodes are started for it.
        packages: the known packages.
        url: the hub's URL, or `NEW_HUB`.
        file: the file for the test's results.
        text: whether to show all output instead of writing the file.
        clear: whether to delete the hub's parameters first.
        console: how to show what the launch and its nodes print.
        report: called with a line about each further try.

    Raises:
        FibwsError: the hub cannot be started or reached, or refuses a parameter.
        KeyboardInterrupt: the user pressed Ctrl-C.
    """
    for attempt in range(test.retry + 1):
        if attempt:
            left = test.retry - attempt
            report(f"test [{test.test_name}] failed, retrying. Retries left: {left}")
        run = _TestRun(test, launch, packages, url, file, text=text, clear=clear, console=console)
        start = time.monotonic()
        asyncio.run(run.run())
        run.outcome.seconds = time.monotonic() - start
        if run.is_interrupted:
            raise KeyboardInterrupt
        if not run.outcome.fault and run.outcome.results.are_good:
            break
    return run.outcome


class _TestRun(Run):
    """One attempt at a test."""

    def __init__(
        self,
        test: LaunchNode,
        launch: Launch,
        packages: Packages,
        url: str,
        file: Path,
        *,
        text: bool,
        clear: bool,
        console: LaunchConsole,
    ) -> None:
        self.outcome = Outcome(test.test_name)
        self._fail("error", f"test [{test.test_name}] was stopped before its start")
        self.is_interrupted = False
        self._test = test
        self._file = file
        self._text = text
        self._clear = clear
        super().__init__(launch, packages, url, Options(), console)

    def new_screen(self) -> Screen:
        """Return a screen that keeps all lines for the results."""
        return _TestScreen(self._write, self.outcome.output, shows_info=self._text)

    def on_signal(self) -> None:
        """Note that the user stops the test."""
        super().on_signal()
        self.is_interrupted = True

    async def set_up(self) -> None:
        """Delete the hub's parameters if that is wanted, and set those of the launch."""
        if self._clear:
            await self.in_thread(self._clear_parameters)
        await super().set_up()

    def _clear_parameters(self) -> None:
        with HubClient("rostest", self.url) as client:
            parameters = HubParameters(client.call)
            for name in parameters.names():
                if name not in KEPT and not name.startswith("/roslaunch/"):
                    parameters.delete(name)

    async def finish(self) -> None:
        """Run the test's program, and read its results."""
        self._fail("", "")
        if self._runner.not_started:
            nodes = ", ".join(self._runner.not_started)
            self._fail("failure", f"Test Fixture Nodes failed to launch: {nodes}")
            return
        self._file.parent.mkdir(parents=True, exist_ok=True)
        self._file.unlink(missing_ok=True)
        try:
            process = self._process()
            await process.start()
        except LaunchError as error:
            self._fail("failure", str(error))
            return
        except OSError as error:
            self._fail("failure", f"cannot start {error.filename}: {error.strerror}")
            return
        await self._wait_for(process)
        if process.is_running:
            # The end of the runner ends it, the test before the nodes.
            self._runner.add(Job(process))
        else:
            self._read_results(process.exit_code)

    def _process(self) -> Process:
        """Return the test's process; raises `LaunchError`."""
        options = ["--gtest_output=xml:" + shlex.quote(str(self._file))]
        options += ["--text"] if self._text else []
        test = replace(self._test, args=" ".join([self._test.args, *options]))
        command = node_command(test, self._packages, self.url, self._environment)
        name = test.resolved.lstrip("/")

        def on_line(line: str, is_error: bool) -> None:
            if self._text or is_error:
                self._screen.output(name, line, is_error=is_error)
            else:
                self.outcome.output.append(line)

        return Process(name, command, on_line)

    async def _wait_for(self, process: Process) -> None:
        """Wait for the end of the test, of its time, or of the run."""
        ending = asyncio.create_task(process.wait())
        stopping = asyncio.create_task(self._runner.stopping())
        limit, name = self._test.time_limit, self._test.test_name
        waits = [ending, stopping]
        await asyncio.wait(waits, timeout=limit, return_when=asyncio.FIRST_COMPLETED)
        if not ending.done():
            if self._runner.is_stopping:
                self._fail("error", f"test [{name}] was stopped before its end")
            else:
                self._fail("error", f"max time [{limit:g}s] allotted for test [{name}]")
        for wait in waits:
            wait.cancel()

    def _read_results(self, code: int | None) -> None:
        name = self._test.test_name
        if self._text:
            faults = (("failure", f"exit code {code}"),) if code else ()
            results = self.outcome.results
            results.tests, results.failures = 1, len(faults)
            results.cases.append(Case(name, faults))
            return
        try:
            self.outcome.results = read_results(self._file)
        except FileNotFoundError:
            text = f"test [{name}] did not generate test results; its exit code is {code}"
            self._fail("failure", text)
        except (ValueError, OSError) as error:
            self._fail("failure", f"cannot read the results in {self._file}: {error}")

    def _fail(self, fault: str, text: str) -> None:
        self.outcome.fault, self.outcome.text = fault, text


class _TestScreen(Screen):
    """A screen that keeps all lines, and shows those of the launch itself only if wanted."""

    def __init__(
        self, write: Callable[[str, bool], None], kept: list[str], *, shows_info: bool
    ) -> None:
        def write_and_keep(line: str, is_error: bool) -> None:
            kept.append(line)
            write(line, is_error)

        super().__init__(write_and_keep)
        self._kept = kept
        self._shows_info = shows_info

    def info(self, text: str, *, bold: bool = False) -> None:
        """Keep a text of the launch itself, and show it if wanted."""
        if self._shows_info:
            super().info(text, bold=bold)
        else:
            self._kept.append(text)
