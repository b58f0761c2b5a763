"""No operation takes longer the more there is: steps of the interpreter are counted, not time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from work import executed_instructions

from fibws.hub.server import HubServer

from .fakes import ADD, FIBONACCI, INT32, FakeHub, number
from .foxglove.foxglove_client import FoxgloveHub
from .rosapi.rosapi_client import RosapiClient

FEW, MANY = 25, 200
LIMIT = 1.2
"""How many times as many steps an operation may take when there is eight times as much."""


def growth(prepare: Callable[[int], Callable[[], object]]) -> float:
    """Return how many times as many steps an operation takes on average when there is more.

    Args:
        prepare: given how much there is to be, makes it; returns a function that performs the
            operation so many times, and can be called again.
    """
    few, many = (_steps_each(prepare(count), count) for count in (FEW, MANY))
    return many / few


def _steps_each(perform: Callable[[], object], count: int) -> float:
    perform()  # What is compiled and cached at the first time does not count.
    return executed_instructions(perform) / count


def names(count: int, of: str = "/name") -> list[str]:
    return [f"{of}_{each}" for each in range(count)]


def test_steps_are_counted_in_calls_and_loops() -> None:
    assert executed_instructions(lambda: [each for each in range(1000)]) > 1000
    assert growth(lambda count: lambda: [each in names(count) for each in names(count)]) > 2


def test_advertising_and_unadvertising_take_the_same_however_many_topics() -> None:
    def prepare(count: int) -> Callable[[], object]:
        client = FakeHub().client()

        def perform() -> None:
            for name in names(count):
                client.send("advertise", name, type=INT32)
            for name in reversed(names(count)):
                client.send("unadvertise", name)
            assert client.forgotten

        return perform

    assert growth(prepare) < LIMIT


def test_early_messages_take_the_same_however_many_topics() -> None:
    def prepare(count: int) -> Callable[[], object]:
        hub = FakeHub()
        hub.client().send("advertise", "/warm", type=INT32)

        def perform() -> None:
            client = hub.client()
            for name in names(count):
                client.send("publish", name, msg=number(1))
            for name in names(count):
                client.send("advertise", name, type=INT32)
            assert (
                sum(source.messages for source in client.session.topics.sources.values()) == count
            )
            client.disconnect()

        return perform

    assert growth(prepare) < LIMIT


def test_receivers_of_a_topic_are_gathered_for_its_messages_only() -> None:
    gathered: list[object] = []

    class Receivers(dict[Any, Any]):
        def __iter__(self) -> Any:
            gathered.append(self)
            return super().__iter__()

    hub = FakeHub()
    talker, listeners = hub.client(), [hub.client() for _ in range(FEW)]
    talker.send("advertise", "/a", type=INT32)
    hub.graph.topics["/a"].untyped.uses = Receivers()
    for size, listener in enumerate(listeners):
        listener.send("subscribe", "/a", fragment_size=1000 + size)
    assert not gathered
    for data in (1, 2):
        talker.send("publish", "/a", msg=number(data))
        assert len(gathered) == 1
    for listener in listeners:
        assert listener.receive_numbers("/a") == [1, 2]
        listener.send("unsubscribe", "/a")
    assert len(gathered) == 1


@pytest.mark.parametrize("with_id", [True, False])
def test_response_takes_the_same_however_many_calls_wait(with_id: bool) -> None:
    def prepare(count: int) -> Callable[[], object]:
        hub = FakeHub()
        server, caller = hub.client(), hub.client()
        for service in ("/a", "/b"):
            server.send("advertise_service", service=service, type=ADD)

        def perform() -> None:
            for service in ["/a"] * count + ["/b"] * count:
                caller.send("call_service", service=service, args={"a": 1, "b": 2})
            waiting = [each for each in server.receive() if each["service"] == "/b"]
            for call in reversed(waiting) if with_id else waiting:
                id_ = call["id"] if with_id else None
                server.send(
                    "service_response", service="/b", id=id_, values={"sum": 3}, result=True
                )
            assert [each["result"] for each in caller.receive()] == [True] * count
            server.send("unadvertise_service", service="/a")
            server.send("advertise_service", service="/a", type=ADD)
            assert not server.session.services._calls
            caller.receive()

        return perform

    assert growth(prepare) < LIMIT


def test_unadvertising_a_service_takes_the_same_however_many_calls_wait() -> None:
    def prepare(count: int) -> Callable[[], object]:
        hub = FakeHub()
        server, caller = hub.client(), hub.client()
        server.send("advertise_service", service="/a", type=ADD)
        for _ in range(count):
            caller.send("call_service", service="/a")

        def perform() -> None:
            for name in names(count):
                server.send("advertise_service", service=name, type=ADD)
                server.send("unadvertise_service", service=name)
            assert len(server.session.services._calls) == count

        return perform

    assert growth(prepare) < LIMIT


def test_timeout_takes_the_same_however_many_calls_wait() -> None:
    def prepare(count: int) -> Callable[[], object]:
        hub = FakeHub()
        server, caller = hub.client(), hub.client()
        server.send("advertise_service", service="/a", type=ADD)

        def perform() -> None:
            for each in range(count):
                caller.send("call_service", service="/a", timeout=1 + each / 16)
            for _ in range(count):
                hub.clock.advance(1 / 16)
            hub.clock.advance(1)
            assert [each["result"] for each in caller.receive()] == [False] * count
            server.receive()

        return perform

    assert growth(prepare) < LIMIT


def test_unadvertising_an_action_takes_the_same_however_many_goals() -> None:
    def prepare(count: int) -> Callable[[], object]:
        hub = FakeHub()
        server, client = hub.client(), hub.client()
        server.send("advertise_action", action="/a", type=FIBONACCI)
        for id_ in names(count):
            client.send("send_action_goal", action="/a", action_type=FIBONACCI, id=id_)

        def perform() -> None:
            for name in names(count):
                server.send("advertise_action", action=name, type=FIBONACCI)
                server.send("unadvertise_action", action=name)
            assert len(server.session.actions._goals) == count

        return perform

    assert growth(prepare) < LIMIT


def test_finding_a_client_takes_the_same_however_many() -> None:
    def prepare(count: int) -> Callable[[], object]:
        rosapi = RosapiClient()
        connections = [rosapi.connect(name) for name in names(count)]
        found = [rosapi.own.clients.find(name) for name in names(count)]
        assert found == connections
        return lambda: [rosapi.own.clients.find(name) for name in names(count)]

    assert growth(prepare) < LIMIT


def test_health_of_a_slow_client_takes_the_same_however_many_topics() -> None:
    def prepare(count: int) -> Callable[[], object]:
        fake, hub = FakeHub(), HubServer()
        hub.graph = fake.graph
        talker, slow = fake.client(), fake.client("/slow")
        for name in names(count):
            talker.send("advertise", name, type=INT32)
        slow.send("subscribe", "/name_0", queue_length=1)
        slow.queue.pause()
        for data in range(3):
            talker.send("publish", "/name_0", msg=number(data))

        def perform() -> None:
            for _ in range(count):
                assert hub._by_topic("/slow", lambda report: report.dropped) == {"/name_0": 2}

        return perform

    assert growth(prepare) < LIMIT


def test_change_of_a_parameter_takes_the_same_however_many_foxglove_follows() -> None:
    def prepare(count: int) -> Callable[[], object]:
        hub = FoxgloveHub()
        client = hub.foxglove_client()
        client.send("subscribeParameterUpdates", parameterNames=names(count))

        def perform() -> None:
            for value in range(count):
                hub.graph.parameters.set("/other", value)
                hub.clock.advance(0)

        return perform

    assert growth(prepare) < LIMIT
