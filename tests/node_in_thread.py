"""Real nodes for the tools to meet, each in a thread of its own."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager

from patience import PATIENCE

import fibws

ACTION_TOPICS = {
    "goal": "actionlib_tutorials/FibonacciActionGoal",
    "cancel": "actionlib_msgs/GoalID",
    "status": "actionlib_msgs/GoalStatusArray",
    "feedback": "actionlib_tutorials/FibonacciActionFeedback",
    "result": "actionlib_tutorials/FibonacciActionResult",
}
"""The topics of an action in ROS 1, with their types."""

Serve = Callable[[fibws.Node], Awaitable[object]]


class Peer:
    """A node that runs until it is stopped or ended by another node."""

    def __init__(self, url: str, name: str, serve: Serve) -> None:
        self.name = f"/{name}"
        self.fault: BaseException | None = None
        """The error that ended it."""
        self._url = url
        self._serve = serve
        self._ready = threading.Event()
        self._loop = asyncio.new_event_loop()
        self._task: asyncio.Task[None] | None = None
        self._thread = threading.Thread(target=self._run)
        self._thread.start()
        assert self._ready.wait(PATIENCE), "the node does not start"

    def join(self) -> None:
        """Wait for its end."""
        self._thread.join(PATIENCE)
        assert not self._thread.is_alive(), "the node does not end"

    def stop(self) -> None:
        """End it."""
        if self._thread.is_alive() and self._task is not None:
            self._loop.call_soon_threadsafe(self._task.cancel)
        self.join()

    def _run(self) -> None:
        self._task = self._loop.create_task(self._live())
        try:
            self._loop.run_until_complete(self._task)
        except (asyncio.CancelledError, fibws.FibwsError) as fault:
            self.fault = fault
        finally:
            self._ready.set()
            self._loop.close()

    async def _live(self) -> None:
        node = fibws.Node(self.name[1:], hub=self._url)
        node.log.disabled = True  # It would print among what the tool does.
        async with node:
            await self._serve(node)
            await node.graph.nodes()  # The hub has all registrations now.
            self._ready.set()
            async for _ in node.subscribe("/never", "std_msgs/Empty"):
                pass


@contextmanager
def peer(url: str, name: str, serve: Serve) -> Iterator[Peer]:
    """A node for as long as the block takes; ``serve`` is given it when it has a hub."""
    found = Peer(url, name, serve)
    try:
        yield found
    finally:
        found.stop()


async def nothing(node: fibws.Node) -> None:
    """Serve nothing at all."""
