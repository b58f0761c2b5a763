"""Action clients and their goals, whether over topics or over operations."""

from __future__ import annotations

import asyncio
import logging
from typing import Any

import pytest

from fibws.errors import (
    ActionError,
    InvalidMessage,
    NodeClosed,
    NodeError,
    OperationRejected,
    WaitTimeout,
)
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions.client import ActionClient, ClientGoal
from fibws.node.session import Session
from fibws.protocol.goals import GoalStatus

from ..conftest import FakeSession
from .conftest import FibonacciType

FibonacciClientGoal = ClientGoal[FibonacciResult, FibonacciFeedback]


# Goals


@pytest.fixture
def cancels() -> list[str]:
    return []


@pytest.fixture
def goal(cancels: list[str]) -> FibonacciClientGoal:
    return ClientGoal("a", 2, cancels.append)


async def test_cancel_is_sent_until_the_goal_ends(
    goal: FibonacciClientGoal, cancels: list[str]
) -> None:
    assert (goal.id, goal.status) == ("a", GoalStatus.PENDING)
    assert repr(goal) == "<ClientGoal a PENDING>"
    await goal.cancel()
    goal._succeed(FibonacciResult([1]))
    await goal.cancel()
    assert cancels == ["a"]


async def test_result_returns_to_all_waiters_and_to_later_calls(
    goal: FibonacciClientGoal,
) -> None:
    async with asyncio.timeout(60), asyncio.TaskGroup() as tasks:
        results = [tasks.create_task(goal.result()) for _ in range(2)]
        await asyncio.sleep(0)
        goal._succeed(FibonacciResult([1]))
    assert [each.result() for each in results] == [FibonacciResult([1])] * 2
    assert await goal.result(timeout=1) == FibonacciResult([1])
    assert goal.status is GoalStatus.SUCCEEDED


async def test_result_of_failed_goal_raises_at_every_call(goal: FibonacciClientGoal) -> None:
    goal._fail(GoalStatus.ABORTED, ActionError("/fibonacci", GoalStatus.ABORTED, "no more"))
    for _ in range(2):
        with pytest.raises(ActionError, match="/fibonacci: ABORTED: no more"):
            await goal.result()
    assert goal.status is GoalStatus.ABORTED


async def test_goal_continues_after_timeout_or_cancellation_of_result(
    goal: FibonacciClientGoal,
) -> None:
    with pytest.raises(WaitTimeout, match="while waiting for the result of goal a"):
        await goal.result(timeout=0.001)
    waiting = asyncio.create_task(goal.result())
    await asyncio.sleep(0)
    waiting.cancel()
    with pytest.raises(asyncio.CancelledError):
        await waiting
    with pytest.raises(ValueError, match="timeout must be a finite number of seconds above 0"):
        await goal.result(timeout=-1)
    goal._succeed(FibonacciResult([1]))
    assert await goal.result() == FibonacciResult([1])


async def test_feedback_is_yielded_until_the_goal_ends(goal: FibonacciClientGoal) -> None:
    received: list[list[int]] = []

    async def receive() -> None:
        async for feedback in goal.feedback():
            received.append(feedback.sequence)

    async with asyncio.timeout(60), asyncio.TaskGroup() as tasks:
        tasks.create_task(receive())
        for number in range(3):
            await asyncio.sleep(0)
            goal._offer(FibonacciFeedback([number]))
        goal._succeed(FibonacciResult())
    assert received == [[0], [1], [2]]


async def test_slow_reader_gets_the_newest_feedback(goal: FibonacciClientGoal) -> None:
    for number in range(5):
        goal._offer(FibonacciFeedback([number]))
    goal._succeed(FibonacciResult())
    assert [feedback.sequence async for feedback in goal.feedback()] == [[3], [4]]
    assert goal.dropped == 3


# Clients


