"""zenoh sessions (https://zenoh.io), and the threads between them and the event loop.

Calls of zenoh may wait for the network, so they are made in threads: messages in those of
`ZenohLanes` and declarations in that of `ZenohCalls`, which wait for no receiver, and all others in
those of `Receivers`. zenoh's callbacks come in threads, too, and hand their data to the event loop
(`Inbox`).
"""

from __future__ import annotations

import asyncio
import json
import logging
import re
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Hashable, Mapping, Sequence
from heapq import heappop, heappush
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from fibws.errors import SettingError
from fibws.hub.log.text import printable

if TYPE_CHECKING:
    import zenoh

logger = logging.getLogger("fibws.hub")

T = TypeVar("T")

AUTO = "auto"
"""In place of an endpoint: find others by multicast."""
LEASE = 4.0
"""Seconds of silence after which a connection counts as lost."""
RETRY = 1.0
"""Most seconds before an endpoint that does not answer is tried again."""
CLOSING = 1.0
"""Most seconds that the end waits for receivers."""
LARGE = 64 * 1024
"""Bytes of a message from which on it is sent in the thread for large messages."""
LANE_BYTES = 2 * 1024 * 1024
"""Bytes of one publisher that may wait; its newest message always may."""
LINGER = 0.5
"""Seconds without calls after which a receiver's thread ends."""
TURN = 0.001
"""Seconds for which arrivals are handled before others have their turn."""


QUEUES: Mapping[str, Any] = {
    "transport/link/tx/queue/size/control": 16,
    "transport/link/tx/queue/size/interactive_low": 16,
    "transport/link/tx/queue/size/data": 16,
    "transport/link/tx/queue/congestion_control/drop/max_wait_before_drop_fragments": 150_000,
}
"""Batches of 64 KiB that wait for a receiver, of each priority: zenoh's most, made when needed; and
the microseconds for which the rest of a large message waits for it."""

_Arrival: TypeAlias = tuple[int, Callable[..., object], tuple[Any, ...], int]
"""Its number, what to call with which arguments, and its size."""


async def open_session(
    listen: Sequence[str],
    connect: Sequence[str],
    config: Path | None,
    *,
    flags: tuple[str, str],
    defaults: Mapping[str, Any] = QUEUES,
) -> zenoh.Session:
    """Open a session as a router.

    Args:
        listen: endpoints to listen on, such as ``tcp/0.0.0.0:7447``.
        connect: endpoints to connect to again and again, or ``auto``.
        config: a file of zenoh's own settings, for TLS and access control.
        flags: the settings of the endpoints to listen on, and of those to connect to, for errors.
        defaults: settings of zenoh's that apply unless the file has others.

    Raises:
        HubError: zenoh is not installed, or the file or an endpoint cannot be used.
    """
    flag = " and ".join(
        name for name, values in zip(flags, (listen, connect), strict=True) if values
    )
    try:
        import zenoh
    except ImportError:
        raise SettingError(f"{flag} requires eclipse-zenoh: pip install 'fibws[zenoh]'") from None
    try:
        made = session_config(listen, connect, config, defaults)
        return await call_in_thread(lambda: zenoh.open(made), undo=close_session)
    except (zenoh.ZError, OSError, ValueError) as error:
        endpoints = ", ".join((*listen, *connect))
        fault = printable(_fault(error))
        raise SettingError(f"{flag}: cannot use {endpoints}: {fault}") from None


async def call_in_thread(
    function: Callable[[], T], undo: Callable[[T], object] = lambda result: None
) -> T:
    """Call a function in a thread, to its end even if this is cancelled.

    Args:
        undo: called in a thread, with the result, if this was cancelled.
    """
    call = asyncio.ensure_future(asyncio.to_thread(function))
    try:
        return await asyncio.shield(call)
    except asyncio.CancelledError:
        await asyncio.wait([call])
        if call.exception() is None:
            await asyncio.to_thread(undo, call.result())
        raise


def close_session(session: zenoh.Session) -> None:
    """Close a session, in a thread; it ends later if a receiver does not read."""

    def close() -> None:
        try:
            session.close()  # type: ignore[no-untyped-call]
        except Exception as error:  # The receiver still does not read.
            logger.debug("zenoh: %s", printable(str(error)))

    thread = threading.Thread(target=close, name="zenoh-close", daemon=True)
    thread.start()
    thread.join(CLOSING)


