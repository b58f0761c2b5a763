"""Messages that ask for many things are handled one thing at a time, whatever the protocol."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from typing import Any, get_args

import pytest

from fibws.access.rights import Principal, Rights
from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.foxglove.messages import Operation
from fibws.hub.rosbridge.session import TokenWait
from fibws.hub.settings import Settings
from fibws.hub.websocket.endpoint import Endpoint, Opening
from fibws.hub.websocket.message_reader import MessageReader, ReadBuffers
from fibws.hub.websocket.quotas import ClientQuotas, Quotas
from fibws.hub.websocket.turns import Turns
from fibws.protocol.decoding import REQUESTS
from fibws.protocol.websocket import CloseReason

from .fakes import ADD, FIBONACCI, INT32, FakeHub
from .foxglove.foxglove_client import FoxgloveHub
from .raw_client import BINARY, TEXT, frame
from .work_clock import WorkClock

FEW, MANY = 50, 1000
LIMIT = 1.2
"""How many times as much work there may be between two looks at the clock when a message asks for
twenty times as many things."""
LOG_LINE = 300
"""The work of a line in the log, as that for the thousandth error of a client."""


class Reading:
    """A client's connection without a socket, each of whose turns is over at the first look."""

    name = "/client"

    def __init__(self, endpoint: Endpoint) -> None:
        self.clock = WorkClock()
        self.turns = 0
        self._turns = Turns(lambda seconds, call: None, lambda: None, self.clock)
        quotas = ClientQuotas(Quotas(Settings()))
        self.reader = MessageReader(self, quotas, Settings(), self._turns, ReadBuffers())
        self.reader.endpoint = endpoint
        self.reader.enter()

    def feed(self, data: bytes) -> None:
        raise AssertionError(data)

    def fail(self, reason: CloseReason) -> None:
        raise AssertionError(reason)

    def grow(self, size: int) -> None:
        raise AssertionError(size)

    def receive(self, data: bytes, first: int = TEXT) -> None:
        """Handle a message, and one behind it, in as many turns as it takes."""
        self.clock.measure(lambda: self.reader.receive(frame(first, data) + frame(TEXT, b"{}")))
        self.finish()

    def finish(self) -> None:
        """Handle what has come, in as many turns as it takes."""
        while self.reader.is_paused:
            self.turns += 1
            self._turns.began = self.clock()
            self.clock.measure(lambda: self.reader.resume(0.0))


def assert_short_stretches(prepare: Callable[[int], Iterator[tuple[Reading, bytes, int]]]) -> None:
    """Assert that a message with many items is handled in steps like one with few.

    Args:
        prepare: yields, given how many items there are to be, messages: one to warm caches, and
            one to be measured.
    """
    longest = {}
    for count in (FEW, MANY):
        for reading, data, first in prepare(count):
            reading.clock.longest = reading.turns = 0
            reading.receive(data, first)
            assert reading.turns >= count
        longest[count] = reading.clock.longest
    assert longest[MANY] <= LIMIT * longest[FEW] + LOG_LINE, longest


def test_what_is_done_first_precedes_the_rest_of_a_message() -> None:
    done: list[str] = []

    def steps(name: str) -> Iterator[None]:
        for each in range(3):
            done.append(f"{name} {each}")
            yield

    class Recorder:
        """Notes the steps of each message."""

        def receive_text(self, data: bytes) -> Iterator[None]:
            return steps(data.decode())

    endpoint: Any = Recorder()
    reading = Reading(endpoint)
    reader = reading.reader
    reading.clock.measure(lambda: reader.receive(frame(TEXT, b"one") + frame(TEXT, b"two")))
    reading.clock.measure(lambda: reader.do_first(steps("rights")))
    reading.finish()
    names = ["one", *["rights"] * 3, *["one"] * 2, *["two"] * 3]
    assert [each.split()[0] for each in done] == names


# rosbridge

FIELDS: dict[str, dict[str, Any]] = {
    "publish": {"msg": {"data": 1}},
    "advertise": {"type": INT32},
    "subscribe": {"type": INT32},
    "acknowledge": {"count": 1},
    "call_service": {"service": "/nothing", "args": {}},
    "service_response": {"service": "/nothing", "values": {}, "result": True},
    "advertise_service": {"type": ADD},
    "send_action_goal": {"action": "/nothing", "action_type": FIBONACCI, "args": {}},
    "cancel_action_goal": {"action": "/nothing"},
    "action_feedback": {"action": "/nothing", "values": {}},
    "action_result": {"action": "/nothing", "values": {}, "status": 4, "result": True},
    "advertise_action": {"type": FIBONACCI},
    "set_will": {"type": INT32, "msg": {"data": 1}},
    "set_level": {"level": "none"},
    "fragment": {"num": 0, "total": 2, "data": "x"},
    "auth": {"token": "x"},
}


