"""A ROS 1 node without ROS: it registers at a master, and answers the calls of its own API."""

from __future__ import annotations

import threading
from types import TracebackType
from typing import Any, Self
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer

REFUSED = "http://127.0.0.1:9/"
"""An address at which nothing listens."""


class FakeRos1Node:
    """A node that runs while the context is open.

    Args:
        name: its global name.
        master_uri: the master at which it registers.
        api: the address that it registers; its own one if it is empty.
    """

    def __init__(self, name: str, master_uri: str, api: str = "") -> None:
        self.name = name
        self._master = ServerProxy(master_uri, use_builtin_types=True)
        self._server = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
        self._server.register_instance(_Api())
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.01,))
        self.api = api or f"http://127.0.0.1:{self._server.server_address[1]}/"

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()
        self._master("close")()

    def publishes(self, topic: str, type_: str) -> None:
        """Register as a publisher."""
        self._register("registerPublisher", topic, type_)

    def subscribes(self, topic: str, type_: str) -> None:
        """Register as a subscriber."""
        self._register("registerSubscriber", topic, type_)

    def _register(self, method: str, topic: str, type_: str) -> None:
        code, text, _ = self._call(method, topic, type_, self.api)
        assert code == 1, text

    def _call(self, method: str, *arguments: object) -> Any:
        return getattr(self._master, method)(self.name, *arguments)


class _Api:
    """The calls of a ROS 1 node's API; a process that no machine has."""

    def getPid(self, caller: str) -> tuple[int, str, int]:
        return 1, "", 2**22 + 1

    def publisherUpdate(self, caller: str, topic: str, apis: list[str]) -> tuple[int, str, int]:
        return 1, "", 0

    def requestTopic(self, caller: str, topic: str, protocols: object) -> tuple[int, str, int]:
        return 0, "no messages", 0
