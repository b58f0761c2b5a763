"""The splitter in front of the library against the library alone: nobody can tell them apart."""

from __future__ import annotations

import random
import struct
import time
from collections.abc import Iterator

import pytest
from websockets.frames import Frame, Opcode
from websockets.protocol import State
from websockets.server import ServerProtocol

from fibws.hub.settings import KIB, MIB
from fibws.hub.splitter import Splitter

MAX_SIZE = 300
STREAMS = 4000
SEEDS = 10


class Reader:
    """What both readers have: the library, and the messages that came of its frames."""

    def __init__(self) -> None:
        self.protocol = ServerProtocol(state=State.OPEN, max_size=MAX_SIZE)
        self.messages: list[tuple[Opcode, bytes]] = []
        self.sent: list[bytes] = []
        self.controls: list[tuple[Opcode, bytes]] = []
        self._kind = Opcode.TEXT
        self._fragments: list[bytes] = []

    def feed(self, data: bytes) -> None:
        """Let the library read."""
        self.protocol.receive_data(data)
        for event in self.protocol.events_received():
            assert isinstance(event, Frame)
            if event.opcode in (Opcode.TEXT, Opcode.BINARY, Opcode.CONT):
                if event.opcode is not Opcode.CONT:
                    self._kind = event.opcode
                self._fragments.append(bytes(event.data))
                self.fragmented(not event.fin)
                if event.fin:
                    message, self._fragments = b"".join(self._fragments), []
                    self.messages.append((self._kind, message))
            else:
                self.controls.append((event.opcode, bytes(event.data)))
        if self.protocol.state is not State.OPEN:
            self.closed()
        self.sent += self.protocol.data_to_send()

    def fragmented(self, yes: bool) -> None:
        """Take note of whether a message is under way."""

    def closed(self) -> None:
        """Take note that the library wants no more."""

    def end(self) -> None:
        """The client sends no more."""
        self.protocol.receive_eof()
        self.sent += self.protocol.data_to_send()

    def outcome(self) -> tuple[object, ...]:
        """All that the rest of the hub, or the client, could see."""
        protocol = self.protocol
        return (
            self.messages,
            self.controls,
            b"".join(self.sent),
            self.sent.count(b""),
            protocol.state,
            protocol.close_rcvd,
            protocol.close_sent,
            repr(protocol.parser_exc),
        )


class SplitReader(Reader):
    """The splitter and the library together, as `Connection` joins them."""

    def __init__(self) -> None:
        super().__init__()
        self.splitter = Splitter(self.text, self.feed, max_size=MAX_SIZE)

    def text(self, payload: bytes) -> None:
        """Take a whole text message that the library never saw."""
        self.messages.append((Opcode.TEXT, payload))

    def receive(self, data: bytes) -> None:
        self.splitter.receive(data)

    def fragmented(self, yes: bool) -> None:
        self.splitter.fragmented = yes

    def closed(self) -> None:
        self.splitter.give_up()

    def end(self) -> None:
        self.splitter.end()
        super().end()


