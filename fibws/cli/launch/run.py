"""A running launch: the hub, then the parameters, then the nodes."""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from threading import Thread
from typing import Any, TypeVar
from urllib.parse import urlsplit

import click

from fibws.cli import output
from fibws.cli.core import ros1_words
from fibws.cli.exit_handling import end_line
from fibws.client.hub_client import HubClient, is_hub_running
from fibws.client.hub_pages import master_variables
from fibws.errors import HubUnreachable, LaunchError, NoHub
from fibws.hub_address import DEFAULT_PORT, ENVIRONMENT, LOOPBACK
from fibws.ros1.launch.model import Launch, Node
from fibws.ros1.launch.node_command import is_built_in, log_folder, node_command
from fibws.ros1.launch.output import Screen, Terminal
from fibws.ros1.launch.preparation import prepare
from fibws.ros1.launch.rosbridge import rosbridges
from fibws.ros1.launch.runner import SIGINT_TIMEOUT, SIGTERM_TIMEOUT, Runner
from fibws.ros1.workspace.packages import Packages

TOOL = "launch"
RETRY = 0.2
"""Seconds between two attempts to connect to the hub, with --wait."""

_Result = TypeVar("_Result")


@dataclass(frozen=True)
class Options:
    """How to run.

    Attributes:
        output: ``screen`` or ``log`` for all nodes; None for what each <node> says.
        wait: whether to wait for a hub instead of starting one.
        has_default_url: whether neither an option nor $FIBWS_HUB chose the hub's URL.
        shares_terminal: whether nodes on the screen use this process's terminal directly.
    """

    output: str | None = None
    wait: bool = False
    has_default_url: bool = False
    shares_terminal: bool = False
    sigint_timeout: float = SIGINT_TIMEOUT
    sigterm_timeout: float = SIGTERM_TIMEOUT


def run(launch: Launch, packages: Packages, url: str, options: Options) -> int:
    """Run a launch until all nodes have ended, or until Ctrl-C.

    Args:
        launch: the content of the launch files.
        packages: the known packages.
        url: the hub's URL. If no hub is running there and it is on this machine, one is started;
            port 0 chooses a free port. If it is the default, the port that the launch files give
            rosbridge_websocket comes first.
        options: how to run.

    Returns:
        The exit code: 1 after a failure, else 0.

    Raises:
        FibwsError: the hub cannot be started, refuses a parameter, or is lost; or the port of
            rosbridge_websocket is invalid.
        OSError: output cannot be written; `BrokenPipeError` if its reader is gone.
    """
    return asyncio.run(Run(launch, packages, url, options).run())


