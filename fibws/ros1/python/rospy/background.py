"""The process's one node, on an event loop in a thread of its own.

rospy's functions wait in whichever thread calls them; the node library waits in an event loop. This
is where the two meet. Nothing of either is loaded before a node is started.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Coroutine
from typing import TYPE_CHECKING, Any, TypeVar

from rospy.exceptions import ROSException, ROSInterruptException

if TYPE_CHECKING:
    import asyncio
    from concurrent.futures import Future

    import fibws

T = TypeVar("T")

UNINTERRUPTED = 0.5
"""Seconds for which the main thread waits without a look at signals, which Windows needs."""


class Background:
    """Runs a node until it is stopped, or ends by itself."""

    def __init__(self) -> None:
        self._node: fibws.Node | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._stop: asyncio.Event | None = None
        self._stopped = False

    @property
    def running(self) -> bool:
        """Whether there is a node."""
        return self._node is not None

    @property
    def node(self) -> fibws.Node:
        """The node; what it is asked must be asked in its loop, unless it says otherwise.

        Raises:
            ROSException: it has not been started.
        """
        if self._node is None:
            raise ROSException(
                "ROS node has not been initialized yet. Please call init_node() first"
            )
        return self._node

    def start(
        self, make_node: Callable[[], fibws.Node], ended: Callable[[BaseException], None]
    ) -> None:
        """Start the node and wait until its hub answers, however long that takes.

        Args:
            make_node: is called in the loop's thread.
            ended: is told, in a thread of its own, what has ended the node, if it was not `stop`.

        Raises:
            ROSInterruptException: it was stopped meanwhile.
            Exception: what makes the node raises, and what it raises when it is entered.
        """
        from concurrent.futures import Future

        ready: Future[None] = Future()
        self._thread = threading.Thread(
            target=self._run, args=(make_node, ended, ready), name="rospy", daemon=True
        )
        self._thread.start()
        self._result(ready, None)

    def call(self, coroutine: Coroutine[Any, Any, T], timeout: float | None = None) -> T:
        """Run a coroutine in the node's loop and wait for its result, in any other thread.

        Args:
            timeout: the most seconds to wait; the coroutine is cancelled then.

        Raises:
            ROSInterruptException: the node has ended.
            TimeoutError: it took too long.
        """
        return self._result(self.begin(coroutine), timeout)

    def begin(self, coroutine: Coroutine[Any, Any, T]) -> Future[T]:
        """Start a coroutine in the node's loop, from any other thread.

        Raises:
            ROSInterruptException: the node has ended.
        """
        import asyncio

        try:
            if self._loop is None:
                raise RuntimeError
            return asyncio.run_coroutine_threadsafe(coroutine, self._loop)
        except RuntimeError:  # The loop is closed, or there never was one.
            coroutine.close()
            raise ROSInterruptException("rospy shutdown") from None

    def soon(self, function: Callable[..., object], *args: object) -> bool:
        """Call a function in the node's loop, from any thread; false if the node has ended."""
        try:
            if self._loop is None:
                return False
            self._loop.call_soon_threadsafe(function, *args)
        except RuntimeError:
            return False
        return True

    def stop(self, timeout: float = 5.0) -> None:
        """End the node, which sends what still waits; called again, it only waits for that.

        Args:
            timeout: the most seconds to wait for its end.
        """
        self._stopped = True
        if self._stop is not None:
            self.soon(self._stop.set)
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(timeout)

    def _result(self, future: Future[T], timeout: float | None) -> T:
        from concurrent.futures import CancelledError
        from concurrent.futures import TimeoutError as NotYet
        from time import monotonic

        end = None if timeout is None else monotonic() + timeout
        try:
            while True:
                left = UNINTERRUPTED if end is None else min(UNINTERRUPTED, end - monotonic())
                try:
                    return future.result(max(left, 0))
                except NotYet:
                    if future.done():
                        raise  # It is the coroutine's own.
                    if end is not None and monotonic() >= end:
                        future.cancel()
                        raise TimeoutError from None
                    if self._thread is None or not self._thread.is_alive():
                        raise ROSInterruptException("rospy shutdown") from None
        except CancelledError:
            raise ROSInterruptException("rospy shutdown") from None

    def _run(
        self,
        make_node: Callable[[], fibws.Node],
        ended: Callable[[BaseException], None],
        ready: Future[None],
    ) -> None:
        import asyncio

        try:
            asyncio.run(self._live(make_node, ended, ready))
        except BaseException as error:
            if not ready.done():
                ready.set_exception(error)
            else:
                raise

    async def _live(
        self,
        make_node: Callable[[], fibws.Node],
        ended: Callable[[BaseException], None],
        ready: Future[None],
    ) -> None:
        import asyncio

        self._loop = asyncio.get_running_loop()
        self._stop = asyncio.Event()
        if self._stopped:
            raise ROSInterruptException("rospy shutdown")
        stop = asyncio.create_task(self._stop.wait())
        node = make_node()
        entering = asyncio.create_task(node.__aenter__())
        await asyncio.wait({stop, entering}, return_when=asyncio.FIRST_COMPLETED)
        if not entering.done():
            entering.cancel()
            await asyncio.wait({entering})
            raise ROSInterruptException("rospy shutdown")
        entering.result()
        try:
            self._node = node
            ready.set_result(None)
            spinning = asyncio.create_task(node.spin())
            await asyncio.wait({stop, spinning}, return_when=asyncio.FIRST_COMPLETED)
            if spinning.done() and (fault := spinning.exception()) is not None:
                threading.Thread(target=ended, args=(fault,), name="rospy's end").start()
            await stop
            spinning.cancel()
        finally:
            await node.__aexit__(None, None, None)