def operations(op: str, count: int) -> bytes:
    """Return a text with an operation of some kind, so many times."""
    name = {"unadvertise_service": "service", "advertise_service": "service"}.get(op, "topic")
    name = "action" if op in ("advertise_action", "unadvertise_action") else name
    return "".join(
        json.dumps({"op": op, "id": f"{each}", name: f"/name_{each}", **FIELDS.get(op, {})})
        for each in range(count)
    ).encode()


@pytest.mark.parametrize("op", [*REQUESTS, "unknown"])
def test_operations_of_one_text_are_performed_one_by_one(op: str) -> None:
    def prepare(count: int) -> Iterator[tuple[Reading, bytes, int]]:
        reading = Reading(FakeHub().client().session)
        yield reading, operations(op, count), TEXT
        yield reading, operations(op, count), TEXT

    assert_short_stretches(prepare)


def test_operations_of_a_text_in_a_binary_message_are_performed_one_by_one() -> None:
    def prepare(count: int) -> Iterator[tuple[Reading, bytes, int]]:
        reading = Reading(FakeHub().client().session)
        yield reading, operations("advertise", count), BINARY
        yield reading, operations("advertise", count), BINARY

    assert_short_stretches(prepare)


def test_operations_of_a_text_in_fragments_are_performed_one_by_one() -> None:
    def prepare(count: int) -> Iterator[tuple[Reading, bytes, int]]:
        reading = Reading(FakeHub().client().session)
        for id_ in ("a", "b"):
            text = operations("advertise", count).decode()
            fragment = {"op": "fragment", "id": id_, "num": 0, "total": 1, "data": text}
            yield reading, json.dumps(fragment).encode(), TEXT

    assert_short_stretches(prepare)


def test_operations_of_a_client_that_sends_too_much_are_refused_one_by_one() -> None:
    class Refused:
        """Has all messages refused."""

        def __init__(self) -> None:
            self.session = session = FakeHub().client().session
            self.receive_text = lambda data: session.refuse(data, "too much", is_text=True)

    def prepare(count: int) -> Iterator[tuple[Reading, bytes, int]]:
        endpoint: Any = Refused()
        reading = Reading(endpoint)
        yield reading, operations("subscribe", count), TEXT
        yield reading, operations("subscribe", count), TEXT

    assert_short_stretches(prepare)


def test_operations_behind_a_token_are_performed_one_by_one() -> None:
    def prepare(count: int) -> Iterator[tuple[Reading, bytes, int]]:
        for _ in range(2):
            hub = FakeHub()
            queue = SendQueue(lambda data: None, lambda: None, hub.flusher, max_bytes=10**6)
            opening = Opening(
                None,
                queue,
                lambda reason: None,
                log_in=lambda token: Principal(token, Rights()),
                replace=lambda endpoint: None,
            )
            wait = hub.rosbridge.open(opening)
            assert isinstance(wait, TokenWait)
            yield Reading(wait), operations("auth", 1) + operations("unsubscribe", count - 1), TEXT

    assert_short_stretches(prepare)


# Foxglove

LISTS: dict[str, Callable[[int], dict[str, Any]]] = {
    "subscribe": lambda count: {
        "subscriptions": [{"id": each, "channelId": 1} for each in range(count)]
    },
    "unsubscribe": lambda count: {"subscriptionIds": list(range(count))},
    "advertise": lambda count: {
        "channels": [
            {"id": each, "topic": f"/topic_{each}", "encoding": "ros1", "schemaName": INT32}
            for each in range(count)
        ]
    },
    "unadvertise": lambda count: {"channelIds": list(range(count))},
    "getParameters": lambda count: {"parameterNames": names(count)},
    "setParameters": lambda count: {
        "parameters": [{"name": name, "value": 1} for name in names(count)],
        "id": "x",
    },
    "subscribeParameterUpdates": lambda count: {"parameterNames": names(count)},
    "unsubscribeParameterUpdates": lambda count: {"parameterNames": names(count)},
}
"""The operations that have a list."""


def names(count: int) -> list[str]:
    return [f"/space/name_{each}" for each in range(count)]


def test_table_has_every_operation_with_a_list() -> None:
    with_list = {
        get_args(model.model_fields["op"].annotation)[0]
        for model in get_args(Operation)
        if any("list" in str(field.annotation) for field in model.model_fields.values())
    }
    assert set(LISTS) == with_list


@pytest.mark.parametrize("op", LISTS)
def test_items_of_a_list_are_handled_one_by_one(op: str) -> None:
    def prepare(count: int) -> Iterator[tuple[Reading, bytes, int]]:
        reading = Reading(FoxgloveHub().foxglove_client().session)
        text = json.dumps({"op": op, **LISTS[op](count)}).encode()
        yield reading, text, TEXT
        yield reading, text, TEXT

    assert_short_stretches(prepare)


def test_all_parameters_are_read_one_by_one() -> None:
    hub = FoxgloveHub()
    reading = Reading(hub.foxglove_client().session)
    for name in names(MANY):
        hub.graph.parameters.set(name, 1)
    reading.receive(b'{"op":"getParameters","parameterNames":[]}')
    assert reading.turns >= MANY
