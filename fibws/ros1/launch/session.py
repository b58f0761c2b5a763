"""Launch files at a hub, which is found or started: its parameters are set, then nodes are started.

A `LaunchSession` does this step by step, as scripts need it; a `Run` takes all steps until the end.
"""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from threading import Thread
from typing import Any, TypeVar
from urllib.parse import urlsplit

from fibws.client.hub_client import HubClient, is_hub_running
from fibws.client.hub_pages import master_variables
from fibws.errors import HubUnreachable, NoHub
from fibws.hub_address import DEFAULT_PORT, ENVIRONMENT, LOOPBACK
from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.model import Launch, LaunchNode
from fibws.ros1.launch.node_command import is_built_in, log_folder, node_command
from fibws.ros1.launch.output import Screen, Terminal
from fibws.ros1.launch.preparation import prepare
from fibws.ros1.launch.rosbridge import rosbridges
from fibws.ros1.launch.runner import SIGINT_TIMEOUT, SIGTERM_TIMEOUT, Job, Runner
from fibws.ros1.master_port import master_options
from fibws.ros1.workspace.packages import Packages

RETRY = 0.2
"""Seconds between two attempts to connect to the hub, if a launch waits for it."""

_Result = TypeVar("_Result")


class LaunchSession:
    """Launch files at a hub.

    Args:
        tool: the tool's name, which the name of its node at the hub begins with.
        launches: the content of the launch files.
        packages: the known packages.
        url: the hub's URL. If no hub is running there and it is on this machine, one is started;
            port 0 chooses a free port.
        screen: where texts of the launch itself are shown.
        runner: runs the processes.
        has_default_url: whether nobody chose the hub's URL; then the port that the launch files
            give rosbridge_websocket comes next.
        waits: whether to wait for a hub instead of starting one.

    Raises:
        FibwsError: the port of rosbridge_websocket is invalid.
    """

    def __init__(
        self,
        tool: str,
        launches: Sequence[Launch],
        packages: Packages,
        url: str,
        screen: Screen,
        runner: Runner,
        *,
        has_default_url: bool = False,
        waits: bool = False,
    ) -> None:
        self.url = url
        """The hub's URL, for good once `find_hub` has ended."""
        self._tool = tool
        self._launches = launches
        self._packages = packages
        self._screen = screen
        self._runner = runner
        self._has_default_url = has_default_url
        self._waits = waits
        self._environment = dict(os.environ)
        """The environment variables that all nodes have, without <env>."""
        self._rosbridges = [each for launch in launches for each in rosbridges(launch, packages)]

    async def find_hub(self) -> None:
        """Connect to the hub, or start one.

        Raises:
            FibwsError: the hub cannot be reached or started.
        """
        urls = list(dict.fromkeys([self.url, *self._urls_of_launch()]))
        for url in urls:
            try:
                if await self._is_hub_running(url):
                    self.url = url
                    break
            except HubUnreachable:
                # The launch files may name a port because another server uses the default one.
                if self._waits or url == urls[-1]:
                    raise
        else:
            if self._runner.is_stopping:
                return
            await self._start_hub(urls[-1])
        found = await self.in_thread(lambda: master_variables(self.url, os.environ))
        self._environment.update(found or {})

    async def prepare(self, launch: Launch) -> None:
        """Set the parameters of a launch.

        Raises:
            FibwsError: the hub refuses a parameter, or is lost.
        """
        loop = asyncio.get_running_loop()

        def warn(text: str) -> None:
            loop.call_soon_threadsafe(self._screen.error, f"WARNING: {text}")

        def prepare_all() -> None:
            with HubClient(self._tool, self.url) as client:
                for _ in prepare(client, launch, warn):
                    if self._runner.is_stopping:
                        return

        await self.in_thread(prepare_all)

    async def start_node(self, node: LaunchNode, *, screen: bool) -> Job | None:
        """Start a node; if that is impossible, say why and return None."""
        try:
            command = node_command(node, self._packages, self.url, self._environment)
        except LaunchError as error:
            self._screen.error(
                f"ERROR: cannot launch node of type [{node.package}/{node.type}]: {error}"
            )
            self._runner.fail(node)
            return None
        return await self._runner.start_node(node, command, screen=screen)

    def is_part_of_hub(self, node: LaunchNode) -> bool:
        """Return whether the hub does what a node does, which is not started then; say so."""
        if not is_built_in(node, self._packages):
            return False
        self._screen.info(f"[{node.name}] not started: {node.package} is part of the hub")
        return True

    async def in_thread(self, function: Callable[[], _Result]) -> _Result | None:
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

    async def _start_hub(self, url: str) -> None:
        where = urlsplit(url)
        if where.hostname not in LOOPBACK or where.scheme != "ws":
            raise NoHub(self.url, "nothing answers")
        self._screen.info("auto-starting new hub")
        port = 80 if where.port is None else where.port
        nodes = [node for launch in self._launches for node in launch.nodes.values()]
        is_master = any(self._packages.installed(node.package, node.type) for node in nodes)
        options = master_options(self._screen.error) if is_master else []
        self.url = await self._runner.start_hub(where.hostname, port, options)
        self._screen.info(f"its page: {self.url.replace('ws:', 'http:')}/")
        if self._has_default_url and urlsplit(self.url).port != DEFAULT_PORT:
            self._screen.info(f"In the other terminals, type: export {ENVIRONMENT}={self.url}")

    def _urls_of_launch(self) -> list[str]:
        """Return the URL with the port of rosbridge_websocket, if nobody chose another port."""
        if not self._has_default_url:
            return []
        host = urlsplit(self.url).hostname
        ports = [each.port for each in self._rosbridges if each.port is not None]
        return [f"ws://{host}:{port}" for port in ports[:1]]

    async def _is_hub_running(self, url: str) -> bool:
        """Return whether a hub is running, after waiting for it if that is wanted."""
        if urlsplit(url).port == 0:
            return False  # A hub on a free port is a new one.
        is_first = True
        while True:
            if await self.in_thread(lambda: is_hub_running(url, self._tool)):
                return True
            if not self._waits or self._runner.is_stopping:
                return False
            if is_first:
                self._screen.info("no hub is running yet, will wait for it to start")
                is_first = False
            await asyncio.sleep(RETRY)

    def _warn_of_rosbridge(self) -> None:
        """Warn of settings of rosbridge_websocket that the hub ignores."""
        for each in self._rosbridges:
            ignored = list(each.ignored)
            if each.port and each.port != urlsplit(self.url).port:
                ignored.append(f"port {each.port} is ignored; the hub is at {self.url}")
            for text in ignored:
                self._screen.error(f"WARNING: {each.place}: {text}")


