"""Reading of one client after its handshake: bytes in, whole messages to its endpoint.

A client that sends more than its limits allow has its messages dropped here, before they are
decoded: the endpoint only reports that.
"""

from __future__ import annotations

import logging
import math
import zlib
from functools import partial
from itertools import chain
from typing import Protocol

from websockets.frames import Frame, Opcode

from fibws.errors import InvalidUtf8
from fibws.hub.settings import KIB, Settings
from fibws.hub.websocket.deflate_extension import DeflatedFrame
from fibws.hub.websocket.endpoint import STRANGER_BYTES, Endpoint, Work
from fibws.hub.websocket.quotas import CHARGED_BYTES, ClientQuotas, Meter
from fibws.hub.websocket.turns import Turns
from fibws.protocol.deflate import inflate
from fibws.protocol.websocket import (
    BINARY,
    DEFLATED,
    FRAGMENTS,
    INVALID_DEFLATE,
    INVALID_UTF8,
    TEXT,
    TOO_LARGE,
    CloseReason,
    FrameParser,
    Payload,
)

logger = logging.getLogger("fibws.hub")

READ_SIZE = 512 * KIB
"""Most bytes of a large message that are read at once."""
MAX_FRAGMENTS = 4096
"""Frames that one fragmented message may have: empty ones do not count towards its size."""


class ReadBuffers:
    """The buffers of one hub that sockets are read into.

    What is read is used up within the same callback, so that one buffer serves all connections. A
    small one makes a flooding publisher take turns with the others; the other one is for
    connections in the middle of a longer frame.
    """

    __slots__ = ("medium", "small")

    def __init__(self) -> None:
        self.small = memoryview(bytearray(16 * KIB))
        self.medium = memoryview(bytearray(256 * KIB))


class ReadClient(Protocol):
    """A client's connection, as far as its reader uses it."""

    @property
    def name(self) -> str:
        """The client's name in the log."""

    def feed(self, data: bytes) -> None:
        """Pass the bytes of all other frames to the library, which calls `MessageReader.add`."""

    def fail(self, reason: CloseReason) -> None:
        """Close because of a fault of the client."""

    def grow(self, size: int) -> None:
        """Count bytes that are kept of a message beyond those that came."""


