"""What becomes of a call."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations
from typing import Any, TypeAlias

import pytest

from fibws.errors import InvalidMessage, OperationError
from fibws.hub.graph.service import Answer, Call, Later, OwnProvider, Provider, Service
from fibws.hub.graph.types import Types
from fibws.interfaces import Interfaces

from ..fakes import ADD, NANOSECONDS

TYPE = Types(Interfaces(), lambda: NANOSECONDS, strict=False).service(ADD)
REQUEST = {"a": 1, "b": 2}
Happening: TypeAlias = Callable[["Calling"], object]


class Patient:
    """A provider that takes its time."""

    node = "/patient"

    def __init__(self) -> None:
        self.due: list[Call] = []
        self.requests: list[dict[str, Any]] = []

    def take(self, call: Call) -> None:
        self.due.append(call)
        self.requests.append(call.request)

    def forget(self, call: Call) -> None:
        if call in self.due:
            self.due.remove(call)

    def displaced(self, service: Service) -> None:
        raise AssertionError("nobody takes it over")


class Calling:
    """A call, and what its caller hears."""

    def __init__(self, provider: Provider | None = None) -> None:
        self.patient = Patient()
        self.heard: list[object] = []
        service = Service("/add", TYPE, provider or self.patient)
        self.call = Call(service, REQUEST, "/caller", self._hear, self._hear)

    def _hear(self, call: Call, what: bytes | str) -> None:
        assert call is self.call
        self.heard.append(what)


def started() -> Calling:
    calling = Calling()
    calling.call.start()
    return calling


def test_a_service_is_of_its_providers_node() -> None:
    assert Service("/add", TYPE, Patient()).node == "/patient"


def test_a_call_waits_for_its_provider() -> None:
    calling = started()
    assert calling.patient.due == [calling.call]
    assert (calling.patient.requests, calling.call.caller) == ([REQUEST], "/caller")
    assert calling.call.request == {}, "what may be large is not kept"
    assert calling.heard == []


HAPPENINGS: dict[str, tuple[Happening, object]] = {
    "answer": (lambda calling: calling.call.answer({"sum": 3}), b'{"sum":3}'),
    "text": (lambda calling: calling.call.answer_text(b'{"sum":4}'), b'{"sum":4}'),
    "fail": (lambda calling: calling.call.fail("no"), "no"),
    "time": (
        lambda calling: calling.call.give_up(5),
        "Service /add did not answer within 5 s",
    ),
    "abandon": (lambda calling: calling.call.abandon(), None),
}


@pytest.mark.parametrize("order", [*permutations(HAPPENINGS, 3)], ids=" ".join)
def test_whatever_happens_the_caller_hears_of_the_first_alone(order: tuple[str, ...]) -> None:
    calling = started()
    for name in order:
        happening, _ = HAPPENINGS[name]
        happening(calling)
    _, expected = HAPPENINGS[order[0]]
    assert calling.heard == ([] if expected is None else [expected])


@pytest.mark.parametrize(("name", "left"), [("abandon", 0), ("time", 0), ("fail", 1)])
def test_a_provider_need_not_answer_what_the_hub_gave_up(name: str, left: int) -> None:
    calling = started()
    HAPPENINGS[name][0](calling)
    assert len(calling.patient.due) == left


@pytest.mark.parametrize("values", [{"sum": "3"}, {"total": 3}, "3", None, []])
def test_what_does_not_fit_answers_nothing(values: object) -> None:
    calling = started()
    with pytest.raises(InvalidMessage):
        calling.call.answer(values)
    assert calling.heard == []
    calling.call.answer({"sum": 3})
    assert calling.heard == [b'{"sum":3}']


def test_an_answer_is_filled() -> None:
    calling = started()
    calling.call.answer({})
    assert calling.heard == [b'{"sum":0}']


# The hub's own services.


def own(function: Callable[[dict[str, Any], str], Answer | Later]) -> Calling:
    return Calling(OwnProvider("/rosapi", function))


@pytest.mark.parametrize("answer", [{"sum": 3}, b'{"sum":3}'])
def test_the_hub_answers_at_once_by_an_object_or_by_its_text(answer: Answer) -> None:
    asked: list[tuple[dict[str, Any], str]] = []

    def function(request: dict[str, Any], caller: str) -> Answer:
        asked.append((request, caller))
        return answer

    calling = own(function)
    calling.call.start()
    assert calling.heard == [b'{"sum":3}']
    assert asked == [(REQUEST, "/caller")]


def test_what_the_hub_refuses_comes_with_its_reason() -> None:
    def function(request: dict[str, Any], caller: str) -> Answer:
        raise OperationError("not today")

    calling = own(function)
    calling.call.start()
    assert calling.heard == ["not today"]


@pytest.mark.parametrize("answer", [{"sum": "3"}, {"total": 3}])
def test_an_answer_of_the_hubs_own_must_fit_too(answer: dict[str, Any]) -> None:
    calling = own(lambda request, caller: answer)
    calling.call.start()
    [text] = calling.heard
    assert isinstance(text, str)
    assert "rospy_tutorials/AddTwoIntsResponse" in text


def test_a_fault_of_the_hubs_own_is_logged_and_the_caller_hears_of_it(
    caplog: pytest.LogCaptureFixture,
) -> None:
    def function(request: dict[str, Any], caller: str) -> Answer:
        raise KeyError("injected")

    calling = own(function)
    calling.call.start()
    assert calling.heard == ["/add failed in the hub, whose log says why"]
    assert "injected" in caplog.text


def test_nothing_is_kept_of_a_call_to_the_hub_itself() -> None:
    provider = OwnProvider("/rosapi", lambda request, caller: {"sum": 3})
    calling = Calling(provider)
    calling.call.start()
    provider.forget(calling.call)
    calling.call.abandon()
    assert calling.heard == [b'{"sum":3}']


class Thinking:
    """A function of the hub's own that answers later, and what became of its answer."""

    def __init__(self) -> None:
        self.forgotten = 0
        self.later = Later(self._forget)
        self.calling = own(lambda request, caller: self.later)
        self.calling.call.start()

    def _forget(self) -> None:
        self.forgotten += 1


def test_the_hub_may_answer_later() -> None:
    thinking = Thinking()
    assert thinking.calling.heard == []
    thinking.later.answer({"sum": 3})
    assert thinking.calling.heard == [b'{"sum":3}']
    assert not thinking.forgotten


@pytest.mark.parametrize("name", ["abandon", "time"])
def test_what_nobody_waits_for_is_forgotten_once(name: str) -> None:
    thinking = Thinking()
    happening, expected = HAPPENINGS[name]
    happening(thinking.calling)
    happening(thinking.calling)
    assert thinking.forgotten == 1
    assert thinking.calling.heard == ([] if expected is None else [expected])


def test_an_answer_that_has_been_given_is_not_forgotten_later() -> None:
    thinking = Thinking()
    thinking.later.answer({"sum": 3})
    thinking.calling.call.abandon()
    thinking.calling.call.give_up(5)
    assert (thinking.forgotten, thinking.calling.heard) == (0, [b'{"sum":3}'])


def test_what_is_known_at_once_is_not_answered_later() -> None:
    with pytest.raises(AssertionError, match="known at once"):
        Later(print).answer({})


def test_nobody_takes_over_what_the_hub_provides() -> None:
    provider = OwnProvider("/rosapi", lambda request, caller: {})
    with pytest.raises(AssertionError, match="/add is the hub's own"):
        provider.displaced(Service("/add", TYPE, provider))
