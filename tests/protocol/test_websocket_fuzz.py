"""`FrameParser` in front of the library against the library alone: the outcome is the same."""

from __future__ import annotations

import random
import struct
import time
from collections.abc import Callable, Iterator

import pytest
from random_inputs import times
from websockets.client import ClientProtocol
from websockets.frames import Frame, Opcode
from websockets.protocol import State
from websockets.server import ServerProtocol
from websockets.uri import parse_uri

from fibws.protocol.websocket import LARGE, FrameParser, Payload

MAX_SIZE = 300


class Reader:
    """The library, and the messages that its frames make."""

    def __init__(self, masked: bool, max_size: int) -> None:
        self.protocol: ClientProtocol | ServerProtocol
        if masked:
            self.protocol = ServerProtocol(state=State.OPEN, max_size=max_size)
        else:
            uri = parse_uri("ws://hub/")
            self.protocol = ClientProtocol(uri, state=State.OPEN, max_size=max_size)
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

    def receive(self, data: bytes) -> None:
        """Process the bytes of one read."""
        self.feed(data)

    def fragmented(self, yes: bool) -> None:
        """Take note of whether a fragmented message has begun."""

    def closed(self) -> None:
        """Take note that the library reads no more."""

    def end(self) -> None:
        """The peer sends no more."""
        self.protocol.receive_eof()
        self.sent += self.protocol.data_to_send()

    def outcome(self) -> tuple[object, ...]:
        """All that the rest of the program, or the peer, could see."""
        protocol = self.protocol
        return (
            self.messages,
            [opcode for opcode, _ in self.controls],
            [data for _, data in self.controls],
            sum(len(data) for data in self.sent),
            self.sent.count(b""),
            protocol.state,
            protocol.close_rcvd,
            protocol.close_sent,
            repr(protocol.parser_exc),
        )


class ParserReader(Reader):
    """The parser and the library together, as a connection joins them.

    Args:
        turn: messages that the parser passes on before it pauses.
        go_on: that of `FrameParser`.
    """

    def __init__(
        self,
        masked: bool,
        max_size: int,
        turn: int = 10**9,
        go_on: Callable[[int], int] = lambda passed: 0,
    ) -> None:
        super().__init__(masked, max_size)
        self.parser = FrameParser(
            self.text,
            self.binary,
            self.feed,
            max_size=max_size,
            masked=masked,
            turn=turn,
            go_on=go_on,
        )

    def text(self, payload: Payload) -> None:
        self.messages.append((Opcode.TEXT, bytes(payload)))

    def binary(self, payload: Payload) -> None:
        self.messages.append((Opcode.BINARY, bytes(payload)))

    def receive(self, data: bytes) -> None:
        """Process the bytes of one read, partly in the parser's own buffer."""
        self.receive_within_turn(data)
        while self.parser.paused:
            self.parser.resume()

    def receive_within_turn(self, data: bytes) -> None:
        """Do the same, without going on where the parser pauses."""
        while data:
            if not self.parser.in_large:
                self.parser.receive(data)
                data = b""
            else:
                buffer = self.parser.buffer()
                size = min(len(buffer), len(data))
                buffer[:size] = data[:size]
                self.parser.filled(size)
                data = data[size:]

    def fragmented(self, yes: bool) -> None:
        self.parser.fragmented = yes

    def closed(self) -> None:
        self.parser.give_up()

    def end(self) -> None:
        self.parser.end()
        super().end()


@pytest.fixture(params=[True, False], ids=["server", "client"])
def masked(request: pytest.FixtureRequest) -> bool:
    return bool(request.param)


def test_random_streams_are_read_alike(masked: bool) -> None:
    chance = random.Random(0)
    messages = 0
    for number in range(times(20)):
        stream = b"".join(_frames(chance, masked))
        alone = Reader(masked, MAX_SIZE)
        parsed = ParserReader(masked, MAX_SIZE, turn=chance.choice((1, 2, 10**9)))
        for reader in (alone, parsed):
            for chunk in _cut(chance, stream):
                reader.receive(chunk)
            reader.end()
        assert parsed.outcome() == alone.outcome(), (number, stream)
        messages += len(alone.messages)
    assert messages > times(20)


def test_random_streams_with_large_messages_are_read_alike(masked: bool) -> None:
    chance = random.Random(0)
    max_size = 3 * LARGE
    for _ in range(times(0.5)):
        frames = [
            _frame(chance, chance.choice((0x1, 0x2)), bytes(chance.choice(LARGE_SIZES)), masked)
            for _ in range(3)
        ]
        frames += _frames(chance, masked)
        chance.shuffle(frames)
        stream = b"".join(frames)
        alone, parsed = Reader(masked, max_size), ParserReader(masked, max_size)
        for reader in (alone, parsed):
            for chunk in _cut(chance, stream, (1000, LARGE, len(stream))):
                reader.receive(chunk)
            reader.end()
        assert parsed.outcome() == alone.outcome()


