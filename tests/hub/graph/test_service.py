"""Service calls: from the request to the one response."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations
from typing import Any, TypeAlias

import pytest

from fibws.errors import InvalidMessage, OperationError
from fibws.hub.errors import CallFailed
from fibws.hub.graph.body import Body
from fibws.hub.graph.service import (
    Call,
    Deferred,
    InternalServer,
    Response,
    Service,
    ServiceServer,
)
from fibws.hub.graph.types import Types
from fibws.interfaces import Interfaces

from ..fakes import ADD, NANOSECONDS, FakeClock

TYPE = Types(Interfaces(), lambda: NANOSECONDS, strict=False).service(ADD)
REQUEST = {"a": 1, "b": 2}
Event: TypeAlias = Callable[["Caller"], object]


class SlowServer:
    """A service server that responds when the test calls it."""

    node = "/server"

    def __init__(self) -> None:
        self.due: list[Call] = []
        self.requests: list[dict[str, Any]] = []

    def handle(self, call: Call) -> None:
        self.due.append(call)
        self.requests.append(call.request.values())

    def cancel(self, call: Call) -> None:
        if call in self.due:
            self.due.remove(call)

    def displaced(self, service: Service) -> None:
        raise AssertionError("no other server takes it over")


class Caller:
    """A call, and the responses and errors that its caller gets."""

    def __init__(self, server: ServiceServer | None = None) -> None:
        self.server = SlowServer()
        self.received: list[object] = []
        service = Service("/add", TYPE, server or self.server)
        self.call = Call(service, REQUEST, "/caller", self._succeeded, self._failed)

    def _succeeded(self, call: Call, response: Body) -> None:
        assert call is self.call
        self.received.append(response.json())

    def _failed(self, call: Call, text: str, code: str) -> None:
        assert call is self.call
        self.received.append((text, code))


def started(timeout: float = 0.0, clock: FakeClock | None = None) -> Caller:
    caller = Caller()
    caller.call.start(timeout, (clock or FakeClock()).call_later)
    return caller


def test_service_belongs_to_the_node_of_its_server() -> None:
    assert Service("/add", TYPE, SlowServer()).node == "/server"


def test_call_waits_for_its_server() -> None:
    caller = started()
    assert caller.server.due == [caller.call]
    assert (caller.server.requests, caller.call.caller) == ([REQUEST], "/caller")
    assert caller.call.request.values() == {}, "a large request is not kept"
    assert caller.received == []


EVENTS: dict[str, tuple[Event, object]] = {
    "respond": (lambda caller: caller.call.respond({"sum": 3}), b'{"sum":3}'),
    "respond_json": (lambda caller: caller.call.respond_json(b'{"sum":4}'), b'{"sum":4}'),
    "fail": (lambda caller: caller.call.fail("no", "server_lost"), ("no", "server_lost")),
    "time_out": (
        lambda caller: caller.call.time_out(5),
        ("Service /add did not answer within 5 s", "timeout"),
    ),
    "abandon": (lambda caller: caller.call.abandon(), None),
}


@pytest.mark.parametrize("order", [*permutations(EVENTS, 3)], ids=" ".join)
def test_call_ends_with_the_first_event_only(order: tuple[str, ...]) -> None:
    caller = started()
    for name in order:
        event, _ = EVENTS[name]
        event(caller)
    _, expected = EVENTS[order[0]]
    assert caller.received == ([] if expected is None else [expected])


def test_call_without_a_response_ends_at_its_deadline() -> None:
    clock = FakeClock()
    caller = started(5.0, clock)
    clock.advance(4.9)
    assert caller.received == []
    clock.advance(0.1)
    assert caller.received == [EVENTS["time_out"][1]]


@pytest.mark.parametrize("name", EVENTS)
def test_call_that_has_ended_has_no_deadline(name: str) -> None:
    clock = FakeClock()
    event, _ = EVENTS[name]
    event(started(5.0, clock))
    assert clock.timers == 0


@pytest.mark.parametrize(("name", "left"), [("abandon", 0), ("time_out", 0), ("fail", 1)])
def test_server_need_not_respond_to_a_call_that_the_hub_ended(name: str, left: int) -> None:
    caller = started()
    EVENTS[name][0](caller)
    assert len(caller.server.due) == left


@pytest.mark.parametrize("values", [{"sum": "three"}, {"total": 3}, "3", None, []])
def test_invalid_response_is_refused_and_the_call_goes_on(values: object) -> None:
    caller = started()
    with pytest.raises(InvalidMessage):
        caller.call.respond(values)
    assert caller.received == []
    caller.call.respond({"sum": 3})
    assert caller.received == [b'{"sum":3}']


def test_missing_fields_of_a_response_get_defaults() -> None:
    caller = started()
    caller.call.respond({})
    assert caller.received == [b'{"sum":0}']


# Internal servers: the hub's own services.


def call_internal(function: Callable[[dict[str, Any], str], Response | Deferred]) -> Caller:
    return Caller(InternalServer("/rosapi", function))


@pytest.mark.parametrize("response", [{"sum": 3}, b'{"sum":3}'])
def test_internal_server_responds_with_values_or_json(response: Response) -> None:
    calls: list[tuple[dict[str, Any], str]] = []

    def function(request: dict[str, Any], node: str) -> Response:
        calls.append((request, node))
        return response

    caller = call_internal(function)
    caller.call.start(0.0, FakeClock().call_later)
    assert caller.received == [b'{"sum":3}']
    assert calls == [(REQUEST, "/caller")]


def test_error_of_an_internal_server_fails_the_call_with_its_code() -> None:
    def function(request: dict[str, Any], node: str) -> Response:
        raise OperationError("not today")

    caller = call_internal(function)
    caller.call.start(0.0, FakeClock().call_later)
    assert caller.received == [("not today", "invalid_operation")]


@pytest.mark.parametrize("response", [{"sum": "three"}, {"total": 3}])
def test_response_of_an_internal_server_is_checked(response: dict[str, Any]) -> None:
    caller = call_internal(lambda request, node: response)
    caller.call.start(0.0, FakeClock().call_later)
    [error] = caller.received
    assert isinstance(error, tuple)
    assert "rospy_tutorials/AddTwoIntsResponse" in error[0]
    assert error[1] == "invalid_message"


def test_exception_in_an_internal_server_is_logged_and_fails_the_call(
    caplog: pytest.LogCaptureFixture,
) -> None:
    def function(request: dict[str, Any], node: str) -> Response:
        raise KeyError("injected")

    caller = call_internal(function)
    caller.call.start(0.0, FakeClock().call_later)
    [error] = caller.received
    assert isinstance(error, tuple)
    assert "/add" in error[0]
    assert error[1] == "server_failed"
    assert "injected" in caplog.text


def test_internal_server_keeps_nothing_of_a_finished_call() -> None:
    server = InternalServer("/rosapi", lambda request, node: {"sum": 3})
    caller = Caller(server)
    caller.call.start(0.0, FakeClock().call_later)
    server.cancel(caller.call)
    caller.call.abandon()
    assert caller.received == [b'{"sum":3}']


class DeferredCall:
    """A call of an internal server that responds later."""

    def __init__(self) -> None:
        self.cancelled = 0
        self.response = Deferred()
        self.response.on_cancel(self._cancel)
        self.caller = call_internal(lambda request, node: self.response)
        self.caller.call.start(0.0, FakeClock().call_later)

    def _cancel(self) -> None:
        self.cancelled += 1


def test_internal_server_may_respond_later() -> None:
    deferred = DeferredCall()
    assert deferred.caller.received == []
    deferred.response.respond({"sum": 3})
    assert deferred.caller.received == [b'{"sum":3}']
    assert not deferred.cancelled


@pytest.mark.parametrize("name", ["abandon", "time_out"])
def test_deferred_response_is_cancelled_once_without_callers(name: str) -> None:
    deferred = DeferredCall()
    event, expected = EVENTS[name]
    event(deferred.caller)
    event(deferred.caller)
    assert deferred.cancelled == 1
    assert deferred.caller.received == ([] if expected is None else [expected])


def test_finished_response_is_not_cancelled() -> None:
    deferred = DeferredCall()
    deferred.response.respond({"sum": 3})
    deferred.caller.call.abandon()
    deferred.caller.call.time_out(5)
    assert (deferred.cancelled, deferred.caller.received) == (0, [b'{"sum":3}'])


def test_invalid_deferred_response_fails_the_call() -> None:
    deferred = DeferredCall()
    deferred.response.respond({"sum": "three"})
    [error] = deferred.caller.received
    assert isinstance(error, tuple)
    assert "rospy_tutorials/AddTwoIntsResponse" in error[0]
    assert error[1] == "invalid_message"


def test_deferred_response_may_be_there_before_the_call_waits_for_it() -> None:
    cancelled: list[str] = []

    def function(request: dict[str, Any], node: str) -> Deferred:
        response = Deferred()
        response.respond({"sum": 3})
        response.on_cancel(lambda: cancelled.append("after its response"))
        return response

    server = InternalServer("/rosapi", function)
    caller = Caller(server)
    caller.call.start(0.0, FakeClock().call_later)
    assert caller.received == [b'{"sum":3}']
    caller.call.abandon()
    server.cancel(caller.call)
    assert cancelled == []


@pytest.mark.parametrize("order", list(permutations(["respond", "then", "cancel", "on_cancel"])))
def test_deferred_response_ends_once_in_any_order(order: tuple[str, ...]) -> None:
    response = Deferred()
    ends: list[str] = []
    steps: dict[str, Callable[[], object]] = {
        "respond": lambda: response.respond({}),
        "then": lambda: response.then(lambda values: ends.append("responded")),
        "cancel": response.cancel,
        "on_cancel": lambda: response.on_cancel(lambda: ends.append("cancelled")),
    }
    for step in order:
        steps[step]()
    is_responded = order.index("respond") < order.index("cancel")
    assert ends == ["responded" if is_responded else "cancelled"]
    for step in order:
        if step in ("respond", "cancel"):
            steps[step]()
    assert len(ends) == 1


def test_internal_server_cannot_be_displaced() -> None:
    server = InternalServer("/rosapi", lambda request, node: {})
    with pytest.raises(AssertionError, match="/add is the hub's own"):
        server.displaced(Service("/add", TYPE, server))


@pytest.mark.parametrize("md5sum", [TYPE.md5sum, "*", None])
def test_caller_may_name_the_md5sum_of_the_type(md5sum: str | None) -> None:
    headers = {} if md5sum is None else {"md5sum": md5sum}
    service = Service("/add", TYPE, SlowServer())
    call = Call(service, REQUEST, "/caller", print, print, headers)
    assert call.request.values() == REQUEST


def test_caller_with_another_md5sum_is_refused() -> None:
    service = Service("/add", TYPE, SlowServer())
    with pytest.raises(CallFailed, match="deadbeef") as caught:
        Call(service, REQUEST, "/caller", print, print, {"md5sum": "deadbeef"})
    assert caught.value.code == "type_conflict"