class RecordingClient(ActionClient[FibonacciGoal, FibonacciResult, FibonacciFeedback]):
    """A client that records what it sends."""

    def __init__(self, session: Session, type_: FibonacciType) -> None:
        super().__init__(session, "/fibonacci", type_)
        self.sent: list[Any] = []
        self.server = asyncio.Event()

    def refuse_all(self, error: NodeError) -> None:
        self._refuse(error)

    def succeed(self, goal: FibonacciClientGoal) -> None:
        self._succeed(goal, FibonacciResult([1]))

    def fail(self, goal: FibonacciClientGoal, *why: Any) -> None:
        self._fail(goal, *why)

    async def _server_available(self) -> None:
        await self.server.wait()

    def _new_id(self) -> str:
        return f"goal {len(self.sent)}"

    def _send_goal(self, id_: str, goal: dict[str, Any]) -> None:
        self.sent.append((id_, goal))

    def _send_cancel(self, id_: str) -> None:
        self.sent.append((id_, "cancel"))

    def _unadvertise(self) -> None:
        self.sent.append("unadvertise")


@pytest.fixture
def client(session: FakeSession, fibonacci: FibonacciType) -> RecordingClient:
    return RecordingClient(session, fibonacci)


async def test_goal_and_its_cancel_are_sent(client: RecordingClient) -> None:
    goal = await client.send(FibonacciGoal(5))
    assert (goal.id, goal.status) == ("goal 0", GoalStatus.PENDING)
    await goal.cancel()
    client.succeed(goal)
    await goal.cancel()
    assert client.sent == [("goal 0", {"order": 5}), ("goal 0", "cancel")]


async def test_error_has_action_status_text_and_result(client: RecordingClient) -> None:
    goal = await client.send(FibonacciGoal(5))
    client.fail(goal, GoalStatus.ABORTED, "no more numbers", FibonacciResult([0]))
    with pytest.raises(ActionError, match="/fibonacci: ABORTED: no more numbers") as caught:
        await goal.result()
    error = caught.value
    assert (error.action, error.status, error.text) == (
        "/fibonacci",
        GoalStatus.ABORTED,
        "no more numbers",
    )
    assert error.result == FibonacciResult([0])


async def test_error_without_text_names_the_status(client: RecordingClient) -> None:
    goal = await client.send(FibonacciGoal(5))
    client.fail(goal, GoalStatus.PREEMPTED, "")
    with pytest.raises(ActionError, match=r"^/fibonacci: PREEMPTED$"):
        await goal.result()


async def test_send_refuses_invalid_arguments(client: RecordingClient) -> None:
    with pytest.raises(InvalidMessage, match="order"):
        await client.send(FibonacciGoal(2**31))
    wrong: Any = FibonacciResult()
    with pytest.raises(TypeError, match="FibonacciGoal"):
        await client.send(wrong)
    with pytest.raises(ValueError, match="queue_size must be at least 1"):
        await client.send(FibonacciGoal(), queue_size=0)
    assert client.sent == []


async def test_send_waits_for_the_hub(client: RecordingClient, session: FakeSession) -> None:
    session.on_disconnect()
    sending = asyncio.create_task(client.send(FibonacciGoal(5)))
    await asyncio.sleep(0)
    assert client.sent == []
    session.reopen()
    async with asyncio.timeout(60):
        goal = await sending
    assert client.sent == [(goal.id, {"order": 5})]


async def test_canceled_send_sends_nothing_later(
    client: RecordingClient, session: FakeSession
) -> None:
    session.on_disconnect()
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.001):
            await client.send(FibonacciGoal(5))
    session.reopen()
    async with asyncio.timeout(60):
        goal = await client.send(FibonacciGoal(6))
    assert client.sent == [(goal.id, {"order": 6})]


async def test_disconnect_fails_all_goals(client: RecordingClient, session: FakeSession) -> None:
    goals = [await client.send(FibonacciGoal(5)) for _ in range(2)]
    session.on_disconnect()
    for goal in goals:
        with pytest.raises(ActionError, match="LOST: the connection to the hub was lost"):
            await goal.result()
        assert [feedback async for feedback in goal.feedback()] == []
    session.reopen()
    assert (await client.send(FibonacciGoal(5))).status is GoalStatus.PENDING


