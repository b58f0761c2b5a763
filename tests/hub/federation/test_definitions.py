"""Definitions that other hubs are asked for: what passes is asked again, later and later."""

from __future__ import annotations

from typing import Any, cast

import pytest

from fibws.hub.federation import definitions
from fibws.hub.federation.backplane import Backplane, Cancel, OnReply, Peer
from fibws.hub.federation.definitions import DefinitionPending, RemoteDefinitions
from fibws.hub.federation.records import HubInfo, Kind, Reply, Request, failure

from ..fakes import FakeClock, FakeHub, finish

TEXT = "int32 left"
TOPIC: tuple[Kind, str] = ("topics", "/wheels")


class FakeBackplane:
    """Keeps the requests of a hub until the test answers them."""

    node = "/link"

    def __init__(self) -> None:
        self.open: list[OnReply] = []
        self.asked = 0

    def request(self, peer: Peer, request: Request, on_reply: OnReply) -> Cancel:
        assert request.op == "describe"
        self.asked += 1
        self.open.append(on_reply)
        return lambda: None

    def answer(self, reply: Reply) -> None:
        self.open.pop(0)(reply)


class World:
    """What finds definitions for a topic, which is settled once more each time they arrive."""

    def __init__(self) -> None:
        self.clock = FakeClock()
        self.settled = 0
        self.found: str | None = None
        self.is_pending = False
        self.definitions = RemoteDefinitions(
            FakeHub().graph, self.clock, self._arrived, chance=lambda: 1.0
        )
        self.wires: list[FakeBackplane] = []
        self.peers: list[Peer] = []
        for id_ in "ab":
            self.wires.append(wire := FakeBackplane())
            self.peers.append(Peer(HubInfo(id=id_ * 16, name=id_), cast(Backplane, wire)))
        self.settle()

    def _arrived(self, kind: Kind, name: str) -> None:
        assert (kind, name) == TOPIC
        self.settled += 1
        self.clock.call_soon(self.settle)

    def settle(self, hub: int = 0, type_: str = "my_msgs/Wheels") -> None:
        self.is_pending = False
        try:
            self.found = self.definitions.find(self.peers[hub], "msg", type_, "0" * 32, TOPIC)
        except DefinitionPending:
            self.is_pending = True

    def answer(self, reply: Reply, hub: int = 0) -> None:
        self.wires[hub].answer(reply)
        self.clock.turn()
        self.clock.turn()


@pytest.fixture
def world() -> World:
    return World()


@pytest.mark.parametrize("code", ["limit", "server_lost", "timeout", "internal_error"])
def test_hub_that_could_not_answer_is_asked_again_ever_later(world: World, code: str) -> None:
    asked_at = []
    for _ in range(8):
        asked = world.wires[0].asked
        world.answer(failure("later", code))
        assert world.is_pending
        assert world.wires[0].asked == asked  # Not at once.
        while world.wires[0].asked == asked:
            world.clock.advance(1)
            world.clock.turn()
        asked_at.append(world.clock.time())
    waited = [round(b - a) for a, b in zip([0.0, *asked_at], asked_at, strict=False)]
    assert waited == [1, 2, 4, 8, 16, 30, 30, 30]
    world.answer(Reply({"text": TEXT}))
    assert (world.found, world.is_pending) == (TEXT, False)
    assert world.clock.timers == 0


def test_hub_that_does_not_tell_a_type_is_not_asked_again(world: World) -> None:
    world.answer(failure("unknown type", "unknown_type"))
    assert (world.found, world.is_pending) == (None, False)
    world.settle()
    assert not world.is_pending
    assert world.wires[0].asked == 1
    assert world.clock.timers == 0


@pytest.mark.parametrize("code", ["limit", "unknown_type"])
def test_another_hub_is_asked_at_once(world: World, code: str) -> None:
    world.answer(failure("no", code))
    world.settle(hub=1)
    assert world.wires[1].asked == 1
    world.answer(Reply({"text": TEXT}), hub=1)
    world.settle()
    assert world.found == TEXT


def test_two_hubs_are_not_asked_at_one_time(world: World) -> None:
    world.settle(hub=1)
    assert (world.wires[0].asked, world.wires[1].asked) == (1, 0)


@pytest.mark.parametrize("code", ["limit", "unknown_type"])
def test_hub_that_is_back_is_asked_again(world: World, code: str) -> None:
    world.answer(failure("no", code))
    finish(world.definitions.forget(world.peers[0]))
    world.settle()
    assert world.is_pending
    assert world.wires[0].asked == 2


def test_failures_are_bounded_and_none_is_asked_again_at_once(
    world: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(definitions, "MOST_KNOWN", 10)
    for each in range(50):
        world.settle(type_=f"my_msgs/Type{each}")
    while world.wires[0].open:
        world.wires[0].answer(failure("later", "limit"))
    world.clock.turn()
    assert world.wires[0].asked == 51
    failures: Any = world.definitions._failures
    world.clock.advance(60)
    for each in range(50):
        world.settle(type_=f"my_msgs/Other{each}")
        world.wires[0].answer(failure("no", "unknown_type"))
    assert len(failures) == 10