@pytest.mark.parametrize("with_large", [False, True])
def test_random_streams_are_read_alike_in_turns_of_any_length(
    masked: bool, with_large: bool
) -> None:
    chance = random.Random(0)
    max_size = 3 * LARGE if with_large else MAX_SIZE
    pauses = 0
    for number in range(times(0.5 if with_large else 5)):
        frames = [*_frames(chance, masked)]
        if with_large:
            frames += [
                _frame(chance, 0x2, bytes(chance.choice(LARGE_SIZES)), masked) for _ in range(3)
            ]
            chance.shuffle(frames)
        stream = b"".join(frames)
        alone = Reader(masked, max_size)
        parsed = ParserReader(
            masked,
            max_size,
            turn=chance.choice((1, 2)),
            go_on=lambda passed: chance.choice((0, 0, 1, passed)),
        )
        sizes = (1000, LARGE, len(stream)) if with_large else (1, 10, 100, 1000)
        for chunk in _cut(chance, stream, sizes):
            alone.receive(chunk)
            if chance.random() < 0.2:
                parsed.parser.pause()
            was_paused = parsed.parser.paused
            before = len(parsed.messages), len(parsed.controls)
            parsed.receive_within_turn(chunk)
            if was_paused:
                assert (len(parsed.messages), len(parsed.controls)) == before
            pauses += parsed.parser.paused
            if parsed.parser.paused and chance.random() < 0.7:
                parsed.parser.resume()
        alone.end()
        while parsed.parser.paused:
            parsed.parser.resume()
        parsed.end()
        assert parsed.outcome() == alone.outcome(), number
    assert pauses > 20


LARGE_SIZES = (LARGE - 1, LARGE, LARGE + 1, 3 * LARGE, 3 * LARGE + 1)


@pytest.mark.long
def test_too_long_messages_are_skipped_in_any_pieces(masked: bool) -> None:
    chance = random.Random(0)
    lengths = (0, 5, 299, 300, 301, 1023, 1024, 1025, 70_000)
    seen: list[tuple[object, ...]] = []
    for _ in range(times(5)):
        sent = [
            (chance.choice((0x1, 0x2)), chance.randbytes(chance.choice(lengths))) for _ in range(10)
        ]
        stream = b"".join(_frame(chance, *each, masked) for each in sent)
        seen.clear()
        parser = FrameParser(
            lambda data: seen.append((0x1, bytes(data))),
            lambda data: seen.append((0x2, bytes(data))),
            lambda data: pytest.fail("the library reads it"),
            max_size=300,
            masked=masked,
            turn=chance.choice((1, 2, 10**9)),
            on_skipped=lambda size, first, is_text: seen.append((is_text, size, first)),
        )
        for chunk in _cut(chance, stream):
            parser.receive(chunk)
            while parser.paused:
                parser.resume()
        assert seen == [
            (opcode, data) if len(data) <= 300 else (opcode == 0x1, len(data), data[:1024])
            for opcode, data in sent
        ]
        assert not parser.kept_bytes


def test_whole_messages_are_read_at_once(masked: bool) -> None:
    chance = random.Random(1000)
    for _ in range(times(2)):
        stream = b"".join(_frame(chance, 0x1, _payload(chance), masked) for _ in range(5))
        alone, parsed = Reader(masked, MAX_SIZE), ParserReader(masked, MAX_SIZE)
        for chunk in _cut(chance, stream):
            alone.receive(chunk)
            parsed.receive(chunk)
            assert parsed.messages == alone.messages


def test_time_for_a_large_frame_does_not_depend_much_on_the_pieces() -> None:
    # A tail that grows by copying would take hundreds of times as long in small pieces.
    size = 8 << 20
    stream = b"\x81\xff" + struct.pack("!Q", size) + bytes(4) + bytes(size)
    taken = []
    for piece in (64 * 1024, 1024):
        messages: list[Payload] = []
        parser = FrameParser(
            messages.append, messages.append, lambda _: None, max_size=size, masked=True
        )
        began = time.thread_time()
        for start in range(0, len(stream), piece):
            parser.receive(stream[start : start + piece])
        taken.append(time.thread_time() - began)
        assert len(messages[0]) == size
    assert taken[1] < 20 * taken[0]


