"""The process's one node, on an event loop in a thread of its own.

rospy's functions block the thread that calls them; the node library waits in an event loop. Nothing
of asyncio or of the node library is imported before a node is started.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Coroutine
from typing import TYPE_CHECKING, Any, TypeVar

from rospy.exceptions import ROSException, ROSInterruptException
from rospy.loop_lock import LoopLock
from rospy.response import Response

if TYPE_CHECKING:
    import asyncio
    from concurrent.futures import Future

    import fibws

T = TypeVar("T")

MOMENT = 0.001
"""Seconds for which a thread gives way to the node's."""


class Background:
    """Runs a node until it is stopped, or ends by itself."""

    def __init__(self) -> None:
        self._node: fibws.Node | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._stop: asyncio.Event | None = None
        self._stopped = False
        self.loop_lock = LoopLock()
        """Lets other threads act for the loop while it sleeps."""

    @property
    def running(self) -> bool:
        """Whether there is a node, or was one."""
        return self._node is not None

    @property
    def node(self) -> fibws.Node:
        """The node; call its methods in its loop, unless they may be called in any thread.

        Raises:
            ROSException: it has not been started.
        """
        if self._node is None:
            raise ROSException(
                "ROS node has not been initialized yet. Please call init_node() first"
            )
        return self._node

    def start(
        self, make_node: Callable[[], fibws.Node], ended: Callable[[Exception], None]
    ) -> None:
        """Start the node and wait until its hub answers, however long that takes.

        Args:
            make_node: is called in the loop's thread.
            ended: is called, in a thread of its own, with the error that ended the node.

        Raises:
            ROSInterruptException: it was stopped meanwhile.
            Exception: `make_node` failed, or entering the node did.
        """
        ready: Response[None] = Response()
        self._thread = threading.Thread(
            target=self._run, args=(make_node, ended, ready), name="rospy", daemon=True
        )
        self._thread.start()
        ready.result(self._alive)

    def call(self, coroutine: Coroutine[Any, Any, T], timeout: float | None = None) -> T:
        """Run a coroutine in the node's loop and wait for its result, in any other thread.

        Args:
            timeout: the most seconds to wait; the coroutine is cancelled then.

        Raises:
            ROSInterruptException: the node has ended.
            TimeoutError: it took too long.
        """
        response: Response[T] = Response()
        if not self.soon(response.execute, coroutine):
            coroutine.close()
            raise ROSInterruptException("rospy shutdown")
        try:
            return response.result(self._alive, timeout)
        except TimeoutError:
            self.soon(response.cancel)
            raise
        finally:
            if not self._alive():
                coroutine.close()  # The loop may have ended before it began.

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
        """End the node, which sends queued messages; called again, only wait for its end.

        Args:
            timeout: the most seconds to wait for its end; with 0 it ends by itself.
        """
        self._stopped = True
        if self._stop is not None:
            self.soon(self._stop.set)
        if timeout:
            self._await_end(timeout)

    def give_way(self) -> None:
        """Wait a moment if the node has not ended yet, so that its thread can run."""
        self._await_end(MOMENT)

    def _await_end(self, timeout: float) -> None:
        thread = self._thread
        if thread is not None and thread is not threading.current_thread():
            thread.join(timeout)

    def _alive(self) -> bool:
        return self._thread is not None and self._thread.is_alive()

    def _run(
        self,
        make_node: Callable[[], fibws.Node],
        ended: Callable[[Exception], None],
        ready: Response[None],
    ) -> None:
        # Not asyncio.run(), which starts a thread at its end: at the interpreter's that fails.
        loop = self.loop_lock.new_loop()
        try:
            loop.run_until_complete(self._live(make_node, ended, ready))
        except BaseException as error:
            if ready.done:
                raise
            ready.fail(error)
        finally:
            loop.run_until_complete(_cancel_all())
            loop.close()
            self.loop_lock.close()

    async def _live(
        self,
        make_node: Callable[[], fibws.Node],
        ended: Callable[[Exception], None],
        ready: Response[None],
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
            ready.succeed(None)
            spinning = asyncio.create_task(node.spin())
            await asyncio.wait({stop, spinning}, return_when=asyncio.FIRST_COMPLETED)
            fault = spinning.exception() if spinning.done() else None
            if isinstance(fault, Exception):
                threading.Thread(target=ended, args=(fault,), name="rospy's end").start()
                await stop
            spinning.cancel()
        finally:
            await node.__aexit__(None, None, None)


async def _cancel_all() -> None:
    """Cancel all other tasks, and wait for their end."""
    import asyncio

    others = asyncio.all_tasks() - {asyncio.current_task()}
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)