async def test_close_fails_goals_and_later_calls(client: RecordingClient) -> None:
    async with client:
        goal = await client.send(FibonacciGoal(5))
    client.close()
    assert client.sent[1:] == ["unadvertise"]
    with pytest.raises(NodeClosed, match="the client of /fibonacci was closed"):
        await goal.result()
    with pytest.raises(NodeClosed, match="the client of /fibonacci was closed"):
        await client.send(FibonacciGoal(5))


@pytest.mark.parametrize("error", [None, OperationRejected("because")])
async def test_end_of_the_node_fails_goals_and_later_calls(
    client: RecordingClient, session: FakeSession, error: OperationRejected | None
) -> None:
    goal = await client.send(FibonacciGoal(5))
    session.end(error)
    with pytest.raises(NodeError, match="because" if error else "the node has ended"):
        await goal.result()
    with pytest.raises(NodeError, match="because" if error else "the node has ended"):
        await client.send(FibonacciGoal(5))


async def test_refusal_by_the_hub_fails_goals_and_later_calls(client: RecordingClient) -> None:
    goal = await client.send(FibonacciGoal(5))
    client.refuse_all(OperationRejected("no"))
    with pytest.raises(OperationRejected, match="no"):
        await goal.result()
    with pytest.raises(OperationRejected, match="no"):
        await client.send(FibonacciGoal(5))


async def test_wait_for_server_returns_when_there_is_one(client: RecordingClient) -> None:
    async with asyncio.timeout(60), asyncio.TaskGroup() as tasks:
        tasks.create_task(client.wait_for_server())
        await asyncio.sleep(0)
        client.server.set()
    await client.wait_for_server(timeout=60)


async def test_wait_for_server_times_out(client: RecordingClient) -> None:
    with pytest.raises(WaitTimeout, match="while waiting for action server /fibonacci"):
        await client.wait_for_server(timeout=0.001)
    with pytest.raises(ValueError, match="timeout must be a finite number of seconds above 0"):
        await client.wait_for_server(timeout=0)


async def test_close_ends_pending_waits_for_a_server(client: RecordingClient) -> None:
    waiting = [asyncio.create_task(client.wait_for_server(timeout=t)) for t in (None, 60)]
    await asyncio.sleep(0)
    client.close()
    async with asyncio.timeout(60):
        for each in waiting:
            with pytest.raises(NodeClosed, match="the client of /fibonacci was closed"):
                await each
    with pytest.raises(NodeClosed, match="the client of /fibonacci was closed"):
        await client.wait_for_server()


async def test_close_during_a_timeout_takes_precedence(
    client: RecordingClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def server_available() -> None:
        try:
            await client.server.wait()
        finally:
            client.close()

    monkeypatch.setattr(client, "_server_available", server_available)
    with pytest.raises(NodeClosed):
        await client.wait_for_server(timeout=0.001)


async def test_calls_before_the_node_is_entered_are_refused(fibonacci: FibonacciType) -> None:
    client = RecordingClient(Session(logging.Logger("test")), fibonacci)
    for waiting in (client.wait_for_server(), client.send({"order": 5})):
        with pytest.raises(RuntimeError, match="enter the node first"):
            await waiting


async def test_1000_feedback_messages_are_kept_by_default(client: RecordingClient) -> None:
    goal = await client.send(FibonacciGoal(5))
    for number in range(1000):
        goal._offer(FibonacciFeedback([number]))
    client.succeed(goal)
    assert len([feedback async for feedback in goal.feedback()]) == 1000


async def test_client_has_name_and_type(client: RecordingClient) -> None:
    assert (client.name, client.type) == ("/fibonacci", "actionlib_tutorials/Fibonacci")
    assert repr(client) == "<ActionClient /fibonacci [actionlib_tutorials/Fibonacci]>"
