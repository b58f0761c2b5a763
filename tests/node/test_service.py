"""The answering end of a service: text in, text out, no socket."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable
from io import StringIO
from typing import Any

import pytest

from fibws.node import session as module
from fibws.node.services import MOST_CALLS, MOST_WAITING, NodeServices, ServiceServer
from fibws.node.types import NodeTypes
from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest, AddTwoIntsResponse

from .conftest import FakeSession, Lines, deliver, next_operation, sent_operations
from .stubborn import Stubborn

Serve = Callable[[Any], ServiceServer[Any, Any]]


@pytest.fixture
def serve(session: FakeSession, types: NodeTypes) -> Serve:
    """Serves ``/add``."""
    services = NodeServices(session, types)

    def serve(handler: Any) -> ServiceServer[Any, Any]:
        server = services.serve("/add", AddTwoInts, handler)
        sent_operations(session)
        return server

    return serve


def send_call(session: FakeSession, a: int = 1, b: int = 2, id_: str = "call") -> None:
    deliver(session, "call_service", id=id_, service="/add", args={"a": a, "b": b})


class Gate:
    """A handler that answers when it is let."""

    def __init__(self) -> None:
        self.entered: list[int] = []
        self.left: list[int] = []
        self.open = asyncio.Event()

    async def __call__(self, request: AddTwoIntsRequest) -> int:
        self.entered.append(request.a)
        try:
            if request.a:
                await self.open.wait()
            return request.a + request.b
        finally:
            self.left.append(request.a)

    async def settled(self, session: FakeSession) -> None:
        """Wait until all that began has ended."""
        async with asyncio.timeout(60):
            await session.tasks.finished()


def plain(request: AddTwoIntsRequest) -> AddTwoIntsResponse:
    return AddTwoIntsResponse(request.a + request.b)


async def coroutine(request: AddTwoIntsRequest) -> AddTwoIntsResponse:
    await asyncio.sleep(0)
    return plain(request)


def future(request: AddTwoIntsRequest) -> Awaitable[AddTwoIntsResponse]:
    return asyncio.ensure_future(coroutine(request))


@pytest.mark.parametrize("handler", [plain, coroutine, future, lambda request: (3,)])
async def test_handler_is_called_with_the_request(
    session: FakeSession, serve: Serve, handler: Any
) -> None:
    serve(handler)
    send_call(session)
    assert await next_operation(session) == {
        "op": "service_response",
        "id": "call",
        "service": "/add",
        "values": {"sum": 3},
        "result": True,
    }


@pytest.mark.parametrize(
    ("fault", "text"),
    [
        (ValueError("boom"), "ValueError: boom"),
        (KeyError("boom"), "KeyError: 'boom'"),
        (AssertionError(), "AssertionError"),
        (OSError("no file \udcff"), "OSError: no file ?"),
    ],
)
async def test_exception_in_the_handler_fails_only_its_call(
    session: FakeSession, serve: Serve, lines: Lines, fault: Exception, text: str
) -> None:
    def fail(request: AddTwoIntsRequest) -> None:
        raise fault

    serve(fail)
    for _ in range(2):
        send_call(session)
        answer = await next_operation(session)
        assert answer["values"] == f"error processing request: {text}"
        assert answer["result"] is False
    assert lines.seen() == 2 * [f"Service /add failed: {text}"]


async def test_invalid_response_fails_the_call(
    session: FakeSession, serve: Serve, lines: Lines
) -> None:
    serve(lambda request: None)
    send_call(session)
    text = "service cannot process request: service handler returned None"
    assert (await next_operation(session))["values"] == text
    assert lines.seen() == ["Service /add failed: service handler returned None"]


async def test_response_that_contains_itself_fails_the_call(
    session: FakeSession, serve: Serve
) -> None:
    endless: list[Any] = []
    endless.append(endless)
    serve(lambda request: {"sum": endless})
    send_call(session)
    assert (await next_operation(session))["result"] is False


async def test_invalid_request_fails_the_call(session: FakeSession, serve: Serve) -> None:
    serve(plain)
    deliver(session, "call_service", id="call", service="/add", args={"c": 1})
    answer = await next_operation(session)
    assert answer["result"] is False
    assert "does not have a field c" in answer["values"]


async def test_calls_are_handled_concurrently(session: FakeSession, serve: Serve) -> None:
    gate = Gate()
    serve(gate)
    send_call(session, 1, id_="slow")
    send_call(session, 0, id_="fast")
    assert (await next_operation(session))["id"] == "fast"
    gate.open.set()
    assert (await next_operation(session))["id"] == "slow"


async def test_number_of_concurrent_calls_is_limited(session: FakeSession, serve: Serve) -> None:
    gate = Gate()
    serve(gate)
    most = MOST_CALLS + MOST_WAITING
    for number in range(most):
        send_call(session, number + 1)
    send_call(session, id_="too many")
    (refused,) = sent_operations(session)
    assert (refused["id"], refused["result"]) == ("too many", False)
    assert refused["values"] == f"service [/add] is busy with {most} calls"
    await asyncio.sleep(0)
    assert gate.entered == list(range(1, MOST_CALLS + 1))
    gate.open.set()
    await gate.settled(session)
    assert gate.entered == list(range(1, most + 1))
    assert len(sent_operations(session)) == most
    send_call(session, 0)
    assert (await next_operation(session))["result"] is True


async def test_calls_of_a_lost_hub_are_dropped(session: FakeSession, serve: Serve) -> None:
    gate = Gate()
    serve(gate)
    for _ in range(MOST_CALLS + 1):
        send_call(session, 1)
    await asyncio.sleep(0)
    session.on_disconnect()
    gate.open.set()
    await gate.settled(session)
    assert len(gate.entered) == MOST_CALLS


async def test_exceptions_of_handlers_are_logged_but_not_errors_of_callers(
    session: FakeSession, serve: Serve
) -> None:
    def divide(request: AddTwoIntsRequest) -> int:
        return request.a // request.b

    log = StringIO()
    session.log.addHandler(logging.StreamHandler(log))
    serve(divide)
    send_call(session, 1, 0)
    await next_operation(session)
    deliver(session, "call_service", id="call", service="/add", args={"c": 1})
    await next_operation(session)
    failed, *traceback, asked = log.getvalue().splitlines()
    assert failed.startswith("Service /add failed: ZeroDivisionError: ")
    assert any(line.endswith("in divide") for line in traceback)
    assert asked.startswith("Service /add got an invalid request: ")


async def raise_now(request: AddTwoIntsRequest) -> None:
    raise BrokenPipeError


async def fail_and_be_logged(request: AddTwoIntsRequest) -> None:
    raise ValueError


@pytest.mark.parametrize("handler", [raise_now, fail_and_be_logged])
async def test_broken_pipe_in_a_handler_ends_the_node(
    session: FakeSession, serve: Serve, handler: Any
) -> None:
    class Unread(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            raise BrokenPipeError

    session.log.addHandler(Unread())
    server = serve(handler)
    send_call(session)
    async with asyncio.timeout(60):
        with pytest.raises(BrokenPipeError):
            await session.ended()
    with pytest.raises(BrokenPipeError):
        await server.spin()
    await session.tasks.finished()
    assert sent_operations(session) == []


async def test_leaving_a_service_waits_for_its_handlers_for_a_while(
    session: FakeSession, serve: Serve, lines: Lines, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "HANDLER_TIMEOUT", 0.0)
    handler = Stubborn()
    async with serve(handler):
        for number in range(module.MOST_NAMED + 2):
            send_call(session, id_=f"call {number}")
        await handler.begun.wait()
    (line,) = lines.seen()
    assert "handler of service /add (call call 0)" in line
    assert line.endswith(" and 2 more.")
    await handler.ends()
    await session.tasks.finished()


async def test_responses_wait_for_room(session: FakeSession, serve: Serve) -> None:
    serve(plain)
    session.fill()
    send_call(session)
    await asyncio.sleep(0)
    assert len(session.outgoing) == 1
    session.drain()
    assert (await next_operation(session))["id"] == "call"


async def test_close_cancels_calls_in_progress(session: FakeSession, serve: Serve) -> None:
    gate = Gate()
    async with serve(gate) as server:
        send_call(session, 1)
        await asyncio.sleep(0)
        assert gate.entered == [1]
    assert gate.left == [1]
    assert [each["op"] for each in sent_operations(session)] == ["unadvertise_service"]
    await server.spin()


async def test_handler_may_close_its_service(session: FakeSession, serve: Serve) -> None:
    left = asyncio.Event()

    async def once(request: AddTwoIntsRequest) -> int:
        async with server:
            pass
        left.set()
        return 3

    server = serve(once)
    send_call(session)
    async with asyncio.timeout(60):
        await left.wait()
        await server.spin()


async def test_end_of_the_node_ends_the_service(session: FakeSession, serve: Serve) -> None:
    gate = Gate()
    server = serve(gate)
    send_call(session, 1)
    await asyncio.sleep(0)
    session.end()
    await server.spin()
    await gate.settled(session)
    assert gate.left == [1]
    assert sent_operations(session) == []


async def test_responses_to_calls_of_a_lost_hub_are_not_sent_to_the_next(
    session: FakeSession, serve: Serve
) -> None:
    gate = Gate()
    serve(gate)
    send_call(session, 1)
    await asyncio.sleep(0)
    session.on_disconnect()
    session.reopen()
    gate.open.set()
    await gate.settled(session)
    assert gate.left == [1]
    assert sent_operations(session) == []


async def test_cancelled_handler_still_responds(session: FakeSession, serve: Serve) -> None:
    async def give_up(request: AddTwoIntsRequest) -> int:
        raise asyncio.CancelledError

    serve(give_up)
    send_call(session)
    answer = await next_operation(session)
    assert answer["values"] == "error processing request: it was cancelled"
    assert answer["result"] is False