def _frames(chance: random.Random, masked: bool) -> Iterator[bytes]:
    """Yield mostly valid frames of all kinds, and now and then an error."""
    for _ in range(chance.randrange(1, 12)):
        kind = chance.random()
        if kind < 0.35:
            yield _frame(chance, 0x1, _payload(chance), masked)
        elif kind < 0.55:
            yield _frame(chance, 0x2, _payload(chance), masked)
        elif kind < 0.7:
            yield from _fragmented(chance, masked)
        elif kind < 0.85:
            payload = chance.randbytes(chance.randrange(126))
            yield _frame(chance, chance.choice((0x9, 0xA)), payload, masked)
        elif kind < 0.9:
            yield _close(chance, masked)
        else:
            yield _wrong(chance, masked)


def _payload(chance: random.Random) -> bytes:
    return chance.randbytes(chance.choice((0, 1, 7, 100, 125, 126, 127, 299, 300)))


def _frame(
    chance: random.Random,
    opcode: int,
    payload: bytes,
    masked: bool,
    *,
    fin: bool = True,
    length: int = -1,
) -> bytes:
    """A frame; its length may be written in more bytes than needed, and be a lie."""
    size = len(payload) if length < 0 else length
    forms = [form for form, most in ((125, 125), (126, 65535), (127, 2**64)) if size <= most]
    form = forms[0] if chance.random() < 0.9 else chance.choice(forms)
    bit = 0x80 if masked else 0
    head = bytes((fin << 7 | opcode,))
    if form == 125:
        head += bytes((bit | size,))
    elif form == 126:
        head += bytes((bit | 126,)) + struct.pack("!H", size)
    else:
        head += bytes((bit | 127,)) + struct.pack("!Q", size)
    if not masked:
        return head + payload
    key = bytes(4) if chance.random() < 0.2 or len(payload) > 1000 else chance.randbytes(4)
    if any(key):
        payload = bytes(byte ^ key[at % 4] for at, byte in enumerate(payload))
    return head + key + payload


def _fragmented(chance: random.Random, masked: bool) -> Iterator[bytes]:
    """Yield a message in pieces, control frames between them; it may be cut off or too large."""
    pieces = [chance.randbytes(chance.choice((0, 1, 50, 126))) for _ in range(chance.randrange(4))]
    yield _frame(chance, chance.choice((0x1, 0x2)), _payload(chance), masked, fin=False)
    for piece in pieces:
        if chance.random() < 0.3:
            yield _frame(chance, 0x9, piece[:20], masked)
        yield _frame(chance, 0x0, piece, masked, fin=False)
    if chance.random() < 0.9:
        yield _frame(chance, 0x0, chance.randbytes(chance.randrange(20)), masked)


def _close(chance: random.Random, masked: bool) -> bytes:
    codes = (1000, 1001, 1003, 1004, 1005, 1006, 1011, 1015, 2999, 3000, 4001, 4999, 5000, 0)
    payloads = (
        b"",
        b"x",
        struct.pack("!H", chance.choice(codes)),
        struct.pack("!H", chance.choice(codes)) + b"why",
        struct.pack("!H", 1000) + b"\xff",
    )
    return _frame(chance, 0x8, chance.choice(payloads), masked)


def _wrong(chance: random.Random, masked: bool) -> bytes:
    payload = _payload(chance)
    control, data = (0x8, 0x9, 0xA), (0x0, 0x1, 0x2)
    lengths = (2**16, 2**62, 2**63, 2**64 - 1)
    wrongs = (
        lambda: _frame(chance, 0x1, payload, not masked),
        lambda: (
            bytes((0x81 | chance.choice((0x10, 0x20, 0x40)),))
            + _frame(chance, 0x1, payload, masked)[1:]
        ),
        lambda: _frame(chance, chance.choice((0x3, 0x7, 0xB, 0xF)), payload, masked),
        lambda: _frame(chance, chance.choice(data), payload, masked, length=MAX_SIZE + 1),
        lambda: _frame(chance, 0x1, payload, masked, length=chance.choice(lengths)),
        lambda: _frame(chance, 0x0, payload, masked),  # It continues nothing.
        lambda: (
            _frame(chance, 0x1, payload, masked, fin=False) + _frame(chance, 0x1, payload, masked)
        ),
        lambda: _frame(chance, chance.choice(control), payload, masked, fin=False),
        lambda: _frame(chance, chance.choice(control), bytes(126), masked),
        lambda: _frame(chance, 0x1, payload, masked)[: chance.randrange(1, 7)],
        lambda: chance.randbytes(chance.randrange(1, 30)),
    )
    return chance.choice(wrongs)()


def _cut(
    chance: random.Random, stream: bytes, sizes: tuple[int, ...] = (1, 3, 10, 100, 1000, 10**6)
) -> Iterator[bytes]:
    """Yield the stream in pieces: of single bytes, of random sizes, or whole."""
    most = chance.choice(sizes)
    start = 0
    while start < len(stream):
        size = chance.randint(1, most)
        yield stream[start : start + size]
        start += size
