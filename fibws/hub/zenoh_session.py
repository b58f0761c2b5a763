"""zenoh sessions (https://zenoh.io), and the threads between them and the event loop.

Calls of zenoh may wait for the network, so they are made in threads (`Sender`). Its callbacks come
in threads, too, and hand their data to the event loop (`Inbox`).
"""

from __future__ import annotations

import asyncio
import json
import logging
import re
import threading
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Sequence
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from fibws.errors import HubError
from fibws.hub.log_text import printable

if TYPE_CHECKING:
    import zenoh

logger = logging.getLogger("fibws.hub")

AUTO = "auto"
"""In place of an endpoint: find others by multicast."""
LEASE = 4.0
"""Seconds of silence after which a connection counts as lost."""
RETRY = 1.0
"""Most seconds before an endpoint that does not answer is tried again."""
LANE_BYTES = 2 * 1024 * 1024
"""Bytes of one publisher that may wait; its newest message always may."""
TURN = 0.001
"""Seconds for which arrivals are handled before others have their turn."""

_Arrival: TypeAlias = tuple[int, Callable[..., object], tuple[Any, ...], int]
"""Its number, what to call with which arguments, and its size."""


async def open_session(
    listen: Sequence[str], connect: Sequence[str], config: Path | None, *, flag: str
) -> zenoh.Session:
    """Open a session as a router.

    Args:
        listen: endpoints to listen on, such as ``tcp/0.0.0.0:7447``.
        connect: endpoints to connect to again and again, or ``auto``.
        config: a file of zenoh's own settings, for TLS and access control.
        flag: names the setting in errors.

    Raises:
        HubError: zenoh is not installed, or the file or an endpoint cannot be used.
    """
    try:
        import zenoh
    except ImportError:
        raise HubError(f"{flag} requires eclipse-zenoh: pip install 'fibws[zenoh]'") from None
    try:
        return await asyncio.to_thread(zenoh.open, _config(listen, connect, config))
    except (zenoh.ZError, OSError, ValueError) as error:
        endpoints = ", ".join((*listen, *connect))
        fault = printable(_fault(error))
        raise HubError(f"{flag}: cannot use {endpoints}: {fault}") from None


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


def _config(listen: Sequence[str], connect: Sequence[str], path: Path | None) -> zenoh.Config:
    import zenoh

    config = zenoh.Config.from_file(path) if path is not None else zenoh.Config()
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
        "transport/link/tx/lease": round(LEASE * 1000),
    }
    if listen or AUTO not in connect:
        values["listen/endpoints"] = list(listen)
    else:
        values["listen/endpoints"] = ["tcp/0.0.0.0:0"]
    if endpoints:
        values["connect/endpoints"] = endpoints
    if AUTO in connect:
        values["scouting/multicast/autoconnect"] = {"router": ["router"]}
    for key, value in values.items():
        config.insert_json5(key, json.dumps(value))
    return config


class Sender(threading.Thread):
    """Makes calls of zenoh in order; a call that waits for the network delays the others here.

    Args:
        limit: most bytes of messages that wait.
        dropped: called, in any thread, for each message that is dropped.
    """

    def __init__(self, name: str, limit: int, dropped: Callable[[], object]) -> None:
        super().__init__(name=name, daemon=True)
        self._limit = limit
        self._dropped = dropped
        self._condition = threading.Condition()
        self._jobs: OrderedDict[int, tuple[Callable[[], object], int, int | None]] = OrderedDict()
        self._lanes: dict[int, deque[int]] = {}
        """The messages of each publisher that wait."""
        self._sizes: dict[int, int] = {}
        self._numbers = count()
        self._bytes = 0
        self._is_closed = False
        self._is_behind = False
        self.control_bytes = 0

    def call(self, job: Callable[[], object], size: int = 0) -> None:
        """Call a function, after those that wait; it is never dropped."""
        with self._condition:
            if self._is_closed:
                return
            self._jobs[next(self._numbers)] = job, size, None
            self.control_bytes += size
            self._condition.notify()

    def send(self, lane: int, job: Callable[[], object], size: int, limit: int) -> None:
        """Send a message; the oldest ones of a publisher are dropped if too much waits."""
        with self._condition:
            if self._is_closed:
                return
            number = next(self._numbers)
            self._jobs[number] = job, size, lane
            waiting = self._lanes.setdefault(lane, deque())
            waiting.append(number)
            self._bytes += size
            self._sizes[lane] = self._sizes.get(lane, 0) + size
            while len(waiting) > 1 and (
                (len(waiting) > limit and self._is_behind)
                or self._sizes[lane] > LANE_BYTES
                or self._bytes > self._limit
            ):
                _, old, _ = self._jobs.pop(waiting.popleft())
                self._shrink(lane, old)
                self._dropped()
            self._condition.notify()

    def has(self, lane: int) -> bool:
        """Return whether messages of a publisher wait."""
        with self._condition:
            return lane in self._lanes

    def close(self) -> None:
        """End once all is done that waits."""
        with self._condition:
            self._is_closed = True
            self._condition.notify()

    def run(self) -> None:
        while True:
            with self._condition:
                self._is_behind = False
                while not self._jobs:
                    if self._is_closed:
                        return
                    self._condition.wait()
                number, (job, size, lane) = self._jobs.popitem(last=False)
                if lane is None:
                    self.control_bytes -= size
                else:
                    waiting = self._lanes[lane]
                    waiting.remove(number)
                    self._shrink(lane, size)
                    if not waiting:
                        del self._lanes[lane], self._sizes[lane]
                self._is_behind = True
            try:
                job()
            except Exception as error:
                if not self._is_closed:
                    logger.warning("zenoh: %s", printable(str(error)))
            del job  # It may hold a query, which ends when nothing refers to it.

    def _shrink(self, lane: int, size: int) -> None:
        self._sizes[lane] -= size
        self._bytes -= size


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
        """What is no message."""
        self._bytes = 0
        self._is_due = False
        self._is_closed = False
        self.dropped = 0

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
