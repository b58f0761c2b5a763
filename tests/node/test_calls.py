"""A node's calls of services: text in, text out, no socket."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from fibws.errors import (
    InvalidMessage,
    NodeClosed,
    NodeReplaced,
    ServiceError,
    ServiceLost,
    ServiceTimeout,
    UnknownService,
)
from fibws.node.calls import MOST_CALLS, Calls
from fibws.node.types import NodeTypes
from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsResponse, BadTwoInts
from fibws.srv.std_srvs import Trigger

from .conftest import FakeSession, Lines, deliver, next_operation, sent_operations


@pytest.fixture
def calls(session: FakeSession, types: NodeTypes) -> Calls:
    return Calls(session, types)


def add(calls: Calls, a: int, b: int, within: float | None = None) -> asyncio.Task[Any]:
    call = calls.call("/add", AddTwoInts, AddTwoInts.Request(a, b), within=within)
    return asyncio.create_task(call)


def responds(
    session: FakeSession, call: dict[str, Any], values: Any, result: bool = True, **more: Any
) -> None:
    deliver(
        session,
        "service_response",
        id=call["id"],
        service=call["service"],
        values=values,
        result=result,
        **more,
    )


async def test_call_is_sent_and_its_response_returned(session: FakeSession, calls: Calls) -> None:
    answer = add(calls, 1, 2)
    call = await next_operation(session)
    assert (call["op"], call["service"], call["args"]) == ("call_service", "/add", {"a": 1, "b": 2})
    assert "timeout" not in call
    responds(session, call, {"sum": 3})
    assert await answer == AddTwoIntsResponse(3)
    assert len(calls) == 0


@pytest.mark.parametrize("request_", [None, {}, Trigger.Request()])
async def test_missing_fields_have_their_defaults(
    session: FakeSession, calls: Calls, request_: Any
) -> None:
    answer = asyncio.create_task(calls.call("/go", Trigger, request_))
    call = await next_operation(session)
    assert call["args"] == {}
    responds(session, call, {"success": True})
    assert await answer == Trigger.Response(success=True, message="")


async def test_invalid_request_raises_and_is_not_sent(session: FakeSession, calls: Calls) -> None:
    with pytest.raises(InvalidMessage, match="field a"):
        await calls.call("/add", AddTwoInts, {"a": "1"})
    with pytest.raises(TypeError, match="rospy_tutorials/BadTwoIntsRequest"):
        await calls.call("/add", AddTwoInts, BadTwoInts.Request(1, 2))  # type: ignore[misc]
    assert sent_operations(session) == []


async def test_each_caller_gets_its_own_response(session: FakeSession, calls: Calls) -> None:
    answers = [add(calls, number, 0) for number in range(3)]
    for call in reversed([await next_operation(session) for _ in range(3)]):
        responds(session, call, {"sum": call["args"]["a"]})
    assert [(await answer).sum for answer in answers] == [0, 1, 2]


@pytest.mark.parametrize(
    ("values", "text"), [("boom", "boom"), (None, "null"), ({"sum": 1}, '{"sum":1}')]
)
async def test_failed_call_raises_the_text_of_the_server(
    session: FakeSession, calls: Calls, values: Any, text: str
) -> None:
    answer = add(calls, 1, 2)
    responds(session, await next_operation(session), values, result=False)
    with pytest.raises(ServiceError) as caught:
        await answer
    assert (caught.value.service, caught.value.text) == ("/add", text)
    assert str(caught.value) == f"/add: {text}"


@pytest.mark.parametrize(
    ("code", "kind"),
    [
        ("unknown_service", UnknownService),
        ("timeout", ServiceTimeout),
        ("server_lost", ServiceError),
        ("new_in_a_later_hub", ServiceError),
        (None, ServiceError),
    ],
)
async def test_error_is_recognised_by_its_code(
    session: FakeSession, calls: Calls, code: str | None, kind: type[ServiceError]
) -> None:
    text = "Service /add does not exist"
    answer = add(calls, 1, 2)
    responds(session, await next_operation(session), text, result=False, code=code)
    with pytest.raises(ServiceError) as caught:
        await answer
    assert type(caught.value) is kind
    assert caught.value.code == (code or "error")
    assert str(caught.value).endswith(text)


async def test_calls_above_the_limit_of_the_hub_wait_for_their_turn(
    session: FakeSession, calls: Calls
) -> None:
    answers = [add(calls, number, 0) for number in range(MOST_CALLS + 2)]
    sent = [await next_operation(session) for _ in range(MOST_CALLS)]
    other = asyncio.create_task(calls.call("/go", Trigger))
    responds(session, await next_operation(session), {"success": True})
    assert (await other).success  # It need not wait: who answers /add may be in need of it.
    for call in sent:
        responds(session, call, {"sum": 0})
    for _ in range(2):
        responds(session, await next_operation(session), {"sum": 1})
    assert [(await answer).sum for answer in answers] == MOST_CALLS * [0] + [1, 1]
    assert len(calls) == 0


async def test_call_waiting_for_its_turn_ends_at_timeout_and_with_the_node(
    session: FakeSession, calls: Calls
) -> None:
    answers = [add(calls, number, 0) for number in range(MOST_CALLS)]
    await next_operation(session)
    with pytest.raises(ServiceTimeout, match="/add: no response within"):
        await add(calls, 1, 2, within=0.01)
    last = add(calls, 1, 2)
    await asyncio.sleep(0)
    session.end()
    for answer in [*answers, last]:
        with pytest.raises(NodeClosed):
            await answer


@pytest.mark.parametrize("values", [None, {"sum": "three"}, {"total": 3}, "3"])
async def test_invalid_response_fails_the_call(
    session: FakeSession, calls: Calls, values: Any
) -> None:
    answer = add(calls, 1, 2)
    responds(session, await next_operation(session), values)
    with pytest.raises(ServiceError, match="does not fit rospy_tutorials/AddTwoInts"):
        await answer


async def test_refused_call_fails(session: FakeSession, calls: Calls) -> None:
    answer = add(calls, 1, 2)
    call = await next_operation(session)
    deliver(session, "status", level="error", id=call["id"], msg="call_service: no")
    with pytest.raises(ServiceError, match="call_service: no"):
        await answer


async def test_call_times_out(session: FakeSession, calls: Calls, lines: Lines) -> None:
    answer = add(calls, 1, 2, within=0.05)
    call = await next_operation(session)
    assert 0 < call["timeout"] <= 0.05 + 1e-9  # uvloop rounds its clock.
    with pytest.raises(ServiceTimeout, match=r"^/add: no response within 0.05 s$"):
        await answer
    assert issubclass(ServiceTimeout, TimeoutError)
    responds(session, call, {"sum": 3})
    assert lines.seen() == []
    assert len(calls) == 0


async def test_call_waits_for_a_hub(session: FakeSession, calls: Calls) -> None:
    session.on_disconnect()
    answer = add(calls, 1, 2)
    await asyncio.sleep(0)
    session.on_disconnect()
    session.reopen()
    call = await next_operation(session)
    responds(session, call, {"sum": 3})
    assert (await answer).sum == 3


async def test_round_trip_ends_with_any_response(session: FakeSession, calls: Calls) -> None:
    waiting = asyncio.create_task(calls.round_trip())
    call = await next_operation(session)
    deliver(
        session,
        "service_response",
        id=call["id"],
        service=call["service"],
        values="unknown service",
        result=False,
    )
    await waiting


async def test_round_trip_starts_over_on_the_next_connection(
    session: FakeSession, calls: Calls
) -> None:
    waiting = asyncio.create_task(calls.round_trip())
    first = await next_operation(session)
    session.on_disconnect()
    session.reconnect()
    second = await next_operation(session)
    assert second["id"] != first["id"]
    assert not waiting.done()
    deliver(session, "service_response", id=second["id"], service=second["service"], result=True)
    await waiting


async def test_call_times_out_without_a_hub(session: FakeSession, calls: Calls) -> None:
    session.on_disconnect()
    with pytest.raises(ServiceTimeout, match="no hub within"):
        await add(calls, 1, 2, within=0.01)


async def test_callers_wait_while_the_connection_is_full(
    session: FakeSession, calls: Calls
) -> None:
    session.fill()
    answer = add(calls, 1, 2)
    await asyncio.sleep(0)
    assert len(session.outgoing) == 1
    session.drain()
    responds(session, await next_operation(session), {"sum": 3})
    await answer


async def test_call_waiting_for_room_waits_for_the_next_hub_after_disconnect(
    session: FakeSession, calls: Calls
) -> None:
    session.fill()
    answer = add(calls, 1, 2)
    await asyncio.sleep(0)
    session.on_disconnect()
    for _ in range(3):
        await asyncio.sleep(0)
    assert sent_operations(session) == []
    session.reopen()
    responds(session, await next_operation(session), {"sum": 3})
    await answer


async def test_disconnect_fails_pending_calls_at_once(session: FakeSession, calls: Calls) -> None:
    answer = add(calls, 1, 2)
    await next_operation(session)
    session.on_disconnect()
    with pytest.raises(ServiceLost, match="the connection to the hub was lost"):
        await answer


@pytest.mark.parametrize(
    ("fault", "raised"), [(None, NodeClosed), (NodeReplaced("by another"), NodeReplaced)]
)
async def test_end_of_the_node_fails_all_calls(
    session: FakeSession, calls: Calls, fault: Exception | None, raised: type[Exception]
) -> None:
    sent = add(calls, 1, 2)
    await next_operation(session)
    session.end(fault)
    session.on_disconnect()
    with pytest.raises(raised):
        await sent
    with pytest.raises(raised):
        await add(calls, 1, 2)


async def test_end_of_the_node_fails_calls_waiting_for_a_hub(
    session: FakeSession, calls: Calls
) -> None:
    session.on_disconnect()
    answer = add(calls, 1, 2)
    await asyncio.sleep(0)
    session.end()
    with pytest.raises(NodeClosed):
        await answer


async def test_cancelled_call_leaves_nothing_behind(
    session: FakeSession, calls: Calls, lines: Lines
) -> None:
    answer = add(calls, 1, 2)
    call = await next_operation(session)
    session.on_disconnect()  # Both at once: it is the cancellation that counts.
    answer.cancel()
    with pytest.raises(asyncio.CancelledError):
        await answer
    assert len(calls) == 0
    responds(session, call, {"sum": 3})
    assert lines.seen() == []


async def test_call_carries_the_headers_of_its_caller(session: FakeSession, calls: Calls) -> None:
    for headers, said_ in (({"user": "ann"}, {"user": "ann"}), ({}, None), (None, None)):
        answer = asyncio.create_task(calls.call("/go", Trigger, headers=headers))
        call = await next_operation(session)
        assert call.get("headers") == said_
        responds(session, call, {})
        await answer


async def test_invalid_headers_are_refused_at_once(session: FakeSession, calls: Calls) -> None:
    with pytest.raises(ValueError, match="headers must be an object of strings"):
        await calls.call("/go", Trigger, headers={"a=b": "c"})
    assert sent_operations(session) == []
