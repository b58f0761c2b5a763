"""The result of a coroutine in the node's event loop, for a thread that waits for it."""

from __future__ import annotations

import threading
from collections.abc import Callable, Coroutine
from time import monotonic
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from rospy.exceptions import ROSInterruptException
from rospy.wakeup import UNINTERRUPTED

if TYPE_CHECKING:
    import asyncio

T = TypeVar("T")


class Response(Generic[T]):
    """The outcome of a coroutine, for one thread outside of its loop.

    Unlike a `concurrent.futures.Future` it has no lock that two threads wait for: a signal handler
    may interrupt the waiting thread at any point, and wait for other responses.
    """

    def __init__(self) -> None:
        self._waiting = threading.Lock()
        self._waiting.acquire()
        self._task: asyncio.Task[None] | None = None
        self._error: BaseException | None = None
        self._result: T
        self.done = False

    def execute(self, coroutine: Coroutine[Any, Any, T]) -> None:
        """Run the coroutine; call this in its loop."""
        import asyncio

        def end(task: asyncio.Task[None]) -> None:
            coroutine.close()
            if not self.done:  # It was cancelled before it began.
                self.fail(ROSInterruptException("rospy shutdown"))

        self._task = asyncio.get_running_loop().create_task(self._run(coroutine))
        self._task.add_done_callback(end)

    def cancel(self) -> None:
        """Cancel the coroutine; call this in its loop."""
        if self._task is not None:
            self._task.cancel()

    def succeed(self, result: T) -> None:
        """Set the result; call this in the loop, and once."""
        self._result = result
        self.done = True
        self._waiting.release()

    def fail(self, error: BaseException) -> None:
        """Set the error; call this in the loop, and once."""
        self._error = error
        self.done = True
        self._waiting.release()

    def result(self, alive: Callable[[], bool], timeout: float | None = None) -> T:
        """Wait for the result.

        Args:
            alive: returns whether the loop still runs.
            timeout: most seconds to wait.

        Raises:
            ROSInterruptException: the node ends, so that there will be no result.
            TimeoutError: there was no result in time.
        """
        end = None if timeout is None else monotonic() + timeout
        while not self.done:
            left = UNINTERRUPTED if end is None else min(UNINTERRUPTED, end - monotonic())
            if left <= 0:
                raise TimeoutError
            if not alive():
                break
            self._waiting.acquire(timeout=left)
        if not self.done:
            raise ROSInterruptException("rospy shutdown")
        if self._error is not None:
            raise self._error
        return self._result

    async def _run(self, coroutine: Coroutine[Any, Any, T]) -> None:
        from asyncio import CancelledError

        from fibws.errors import NodeClosed

        try:
            self.succeed(await coroutine)
        except (CancelledError, NodeClosed):
            self.fail(ROSInterruptException("rospy shutdown"))
        except BaseException as error:  # A KeyboardInterrupt must not end the loop.
            self.fail(error)
