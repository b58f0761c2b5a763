"""What one thread waits for, and the node's loop finds out."""

from __future__ import annotations

import threading
from collections.abc import Callable, Coroutine
from time import monotonic
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from rospy.bell import UNINTERRUPTED
from rospy.exceptions import ROSInterruptException

if TYPE_CHECKING:
    import asyncio

T = TypeVar("T")


class Answer(Generic[T]):
    """The outcome of a coroutine, for one thread outside of its loop.

    Other than a `concurrent.futures.Future` it takes no lock that two threads would wait for: who
    waits may be interrupted by a signal at any point, whose handler waits for other answers.
    """

    def __init__(self) -> None:
        self._waiting = threading.Lock()
        self._waiting.acquire()
        self._task: asyncio.Task[None] | None = None
        self._error: BaseException | None = None
        self._result: T
        self.done = False

    def pursue(self, coroutine: Coroutine[Any, Any, T]) -> None:
        """Run the coroutine whose outcome this is, in its loop."""
        import asyncio

        def end(task: asyncio.Task[None]) -> None:
            coroutine.close()
            if not self.done:  # It was cancelled before it began.
                self.fail(ROSInterruptException("rospy shutdown"))

        self._task = asyncio.get_running_loop().create_task(self._run(coroutine))
        self._task.add_done_callback(end)

    def cancel(self) -> None:
        """Cancel the coroutine, in its loop."""
        if self._task is not None:
            self._task.cancel()

    def succeed(self, result: T) -> None:
        """Tell the result, in the loop; once."""
        self._result = result
        self.done = True
        self._waiting.release()

    def fail(self, error: BaseException) -> None:
        """Tell what went wrong, in the loop; once."""
        self._error = error
        self.done = True
        self._waiting.release()

    def result(self, alive: Callable[[], bool], timeout: float | None = None) -> T:
        """Wait for the result.

        Args:
            alive: tells whether there still is a loop.
            timeout: the most seconds to wait.

        Raises:
            ROSInterruptException: the node ends, so that there will be none.
            TimeoutError: there is none yet.
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
