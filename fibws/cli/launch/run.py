"""A launch that runs: the hub, the parameters, the nodes."""

from __future__ import annotations

import asyncio
import os
import time
from dataclasses import dataclass
from urllib.parse import urlsplit

import click

from fibws.cli import output
from fibws.cli.exit_handling import end_line
from fibws.cli.launch.parameters import prepare
from fibws.client.hub_client import HubClient
from fibws.errors import LaunchError, NoHub
from fibws.hub_address import LOOPBACK
from fibws.ros1.launch.command import hub_does_it, log_folder, start_of
from fibws.ros1.launch.hub import start_hub
from fibws.ros1.launch.model import Launch, Node
from fibws.ros1.launch.runner import WAIT_INTERRUPT, WAIT_TERMINATE, Runner
from fibws.ros1.launch.screen import Screen
from fibws.ros1.workspace.packages import Packages

TOOL = "launch"
RETRY = 0.2
"""Seconds between two looks for a hub that is waited for."""


@dataclass(frozen=True)
class Options:
    """How to run.

    Attributes:
        output: ``screen`` or ``log``, whatever the nodes say; None for what they say.
        wait: whether to wait for a hub rather than start one.
    """

    output: str | None = None
    wait: bool = False
    wait_interrupt: float = WAIT_INTERRUPT
    wait_terminate: float = WAIT_TERMINATE


def run(launch: Launch, packages: Packages, url: str, options: Options) -> int:
    """Run what was read until all has ended, or somebody has had enough of it.

    Args:
        launch: what was read.
        packages: those that are known.
        url: the hub's; if none is there, and that is this machine, one is started. Port 0 is one
            that is free.
        options: how to run.

    Returns:
        The exit code: 1 if something has failed, else 0.

    Raises:
        FibwsError: the hub cannot be started, will not have a parameter, or is gone.
        OSError: what is printed cannot be written: `BrokenPipeError` if nobody reads it any more.
    """
    return asyncio.run(_Launch(launch, packages, url, options).run())


class _Launch:
    """One run."""

    def __init__(self, launch: Launch, packages: Packages, url: str, options: Options) -> None:
        self._launch = launch
        self._packages = packages
        self._url = url
        self._options = options
        self._lost: OSError | None = None
        folder = log_folder(os.environ) / f"{time.strftime('%Y-%m-%d_%H-%M-%S')}-{os.getpid()}"
        self._folder = folder
        self._screen = Screen(self._write, colours=output.has_colours())
        self._runner = Runner(
            self._screen,
            folder,
            wait_interrupt=options.wait_interrupt,
            wait_terminate=options.wait_terminate,
        )

    async def run(self) -> int:
        self._runner.obey_signals(end_line)
        try:
            for step in (self._find_hub, self._prepare, self._start_nodes, self._runner.run):
                if not self._runner.is_stopping:
                    await step()
        finally:
            await self._runner.shut_down()
        if self._lost is not None:
            raise self._lost
        self._screen.say("done", bold=True)
        return 1 if self._runner.has_failed else 0

    async def _prepare(self) -> None:
        self._screen.say(f"FIBWS_HUB={self._url}", bold=True)
        self._screen.say("")
        with HubClient(TOOL, self._url) as client:
            for _ in prepare(client, self._launch, self._screen.complain):
                await asyncio.sleep(0)  # Ctrl-C is heard between two parameters.
                if self._runner.is_stopping:
                    return

    async def _find_hub(self) -> None:
        where = urlsplit(self._url)
        if where.port != 0 and await self._is_there():
            return
        if self._runner.is_stopping:
            return
        if where.hostname not in LOOPBACK or where.scheme != "ws":
            raise NoHub(self._url, "nothing answers")
        self._screen.say("auto-starting new hub")
        port = 80 if where.port is None else where.port
        job, self._url = await start_hub(where.hostname, port, self._folder)
        self._runner.add(job)
        process = job.process
        self._screen.say(f"process[{process.name}]: started with pid [{process.pid}]", bold=True)
        self._screen.say(f"open {self._url.replace('ws:', 'http:')}/ in a browser to look at it")

    async def _is_there(self) -> bool:
        """Whether a hub answers, which is waited for if that is wanted."""
        is_said = False
        while True:
            try:
                HubClient(TOOL, self._url).close()
                return True
            except NoHub:
                if not self._options.wait or self._runner.is_stopping:
                    return False
            if not is_said:
                self._screen.say("no hub is running yet, will wait for it to start")
                is_said = True
            await asyncio.sleep(RETRY)

    async def _start_nodes(self) -> None:
        nodes = [node for node in self._launch.nodes.values() if not node.is_test]
        if not nodes:
            self._screen.say("No processes to monitor", bold=True)
        if any(not self._is_shown(node) for node in nodes):
            self._screen.say(f"... logging to {self._folder}")
        for node in nodes:
            if self._runner.is_stopping:
                return
            if hub_does_it(node, self._packages):
                self._screen.say(f"[{node.name}] the hub is {node.package} already: nothing to do")
                continue
            try:
                start = start_of(node, self._packages, self._url, os.environ)
            except LaunchError as error:
                self._screen.complain(
                    f"ERROR: cannot launch node of type [{node.package}/{node.type}]: {error}"
                )
                self._runner.fail(node)
                continue
            await self._runner.start_node(node, start, screen=self._is_shown(node))

    def _is_shown(self, node: Node) -> bool:
        return node.screen if self._options.output is None else self._options.output == "screen"

    def _write(self, line: str, is_error: bool) -> None:
        if self._lost is not None:
            return
        text = line.encode(output.encoding(), "backslashreplace").decode(output.encoding())
        try:
            # Else click would take out of a text what it thinks is a style.
            click.echo(text, err=is_error, color=True)
        except OSError as error:  # A pipe is closed, a disk full: nodes must not be left over.
            self._lost = error
            self._runner.stop()
