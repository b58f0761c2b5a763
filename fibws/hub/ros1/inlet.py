"""Inlets: connections by which the hub subscribes at ROS 1 publishers, for its own clients.

Messages stay bytes: they are checked and handed to the graph as they came. Small ones are copied
out of one buffer, and a large one is read straight into a buffer of its size.
"""

from __future__ import annotations

import asyncio
import logging
import random
from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any, cast

from fibws.errors import FibwsError, Ros1Error, TcprosError
from fibws.hub.graph.topic import Source
from fibws.hub.log_text import is_power_of_ten, shortened
from fibws.hub.ros1.http import NodeCalls
from fibws.hub.ros1.nodes import Ros1Publisher
from fibws.hub.ros1.tcpros import (
    ANY,
    LENGTH,
    check_header_size,
    decode_header,
    encode_header,
    require,
)

logger = logging.getLogger("fibws.hub")

SCRATCH = 64 * 1024
"""Bytes of the buffer in which small messages arrive."""
TURN = 0.001
"""Seconds for which the messages of one link are delivered before others have their turn."""
CHECKED_EVERY = 8
"""Messages between two looks at the clock."""
CONNECT_TIMEOUT = 5.0
FIRST_RETRY, LONGEST_RETRY = 0.1, 20.0
"""Seconds before a lost link is opened again; they double each time, as roscpp's."""


