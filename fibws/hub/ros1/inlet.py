"""Inlets: connections by which the hub subscribes at ROS 1 publishers, for its own clients.

Messages stay bytes: they are checked and handed to the graph as they came. Small ones are copied
out of one buffer, and a large one is read straight into a buffer of its size.
"""

from __future__ import annotations

import asyncio
import logging
import random
from collections.abc import Awaitable, Callable, Mapping
from time import perf_counter
from typing import Any, cast

from fibws.errors import FibwsError, InvalidMessage
from fibws.hub.errors import NodeUnreachable, Ros1Error, TcprosError
from fibws.hub.foreign.worklist import TURN
from fibws.hub.graph.topic import Source
from fibws.hub.log.text import is_power_of_ten, printable
from fibws.hub.ros1.connection import describe, detect_dead_peer
from fibws.hub.ros1.http import NodeCalls
from fibws.hub.ros1.tcpros import (
    ANY,
    LENGTH,
    MOST_HEADER,
    MOST_MESSAGE,
    decode_header,
    encode_header,
    require,
)
from fibws.hub.ros1.topic_registrations import Registrant, Ros1Publisher

logger = logging.getLogger("fibws.hub")

AHEAD = 1024 * 1024
"""Bytes allocated for a large message at first; more follow as it arrives."""
SCRATCH = 128 * 1024
"""Bytes of the buffer in which small messages arrive."""
CHECKED_EVERY = 8
"""Messages between two looks at the clock."""
CONNECT_TIMEOUT = 5.0
FIRST_RETRY, LONGEST_RETRY = 0.1, 20.0
"""Seconds before a lost link is opened again; they double each time, as roscpp's."""
STEADY = 1.0
"""Seconds for which a link without messages must last to count as one that works."""
PATIENCE = 3
"""Failures in a row until it is logged that a node cannot be reached."""
MD5_OF_EMPTY = "d41d8cd98f00b204e9800998ecf8427e"
"""The md5 of types without fields, whose definition is an empty text."""


class TcprosInlet:
    """A link to one publisher, reopened until it is closed.

    Args:
        number: its id among the links of the hub.
        caller: returns the name of the node that the link is for.
        learn: takes the type, the definition and the md5sum that the publisher tells, and returns
            its source; None ends the link.
        ping: checks whether a node answers at all, and logs it for the node if not.
    """

    def __init__(
        self,
        number: int,
        publisher: Ros1Publisher,
        calls: NodeCalls,
        caller: Callable[[], str],
        learn: Callable[[Ros1Publisher, str, str | None, str], Source | None],
        ping: Callable[[Registrant], Awaitable[None]],
        max_size: int,
    ) -> None:
        self.number = number
        self.publisher = publisher
        self.caller = ""
        """The name that the publisher knows."""
        self.connection: InletConnection | None = None
        """The present connection, if its header has arrived."""
        self._calls = calls
        self._name_caller = caller
        self._learn = learn
        self._ping = ping
        self._max_size = max_size
        self._delay = FIRST_RETRY
        self._last_fault = ""
        self._failures = 0
        """How often it has failed since it last worked."""
        self._newest: InletConnection | None = None
        """The connection that is open, or about to be."""
        self._is_refused = False
        self._task = asyncio.get_running_loop().create_task(self._run())

    @property
    def incomplete_bytes(self) -> int:
        """Bytes that are kept of a large message that came in part."""
        return self._newest.incomplete_bytes if self._newest is not None else 0

    def interrupt(self) -> None:
        """Close the connection; it is opened again, later after each failure."""
        if self._newest is not None:
            self._newest.close()

    @property
    def has_ended(self) -> bool:
        """Whether it is not opened again, since the publisher's type conflicts with the topic's."""
        return self._task.done()

    def close(self) -> None:
        """Close the link; latched messages that came by it are forgotten."""
        self._stop()
        source = self.publisher.source
        if source is not None:
            source.forget_latched()

    async def closed(self) -> None:
        """Wait until a link that is closed has left nothing."""
        await asyncio.wait([self._task])

    def reopen(self) -> None:
        """Open the link again at once, in the name of the node that it is for now."""
        self.caller = self._name_caller()
        older = self._task
        self._stop()
        self._task = asyncio.get_running_loop().create_task(self._run(older))

    def _stop(self) -> None:
        self._task.cancel()
        if self._newest is not None:
            self._newest.close()

    async def _run(self, older: asyncio.Task[None] | None = None) -> None:
        if older is not None:
            await asyncio.wait([older])
        while True:
            try:
                await self._connect_once()
            except (FibwsError, OSError, ValueError) as error:
                if self._is_refused:
                    return
                self._failures += 1
                await self._report(error)
            await asyncio.sleep(self._delay * random.uniform(0.8, 1.2))
            self._delay = min(2 * self._delay, LONGEST_RETRY)

    async def _connect_once(self) -> None:
        """Connect, and return once the connection has ended; raise if it failed before."""
        loop, publisher = asyncio.get_running_loop(), self.publisher
        self.caller = self._name_caller()
        answer = await self._calls.call(
            publisher.node.api, "requestTopic", self.caller, publisher.topic, [["TCPROS"]]
        )
        match answer:
            case ["TCPROS", str() as host, int() as port] if 0 < port < 65536:
                pass
            case _:
                fault = f"requestTopic returned {answer!r}, expected ['TCPROS', host, port]"
                raise TcprosError(fault)
        header = {
            "callerid": self.caller,
            "topic": publisher.topic,
            "type": ANY,
            "md5sum": ANY,
            "tcp_nodelay": "1",
        }
        self._is_refused = False
        self._newest = connection = InletConnection(self._opened, self._max_size)
        try:
            async with asyncio.timeout(CONNECT_TIMEOUT):
                transport, _ = await loop.create_connection(lambda: connection, host, port)
                transport.write(encode_header(header))
                await connection.opened
            self.connection, began = connection, loop.time()
            await connection.ended
            if connection.messages or loop.time() - began > STEADY:
                self._delay, self._failures, self._last_fault = FIRST_RETRY, 0, ""
        finally:
            connection.close()
            self.connection = self._newest = None
            source = publisher.source
            if source is not None:
                source.unlink()

    def _opened(self, header: Mapping[str, str]) -> Source:
        """Return the source for a publisher's header; raises `TcprosError`."""
        if "error" in header:
            raise TcprosError(header["error"])
        require(header, "type", "md5sum")
        type_, md5sum = header["type"], header["md5sum"]
        if type_ == ANY:
            raise TcprosError("expected the type of its messages, got *")
        definition = header.get("message_definition") or None
        if md5sum == MD5_OF_EMPTY:
            definition = definition or ""
        source = self._learn(self.publisher, type_, definition, md5sum)
        if source is None:
            self._is_refused = True
            raise TcprosError("its type conflicts with that of the topic")
        source.latch = header.get("latching") == "1"
        if not source.latch:
            source.forget_latched()
        source.set_headers({"type": type_, "md5sum": md5sum})
        source.link()
        return source

    async def _report(self, error: Exception) -> None:
        """Log why the link failed, once; a node that is ending is unreachable for a moment."""
        if isinstance(error, (NodeUnreachable, OSError)):
            if self._failures < PATIENCE:
                return
            try:
                await self._ping(self.publisher.node)
            except Ros1Error:
                return  # One line for the node is enough.
        fault = printable(str(error) or f"no answer within {CONNECT_TIMEOUT:g} s")
        if fault != self._last_fault:
            node, topic = self.publisher.node, self.publisher.topic
            logger.warning("%s: no link to its topic %s: %s.", node.name, topic, fault)
            self._last_fault = fault