class Run:
    """One run of a launch, from the hub to the end of the last node; see `run`.

    rostest overrides `new_screen`, `on_signal` and `finish`.
    """

    def __init__(self, launch: Launch, packages: Packages, url: str, options: Options) -> None:
        self._launch = launch
        self._packages = packages
        self._url = url
        self._options = options
        self._environment = dict(os.environ)
        """The variables of the nodes, before those of their own."""
        self._rosbridges = list(rosbridges(launch, packages))
        self._write_error: OSError | None = None
        folder = log_folder(os.environ) / f"{time.strftime('%Y-%m-%d_%H-%M-%S')}-{os.getpid()}"
        self._folder = folder
        self._screen = self.new_screen()
        self._runner = Runner(
            self._screen,
            Terminal(is_shared=options.shares_terminal),
            folder,
            sigint_timeout=options.sigint_timeout,
            sigterm_timeout=options.sigterm_timeout,
        )

    async def run(self) -> int:
        self._runner.handle_signals(self.on_signal)
        try:
            for step in (self._find_hub, self._prepare, self._start_nodes, self.finish):
                if not self._runner.is_stopping:
                    await step()
        finally:
            await self._runner.shut_down()
        if self._write_error is not None:
            raise self._write_error
        self._screen.info("done", bold=True)
        return 1 if self._runner.has_failed else 0

    def new_screen(self) -> Screen:
        """Return where output is shown."""
        return Screen(self._write, colours=output.has_colours())

    def on_signal(self) -> None:
        """Note that Ctrl-C was pressed, or a similar signal received."""
        end_line()

    async def finish(self) -> None:
        """Wait for the end of all nodes."""
        await self._runner.run()

    async def _find_hub(self) -> None:
        """Connect to the hub, or start one."""
        urls = list(dict.fromkeys([self._url, *self._urls_of_launch()]))
        for url in urls:
            try:
                if await self._is_hub_running(url):
                    self._url = url
                    return
            except HubUnreachable:
                # The launch files may name a port because another server uses the default one.
                if self._options.wait or url == urls[-1]:
                    raise
        if self._runner.is_stopping:
            return
        where = urlsplit(urls[-1])
        if where.hostname not in LOOPBACK or where.scheme != "ws":
            raise NoHub(self._url, "nothing answers")
        self._screen.info("auto-starting new hub")
        port = 80 if where.port is None else where.port
        nodes = self._launch.nodes.values()
        is_master = any(self._packages.installed(node.package, node.type) for node in nodes)
        options = ros1_words() if is_master else []
        self._url = await self._runner.start_hub(where.hostname, port, options)
        self._screen.info(f"its page: {self._url.replace('ws:', 'http:')}/")
        if self._options.has_default_url and urlsplit(self._url).port != DEFAULT_PORT:
            self._screen.info(f"In the other terminals, type: export {ENVIRONMENT}={self._url}")

    def _urls_of_launch(self) -> list[str]:
        """Return the URL with the port of rosbridge_websocket, if nobody chose another port."""
        if not self._options.has_default_url:
            return []
        host = urlsplit(self._url).hostname
        ports = [each.port for each in self._rosbridges if each.port is not None]
        return [f"ws://{host}:{port}" for port in ports[:1]]

    async def _is_hub_running(self, url: str) -> bool:
        """Return whether a hub is running, after waiting for it if that is wanted."""
        if urlsplit(url).port == 0:
            return False  # A hub on a free port is a new one.
        is_first = True
        while True:
            if await self._in_thread(lambda: is_hub_running(url, TOOL)):
                return True
            if not self._options.wait or self._runner.is_stopping:
                return False
            if is_first:
                self._screen.info("no hub is running yet, will wait for it to start")
                is_first = False
            await asyncio.sleep(RETRY)

    def _warn_of_rosbridge(self) -> None:
        """Warn of settings of rosbridge_websocket that the hub ignores."""
        for each in self._rosbridges:
            ignored = list(each.ignored)
            if each.port and each.port != urlsplit(self._url).port:
                ignored.append(f"port {each.port} is ignored; the hub is at {self._url}")
            for text in ignored:
                self._screen.error(f"WARNING: {each.place}: {text}")

    async def _prepare(self) -> None:
        """Set the parameters."""
        self._warn_of_rosbridge()
        self._screen.info(f"FIBWS_HUB={self._url}", bold=True)
        found = await self._in_thread(lambda: master_variables(self._url, os.environ))
        self._environment.update(found or {})
        self._screen.info("")
        loop = asyncio.get_running_loop()

        def warn(text: str) -> None:
            loop.call_soon_threadsafe(self._screen.error, text)

        def prepare_all() -> None:
            with HubClient(TOOL, self._url) as client:
                for _ in prepare(client, self._launch, warn):
                    if self._runner.is_stopping:
                        return

        await self._in_thread(prepare_all)

    async def _in_thread(self, function: Callable[[], _Result]) -> _Result | None:
        """Call a function that blocks; return None if the launch is stopped meanwhile.

        The thread is a daemon: a hub that does not respond must not delay the end of the program.
        """
        loop = asyncio.get_running_loop()
        future: asyncio.Future[_Result] = loop.create_future()

        def call() -> None:
            try:
                result = function()
            except Exception as error:
                end(future.set_exception, error)
            else:
                end(future.set_result, result)

        def end(set_: Callable[[Any], None], value: object) -> None:
            with suppress(RuntimeError):  # The loop is closed.
                loop.call_soon_threadsafe(set_unless_cancelled, set_, value)

        def set_unless_cancelled(set_: Callable[[Any], None], value: object) -> None:
            if not future.done():
                set_(value)

        Thread(target=call, daemon=True).start()
        stopping = asyncio.create_task(self._runner.stopping())
        waits: list[asyncio.Future[Any]] = [future, stopping]
        try:
            await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
            return future.result() if future.done() else None
        finally:
            stopping.cancel()
            future.cancel()

    async def _start_nodes(self) -> None:
        nodes = []
        for node in self._launch.nodes.values():
            if is_built_in(node, self._packages):
                self._screen.info(f"[{node.name}] not started: {node.package} is part of the hub")
            elif not node.is_test:
                nodes.append(node)
        if not nodes:
            self._screen.info("No processes to monitor", bold=True)
        if any(not self._is_shown(node) for node in nodes):
            self._screen.info(f"... logging to {self._folder}")
        for node in nodes:
            if self._runner.is_stopping:
                return
            try:
                command = node_command(node, self._packages, self._url, self._environment)
            except LaunchError as error:
                self._screen.error(
                    f"ERROR: cannot launch node of type [{node.package}/{node.type}]: {error}"
                )
                self._runner.fail(node)
                continue
            await self._runner.start_node(node, command, screen=self._is_shown(node))

    def _is_shown(self, node: Node) -> bool:
        return node.screen if self._options.output is None else self._options.output == "screen"

    def _write(self, line: str, is_error: bool) -> None:
        if self._write_error is not None:
            return
        text = line.encode(output.encoding(), "backslashreplace").decode(output.encoding())
        try:
            # Without color=True, click would remove escape sequences from nodes' output.
            click.echo(text, err=is_error, color=True)
        except OSError as error:  # A closed pipe, a full disk: end all nodes.
            self._write_error = error
            self._runner.stop()