@dataclass(frozen=True)
class LaunchConsole:
    """How a command shows a launch.

    Attributes:
        write: writes a line; its other argument is whether that goes to standard error.
        has_colours: whether lines may be coloured.
        on_signal: called on Ctrl-C, or a similar signal.
    """

    write: Callable[[str, bool], None]
    has_colours: bool = False
    on_signal: Callable[[], None] = lambda: None


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


def run(
    launch: Launch, packages: Packages, url: str, options: Options, console: LaunchConsole
) -> int:
    """Run a launch until all nodes have ended, or until Ctrl-C.

    Args:
        launch: the content of the launch files.
        packages: the known packages.
        url: the hub's URL. If no hub is running there and it is on this machine, one is started;
            port 0 chooses a free port. If it is the default, the port that the launch files give
            rosbridge_websocket comes first.
        options: how to run.
        console: how to show it.

    Returns:
        The exit code: 1 after a failure, else 0.

    Raises:
        FibwsError: the hub cannot be started, refuses a parameter, or is lost; or the port of
            rosbridge_websocket is invalid.
        OSError: output cannot be written; `BrokenPipeError` if its reader is gone.
    """
    return asyncio.run(Run(launch, packages, url, options, console).run())


class Run(LaunchSession):
    """One run of a launch, from the hub to the end of the last node; see `run`.

    rostest overrides `new_screen`, `on_signal`, `set_up` and `finish`.
    """

    def __init__(
        self, launch: Launch, packages: Packages, url: str, options: Options, console: LaunchConsole
    ) -> None:
        self._launch = launch
        self._options = options
        self._console = console
        self._write_error: OSError | None = None
        folder = log_folder(os.environ) / f"{time.strftime('%Y-%m-%d_%H-%M-%S')}-{os.getpid()}"
        self._folder = folder
        screen = self.new_screen()
        runner = Runner(
            screen,
            Terminal(is_shared=options.shares_terminal),
            folder,
            sigint_timeout=options.sigint_timeout,
            sigterm_timeout=options.sigterm_timeout,
        )
        super().__init__(
            "launch",
            [launch],
            packages,
            url,
            screen,
            runner,
            has_default_url=options.has_default_url,
            waits=options.wait,
        )

    async def run(self) -> int:
        """Take all steps; return the exit code, and raise as `run`."""
        self._runner.handle_signals(self.on_signal)
        try:
            for step in (self.find_hub, self.set_up, self._start_nodes, self.finish):
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
        return Screen(self._write, colours=self._console.has_colours)

    def on_signal(self) -> None:
        """Note that Ctrl-C was pressed, or a similar signal received."""
        self._console.on_signal()

    async def set_up(self) -> None:
        """Set the parameters."""
        self._warn_of_rosbridge()
        self._screen.info(f"{ENVIRONMENT}={self.url}", bold=True)
        self._screen.info("")
        await self.prepare(self._launch)

    async def finish(self) -> None:
        """Wait for the end of all nodes."""
        await self._runner.run()

    async def _start_nodes(self) -> None:
        nodes = []
        for node in self._launch.nodes.values():
            if not self.is_part_of_hub(node) and not node.is_test:
                nodes.append(node)
        if not nodes:
            self._screen.info("No processes to monitor", bold=True)
        if any(not self._is_shown(node) for node in nodes):
            self._screen.info(f"... logging to {self._folder}")
        for node in nodes:
            if self._runner.is_stopping:
                return
            await self.start_node(node, screen=self._is_shown(node))

    def _is_shown(self, node: LaunchNode) -> bool:
        return node.screen if self._options.output is None else self._options.output == "screen"

    def _write(self, line: str, is_error: bool) -> None:
        if self._write_error is not None:
            return
        try:
            self._console.write(line, is_error)
        except OSError as error:  # A closed pipe, a full disk: end all nodes.
            self._write_error = error
            self._runner.stop()