class Inlet:
    """A link to one publisher, opened again and again until it is closed.

    Args:
        caller: returns the name of the node that the link is for.
        learn: takes the type, the definition and the md5sum that the publisher tells, and returns
            its source; None closes the link.
    """

    def __init__(
        self,
        publisher: Ros1Publisher,
        calls: NodeCalls,
        caller: Callable[[], str],
        learn: Callable[[Ros1Publisher, str, str, str], Source | None],
        max_size: int,
    ) -> None:
        self.publisher = publisher
        self.caller = ""
        """The name that the publisher knows."""
        self.connection: InletConnection | None = None
        """The present connection, if its header has arrived."""
        self._calls = calls
        self._name_caller = caller
        self._learn = learn
        self._max_size = max_size
        self._task = asyncio.get_running_loop().create_task(self._run())
        self._last_fault = ""
        self._is_renamed = False

    def close(self) -> None:
        """Close the link; latched messages that came by it are forgotten."""
        self._task.cancel()
        if self.connection is not None:
            self.connection.close()
        source = self.publisher.source
        if source is not None:
            source.forget_latched()

    def reopen(self) -> None:
        """Open the link again at once, in the name of the node that it is for now."""
        self._is_renamed = True
        if self.connection is not None:
            self.connection.close()

    async def _run(self) -> None:
        delay = FIRST_RETRY
        while True:
            try:
                await self._connect_once()
                delay, self._last_fault = FIRST_RETRY, ""
            except (Ros1Error, OSError, TimeoutError, UnicodeError) as error:
                self._report(error)
            if self.publisher.source is None and not self.publisher.is_relayed:
                return
            if self._is_renamed:
                continue
            await asyncio.sleep(delay * random.uniform(0.8, 1.2))
            delay = min(2 * delay, LONGEST_RETRY)

    async def _connect_once(self) -> None:
        """Connect, and return once the connection has ended; raise if it failed before."""
        loop, publisher = asyncio.get_running_loop(), self.publisher
        self.caller, self._is_renamed = self._name_caller(), False
        answer = await self._calls.call(
            publisher.node.api, "requestTopic", self.caller, publisher.topic, [["TCPROS"]]
        )
        match answer:
            case ["TCPROS", str() as host, int() as port]:
                pass
            case _:
                raise TcprosError(f"requestTopic returned {answer!r}, expected a TCPROS address")
        header = {
            "callerid": self.caller,
            "topic": publisher.topic,
            "type": ANY,
            "md5sum": ANY,
            "tcp_nodelay": "1",
        }
        async with asyncio.timeout(CONNECT_TIMEOUT):
            transport, connection = await loop.create_connection(
                lambda: InletConnection(self._opened, self._max_size), host, port
            )
        try:
            transport.write(encode_header(header))
            async with asyncio.timeout(CONNECT_TIMEOUT):
                await connection.opened
            self.connection = connection
            if self._is_renamed:
                connection.close()
            await connection.ended
        finally:
            self.connection = None
            source = publisher.source
            if source is not None:
                source.topic.watching_sources.unlinked(publisher.node.name)
            transport.abort()

    def _opened(self, header: Mapping[str, str]) -> Source:
        """Return the source for a publisher's header; raises `TcprosError`."""
        if "error" in header:
            raise TcprosError(header["error"])
        require(header, "type", "md5sum")
        definition = header.get("message_definition", "")
        source = self._learn(self.publisher, header["type"], definition, header["md5sum"])
        if source is None:
            raise TcprosError("its type conflicts with that of the topic")
        source.latch = header.get("latching") == "1"
        source.set_headers({"type": header["type"], "md5sum": header["md5sum"]})
        source.topic.source_linked(self.publisher.node.name)
        return source

    def _report(self, error: Exception) -> None:
        """Log why the link failed, once."""
        fault = shortened(str(error) or "no answer in time")
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
        self._loop = loop
        self._transport: asyncio.Transport
        self._source: Source | None = None
        self._scratch = memoryview(bytearray(SCRATCH))
        self._start = self._end = 0
        """The bytes in the scratch buffer that are not processed yet."""
        self._large: memoryview | None = None
        """The buffer of a large message that is arriving."""
        self._large_end = 0
        self._is_closed = False
        self._faults = 0

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Wait for the publisher's header."""
        # Not checked: uvloop's transports are not subclasses of asyncio's.
        self._transport = cast(asyncio.Transport, transport)

    def get_buffer(self, sizehint: int) -> memoryview:
        """Return where the next bytes are to be put."""
        if self._large is not None:
            return self._large[self._large_end :]
        if self._start and self._end - self._start < LENGTH:
            rest = bytes(self._scratch[self._start : self._end])
            self._start, self._end = 0, len(rest)
            self._scratch[: self._end] = rest
        return self._scratch[self._end :]

    def buffer_updated(self, count: int) -> None:
        """Take bytes that have arrived."""
        if self._large is None:
            self._end += count
            self._process()
            return
        self._large_end += count
        self.bytes += count
        if self._large_end == len(self._large):
            message, self._large = self._large, None
            self._deliver(message)

    def connection_lost(self, error: Exception | None) -> None:
        """End."""
        self._is_closed = True
        lost = TcprosError("the connection was closed before its header")
        if not self.opened.done():
            self._fail(self.opened, lost)
        if not self.ended.done():
            self.ended.set_result(None)

    def close(self) -> None:
        """Close the connection: nothing is delivered any more."""
        self._is_closed = True
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
            try:
                self._check(size)
            except TcprosError as error:
                self._break(error)
                return
            if begin + size > SCRATCH or (size > available and size > SCRATCH // 4):
                self._begin_large(begin, size)
                if self._large is not None:
                    return
                continue
            if size > available - LENGTH:
                self._make_room()
                break
            self._start = begin + size
            self._take(bytes(self._scratch[begin : begin + size]))
            count += 1
            if count % CHECKED_EVERY == 0 and perf_counter() > until:
                self._transport.pause_reading()
                self._loop.call_soon(self._resume)
                return
        if self._start == self._end:
            self._start = self._end = 0

    def _resume(self) -> None:
        if not self._is_closed:
            self._transport.resume_reading()
            self._process()

    def _make_room(self) -> None:
        """Move the beginning of a message to the front if the rest has no room behind it."""
        if self._start > SCRATCH // 2:
            rest = bytes(self._scratch[self._start : self._end])
            self._start, self._end = 0, len(rest)
            self._scratch[: self._end] = rest

    def _begin_large(self, begin: int, size: int) -> None:
        """Move the beginning of a large message to a buffer of its size."""
        there = min(size, self._end - begin)
        self._large = memoryview(bytearray(size))
        self._large[:there] = self._scratch[begin : begin + there]
        self._large_end = there
        self.bytes += there
        self._start = begin + there
        if there < size:
            self._start = self._end = 0
            return
        message, self._large = self._large, None
        self._deliver(message)

    def _check(self, size: int) -> None:
        if self._source is None:
            check_header_size(size)
        elif size > self._max_size:
            fault = f"a message of {size} bytes, limit is {self._max_size} (--max-message-size)"
            raise TcprosError(fault)

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
            self.opened.set_result(None)
            return
        self.messages += 1
        try:
            self._source.relay(data)
        except FibwsError as error:
            self._faults += 1
            if is_power_of_ten(self._faults):
                name, topic = self._source.node, self._source.topic.name
                text = shortened(f"{name}: a message of {topic} was dropped: {error}")
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
