"""Clients and servers that leave at every step of a call or goal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, permutations
from typing import TypeAlias

import pytest

from ..fakes import Client, FakeHub
from .client_group import ClientGroup


class Pair:
    """A caller, a server, and a second server of the same names."""

    def __init__(self, hub: FakeHub) -> None:
        self.group = ClientGroup(hub)
        self.caller, self.responder, self.rival = map(
            self.group.connect, ("/caller", "/responder", "/rival")
        )

    def answer(self, client: Client) -> None:
        """Respond to all requests of all clients, also to those of other servers."""
        for request in [each for due in self.group.due.values() for each in due]:
            self.group.respond(client, request)

    def tell(self) -> None:
        for request in list(self.group.due[self.responder]):
            self.group.send_feedback(self.responder, request)

    def cancel(self) -> None:
        ids = self.group.requests[self.caller]
        self.group.send(self.caller, "cancel_action_goal", action="/a", id=next(iter(ids), 0))

    def new_caller(self) -> None:
        self.caller = self.group.connect("/caller")

    def new_responder(self) -> None:
        self.responder = self.group.connect("/responder")

    def pause(self) -> None:
        self.responder.queue.pause()
        self.caller.queue.pause()

    def resume(self) -> None:
        for client in (self.responder, self.caller):
            client.queue.resume()
        self.group.receive_all()


Step: TypeAlias = Callable[[Pair], object]

DISTURBANCES: dict[str, Step] = {
    "the caller leaves": lambda pair: pair.group.disconnect(pair.caller),
    "the responder leaves": lambda pair: pair.group.disconnect(pair.responder),
    "a new caller": Pair.new_caller,
    "a new responder": Pair.new_responder,
    "the rival leaves": lambda pair: pair.group.disconnect(pair.rival),
    "the rival answers": lambda pair: pair.answer(pair.rival),
    "time passes": lambda pair: pair.group.advance(61),
    "clients stop reading": Pair.pause,
    "clients resume reading": Pair.resume,
}
SERVICE: dict[str, Step] = {
    "provide": lambda pair: pair.group.advertise_service(pair.responder, "/s"),
    "call": lambda pair: pair.group.call(pair.caller, "/s"),
    "respond": lambda pair: pair.answer(pair.responder),
}
SERVICE_DISTURBANCES: dict[str, Step] = {
    **DISTURBANCES,
    "unadvertise": lambda pair: pair.group.send(
        pair.responder, "unadvertise_service", service="/s"
    ),
    "the rival provides": lambda pair: pair.group.advertise_service(pair.rival, "/s"),
    "provide again": lambda pair: pair.group.advertise_service(pair.responder, "s"),
    "call again": lambda pair: pair.group.call(pair.caller, "/s", timeout=30),
    "the responder calls": lambda pair: pair.group.call(pair.responder, "/s"),
}
ACTION: dict[str, Step] = {
    "serve": lambda pair: pair.group.advertise_action(pair.responder, "/a"),
    "send": lambda pair: pair.group.send_goal(pair.caller, "/a"),
    "tell": Pair.tell,
    "finish": lambda pair: pair.answer(pair.responder),
}
ACTION_DISTURBANCES: dict[str, Step] = {
    **DISTURBANCES,
    "unadvertise": lambda pair: pair.group.send(pair.responder, "unadvertise_action", action="/a"),
    "the rival serves": lambda pair: pair.group.advertise_action(pair.rival, "/a"),
    "serve again": lambda pair: pair.group.advertise_action(pair.responder, "a"),
    "cancel": Pair.cancel,
    "cancel all": lambda pair: pair.group.call(pair.rival, "/a/_action/cancel_goal"),
    "send again": lambda pair: pair.group.send_goal(pair.caller, "/a"),
    "the responder sends": lambda pair: pair.group.send_goal(pair.responder, "/a"),
}


def interleavings(steps: Sequence[str], others: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """All ways to mix the two, each in its own order."""
    size = len(steps) + len(others)
    for places in combinations(range(size), len(others)):
        rest, strewn = iter(steps), iter(others)
        yield tuple(next(strewn) if place in places else next(rest) for place in range(size))


def play(hub: FakeHub, steps: dict[str, Step], names: tuple[str, ...]) -> None:
    pair = Pair(hub)
    try:
        for name in names:
            steps[name](pair)
        pair.group.end()
    except Exception as error:
        error.add_note(f"when: {', '.join(names)}")
        raise


@pytest.mark.parametrize("first", [None, *SERVICE_DISTURBANCES])
def test_call_gets_one_response_for_any_two_events(first: str | None) -> None:
    hub, steps = FakeHub(), {**SERVICE, **SERVICE_DISTURBANCES}
    for others in disturbed(first, SERVICE_DISTURBANCES):
        for names in interleavings([*SERVICE], others):
            play(hub, steps, names)


@pytest.mark.parametrize("first", [None, *ACTION_DISTURBANCES])
@pytest.mark.long
def test_goal_gets_one_result_for_any_two_events(first: str | None) -> None:
    hub, steps = FakeHub(), {**ACTION, **ACTION_DISTURBANCES}
    for others in disturbed(first, ACTION_DISTURBANCES):
        for names in interleavings([*ACTION], others):
            play(hub, steps, names)


def disturbed(first: str | None, disturbances: dict[str, Step]) -> Iterator[tuple[str, ...]]:
    """Nothing, or that disturbance alone and before each other."""
    if first is None:
        yield ()
    else:
        yield (first,)
        yield from ((first, second) for second in disturbances)


VANISHING = ["the caller leaves", "the responder leaves", "a new caller", "a new responder"]


@pytest.mark.parametrize("others", [*permutations(VANISHING, 2)], ids=", ".join)
@pytest.mark.long
def test_both_clients_may_leave_in_either_order_after_any_event(others: tuple[str, str]) -> None:
    hub = FakeHub()
    for steps, disturbances in ((SERVICE, SERVICE_DISTURBANCES), (ACTION, ACTION_DISTURBANCES)):
        for first in disturbances:
            for names in interleavings([*steps], [first, *others]):
                play(hub, {**steps, **disturbances}, names)
