"""WebSocket frames: as the library makes them, and split where the library splits them."""

from __future__ import annotations

import pytest
from websockets.frames import Close, Frame, Opcode

from fibws.protocol import websocket
from fibws.protocol.websocket import (
    BINARY,
    LARGE,
    TEXT,
    CloseReason,
    FrameParser,
    Payload,
    client_frame,
    client_header,
    client_payload,
    server_frame,
    server_header,
)

SIZES = [0, 1, 125, 126, 127, 65535, 65536, 100_000]
OPCODES = {TEXT: Opcode.TEXT, BINARY: Opcode.BINARY}
KEY = b"\x01\xf2\x33\x84"
REASONS = {name: each for name, each in vars(websocket).items() if isinstance(each, CloseReason)}

Came = list[tuple[str, bytes]]


@pytest.mark.parametrize("reason", REASONS.values(), ids=REASONS)
def test_close_reason_fits_into_a_close_frame(reason: CloseReason) -> None:
    close = Close(reason.code, reason.reason)
    close.check()
    assert len(close.serialize()) <= 125


def test_close_reasons_differ() -> None:
    assert len({each.reason for each in REASONS.values()}) == len(REASONS) > 0


@pytest.mark.parametrize("first", OPCODES)
@pytest.mark.parametrize("size", SIZES)
def test_server_frame_is_the_librarys(first: int, size: int) -> None:
    data = bytes(range(256)) * (size // 256 + 1)
    data = data[:size]
    assert server_frame(first, data) == Frame(OPCODES[first], data).serialize(mask=False)
    assert server_frame(first, data) == server_header(first, size) + data


@pytest.mark.parametrize("first", OPCODES)
@pytest.mark.parametrize("size", SIZES)
def test_client_frame_is_the_librarys(
    first: int, size: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = bytes(range(256)) * (size // 256 + 1)
    data = data[:size]
    for key in (bytes(4), KEY):
        monkeypatch.setattr("websockets.frames.secrets.token_bytes", lambda size, key=key: key)
        frame = client_frame(first, data, key)
        assert frame == Frame(OPCODES[first], data).serialize(mask=True)
        assert frame[: -size or None] == client_header(first, size, key)
    assert client_payload(client_frame(first, data)) == data


def frame(opcode: Opcode, data: bytes, masked: bool, *, fin: bool = True) -> bytes:
    return Frame(opcode, data, fin).serialize(mask=masked)


class Parsed:
    """A parser with its output; other bytes are joined."""

    def __init__(self, masked: bool, *, max_size: int = 1000, turn: int = 1000) -> None:
        self.came: Came = []
        self.parser = FrameParser(
            lambda data: self.came.append(("text", bytes(data))),
            lambda data: self.came.append(("binary", bytes(data))),
            self._other,
            max_size=max_size,
            masked=masked,
            turn=turn,
        )

    def _other(self, data: bytes) -> None:
        if self.came and self.came[-1][0] == "other":
            data = self.came.pop()[1] + data
        self.came.append(("other", data))

    def receive(self, data: bytes) -> Came:
        self.parser.receive(data)
        return self.came


@pytest.fixture(params=[True, False], ids=["masked", "unmasked"])
def masked(request: pytest.FixtureRequest) -> bool:
    return bool(request.param)


def mixed(masked: bool) -> tuple[bytes, Came]:
    """Frames of all kinds with the expected output."""
    ping = frame(Opcode.PING, b"are you there?", masked)
    first = frame(Opcode.TEXT, b"one ", masked, fin=False)
    rest = frame(Opcode.CONT, b"message", masked)
    stream = (
        frame(Opcode.TEXT, b"one", masked)
        + ping
        + first
        + rest
        + frame(Opcode.BINARY, b"two" * 50, masked)
        + frame(Opcode.TEXT, b"", masked)
        + ping
    )
    return stream, [
        ("text", b"one"),
        ("other", ping + first + rest),
        ("binary", b"two" * 50),
        ("text", b""),
        ("other", ping),
    ]


def test_messages_come_whole_and_other_frames_as_bytes(masked: bool) -> None:
    stream, came = mixed(masked)
    assert Parsed(masked).receive(stream) == came


def test_cut_anywhere_makes_no_difference(masked: bool) -> None:
    stream, came = mixed(masked)
    for cut in range(len(stream) + 1):
        parsed = Parsed(masked)
        parsed.receive(stream[:cut])
        assert parsed.receive(stream[cut:]) == came


@pytest.mark.parametrize("size", [1, 2, 3, 5, 7, 13, 100])
def test_pieces_of_any_size_make_no_difference(masked: bool, size: int) -> None:
    stream, came = mixed(masked)
    parsed = Parsed(masked)
    for start in range(0, len(stream), size):
        parsed.receive(stream[start : start + size])
    assert parsed.came == came


@pytest.mark.parametrize("size", [LARGE - 1, LARGE, LARGE + 1, 3 * LARGE])
@pytest.mark.parametrize("piece", [1000, LARGE // 2, 10 * LARGE])
def test_large_message_is_read_into_a_buffer_of_its_own(
    masked: bool, size: int, piece: int
) -> None:
    large = bytes(range(256)) * (size // 256 + 1)
    large = large[:size]
    stream = frame(Opcode.BINARY, large, masked) + frame(Opcode.TEXT, b"next", masked)
    parsed = Parsed(masked, max_size=4 * LARGE)
    used = 0
    start = 0
    while start < len(stream):
        if not parsed.parser.in_large:
            parsed.receive(stream[start : start + piece])
            start += piece
            continue
        buffer = parsed.parser.buffer()
        data = stream[start : start + min(piece, len(buffer))]
        buffer[: len(data)] = data
        parsed.parser.filled(len(data))
        start += len(data)
        used += len(data)
    assert parsed.came == [("binary", large), ("text", b"next")]
    assert not parsed.parser.in_large
    if piece < size and size >= LARGE:
        assert used > 0


def test_large_message_may_also_come_by_receive(masked: bool) -> None:
    large = b"large" * LARGE
    parsed = Parsed(masked, max_size=len(large))
    stream = frame(Opcode.TEXT, large, masked) + frame(Opcode.TEXT, b"next", masked)
    for start in range(0, len(stream), 1000):
        parsed.receive(stream[start : start + 1000])
    assert parsed.came == [("text", large), ("text", b"next")]


def test_other_frame_is_passed_on_before_it_is_whole(masked: bool) -> None:
    ping = frame(Opcode.PING, b"are you there?", masked)
    assert Parsed(masked).receive(ping[:8]) == [("other", ping[:8])]


def test_message_that_is_too_large_is_left_to_the_library(masked: bool) -> None:
    whole = frame(Opcode.TEXT, b"x" * 1001, masked)
    assert Parsed(masked, max_size=1000).receive(whole[:10]) == [("other", whole[:10])]


def test_message_within_a_fragmented_one_is_left_to_the_library(masked: bool) -> None:
    parsed = Parsed(masked)
    first = frame(Opcode.TEXT, b"one ", masked, fin=False)
    parsed.receive(first)
    parsed.parser.fragmented = True
    wrong = frame(Opcode.TEXT, b"wrong", masked)
    assert parsed.receive(wrong) == [("other", first + wrong)]


@pytest.mark.parametrize(
    "wrong",
    [b"\xc1\x80abcd", b"\x83\x80abcd", b"\x8f\x80abcd", b"GET / HTTP/1.1\r\n\r\n", None],
    ids=["reserved bit", "opcode 3", "opcode 15", "not a WebSocket", "wrong mask bit"],
)
def test_everything_after_an_error_is_left_to_the_library(
    masked: bool, wrong: bytes | None
) -> None:
    wrong = wrong or frame(Opcode.TEXT, b"wrong", not masked)
    parsed = Parsed(masked)
    later = frame(Opcode.TEXT, b"later", masked)
    parsed.receive(frame(Opcode.TEXT, b"good", masked) + wrong + later)
    parsed.receive(later)
    assert parsed.came == [("text", b"good"), ("other", wrong + later + later)]


def test_everything_is_left_to_the_library_after_give_up(masked: bool) -> None:
    parsed = Parsed(masked)
    parsed.parser.give_up()
    data = frame(Opcode.TEXT, b"x", masked)
    assert parsed.receive(data) == [("other", data)]


def test_callback_may_give_up(masked: bool) -> None:
    others: list[bytes] = []
    parser = FrameParser(
        lambda _: parser.give_up(), lambda _: None, others.append, max_size=10, masked=masked
    )
    rest = frame(Opcode.TEXT, b"two", masked) + frame(Opcode.TEXT, b"three", masked)
    parser.receive(frame(Opcode.TEXT, b"one", masked) + rest)
    assert others == [rest]


def test_incomplete_frame_is_left_to_the_library_at_the_end(masked: bool) -> None:
    parsed = Parsed(masked)
    data = frame(Opcode.TEXT, b"never whole", masked)
    parsed.receive(data[:-1])
    parsed.parser.end()
    parsed.parser.end()
    assert parsed.came == [("other", data[:-1])]


def test_incomplete_large_message_is_dropped_at_the_end(masked: bool) -> None:
    parsed = Parsed(masked, max_size=2 * LARGE)
    parsed.receive(frame(Opcode.TEXT, bytes(2 * LARGE), masked)[:-1])
    parsed.parser.end()
    assert parsed.came == []
    assert not parsed.parser.in_large


def numbers(masked: bool, *range_: int) -> tuple[bytes, Came]:
    data = [b"%d" % number for number in range(*range_)]
    return b"".join(frame(Opcode.TEXT, each, masked) for each in data), [
        ("text", each) for each in data
    ]


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6, 7])
def test_parser_pauses_after_a_turn(masked: bool, count: int) -> None:
    stream, came = numbers(masked, count)
    parsed = Parsed(masked, turn=3)
    assert parsed.receive(stream) == came[:3]
    while parsed.parser.paused:
        before = len(parsed.came)
        parsed.parser.resume()
        assert 0 < len(parsed.came) - before <= 3
    assert parsed.came == came


def test_bytes_that_come_while_it_is_paused_are_kept(masked: bool) -> None:
    stream, came = numbers(masked, 10)
    parsed = Parsed(masked)
    parsed.parser.pause()
    for start in range(0, len(stream), 5):
        assert parsed.receive(stream[start : start + 5]) == []
    parsed.parser.resume()
    assert parsed.came == came
    assert not parsed.parser.paused


def test_callback_may_pause(masked: bool) -> None:
    came: list[bytes] = []

    def on_text(data: Payload) -> None:
        came.append(bytes(data))
        parser.pause()

    parser = FrameParser(on_text, on_text, came.append, max_size=10, masked=masked)
    stream, expected = numbers(masked, 3)
    parser.receive(stream[:-1])
    assert came == [b"0"]
    parser.receive(stream[-1:])
    for count in (1, 2, 3):
        assert (len(came), parser.paused) == (count, True)
        parser.resume()
    assert came == [each for _, each in expected]


def test_large_message_behind_a_pause_is_read(masked: bool) -> None:
    large = bytes(LARGE)
    parsed = Parsed(masked, max_size=LARGE, turn=1)
    stream = frame(Opcode.TEXT, b"first", masked) + frame(Opcode.BINARY, large, masked)
    parsed.receive(stream[: LARGE // 2])
    assert parsed.came == [("text", b"first")]
    parsed.parser.resume()
    buffer = parsed.parser.buffer()
    buffer[:] = stream[-len(buffer) :]
    parsed.parser.filled(len(buffer))
    assert parsed.came[1:] == [("binary", large)]
