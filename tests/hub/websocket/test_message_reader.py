"""Reading of one client: what it costs, with a given clock."""

from __future__ import annotations

import zlib
from typing import Any

import pytest
from conftest import Faults
from websockets.frames import Frame, Opcode

from fibws.hub.rosbridge.session import RosbridgeSession
from fibws.hub.settings import Settings
from fibws.hub.websocket.endpoint import Work
from fibws.hub.websocket.message_reader import MessageReader, ReadBuffers
from fibws.hub.websocket.quotas import (
    CHARGED_BYTES,
    LEAST_BYTES,
    LEAST_MESSAGES,
    ClientQuotas,
    Quotas,
)
from fibws.hub.websocket.turns import ITERATION, Turns
from fibws.protocol.deflate import PIECE
from fibws.protocol.websocket import CloseReason, Payload

from ..fakes import FakeHub
from ..raw_client import BINARY, TEXT, frame

NOTHING = frame(TEXT, b" ")
"""A message with which the hub does nothing."""


class FakeConnection:
    """A client's connection, which sends what a test gives it."""

    name = node = "/flooder"

    def __init__(self, **settings: Any) -> None:
        self.now = 0.0
        quotas = ClientQuotas(Quotas(Settings(**settings)))
        turns = Turns(lambda seconds, callback: None, lambda: None, lambda: 0.0)
        self.reader = MessageReader(self, quotas, Settings(**settings), turns, ReadBuffers())
        quotas.join_address(self, "10.0.0.1", self.now)
        session = FakeHub().client().session
        assert isinstance(session, RosbridgeSession)
        self.reader.endpoint = session
        self.reader.enter()

    @property
    def messages_received(self) -> int:
        return self.reader.messages

    def registrations(self, what: str) -> int:
        raise AssertionError(what)

    def feed(self, data: bytes) -> None:
        raise AssertionError(data)

    def fail(self, reason: CloseReason) -> None:
        raise AssertionError(reason)

    def grow(self, size: int) -> None:
        raise AssertionError(size)

    def send(self, data: bytes) -> None:
        """Send bytes, and have them read at once."""
        buffer = self.reader.buffer()
        buffer[: len(data)] = data
        self.reader.filled(len(data), self.now)

    @property
    def accepted(self) -> int:
        """Messages that were not dropped."""
        return self.reader.messages - self.reader.dropped


def test_client_that_sends_twice_its_rate_has_half_its_messages_accepted() -> None:
    """Messages that are dropped cost nothing; otherwise all of them would be dropped for ever."""
    client = FakeConnection(max_messages_per_second=100)
    for number in range(100 * 200):
        client.now = number / 200
        client.send(NOTHING)
    assert 0.98 <= (client.accepted - LEAST_MESSAGES) / (100 * 100) <= 1.02


def test_bytes_of_dropped_messages_cost_nothing() -> None:
    message = frame(TEXT, b" " * 1000)
    client = FakeConnection(max_bytes_per_second=100 * len(message))
    for number in range(100 * 200):
        client.now = number / 200
        client.send(message)
    at_once = max(200, LEAST_BYTES / len(message))
    assert 0.98 <= (client.accepted - at_once) / (100 * 100) <= 1.02


def test_accepted_message_whose_end_comes_while_others_are_dropped_is_charged() -> None:
    """A large message could be had for nothing otherwise."""
    client = FakeConnection(max_bytes_per_second=1000)
    large = frame(TEXT, b" " * 300_000)
    for start in range(0, len(large), 10_000):
        client.send(large[start : start + 10_000])
    assert client.accepted == 1
    debt = len(large) - LEAST_BYTES
    client.now = (debt - 2 * CHARGED_BYTES) / 1000
    client.send(NOTHING)
    assert client.accepted == 1
    client.now = debt / 1000 + 1
    client.send(NOTHING)
    assert client.accepted == 2


# Messages that are handled in steps.


class Steps:
    """An endpoint that takes a step for each character of a text; a ``!`` fails."""

    incomplete_bytes = 0

    def __init__(self, seconds: float) -> None:
        self.now = 0.0
        self.done = ""
        self._seconds = seconds

    def receive_text(self, data: Payload) -> Work:
        for character in data.decode():
            self.now += self._seconds
            self.done += character
            if character == "!":
                raise ZeroDivisionError("injected")
            yield

    receive_binary = receive_text