class InletConnection(asyncio.BufferedProtocol):
    """One connection to a publisher.

    Args:
        open_: takes the publisher's header and returns the source for the messages.
        max_size: most bytes of a message.

    Attributes:
        opened: done once the header has been accepted; fails if it was not.
        ended: done once the connection has ended; fails if the publisher broke the protocol.
        messages, bytes: received so far.
    """

    def __init__(self, open_: Callable[[Mapping[str, str]], Source], max_size: int) -> None:
        loop = asyncio.get_running_loop()
        self.opened: asyncio.Future[None] = loop.create_future()
        self.ended: asyncio.Future[None] = loop.create_future()
        self.messages = 0
        self.bytes = 0
        self._open = open_
        self._max_size = max_size
        self._limit = MOST_HEADER
        """Most bytes of what comes next."""
        self._loop = loop
        self._transport: asyncio.Transport | None = None
        self._source: Source | None = None
        self._scratch = memoryview(bytearray(SCRATCH))
        self._start = self._end = 0
        """The bytes in the scratch buffer that are not processed yet."""
        self._large: memoryview | None = None
        """The buffer of a large message that is arriving."""
        self._large_end = self._large_size = 0
        self._skipped = 0
        """The bytes that are still to come of a message that is too large."""
        self._is_closed = False
        self._faults = 0

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Wait for the publisher's header."""
        # Not checked: uvloop's transports are not subclasses of asyncio's.
        self._transport = cast(asyncio.Transport, transport)
        detect_dead_peer(self._transport)
        if self._is_closed:
            self._transport.abort()

    @property
    def incomplete_bytes(self) -> int:
        """Bytes that are kept of a large message that came in part."""
        return len(self._large) if self._large is not None else 0

    def get_buffer(self, sizehint: int) -> memoryview:
        """Return where the next bytes are to be put."""
        if self._large is not None:
            return self._large[self._large_end :]
        if self._skipped:
            return self._scratch[: self._skipped]
        if self._start and self._end - self._start < LENGTH:
            rest = bytes(self._scratch[self._start : self._end])
            self._start, self._end = 0, len(rest)
            self._scratch[: self._end] = rest
        return self._scratch[self._end :]

    def buffer_updated(self, count: int) -> None:
        """Take bytes that have arrived."""
        if self._is_closed:
            return
        if self._large is not None:
            self._large_end += count
            self.bytes += count
            if self._large_end == self._large_size:
                message, self._large = self._large, None
                self._deliver(message)
            elif self._large_end == len(self._large):
                self._grow()
        elif self._skipped:
            self._skipped -= count
            self.bytes += count
        else:
            self._end += count
            self._process()

    def connection_lost(self, error: Exception | None) -> None:
        """End."""
        self._is_closed = True
        lost = TcprosError("the connection was closed before its header")
        if not self.opened.done():
            self._fail(self.opened, lost)
        if not self.ended.done():
            self.ended.set_result(None)

    def describe(self) -> str:
        """Return the ends of the connection, as getBusInfo does."""
        return describe(self._transport) if self._transport is not None else ""

    def close(self) -> None:
        """Close the connection: nothing is delivered any more."""
        self._is_closed = True
        if self._transport is not None:
            self._transport.abort()

    def _process(self) -> None:
        """Deliver the messages in the scratch buffer, for as long as a turn lasts."""
        until, count = perf_counter() + TURN, 0
        while not self._is_closed:
            available = self._end - self._start
            if available < LENGTH:
                break
            begin = self._start + LENGTH
            size = int.from_bytes(self._scratch[self._start : begin], "little")
            if size > self._limit:
                if self._source is None or size > MOST_MESSAGE:
                    fault = f"{size} bytes announced, limit is {self._limit}"
                    self._break(TcprosError(f"invalid TCPROS length: {fault}"))
                    return
                self._begin_skipping(begin, size)
                continue
            if begin + size > SCRATCH or (size > available and size > SCRATCH // 4):
                self._begin_large(begin, size)
                return
            if size > available - LENGTH:
                self._make_room()
                break
            self._start = begin + size
            self._take(bytes(self._scratch[begin : begin + size]))
            count += 1
            if count % CHECKED_EVERY == 0 and perf_counter() > until:
                self._pause()
                return
        if self._start == self._end:
            self._start = self._end = 0

    def _pause(self) -> None:
        """Process the rest when others have had their turn."""
        assert self._transport is not None
        self._transport.pause_reading()
        self._loop.call_soon(self._resume)

    def _resume(self) -> None:
        if not self._is_closed:
            assert self._transport is not None
            self._transport.resume_reading()
            self._process()

    def _make_room(self) -> None:
        """Move the beginning of a message to the front if the rest has no room behind it."""
        if self._start > SCRATCH // 2:
            rest = bytes(self._scratch[self._start : self._end])
            self._start, self._end = 0, len(rest)
            self._scratch[: self._end] = rest

    def _grow(self) -> None:
        """Make room for more of the large message, most of which is still to come."""
        assert self._large is not None
        larger = memoryview(bytearray(min(self._large_size, 4 * len(self._large))))
        larger[: self._large_end] = self._large
        self._large = larger

    def _begin_large(self, begin: int, size: int) -> None:
        """Move the beginning of a large message to a buffer of its own, which grows with it."""
        there = self._end - begin
        self._large_size = size
        self._large = memoryview(bytearray(min(size, max(AHEAD, 4 * there))))
        self._large[:there] = self._scratch[begin : self._end]
        self._large_end = there
        self.bytes += there
        self._start = self._end = 0

    def _begin_skipping(self, begin: int, size: int) -> None:
        """Drop a message that is larger than the hub takes; others may follow."""
        there = min(size, self._end - begin)
        self._skipped = size - there
        self._start = begin + there
        self.bytes += there
        limit = f"limit is {self._max_size} (--max-message-size)"
        self._log(f"a message of {size} bytes was dropped: {limit}")

    def _take(self, data: bytes) -> None:
        self.bytes += len(data)
        self._deliver(data)

    def _deliver(self, data: bytes | memoryview) -> None:
        """Give a message to the graph; the first one is the header."""
        if self._source is None:
            try:
                self._source = self._open(decode_header(bytes(data)))
            except FibwsError as error:
                self._break(error)
                return
            self._limit = self._max_size
            self.opened.set_result(None)
            return
        self.messages += 1
        try:
            self._source.relay(data)
        except InvalidMessage as error:
            self._log(f"a message was dropped: {error}")
        except FibwsError as error:
            self._log(str(error))

    def _log(self, fault: str) -> None:
        assert self._source is not None
        self._faults += 1
        if is_power_of_ten(self._faults):
            text = printable(f"{self._source.node}: {self._source.topic.name}: {fault}")
            logger.warning("%s (%d so far)", text, self._faults)

    def _break(self, error: FibwsError) -> None:
        """Close the connection of a publisher that breaks the protocol."""
        future: asyncio.Future[Any] = self.ended if self.opened.done() else self.opened
        self._fail(future, error)
        self.close()

    @staticmethod
    def _fail(future: asyncio.Future[None], error: Exception) -> None:
        if not future.done():
            future.set_exception(error)
            future.exception()  # Nobody may be waiting any more.
