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
        self.asker, self.answerer, self.rival = map(
            self.group.connect, ("/asker", "/answerer", "/rival")
        )

    def answer(self, client: Client) -> None:
        """Respond to all requests of all clients, also to those of other servers."""
        for request in [each for due in self.group.due.values() for each in due]:
            self.group.respond(client, request)

    def tell(self) -> None:
        for request in list(self.group.due[self.answerer]):
            self.group.send_feedback(self.answerer, request)

    def cancel(self) -> None:
        ids = self.group.requests[self.asker]
        self.group.send(self.asker, "cancel_action_goal", action="/a", id=next(iter(ids), 0))

    def new_asker(self) -> None:
        self.asker = self.group.connect("/asker")

    def new_answerer(self) -> None:
        self.answerer = self.group.connect("/answerer")

    def pause(self) -> None:
        self.answerer.queue.pause()
        self.asker.queue.pause()

    def resume(self) -> None:
        for client in (self.answerer, self.asker):
            client.queue.resume()
        self.group.receive_all()


Step: TypeAlias = Callable[[Pair], object]

DISTURBANCES: dict[str, Step] = {
    "the asker leaves": lambda pair: pair.group.disconnect(pair.asker),
    "the answerer leaves": lambda pair: pair.group.disconnect(pair.answerer),
    "a new asker": Pair.new_asker,
    "a new answerer": Pair.new_answerer,
    "the rival leaves": lambda pair: pair.group.disconnect(pair.rival),
    "the rival answers": lambda pair: pair.answer(pair.rival),
    "time passes": lambda pair: pair.group.advance(61),
    "clients stop reading": Pair.pause,
    "clients resume reading": Pair.resume,
}
SERVICE: dict[str, Step] = {
    "provide": lambda pair: pair.group.advertise_service(pair.answerer, "/s"),
    "call": lambda pair: pair.group.call(pair.asker, "/s"),
    "respond": lambda pair: pair.answer(pair.answerer),
}
SERVICE_DISTURBANCES: dict[str, Step] = {
    **DISTURBANCES,
    "unadvertise": lambda pair: pair.group.send(pair.answerer, "unadvertise_service", service="/s"),
    "the rival provides": lambda pair: pair.group.advertise_service(pair.rival, "/s"),
    "provide again": lambda pair: pair.group.advertise_service(pair.answerer, "s"),
    "call again": lambda pair: pair.group.call(pair.asker, "/s", timeout=30),
    "the answerer calls": lambda pair: pair.group.call(pair.answerer, "/s"),
}
ACTION: dict[str, Step] = {
    "serve": lambda pair: pair.group.advertise_action(pair.answerer, "/a"),
    "send": lambda pair: pair.group.send_goal(pair.asker, "/a"),
    "tell": Pair.tell,
    "finish": lambda pair: pair.answer(pair.answerer),
}
ACTION_DISTURBANCES: dict[str, Step] = {
    **DISTURBANCES,
    "unadvertise": lambda pair: pair.group.send(pair.answerer, "unadvertise_action", action="/a"),
    "the rival serves": lambda pair: pair.group.advertise_action(pair.rival, "/a"),
    "serve again": lambda pair: pair.group.advertise_action(pair.answerer, "a"),
    "cancel": Pair.cancel,
    "cancel all": lambda pair: pair.group.call(pair.rival, "/a/_action/cancel_goal"),
    "send again": lambda pair: pair.group.send_goal(pair.asker, "/a"),
    "the answerer sends": lambda pair: pair.group.send_goal(pair.answerer, "/a"),
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


VANISHING = ["the asker leaves", "the answerer leaves", "a new asker", "a new answerer"]


@pytest.mark.parametrize("others", [*permutations(VANISHING, 2)], ids=", ".join)
def test_both_clients_may_leave_in_either_order_after_any_event(others: tuple[str, str]) -> None:
    hub = FakeHub()
    for steps, disturbances in ((SERVICE, SERVICE_DISTURBANCES), (ACTION, ACTION_DISTURBANCES)):
        for first in disturbances:
            for names in interleavings([*steps], [first, *others]):
                play(hub, {**steps, **disturbances}, names)