class SteppedConnection(FakeConnection):
    """A client's connection, whose messages are handled in steps of some seconds."""

    def __init__(self, seconds: float = ITERATION) -> None:
        super().__init__()
        self.endpoint: Any
        self.endpoint = Steps(seconds)
        self.turns = Turns(lambda seconds, call: None, lambda: None, lambda: self.endpoint.now)
        quotas = ClientQuotas(Quotas(Settings()))
        self.reader = MessageReader(self, quotas, Settings(), self.turns, ReadBuffers())
        self.reader.endpoint = self.endpoint

    def turn(self) -> str:
        """Take a turn; return what it has done."""
        before = len(self.endpoint.done)
        self.turns.began = self.endpoint.now
        self.reader.resume(0.0)
        done: str = self.endpoint.done[before:]
        return done


def test_message_goes_on_in_the_next_turn_and_all_behind_it_waits() -> None:
    client = SteppedConnection(0.6 * ITERATION)
    client.send(frame(TEXT, b"abcde") + frame(BINARY, b"fg") + frame(TEXT, b"h"))
    assert client.endpoint.done == "ab"
    assert [client.turn() for _ in range(3)] == ["cd", "ef", "gh"]
    client.turn()
    assert not client.reader.is_paused


def test_short_message_waits_for_no_turn() -> None:
    client = SteppedConnection(0.1 * ITERATION)
    client.send(frame(TEXT, b"abc"))
    assert client.endpoint.done == "abc"
    assert not client.reader.is_paused


def test_message_counts_as_incoming_until_its_end() -> None:
    client = SteppedConnection()
    client.send(frame(TEXT, b"abc"))
    assert client.reader.kept_bytes == 3
    while client.reader.is_paused:
        client.turn()
    assert client.reader.kept_bytes == 0


def test_compressed_message_is_inflated_in_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise 64 KB that inflate to 64 MB would hold up all others."""
    client = SteppedConnection()
    client.reader.enter()
    client.reader.accept_deflated()
    grown: list[int] = []

    def grow(size: int) -> None:
        grown.append(size)
        client.endpoint.now += ITERATION

    received: list[int] = []
    monkeypatch.setattr(client, "grow", grow)
    client.endpoint.receive_text = lambda data: received.append(len(data))
    deflater = zlib.compressobj(wbits=-15)
    data = deflater.compress(b" " * (3 * PIECE)) + deflater.flush(zlib.Z_SYNC_FLUSH)
    client.send(frame(TEXT, data[:-4], rsv=4) + frame(TEXT, b"x"))
    for kept in (1, 2, 3):
        assert grown == kept * [PIECE]
        assert client.reader.kept_bytes > kept * PIECE
        assert not received
        client.turn()
    while client.reader.is_paused:
        client.turn()
    assert received == [3 * PIECE, 1]
    assert client.reader.kept_bytes == 0


def test_rest_of_a_message_is_dropped_when_the_client_has_left() -> None:
    client = SteppedConnection()
    client.send(frame(TEXT, b"abc"))
    client.reader.stop()
    assert client.turn() == ""
    assert client.reader.kept_bytes == 0


def test_client_may_be_closed_within_a_step() -> None:
    client = SteppedConnection(0.0)
    steps = client.endpoint.receive_text

    def closing(data: Payload) -> Work:
        for _ in steps(data):
            client.reader.stop()
            yield

    client.endpoint.receive_text = closing
    client.send(frame(TEXT, b"abc"))
    assert client.endpoint.done == "a"


def test_fault_in_a_step_ends_only_its_message(faults: Faults) -> None:
    client = SteppedConnection()
    client.send(frame(TEXT, b"a!b") + frame(TEXT, b"c"))
    while client.reader.is_paused:
        client.turn()
    assert client.endpoint.done == "a!c"
    faults.expect("injected")


def test_frames_that_the_library_has_read_keep_their_order() -> None:
    client = SteppedConnection()
    for text in (b"ab", b"cd", b"ef"):
        client.reader.add(Frame(Opcode.TEXT, text))
    while client.reader.is_paused:
        client.turn()
    assert client.endpoint.done == "abcdef"


def test_all_is_done_at_once_when_the_client_has_closed_behind_it() -> None:
    client = SteppedConnection()
    for text in (b"ab", b"cd", b"ef"):
        client.reader.add(Frame(Opcode.TEXT, text))
    client.reader.finish()
    assert client.endpoint.done == "abcdef"
