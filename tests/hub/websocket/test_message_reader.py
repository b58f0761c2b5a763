"""Reading of one client: what it costs, with a given clock."""

from __future__ import annotations

from typing import Any

from fibws.hub.rosbridge.session import Session
from fibws.hub.settings import Settings
from fibws.hub.websocket.message_reader import MessageReader, ReadBuffers
from fibws.hub.websocket.quotas import (
    CHARGED_BYTES,
    LEAST_BYTES,
    LEAST_MESSAGES,
    ClientQuotas,
    Quotas,
)
from fibws.hub.websocket.turns import Turns
from fibws.protocol.websocket import CloseReason

from ..fakes import FakeHub
from ..raw_client import TEXT, frame

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
        assert isinstance(session, Session)
        self.reader.endpoint = session

    @property
    def messages_received(self) -> int:
        return self.reader.messages

    def registrations(self, what: str) -> int:
        raise AssertionError(what)

    def feed(self, data: bytes) -> None:
        raise AssertionError(data)

    def fail(self, reason: CloseReason) -> None:
        raise AssertionError(reason)

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
