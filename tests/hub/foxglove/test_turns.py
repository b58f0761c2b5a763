"""Clients that follow the graph share the event loop's time, however many they are."""

from __future__ import annotations

from typing import Any

from fibws.access.rights import Right
from fibws.hub.foxglove.turns import ITERATION, TURN, FeedTurns
from fibws.hub.graph.policy import AllowAll

from ..fakes import ADD, INT32, FakeClock
from .foxglove_client import FoxgloveHub

SLOW = TURN / 10


class SlowClock(FakeClock):
    """A clock that work advances, too."""

    def work(self, seconds: float) -> None:
        self._now += seconds

    def iterate(self) -> float:
        """Run one iteration of the event loop; return the seconds that it took."""
        before = self._now
        due, self._timers = self._timers, []
        for _, _, timer in due:
            if not timer.cancelled:
                timer.callback()
        return self._now - before


class SlowPolicy(AllowAll):
    """A policy that allows everything, but thinks about it."""

    allows_all = False

    def __init__(self, clock: SlowClock) -> None:
        self._clock = clock

    def may(self, node: str, right: Right, name: str) -> bool:
        self._clock.work(SLOW)
        return True


def iterate_all(clock: SlowClock) -> float:
    """Run iterations until nothing is left to do; return the seconds of the longest one."""
    longest = 0.0
    while clock.timers:
        longest = max(longest, clock.iterate())
    return longest


def test_functions_are_called_in_turns_and_once() -> None:
    clock, called = SlowClock(), list[str]()
    turns = FeedTurns(clock)

    def send(name: str) -> None:
        called.append(name)
        clock.work(TURN)

    functions = [lambda name=name: send(name) for name in "abcdefgh"]
    for function in [*functions, *functions]:
        turns.wait(function)
    turns.cancel(functions[1])
    while clock.timers:
        assert clock.iterate() < 1.1 * ITERATION
    assert "".join(called) == "acdefgh"


def test_fault_of_one_keeps_no_other_waiting() -> None:
    clock, called = SlowClock(), list[int]()
    turns = FeedTurns(clock)

    def fail() -> None:
        raise ZeroDivisionError

    turns.wait(fail)
    turns.wait(lambda: called.append(1))
    for _ in range(2):
        try:
            clock.iterate()
        except ZeroDivisionError:
            continue
    assert called == [1]
    clock.iterate()
    assert not clock.timers


def test_clients_are_told_in_turns_of_a_departure() -> None:
    clock = SlowClock()
    hub = FoxgloveHub(policy=SlowPolicy(clock), clock=clock)
    talker = hub.client("/talker")
    for number in range(100):
        talker.send("advertise", f"/topic_{number}", type=INT32)
        talker.send("advertise_service", service=f"/service_{number}", type=ADD)
    clients = [hub.foxglove_client(f"/foxglove_{number}") for number in range(20)]
    for client in clients:
        client.send("subscribeConnectionGraph")
    iterate_all(clock)
    for client in clients:
        client.receive()
        assert len(client.channels) == len(client.services) == 100
    began = clock.time()
    talker.disconnect()
    assert clock.time() == began
    assert iterate_all(clock) < ITERATION + 2 * TURN
    for client in clients:
        client.receive()
        assert not client.channels
        assert not client.services
    for client in clients:
        client.disconnect()
    assert hub.empty


def test_clients_are_told_in_turns_of_changed_namespaces() -> None:
    clock = SlowClock()
    hub = FoxgloveHub(policy=SlowPolicy(clock), clock=clock)
    below = 5
    value: dict[str, Any] = {f"p_{number}": number for number in range(below)}
    names = ["/space"]
    for _ in range(50):
        value = {"n": value}
        names.append(f"{names[-1]}/n")
    hub.graph.parameters.set(names[0], value)
    client = hub.foxglove_client()
    client.send("subscribeParameterUpdates", parameterNames=names)
    iterate_all(clock)
    client.receive()
    hub.graph.parameters.set(f"{names[-1]}/p_0", 7)
    assert iterate_all(clock) < ITERATION + TURN + 4 * below * SLOW
    received = client.receive()
    assert len(received) > 1
    found = [
        each["name"]
        for frame in received
        if isinstance(frame, dict)
        for each in frame["parameters"]
    ]
    assert found == sorted(names)