class MessageReader:
    """Splits what a client sends into messages, and measures how much that is.

    Until `enter` a message may have `STRANGER_BYTES` at most.

    Args:
        quotas: the client's; a login may change them at any time.
    """

    __slots__ = (
        "_binary",
        "_buffers",
        "_client",
        "_exempt",
        "_fragments",
        "_frames",
        "_inflated",
        "_is_deflated",
        "_medium",
        "_others",
        "_parser",
        "_quotas",
        "_settings",
        "_stopped",
        "_turns",
        "_work",
        "_work_bytes",
        "dropped",
        "endpoint",
    )

    def __init__(
        self,
        client: ReadClient,
        quotas: ClientQuotas,
        settings: Settings,
        turns: Turns,
        buffers: ReadBuffers,
    ) -> None:
        self.endpoint: Endpoint | None = None
        """Receives the messages; to be set before the first one comes."""
        self.dropped = 0
        """Messages that were dropped because they were more than the client may send."""
        self._client = client
        self._quotas = quotas
        self._buffers = buffers
        self._turns = turns
        self._work: Work | None = None
        """What is left to do of a message; all that follows waits."""
        self._work_bytes = 0
        """The bytes of that message."""
        self._frames: list[Frame] = []
        """Frames that the library has read behind it."""
        self._medium = buffers.small
        """The buffer for connections in the middle of a longer frame."""
        self._fragments: list[bytes] = []
        self._binary = False
        self._is_deflated = False
        """Whether the fragments are of a compressed message."""
        self._inflated: tuple[Payload, bool] | None = None
        """A message that was compressed and is to be handled, and whether it is binary."""
        self._stopped = False
        self._exempt = False
        """Whether the data that is read now costs nothing, as its messages are dropped."""
        self._others = 0
        """Messages received that the parser has not counted."""
        self._parser = FrameParser(
            self._on_text,
            self._on_binary,
            client.feed,
            max_size=min(STRANGER_BYTES, settings.max_message_size),
            masked=True,
            turn=1,
            go_on=turns.go_on,
        )
        self._settings = settings

    def enter(self) -> None:
        """Accept messages of any size that the settings allow: the client has logged in."""
        self._medium = self._buffers.medium
        self._parser.max_size = self._settings.max_message_size
        if not self._settings.fast_framing:
            self._parser.give_up()

    def accept_deflated(self) -> None:
        """Accept compressed messages from now on."""
        self._parser.deflated = {
            TEXT | DEFLATED: partial(self._begin_inflating, binary=False),
            BINARY | DEFLATED: partial(self._begin_inflating, binary=True),
        }

    @property
    def messages(self) -> int:
        """How many messages have come, pings and pongs included."""
        return self._others + self._parser.messages

    @property
    def kept_bytes(self) -> int:
        """Bytes that are kept of messages that came in part, or are handled in part."""
        return self._parser.kept_bytes + self._work_bytes + sum(map(len, self._fragments))

    @property
    def is_paused(self) -> bool:
        """Whether frames that were read wait for `resume`."""
        return self._parser.paused

    @property
    def is_dropping(self) -> bool:
        """Whether the client's messages are dropped, as it sends too much."""
        meter = self._quotas.meter
        return meter is not None and meter.refusal is not None

    # Bytes.

    def buffer(self) -> memoryview:
        """Return the buffer for the next bytes of the socket."""
        parser = self._parser
        if parser.in_large:
            return parser.buffer()[:READ_SIZE]
        small = self._buffers.small
        return self._medium if parser.missing > len(small) else small

    def filled(self, size: int, now: float) -> bool:
        """Process bytes that were read into `buffer`.

        Args:
            now: seconds of the clock of `Turns`.

        Returns:
            Whether the client should wait for its turn, as it sends much.
        """
        parser, meter = self._parser, self._quotas.meter
        if meter is not None and meter.refusal is not None:
            self._continue_dropping(meter, now)
        full = False
        if parser.in_large:
            parser.filled(size)
        else:
            buffer = self.buffer()
            full = size == len(buffer)
            parser.receive(bytes(buffer[:size]))
        held = parser.paused
        meter = self._quotas.meter  # A login in these bytes may have changed it.
        if meter is None:
            return full or held
        meter.uncharged_bytes += size
        self._measure(meter, now)
        return full or held or meter.refusal is not None

    def receive(self, data: bytes) -> None:
        """Process bytes that came with the handshake's request."""
        self._parser.receive(data)

    def pause(self) -> None:
        """Keep all bytes until `resume`."""
        self._parser.pause()

    def resume(self, now: float) -> None:
        """Continue with the message and the bytes that were kept, for one turn."""
        meter = self._quotas.meter
        if meter is not None and meter.refusal is not None:
            self._continue_dropping(meter, now)
        if self._take_steps():
            self._parser.resume()
        meter = self._quotas.meter  # A login in these bytes may have changed it.
        if meter is not None:
            self._measure(meter, now)

    def do_first(self, work: Work) -> None:
        """Do something before all that the client has sent, for one turn at first."""
        if self._stopped:
            return
        self._work = work if self._work is None else chain(work, self._work)
        if not self._take_steps():
            self._parser.pause()

    def end(self) -> None:
        """Pass the rest of a frame to the library: the client sends no more."""
        self._parser.end()

    def give_up(self) -> None:
        """Pass everything to the library from now on."""
        self._parser.give_up()

    def stop(self) -> None:
        """Ignore all further messages.

        The library reads on behind a close frame, and behind an error.
        """
        self._stopped = True
        self._free()

    def finish(self) -> None:
        """Do at once what is left of messages: the client has closed behind them."""
        while not self._take_steps(to_the_end=True):
            pass

    def release(self) -> None:
        """Free the memory of incomplete messages, and references that would keep the client."""
        self._free()
        self.endpoint = None
        del self._parser, self._client

    def _free(self) -> None:
        self._fragments = []
        self._frames = []
        self._inflated = None
        self._work, self._work_bytes = None, 0

    # Messages.

    def add(self, frame: Frame) -> None:
        """Process a frame that the library has read: of control, or part of a message."""
        if self._work is not None:
            self._frames.append(frame)  # Without fast framing the library reads several at once.
            return
        self._others += 1
        if frame.opcode is Opcode.PING:
            self.dropped += self.is_dropping
        elif frame.opcode in (Opcode.TEXT, Opcode.BINARY, Opcode.CONT) and not self._stopped:
            self._add_fragment(frame)

    def count_operations(self, count: int) -> None:
        """Count operations of a message beyond the first as messages, too."""
        self._others += count
        if self._quotas.meter is not None:
            self._quotas.meter.due = -math.inf

    def _add_fragment(self, frame: Frame) -> None:
        if len(self._fragments) == MAX_FRAGMENTS:
            self._client.fail(FRAGMENTS)
            return
        if frame.opcode is not Opcode.CONT:
            self._binary = frame.opcode is Opcode.BINARY
            self._is_deflated = isinstance(frame, DeflatedFrame)
        self._fragments.append(bytes(frame.data))
        parser = self._parser
        parser.fragmented = not frame.fin
        if frame.fin:
            message, self._fragments = b"".join(self._fragments), []
            if self._is_deflated:
                self._begin_inflating(message, binary=self._binary)
            else:
                on_message = parser.on_binary if self._binary else parser.on_text
                on_message(message)

    def _on_text(self, text: Payload) -> None:
        assert self.endpoint is not None
        try:
            work = self.endpoint.receive_text(text)
        except InvalidUtf8:
            self._client.fail(INVALID_UTF8)
        except Exception:
            # An exception here would end the connection of a client that did nothing wrong.
            logger.exception("%s: an operation failed.", self._client.name)
        else:
            if work is not None:
                self._begin(work, len(text))

    def _on_binary(self, data: Payload) -> None:
        assert self.endpoint is not None
        try:
            work = self.endpoint.receive_binary(data)
        except Exception:
            logger.exception("%s: an operation failed.", self._client.name)
        else:
            if work is not None:
                self._begin(work, len(data))

    def _begin_inflating(self, data: Payload, *, binary: bool) -> None:
        self._begin(self._inflate(data, binary=binary), len(data))

    def _inflate(self, data: Payload, *, binary: bool) -> Work:
        """Inflate a compressed message, which may be a thousand times as long."""
        try:
            message = yield from inflate(data, self._parser.max_size, self._count_inflated)
        except OverflowError as error:
            self._client.fail(CloseReason(TOO_LARGE, str(error)))
        except zlib.error:
            self._client.fail(INVALID_DEFLATE)
        else:
            self._inflated = message, binary

    def _count_inflated(self, size: int) -> None:
        """Count a piece of an inflated message as if it had come so."""
        self._work_bytes += size
        self._client.grow(size)
        if self._quotas.meter is not None:
            self._quotas.meter.uncharged_bytes += size

    def _begin(self, work: Work, size: int) -> None:
        """Do what is left of a message of some bytes; in further turns if it takes long."""
        if self._stopped:
            return
        self._work, self._work_bytes = work, size
        if not self._take_steps():
            self._parser.pause()

    def _take_steps(self, *, to_the_end: bool = False) -> bool:
        """Continue with a message until the turn is over; return whether nothing is left of it."""
        work = self._work
        if work is None:
            return True
        try:
            for _ in work:
                if self._work is not work:
                    return True  # The connection is closed.
                if not to_the_end and self._turns.is_over():
                    return False
        except InvalidUtf8:
            self._client.fail(INVALID_UTF8)
        except Exception:
            logger.exception("%s: an operation failed.", self._client.name)
        self._work, self._work_bytes = None, 0
        if self._inflated is not None:
            (message, binary), self._inflated = self._inflated, None
            on_message = self._parser.on_binary if binary else self._parser.on_text
            on_message(message)
        while self._frames and self._work is None:
            self.add(self._frames.pop(0))
        return self._work is None

    # How much the client sends.

    def accept(self) -> None:
        """Drop no messages from now on: the client's quotas have changed."""
        self._parser.on_text, self._parser.on_binary = self._on_text, self._on_binary

    def _measure(self, meter: Meter, now: float) -> None:
        """Charge what was read lately; drop messages from now on if that was too much."""
        if now < meter.due and meter.uncharged_bytes < CHARGED_BYTES:
            return
        size, meter.uncharged_bytes = meter.uncharged_bytes, 0
        if self._exempt or self.endpoint is None:
            return
        meter.charge(self.messages - meter.charged, size, now)
        if meter.refusal is not None:
            self._parser.on_text, self._parser.on_binary = self._drop_text, self._drop_binary

    def _continue_dropping(self, meter: Meter, now: float) -> None:
        """Continue to drop messages, or accept them again if it is time."""
        self._exempt = False
        if meter.resumes(now):
            meter.charged = self.messages
            meter.uncharged_bytes = 0
            self.accept()
        else:
            # A message that began before is still to be paid for.
            paid = (self._on_text, self._on_binary, *self._parser.deflated.values())
            self._exempt = self._parser.large_taker not in paid

    def _drop_text(self, text: Payload) -> None:
        self._drop(text, is_text=True)

    def _drop_binary(self, data: Payload) -> None:
        self._drop(data, is_text=False)

    def _drop(self, data: Payload, *, is_text: bool) -> None:
        """Drop a message of which the endpoint reports why."""
        meter = self._quotas.meter
        assert meter is not None
        assert self.endpoint is not None
        self.dropped += 1
        try:
            work = self.endpoint.refuse(data, meter.reason, is_text=is_text)
        except InvalidUtf8:
            self._client.fail(INVALID_UTF8)
        except Exception:
            logger.exception("%s: an operation could not be refused.", self._client.name)
        else:
            if work is not None:
                self._begin(work, len(data))
