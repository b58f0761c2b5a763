"""The process's one node, on an event loop in a thread of its own.

rospy's functions block the thread that calls them; the node library waits in an event loop. Nothing
of asyncio or of the node library is imported before a node is started.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Coroutine
from time import monotonic
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from rospy.exceptions import ROSException, ROSInterruptException
from rospy.wakeup import UNINTERRUPTED

if TYPE_CHECKING:
    import asyncio
    from concurrent.futures import Future

    import fibws

T = TypeVar("T")

END_TIMEOUT = 2.0
"""Seconds to wait for messages on their way to the node before it ends."""

MOMENT = 0.001
"""Seconds that `Background.give_way` waits."""


class Background:
    """Runs a node until it is stopped, or ends by itself."""

    def __init__(self) -> None:
        self._node: fibws.Node | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._stop: asyncio.Event | None = None
        self._stopped = False
        self._unfinished: set[asyncio.Task[None]] = set()
        self.loop_lock = LoopLock()
        """Lets other threads act for the loop while it sleeps."""

    @property
    def running(self) -> bool:
        """Whether a node was started; it may have ended."""
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
            make_node: creates the node, in the loop's thread.
            ended: called in a thread of its own with the error that ended the node.

        Raises:
            ROSInterruptException: it was stopped while it waited.
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
                coroutine.close()  # The loop may have ended before the coroutine began.

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
        """Call a function in the node's loop, from any thread; return False after its end."""
        try:
            if self._loop is None:
                return False
            self._loop.call_soon_threadsafe(function, *args)
        except RuntimeError:
            return False
        return True

    def finish_before_end(self, task: asyncio.Task[None]) -> None:
        """Wait for a task before the node ends, for `END_TIMEOUT` seconds at most."""
        self._unfinished.add(task)
        task.add_done_callback(self._unfinished.discard)

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
        # asyncio.run() starts a thread when it ends, which fails while the interpreter exits.
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
            if self._unfinished:
                await asyncio.wait(self._unfinished, timeout=END_TIMEOUT)
            await node.__aexit__(None, None, None)


async def _cancel_all() -> None:
    """Cancel all other tasks, and wait for their end."""
    import asyncio

    others = asyncio.all_tasks() - {asyncio.current_task()}
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)


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
            if not self.done:  # The task was cancelled before it began.
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


class LoopLock:
    """A lock that an event loop holds while it runs callbacks; it is free while the loop sleeps.

    A thread that gets the lock may use the loop's objects itself. Waking the loop for each message
    that a script publishes would cost a system call, two switches of threads, and waits for the
    interpreter's lock: about a quarter of the latency and of the CPU time of small messages.

    A signal handler must not run in a thread that holds the lock: it may wait for the loop, which
    waits for the lock.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._main_has_it = False
        self.allows_main_thread = False
        """Whether the main thread may take the lock, too. It may if all signal handlers use
        `defer`: an exception raised by a handler could leave the lock held for ever."""
        self._deferred: list[Callable[[], object]] = []

    def new_loop(self) -> asyncio.AbstractEventLoop:
        """Return a new event loop, and hold the lock for it until `close`."""
        import asyncio
        import selectors

        lock = self._lock

        class Selector(selectors.DefaultSelector):
            """Releases the lock while it waits."""

            def select(self, timeout: float | None = None) -> Any:
                lock.release()
                try:
                    return super().select(timeout)
                finally:
                    lock.acquire()

        lock.acquire()
        self._loop = asyncio.SelectorEventLoop(Selector())
        return self._loop

    def close(self) -> None:
        """Make the lock unavailable: the loop has ended."""
        self._loop = None
        self._lock.release()

    def try_acquire(self) -> bool:
        """Take the lock until `release` if the loop sleeps; return whether it does.

        Callbacks that are scheduled meanwhile run when the loop wakes up next: wake it if they must
        not wait.
        """
        main = threading.current_thread() is threading.main_thread()
        if main:
            if self._main_has_it or not self.allows_main_thread:
                return False
            self._main_has_it = True
        if self._lock.acquire(blocking=False):
            # A loop in debug mode refuses calls from other threads.
            if self._loop is not None and not self._loop.get_debug():
                return True
            self._lock.release()
        if main:
            self._released_by_main()
        return False

    def release(self) -> None:
        """Release the lock after `try_acquire`."""
        self._lock.release()
        if threading.current_thread() is threading.main_thread():
            self._released_by_main()

    def defer(self, function: Callable[[], object]) -> bool:
        """Call a function once the main thread has released the lock; for signal handlers.

        Return False, and do nothing, if the main thread does not hold it.
        """
        if self._main_has_it:
            self._deferred.append(function)
        return self._main_has_it

    def _released_by_main(self) -> None:
        self._main_has_it = False
        while self._deferred:
            self._deferred.pop(0)()
