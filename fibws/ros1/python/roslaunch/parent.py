"""Launch files that scripts start."""

from __future__ import annotations

import atexit
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fibws import hub_address, names
from fibws.errors import FibwsError
from fibws.ros1.launch import model
from fibws.ros1.launch.environment import LocalEnvironment
from fibws.ros1.launch.reader import LaunchReader
from fibws.ros1.launch.runner import SIGINT_TIMEOUT as DEFAULT_TIMEOUT_SIGINT
from fibws.ros1.launch.runner import SIGTERM_TIMEOUT as DEFAULT_TIMEOUT_SIGTERM
from fibws.ros1.launch.session import LaunchSession
from fibws.ros1.workspace.packages import Packages
from fibws.values import parameter_files
from roslaunch.core import RLException
from roslaunch.pmon import Process, ProcessListener, ProcessMonitor

__all__ = ["DEFAULT_TIMEOUT_SIGINT", "DEFAULT_TIMEOUT_SIGTERM", "ROSLaunchParent"]

File = str | tuple[str, Sequence[str]]
"""A launch file's path, perhaps with arguments, ``speed:=2``."""


class ROSLaunchParent:
    """Starts the nodes of launch files, and ends them.

    A hub is started, too, if none is running and its address is on this machine.

    Args:
        run_id: ignored, as `configure_logging`.
        roslaunch_files: the launch files.
        is_core: ignored.
        port: the port of the hub on this machine; by default that of $FIBWS_HUB.
        local_only: ignored; all nodes are on this machine.
        process_listeners: told about processes that end by themselves.
        verbose: ignored.
        force_screen: whether to show the output of all nodes.
        force_log: whether to log the output of all nodes.
        is_rostest: ignored.
        roslaunch_strs: the contents of further launch files.
        num_workers: ignored, and so are ``timeout`` and ``master_logger_level``.
        show_summary: whether to print the parameters and nodes first.
        force_required: whether the end of any node ends all.
        sigint_timeout: seconds after SIGINT until a node gets SIGTERM.
        sigterm_timeout: seconds after SIGTERM until it is killed.

    Raises:
        RLException: a timeout is not positive.
    """

    def __init__(
        self,
        run_id: str | None,
        roslaunch_files: Sequence[File],
        is_core: bool = False,
        port: int | None = None,
        local_only: bool = False,
        process_listeners: Sequence[ProcessListener] | None = None,
        verbose: bool = False,
        force_screen: bool = False,
        force_log: bool = False,
        is_rostest: bool = False,
        roslaunch_strs: Sequence[str] | None = None,
        num_workers: int | None = None,
        timeout: float | None = None,
        master_logger_level: str | bool = False,
        show_summary: bool = True,
        force_required: bool = False,
        sigint_timeout: float = DEFAULT_TIMEOUT_SIGINT,
        sigterm_timeout: float = DEFAULT_TIMEOUT_SIGTERM,
    ) -> None:
        for name, seconds in (("sigint", sigint_timeout), ("sigterm", sigterm_timeout)):
            if seconds <= 0:
                raise RLException(f"{name}_timeout must be a positive number, received {seconds:f}")
        self.run_id = run_id
        self.roslaunch_files = list(roslaunch_files or ())
        self.roslaunch_strs = list(roslaunch_strs or ())
        self.port = port
        self.process_listeners = list(process_listeners or ())
        self.force_screen = force_screen
        self.force_log = force_log
        self.force_required = force_required
        self.show_summary = show_summary
        self.sigint_timeout = sigint_timeout
        self.sigterm_timeout = sigterm_timeout
        self.pm: ProcessMonitor | None = None
        """The monitor of the processes, once started."""
        self._packages = Packages.from_environment()
        self._auto_terminate = True
        self._session: LaunchSession | None = None

    def start(self, auto_terminate: bool = True) -> None:
        """Set the parameters, and start all nodes.

        Args:
            auto_terminate: whether `spin` returns when all nodes have ended.

        Raises:
            RLException: a launch file is invalid, or there is no hub.
        """
        self._auto_terminate = auto_terminate
        try:
            launches = [*map(self._read, self.roslaunch_files), *self._read_texts()]
            self.pm = ProcessMonitor(
                sigint_timeout=self.sigint_timeout, sigterm_timeout=self.sigterm_timeout
            )
            atexit.register(self.shutdown)
            for listener in self.process_listeners:
                self.pm.add_process_listener(listener)
            self._find_hub(self.pm, launches)
            for launch in launches:
                self._launch(launch)
        except (FibwsError, OSError) as error:
            self.shutdown()
            raise RLException(_text(error)) from error

    def launch(self, node: model.LaunchNode) -> Process | None:
        """Start one more node; if that is impossible, say why and return None."""
        assert self.pm is not None and self._session is not None
        if self._session.is_part_of_hub(node):
            return None
        screen = not self.force_log and (self.force_screen or node.screen)
        if self.force_required:
            node = replace(node, required=True, respawn=False)
        return self.pm.launch(node, self._session, screen=screen)

    def spin(self) -> None:
        """Wait until all nodes have ended, or a required one, or for Ctrl-C; then end all."""
        if self.pm is None:
            raise RLException("parent not started yet")
        with suppress(KeyboardInterrupt):
            self.pm.wait(for_processes=self._auto_terminate)
        self.shutdown()

    def spin_once(self) -> None:
        """Do nothing: the nodes are watched by a thread."""

    def shutdown(self) -> None:
        """End all nodes, and the hub if this has started it."""
        if self.pm is not None:
            self.pm.shutdown()
        atexit.unregister(self.shutdown)

    def _read(self, file: File) -> model.Launch:
        path, words = (file, ()) if isinstance(file, str) else file
        values = dict(word.split(":=", 1) for word in words if ":=" in word)
        namespace = names.check_namespace(os.environ.get("ROS_NAMESPACE") or "/")
        environment = LocalEnvironment(self._packages, parameter_files.parse)
        reader = LaunchReader(environment, values, namespace)
        reader.read(path)
        for text in [*reader.launch.warnings, *reader.unknown_values()]:
            print(f"WARNING: {text}")
        return reader.launch

    def _read_texts(self) -> list[model.Launch]:
        found = []
        with TemporaryDirectory(prefix="fibws-", ignore_cleanup_errors=True) as folder:
            for number, text in enumerate(self.roslaunch_strs, 1):
                path = Path(folder) / f"string{number}.launch"
                path.write_text(text, "utf-8")
                found.append(self._read(str(path)))
        return found

    def _find_hub(self, monitor: ProcessMonitor, launches: Sequence[model.Launch]) -> None:
        url = hub_address.hub_url(f"127.0.0.1:{self.port}" if self.port else None)
        self._session = monitor.session(
            launches,
            self._packages,
            url,
            has_default_url=not self.port and not os.environ.get(hub_address.ENVIRONMENT),
        )
        monitor.call(self._session.find_hub())

    def _launch(self, launch: model.Launch) -> None:
        parameters: dict[str, Any] = {**model.CORE_PARAMETERS, **launch.parameters}
        launch.parameters = parameters
        if self.show_summary:
            print(*model.summary(launch), sep="\n")
        assert self.pm is not None and self._session is not None
        self.pm.call(self._session.prepare(launch))
        for node in launch.nodes.values():
            if not node.is_test:
                self.launch(node)


def _text(error: FibwsError | OSError) -> str:
    if isinstance(error, OSError) and error.filename is not None:
        return f"cannot read {error.filename}: {error.strerror}"
    return str(error)
