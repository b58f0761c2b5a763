"""The socket between a node and its hub, made again whenever it breaks."""

from __future__ import annotations

import asyncio
import logging
import os
import random
import re
from collections.abc import Iterator
from contextlib import suppress

from websockets.asyncio.client import connect
from websockets.exceptions import (
    ConnectionClosed,
    InvalidHandshake,
    InvalidProxy,
    InvalidStatus,
    InvalidURI,
)
from websockets.protocol import State

from fibws.errors import HubUnreachable, NodeError, NodeKilled, NodeReplaced
from fibws.node.address import node_url
from fibws.node.rosout import TOPIC as ROSOUT
from fibws.node.session import MAX_SIZE, Session
from fibws.node.websocket import TURN, WebSocket
from fibws.protocol.closing import KILLED, REPLACED

FIRST_RETRY = 0.1
LONGEST_RETRY = 0.5
OPENING = 5.0
FLUSHING = 0.6
CLOSING = 0.3
"""Seconds, all five; the last two together bound how long a node's end takes."""

_TRY_LATER = (408, 425, 429)
_ERRNO = re.compile(r"\[Errno (\d+)\]")


class Connection:
    """Keeps one node connected to its hub until it is closed."""

    def __init__(self, hub: str, node: str, session: Session, log: logging.Logger) -> None:
        self._hub = hub
        self._node = node
        self._session = session
        self._log = log
        self._answered = asyncio.Event()
        self._missed = False
        self._task: asyncio.Task[None] | None = None

    async def open(self) -> None:
        """Wait until the hub has answered, for as long as that takes.

        Raises:
            HubUnreachable: it never will.
        """
        self._session.begin()
        self._task = asyncio.create_task(self._run(), name=f"connection of {self._node}")
        try:
            await self._answered.wait()
            self._session.check()
        except BaseException:
            await self.close()
            raise

    async def close(self) -> None:
        """Send what still waits if that is possible soon, then leave and say what was not sent."""
        self._session.end()
        if self._task is None:
            return
        if not self._session.outbox.connected:
            self._task.cancel()
        try:
            await asyncio.wait({self._task}, timeout=FLUSHING)
        finally:
            self._task.cancel()
            await asyncio.wait({self._task})
        unsent = self._session.outbox.unsent()
        del unsent[ROSOUT]  # The console has shown those.
        if unsent:
            self._log.warning("Messages that were not sent: %d.", unsent.total())

    async def _run(self) -> None:
        """Connect and converse, again and again, until the node is over."""
        delays = _delays()
        try:
            while not self._session.over:
                if await self._visit():
                    delays = _delays()
                if not self._session.over:
                    await asyncio.sleep(next(delays))
        except Exception as fault:
            # The hub's last word; or a mistake of ours, which must not leave a program waiting.
            self._session.end(fault)
        finally:
            self._answered.set()

    async def _visit(self) -> bool:
        """Connect and converse once; tell whether that went well for a while."""
        try:
            websocket = await self._connect()
        except (OSError, InvalidHandshake) as error:
            self._missing(_reason(error))
            return False
        loop = asyncio.get_running_loop()
        began = loop.time()
        closed = await self._converse(websocket)
        if not self._session.over:
            reason = closed.rcvd.reason if closed.rcvd is not None else ""
            self._missing(reason or str(closed))
        return loop.time() - began > LONGEST_RETRY

    async def _connect(self) -> WebSocket:
        try:
            websocket = await connect(
                node_url(self._hub, self._node),
                create_connection=WebSocket,
                compression=None,
                max_size=MAX_SIZE,
                open_timeout=OPENING,
                close_timeout=CLOSING,
                # A hub is next door: a proxy that the environment names is for the world outside.
                proxy=True if self._hub.startswith("wss:") else None,
            )
            assert isinstance(websocket, WebSocket)
            return websocket
        except InvalidStatus as error:
            status = error.response.status_code
            if status >= 500 or status in _TRY_LATER:
                raise
            text = error.response.body.decode("utf-8", "replace").strip()
            raise HubUnreachable(self._hub, f"HTTP {status}: {text[:500]}") from None
        except (InvalidURI, InvalidProxy, ValueError) as error:  # The last for odd host names.
            raise HubUnreachable(self._hub, str(error)) from None

    async def _converse(self, websocket: WebSocket) -> ConnectionClosed:
        """Talk until one side hangs up."""
        outbox = self._session.outbox
        greeting = self._session.greeting()
        outbox.open()
        writing = self._write(websocket, greeting, again=self._answered.is_set())
        writer = asyncio.create_task(writing, name=f"to {self._hub}")
        websocket.hand_to(self._take)
        try:
            self._found()
            while True:
                for _ in range(TURN):
                    # It returns at once while messages are left of what the socket had: unless the
                    # readers have a turn in between, a burst overflows their queues.
                    if not self._take(await websocket.receive()):
                        break
                await asyncio.sleep(0)
        except ConnectionClosed as closed:
            reason = closed
            if (fault := self._last_word(closed)) is not None:
                # Before the connection's loss is told, which would fail what waits for answers.
                self._session.end(fault)
        finally:
            self._session.lose()
            writer.cancel()
            await asyncio.wait({writer})
            websocket.transport.abort()  # Does nothing if the writer could hang up in good order.
        if not writer.cancelled():
            writer.result()
        return reason

    def _take(self, text: bytes) -> bool:
        """Hand on a message; tell whether there is room for another before the readers' turn."""
        try:
            self._session.receive(text)
        except Exception as fault:  # A mistake of ours, which must not leave a program waiting.
            self._session.end(fault)
        crowded, self._session.crowded = self._session.crowded, False
        return not crowded

    def _last_word(self, closed: ConnectionClosed) -> NodeError | None:
        """What ends the node for good, if that is why the hub has hung up."""
        code = closed.rcvd.code if closed.rcvd is not None else None
        if code == REPLACED.code:
            return NodeReplaced(f"another node took the name {self._node}")
        if code == KILLED.code:
            return NodeKilled(f"{self._node} was killed: somebody asked the hub to end it")
        return None

    async def _write(self, websocket: WebSocket, greeting: list[bytes], *, again: bool) -> None:
        """Send what there is to send until there never will be more, then hang up."""
        outbox = self._session.outbox
        try:
            for text in greeting:
                await websocket.send(text, text=True)
            if again:
                # The listeners lost their hub, too, and are back after a retry at the latest:
                # what was kept for them would reach nobody before.
                await self._session.ended(LONGEST_RETRY)
            outbox.offer_first_to(websocket.write_at_once)
            # At most once: a frame is taken just before it is written, so that none is sent twice.
            # What the socket still held when it broke is lost, and nobody can count it.
            while await outbox.arrival() and websocket.state is State.OPEN:
                await websocket.send(outbox.pop(), text=True)
        except ConnectionClosed:
            pass  # The reader hears of it, too.
        finally:
            await _hang_up(websocket)

    def _missing(self, reason: str) -> None:
        """Say that there is no hub, once each time."""
        if self._missed:
            return
        self._missed = True
        if self._answered.is_set():
            self._log.warning("Lost the hub at %s (%s); trying again.", self._hub, reason)
        else:
            self._log.warning(
                "Waiting for a hub at %s (%s). Start one with: python -m fibws.hub",
                self._hub,
                reason,
            )

    def _found(self) -> None:
        if self._missed:
            word = "back" if self._answered.is_set() else "there"
            self._log.info("The hub at %s is %s.", self._hub, word)
        self._missed = False
        self._answered.set()


async def _hang_up(websocket: WebSocket) -> None:
    with suppress(TimeoutError):
        # Its own close_timeout does not count while it waits for a full socket to drain.
        async with asyncio.timeout(CLOSING):
            await websocket.close()


def _delays() -> Iterator[float]:
    """Seconds to wait before each retry, with some jitter so that nodes come back one by one.

    All are shorter than LONGEST_RETRY, for who waits that long for others to have come back.
    """
    delay = FIRST_RETRY
    while True:
        yield delay * random.uniform(0.7, 0.9)
        delay = min(2 * delay, LONGEST_RETRY)


def _reason(error: Exception) -> str:
    """Why there is no connection, without the address, which whoever reads this knows."""
    if number := _ERRNO.search(str(error)):
        return os.strerror(int(number[1]))
    return getattr(error, "strerror", None) or str(error) or type(error).__name__
