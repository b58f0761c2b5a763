"""A connection on which messages take short ways, for as long as nothing is in them.

The library hands each message to a task, and takes each from one: two turns of the loop, which at a
calm rate are much of what a message takes from node to node.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from websockets.asyncio.client import ClientConnection
from websockets.frames import Frame, Opcode
from websockets.protocol import Event, State

TURN = 64
"""Messages that may go a short way in one turn of the loop: then others have theirs."""

_DATA = (Opcode.TEXT, Opcode.BINARY)


class WebSocket(ClientConnection):
    """A client's connection; nobody sends on it in fragments."""

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self._take: Callable[[bytes], bool] | None = None
        self._writes_left = self._takes_left = TURN
        self._waiting = 0
        """Messages that have come, and wait for `receive`."""

    def write_at_once(self, text: bytes) -> bool:
        """Send a message, unless the socket is behind or it is others' turn; tell whether it was.

        It is for whoever has no other message under way.
        """
        if not self._writes_left or self.state is not State.OPEN or self.transport.is_closing():
            return False
        if self.transport.get_write_buffer_size():
            return False
        if self._writes_left == TURN:
            self.loop.call_soon(self._renew)
        self._writes_left -= 1
        self.transport.write(Frame(Opcode.TEXT, text).serialize(mask=True))
        if self.transport.is_closing() or self.transport.get_write_buffer_size():
            # A loop that another thread acts for sleeps, and does not know of what is left to do.
            self.loop.call_soon_threadsafe(self._renew)
        return True

    def hand_to(self, take: Callable[[bytes], bool]) -> None:
        """From now on give a message to a function if no other one waits for `receive`.

        Args:
            take: must not raise; it tells whether it may be given another one in the same turn.
        """
        self._take = take

    async def receive(self) -> bytes:
        """Wait for a message that was not handed on.

        Raises:
            ConnectionClosed: no more will come.
        """
        text = await self.recv(decode=False)
        self._waiting -= 1
        return text

    def process_event(self, event: Event) -> None:
        """Take what the socket has brought; the library calls this."""
        if isinstance(event, Frame) and event.fin:
            if self._take is not None and event.opcode in _DATA and self._is_free():
                if not self._take(bytes(event.data)):
                    self._takes_left = 0
                return
            self._waiting += event.opcode in _DATA or event.opcode is Opcode.CONT
        super().process_event(event)

    def _is_free(self) -> bool:
        """Whether the next message may go the short way."""
        if self._waiting or not self._takes_left:
            return False
        if self._takes_left == TURN:
            self.loop.call_soon(self._renew)
        self._takes_left -= 1
        return True

    def _renew(self) -> None:
        self._writes_left = self._takes_left = TURN