def direct(
    callback: Callable[[Any], object], drop: Callable[[], object] | None = None
) -> zenoh.handlers.Callback[Any]:
    """Return a handler that is called in zenoh's own thread; it must not wait for anything.

    Otherwise each would have a thread of its own, and messages of different keys lose their order.

    Args:
        drop: called when no call follows.
    """
    import zenoh

    return zenoh.handlers.Callback(callback, drop, indirect=False)


def _fault(error: Exception) -> str:
    """Return what zenoh says, without the names of its types and source files."""
    text = str(error).partition("\n")[0]
    quoted = re.search(r'msg: "(.*?)"', text)
    return re.split(r"\.? at /", quoted[1] if quoted else text)[0][:300]


def session_config(
    listen: Sequence[str], connect: Sequence[str], path: Path | None, defaults: Mapping[str, Any]
) -> zenoh.Config:
    """Return the configuration of a session; see `open_session`.

    Raises:
        HubError: the file cannot be used.
        ZError: an endpoint cannot be used.
    """
    import zenoh

    config = usual = zenoh.Config()
    if path is not None:
        try:
            config = zenoh.Config.from_file(path)
        except (zenoh.ZError, OSError, ValueError) as error:
            fault = printable(_fault(error))
            raise SettingError(f"--zenoh-config: cannot use {path}: {fault}") from None
    endpoints = [each for each in connect if each != AUTO]
    values: dict[str, Any] = {
        "mode": "router",
        "connect/timeout_ms": -1,
        "connect/exit_on_failure": False,
        "connect/retry": {
            "period_init_ms": 100,
            "period_max_ms": round(RETRY * 1000),
            "period_increase_factor": 2,
        },
        "scouting/delay": 0,  # Opening would take that long.
        "scouting/multicast/enabled": AUTO in connect,
    }
    if listen or AUTO not in connect:
        values["listen/endpoints"] = list(listen)
    else:
        values["listen/endpoints"] = ["tcp/0.0.0.0:0"]
    if endpoints:
        values["connect/endpoints"] = endpoints
    if AUTO in connect:
        values["scouting/multicast/autoconnect"] = {"router": ["router"]}
    lease = {"transport/link/tx/lease": round(LEASE * 1000)}
    for key, value in {**lease, **defaults}.items():
        if config.get_json(key) == usual.get_json(key):
            values[key] = value
    for key, value in values.items():
        config.insert_json5(key, json.dumps(value))
    return config


def lossy() -> dict[str, Any]:
    """Return the arguments of publishers: messages for receivers that do not read are dropped.

    zenoh waits for a receiver 1 ms for a small message and 150 ms for a large one (`QUEUES`), and
    then drops all for it at once until it reads again.
    """
    import zenoh

    return {"congestion_control": zenoh.CongestionControl.DROP}


def lossless() -> dict[str, Any]:
    """Return the arguments of queries, and of messages that are no publisher's.

    They wait for their receivers, which are disconnected if they do not read for 5 s. The priority
    is one that messages do not have: messages cannot be behind them in a queue that stands still.
    """
    import zenoh

    return {
        "congestion_control": zenoh.CongestionControl.BLOCK,
        "priority": zenoh.Priority.INTERACTIVE_LOW,
    }


def preferred() -> dict[str, Any]:
    """Return the arguments of small messages that wait for no receiver, and for no other message.

    They are dropped only for a receiver for which too much waits that is `lossless`.
    """
    return {**lossy(), "priority": lossless()["priority"]}


class ZenohCalls(threading.Thread):
    """Makes the calls of zenoh that wait for no receiver, one after the other.

    Attributes:
        bytes: what waits.
    """

    def __init__(self, name: str) -> None:
        super().__init__(name=name, daemon=True)
        self._condition = threading.Condition()
        self._jobs: deque[tuple[Callable[[], object], int]] = deque()
        self._is_closed = False
        self.bytes = 0

    def call(self, job: Callable[[], object], size: int = 0) -> None:
        """Call a function after the waiting ones."""
        with self._condition:
            if self._is_closed:
                return
            self._jobs.append((job, size))
            self.bytes += size
            self._condition.notify()

    def close(self) -> None:
        """End once all is done that waits."""
        with self._condition:
            self._is_closed = True
            self._condition.notify()

    def run(self) -> None:
        while True:
            with self._condition:
                while not self._jobs:
                    if self._is_closed:
                        return
                    self._condition.wait()
                job, size = self._jobs.popleft()
                self.bytes -= size
            _attempt(job, lambda: self._is_closed)
            del job  # It may hold a query, which ends when nothing refers to it.