@pytest.mark.parametrize("seed", range(SEEDS))
def test_random_streams_are_read_alike(seed: int) -> None:
    chance = random.Random(seed)
    messages = 0
    for number in range(STREAMS // SEEDS):
        stream = b"".join(_frames(chance))
        alone, split = Reader(), SplitReader()
        for chunk in _cut(chance, stream):
            alone.feed(chunk)
        for chunk in _cut(chance, stream):
            split.receive(chunk)
        alone.end()
        split.end()
        assert split.outcome() == alone.outcome(), (seed, number, stream)
        messages += len(alone.messages)
    assert messages > STREAMS // SEEDS


@pytest.mark.parametrize("seed", range(3))
def test_what_is_whole_is_read_at_once(seed: int) -> None:
    """Not only in the end: after each chunk, the messages that it completed have come."""
    chance = random.Random(1000 + seed)
    for _ in range(100):
        stream = b"".join(_frame(chance, 0x1, _payload(chance)) for _ in range(5))
        alone, split = Reader(), SplitReader()
        for chunk in _cut(chance, stream):
            alone.feed(chunk)
            split.receive(chunk)
            assert split.messages == alone.messages


def test_a_large_frame_is_read_in_time_whatever_the_pieces() -> None:
    # R6: a tail that grows by copying takes hundreds of times as long in small pieces.
    size = 8 * MIB
    stream = b"\x81\xff" + struct.pack("!Q", size) + bytes(4) + bytes(size)
    taken = []
    for piece in (64 * KIB, KIB):
        messages: list[bytes] = []
        splitter = Splitter(messages.append, lambda _: None, max_size=size)
        began = time.thread_time()
        for start in range(0, len(stream), piece):
            splitter.receive(stream[start : start + piece])
        taken.append(time.thread_time() - began)
        assert len(messages[0]) == size
    assert taken[1] < 20 * taken[0]


def _frames(chance: random.Random) -> Iterator[bytes]:
    """Mostly good frames of all kinds; now and then something that is wrong."""
    for _ in range(chance.randrange(1, 12)):
        kind = chance.random()
        if kind < 0.45:
            yield _frame(chance, 0x1, _payload(chance))
        elif kind < 0.55:
            yield _frame(chance, 0x2, _payload(chance))
        elif kind < 0.7:
            yield from _fragmented(chance)
        elif kind < 0.85:
            yield _frame(chance, chance.choice((0x9, 0xA)), chance.randbytes(chance.randrange(126)))
        elif kind < 0.9:
            yield _close(chance)
        else:
            yield _wrong(chance)


def _payload(chance: random.Random) -> bytes:
    return chance.randbytes(chance.choice((0, 1, 7, 100, 125, 126, 127, 299, 300)))


def _frame(
    chance: random.Random, opcode: int, payload: bytes, *, fin: bool = True, length: int = -1
) -> bytes:
    """A masked frame; its length may be written in more bytes than needed, and be a lie."""
    size = len(payload) if length < 0 else length
    forms = [form for form, most in ((125, 125), (126, 65535), (127, 2**64)) if size <= most]
    form = forms[0] if chance.random() < 0.9 else chance.choice(forms)
    head = bytes((fin << 7 | opcode,))
    if form == 125:
        head += bytes((0x80 | size,))
    elif form == 126:
        head += b"\xfe" + struct.pack("!H", size)
    else:
        head += b"\xff" + struct.pack("!Q", size)
    mask = chance.randbytes(4)
    return head + mask + bytes(byte ^ mask[at % 4] for at, byte in enumerate(payload))


def _fragmented(chance: random.Random) -> Iterator[bytes]:
    """A message in pieces, control frames between them; it may end too soon, or be too large."""
    pieces = [chance.randbytes(chance.choice((0, 1, 50, 126))) for _ in range(chance.randrange(4))]
    yield _frame(chance, chance.choice((0x1, 0x2)), _payload(chance), fin=False)
    for piece in pieces:
        if chance.random() < 0.3:
            yield _frame(chance, 0x9, piece[:20])
        yield _frame(chance, 0x0, piece, fin=False)
    if chance.random() < 0.9:
        yield _frame(chance, 0x0, chance.randbytes(chance.randrange(20)))


def _close(chance: random.Random) -> bytes:
    codes = (1000, 1001, 1003, 1004, 1005, 1006, 1011, 1015, 2999, 3000, 4001, 4999, 5000, 0)
    payloads = (
        b"",
        b"x",
        struct.pack("!H", chance.choice(codes)),
        struct.pack("!H", chance.choice(codes)) + b"why",
        struct.pack("!H", 1000) + b"\xff",
    )
    return _frame(chance, 0x8, chance.choice(payloads))


def _wrong(chance: random.Random) -> bytes:
    payload = _payload(chance)
    wrongs = (
        lambda: bytes((0x81, len(payload[:125]))) + payload[:125],  # Not masked.
        lambda: (
            bytes((0x81 | chance.choice((0x10, 0x20, 0x40)),)) + _frame(chance, 0x1, payload)[1:]
        ),
        lambda: _frame(chance, chance.choice((0x3, 0x7, 0xB, 0xF)), payload),
        lambda: _frame(chance, chance.choice((0x0, 0x1, 0x2)), payload, length=MAX_SIZE + 1),
        lambda: _frame(
            chance, 0x1, payload, length=chance.choice((2**16, 2**62, 2**63, 2**64 - 1))
        ),
        lambda: _frame(chance, 0x0, payload),  # Continues nothing.
        lambda: _frame(chance, 0x1, payload, fin=False) + _frame(chance, 0x1, payload),
        lambda: _frame(chance, chance.choice((0x8, 0x9, 0xA)), payload, fin=False),
        lambda: _frame(chance, chance.choice((0x8, 0x9, 0xA)), bytes(126)),
        lambda: _frame(chance, 0x1, payload)[: chance.randrange(1, 7)],  # The rest is misread.
        lambda: chance.randbytes(chance.randrange(1, 30)),
    )
    return chance.choice(wrongs)()


def _cut(chance: random.Random, stream: bytes) -> Iterator[bytes]:
    """The stream in pieces: of single bytes, of random sizes, or whole."""
    most = chance.choice((1, 3, 10, 100, 1000, len(stream)))
    start = 0
    while start < len(stream):
        size = chance.randint(1, most)
        yield stream[start : start + size]
        start += size