class Receivers:
    """Makes calls of zenoh that may wait for a receiver: one that stands still delays no other.

    Those for one receiver are made one after the other, in a thread that ends when nothing waits.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._changed = threading.Condition()
        self._jobs: dict[Hashable, deque[tuple[Callable[[], object], int]]] = {}
        """What waits for each receiver that has a thread."""
        self._bytes: Counter[Hashable] = Counter()
        self._is_closed = False

    @property
    def bytes(self) -> int:
        """Bytes of all calls that wait or are being made."""
        with self._changed:
            return self._bytes.total()

    def waiting(self, receiver: Hashable) -> int:
        """Return the bytes of the calls for a receiver that wait or are being made."""
        with self._changed:
            return self._bytes[receiver]

    def call(self, receiver: Hashable, job: Callable[[], object], size: int = 0) -> None:
        """Call a function after the waiting ones of the same receiver."""
        with self._changed:
            if self._is_closed:
                return
            self._bytes[receiver] += size
            if receiver in self._jobs:
                self._jobs[receiver].append((job, size))
                self._changed.notify_all()
                return
            self._jobs[receiver] = jobs = deque([(job, size)])
        arguments = (receiver, jobs)
        threading.Thread(target=self._run, args=arguments, name=self._name, daemon=True).start()

    def forget(self, receiver: Hashable) -> None:
        """Drop what waits for a receiver that is gone."""
        with self._changed:
            if jobs := self._jobs.get(receiver):
                self._bytes[receiver] -= sum(size for _, size in jobs)
                jobs.clear()

    def close(self) -> None:
        """Accept no further calls; the threads end once the waiting ones are done."""
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()

    def join(self, timeout: float) -> None:
        """Wait until all threads have ended."""
        with self._changed:
            self._changed.wait_for(lambda: not self._jobs, timeout)

    def _run(self, receiver: Hashable, jobs: deque[tuple[Callable[[], object], int]]) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: jobs or self._is_closed, LINGER)
                if not jobs:
                    del self._jobs[receiver], self._bytes[receiver]
                    self._changed.notify_all()
                    return
                job, size = jobs.popleft()
            _attempt(job, lambda: self._is_closed)
            del job  # It may hold a query, which ends when nothing refers to it.
            with self._changed:
                self._bytes[receiver] -= size


class ZenohLane:
    """The messages of one publisher that wait for a thread; see `ZenohLanes`."""

    __slots__ = ("bytes", "is_open", "is_sending", "jobs")

    def __init__(self) -> None:
        self.jobs: deque[tuple[int, Callable[[], object], int]] = deque()
        """The number, the function and the size of each."""
        self.bytes = 0
        self.is_open = False
        self.is_sending = False


class ZenohLanes:
    """Sends messages in two threads, so that small ones do not wait for large ones.

    The messages of a publisher stay in order, as do small ones of all publishers. zenoh drops what
    a receiver does not read (`lossy`), so messages wait for those before them, not for receivers.

    Args:
        limit: most bytes that wait.
        dropped: called, in any thread, for each message that is dropped.
    """

    def __init__(self, name: str, limit: int, dropped: Callable[[], object]) -> None:
        self._limit = limit
        self._dropped = dropped
        self._lock = threading.Lock()
        self._changed = threading.Condition(self._lock)
        self._small, self._large = self._queues = _Due(self._lock), _Due(self._lock)
        self._threads = [
            threading.Thread(target=self._run, args=(due,), name=f"{name}-{size}", daemon=True)
            for due, size in zip(self._queues, ("small", "large"), strict=True)
        ]
        self._numbers = count()
        self._bytes = 0
        self._sending = 0
        self._is_closed = False

    def start(self) -> None:
        """Start the threads."""
        for thread in self._threads:
            thread.start()

    def open(self, lane: ZenohLane) -> None:
        """Begin to send the messages of a publisher, which is declared now."""
        with self._lock:
            lane.is_open = True
            self._schedule(lane)

    @property
    def bytes(self) -> int:
        """Bytes of the messages that wait."""
        return self._bytes

    def send(self, lane: ZenohLane, job: Callable[[], object], size: int, limit: int) -> None:
        """Send a message; the oldest ones of its publisher are dropped if too many wait.

        Args:
            job: sends it; called in a thread.
            limit: most messages of the publisher that wait.
        """
        with self._lock:
            if self._is_closed:
                return
            lane.jobs.append((next(self._numbers), job, size))
            lane.bytes += size
            self._bytes += size
            if len(lane.jobs) == 1:
                self._schedule(lane)
            while len(lane.jobs) > 1 and (
                (len(lane.jobs) > limit and self._sending)
                or lane.bytes > LANE_BYTES
                or self._bytes > self._limit
            ):
                self._take(lane)
                self._dropped()

    def drain(self, lane: ZenohLane) -> None:
        """Wait until the messages of a publisher are sent."""
        with self._lock:
            self._changed.wait_for(lambda: not (lane.jobs or lane.is_sending), LEASE)

    def close(self) -> None:
        """End once all is sent that waits."""
        with self._lock:
            self._is_closed = True
            for due in self._queues:
                due.changed.notify()

    def join(self, timeout: float) -> None:
        """Wait for the end."""
        for thread in self._threads:
            thread.join(timeout)

    def _schedule(self, lane: ZenohLane) -> None:
        """Give a lane to the thread for its next message."""
        if lane.jobs and lane.is_open and not lane.is_sending:
            number, _, size = lane.jobs[0]
            due = self._large if size >= LARGE else self._small
            heappush(due.lanes, (number, lane))
            due.changed.notify()

    def _take(self, lane: ZenohLane) -> Callable[[], object]:
        _, job, size = lane.jobs.popleft()
        lane.bytes -= size
        self._bytes -= size
        return job

    def _run(self, due: _Due) -> None:
        while True:
            with self._lock:
                while not due.lanes:
                    if self._is_closed and not self._sending:
                        return
                    due.changed.wait()
                _, lane = heappop(due.lanes)
                job = self._take(lane)
                lane.is_sending = True
                self._sending += 1
            _attempt(job, lambda: self._is_closed)
            del job
            with self._lock:
                lane.is_sending = False
                self._sending -= 1
                self._schedule(lane)
                self._changed.notify_all()
                if self._is_closed:
                    for each in self._queues:
                        each.changed.notify()


class _Due:
    """The lanes with messages for one thread, each by the number of its first one."""

    def __init__(self, lock: threading.Lock) -> None:
        self.lanes: list[tuple[int, ZenohLane]] = []
        self.changed = threading.Condition(lock)


def _attempt(job: Callable[[], object], is_closed: Callable[[], bool]) -> None:
    try:
        job()
    except Exception as error:
        if not is_closed():
            logger.warning("zenoh: %s", printable(str(error)))


class Inbox:
    """Hands calls from zenoh's threads to the event loop, in order.

    Args:
        limit: most bytes of messages that wait for the event loop; the oldest are dropped, and the
            newest always may wait.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop, limit: int) -> None:
        self._loop = loop
        self._limit = limit
        self._lock = threading.Lock()
        self._numbers = count()
        self._messages: deque[_Arrival] = deque()
        self._calls: deque[_Arrival] = deque()
        """Calls that are not messages."""
        self._bytes = 0
        self._is_due = False
        self._is_closed = False
        self.dropped = 0

    @property
    def bytes(self) -> int:
        """Bytes of the messages that wait."""
        return self._bytes

    def put(self, function: Callable[..., object], *arguments: Any, size: int = 0) -> None:
        """Call a function in the event loop soon.

        Args:
            size: bytes of a message, which may be dropped; 0 for other calls.
        """
        with self._lock:
            if self._is_closed:
                return
            arrival = next(self._numbers), function, arguments, size
            (self._messages if size else self._calls).append(arrival)
            self._bytes += size
            while self._bytes > self._limit and len(self._messages) > 1:
                self._bytes -= self._messages.popleft()[3]
                self.dropped += 1
            if not self._is_due:
                self._is_due = True
                self._loop.call_soon_threadsafe(self._run)

    def close(self) -> None:
        """Call nothing more."""
        with self._lock:
            self._is_closed = True
            self._messages.clear()
            self._calls.clear()

    def _next(self) -> _Arrival | None:
        with self._lock:
            found = [queue for queue in (self._messages, self._calls) if queue]
            if not found:
                self._is_due = False
                return None
            arrival = min(found, key=lambda queue: queue[0][0]).popleft()
            self._bytes -= arrival[3]
            return arrival

    def _run(self) -> None:
        until = time.perf_counter() + TURN
        while (arrival := self._next()) is not None:
            _, function, arguments, _ = arrival
            try:
                function(*arguments)
            except Exception:
                logger.exception("zenoh: something that arrived could not be handled.")
            if time.perf_counter() > until:
                self._loop.call_soon(self._run)
                return
