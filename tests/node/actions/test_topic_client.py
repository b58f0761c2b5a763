"""Action clients over topics."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from typing import Any

import pytest

from fibws.action.actionlib_tutorials import Fibonacci
from fibws.errors import ActionError, NodeClosed, OperationRejected, WaitTimeout
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions import topics
from fibws.node.actions.actions import NodeActions
from fibws.node.actions.client import ActionClient
from fibws.protocol.goals import GoalStatus

from ..conftest import FakeSession, deliver, reconnected, sent_operations

FibonacciClient = ActionClient[FibonacciGoal, FibonacciResult, FibonacciFeedback]


@pytest.fixture
async def client(actions: NodeActions) -> AsyncIterator[FibonacciClient]:
    async with actions.client("/fibonacci", Fibonacci, over="topics") as client:
        yield client


def status(id_: str, number: int, text: str = "") -> dict[str, Any]:
    return {"goal_id": {"id": id_}, "status": number, "text": text}


def receive_status(session: FakeSession, *statuses: dict[str, Any]) -> None:
    msg = {"status_list": statuses}
    deliver(session, "publish", topic="/fibonacci/status", msg=msg)


def receive(session: FakeSession, kind: str, of: dict[str, Any], **content: Any) -> None:
    deliver(session, "publish", topic=f"/fibonacci/{kind}", msg={"status": of, **content})


@pytest.mark.usefixtures("client")
async def test_client_registers_its_topics(session: FakeSession) -> None:
    assert [(each["op"], each["topic"]) for each in reconnected(session)] == [
        ("advertise", "/fibonacci/goal"),
        ("advertise", "/fibonacci/cancel"),
        ("subscribe", "/fibonacci/status"),
        ("subscribe", "/fibonacci/feedback"),
        ("subscribe", "/fibonacci/result"),
    ]


async def test_goal_and_cancel_are_published(session: FakeSession, client: FibonacciClient) -> None:
    sent_operations(session)
    goal = await client.send(FibonacciGoal(5))
    await goal.cancel()
    sent, cancel = sent_operations(session)
    assert sent["topic"] == "/fibonacci/goal"
    assert sent["msg"]["goal"] == {"order": 5}
    assert sent["msg"]["goal_id"]["id"] == goal.id == "/node-1-1700000000.500"
    assert sent["msg"]["goal_id"]["stamp"]["secs"] > 1_700_000_000
    assert cancel["topic"] == "/fibonacci/cancel"
    assert cancel["msg"] == {"id": goal.id, "stamp": {"secs": 0, "nsecs": 0}}


async def test_status_feedback_and_result_are_received(
    session: FakeSession, client: FibonacciClient
) -> None:
    goal = await client.send(FibonacciGoal(5))
    seen = [goal.status]
    receive_status(session, status("other", 4), status(goal.id, 1))
    seen.append(goal.status)
    receive(session, "feedback", status(goal.id, 6), feedback={"sequence": [0]})
    seen.append(goal.status)
    assert seen == [GoalStatus.PENDING, GoalStatus.ACTIVE, GoalStatus.PREEMPTING]
    receive(session, "result", status(goal.id, 3), result={"sequence": [0, 1]})
    assert [feedback.sequence async for feedback in goal.feedback()] == [[0]]
    assert await goal.result() == FibonacciResult([0, 1])


async def test_two_clients_of_an_action_receive_only_their_own_results(
    session: FakeSession, actions: NodeActions, client: FibonacciClient
) -> None:
    async with actions.client("/fibonacci", Fibonacci, over="topics") as other:
        goals = [await each.send(FibonacciGoal(5)) for each in (client, other)]
        for number, goal in enumerate(goals):
            receive(session, "result", status(goal.id, 3), result={"sequence": [number]})
        results = [(await goal.result(timeout=60)).sequence for goal in goals]
    assert results == [[0], [1]]


@pytest.mark.parametrize("number", [2, 4, 5, 8])
async def test_failed_goal_raises_with_status_text_and_result(
    session: FakeSession, client: FibonacciClient, number: int
) -> None:
    goal = await client.send(FibonacciGoal(5))
    receive(session, "result", status(goal.id, number, "because"), result={"sequence": [0]})
    with pytest.raises(ActionError, match="because") as error:
        await goal.result()
    assert error.value.status is goal.status is GoalStatus(number)
    assert error.value.result == FibonacciResult([0])


async def test_messages_about_other_goals_are_ignored(
    session: FakeSession, client: FibonacciClient
) -> None:
    goal = await client.send(FibonacciGoal(5))
    receive(session, "feedback", status("other", 1), feedback={"sequence": [7]})
    receive(session, "result", status("other", 3), result={})
    receive(session, "feedback", status(goal.id, 77), feedback={"sequence": [8]})
    assert goal.status is GoalStatus.PENDING
    receive(session, "result", status(goal.id, 3), result={})
    receive(session, "result", status(goal.id, 4), result={})
    assert [feedback.sequence async for feedback in goal.feedback()] == [[8]]
    assert await goal.result() == FibonacciResult()


# Lost goals


class Timer:
    def __init__(self, due: float, check: Callable[[str], None], id_: str) -> None:
        self.due = due
        self.check = check
        self.id = id_
        self.canceled = False

    def cancel(self) -> None:
        self.canceled = True


class Clock:
    """A clock that the test advances."""

    def __init__(self) -> None:
        self.time = 100.0
        self.timers: list[Timer] = []

    def now(self) -> float:
        return self.time

    def later(self, seconds: float, check: Callable[[str], None], id_: str) -> Timer:
        timer = Timer(self.time + seconds, check, id_)
        self.timers.append(timer)
        return timer

    def pending(self) -> list[Timer]:
        return [timer for timer in self.timers if not timer.canceled]

    def advance(self, seconds: float) -> None:
        """Let seconds pass, and call the timers that are due."""
        end = self.time + seconds
        while due := [timer for timer in self.pending() if timer.due <= end]:
            timer = min(due, key=lambda timer: timer.due)
            self.time = timer.due
            timer.canceled = True
            timer.check(timer.id)
        self.time = end


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(topics, "_now", clock.now)
    monkeypatch.setattr(topics, "_later", clock.later)
    return clock


async def test_goal_without_a_server_is_lost(client: FibonacciClient, clock: Clock) -> None:
    goal = await client.send(FibonacciGoal(5))
    clock.advance(4.9)
    assert goal.status is GoalStatus.PENDING
    clock.advance(0.2)
    with pytest.raises(ActionError, match=r"LOST: .*5 s; the action has no server"):
        await goal.result()


async def test_goal_that_disappears_from_the_status_is_lost(
    session: FakeSession, client: FibonacciClient, clock: Clock
) -> None:
    forgotten, waiting = [await client.send(FibonacciGoal(5)) for _ in range(2)]
    receive_status(session, status(forgotten.id, 1))
    for _ in range(30):
        clock.advance(0.2)
        receive_status(session)
    # The other one may wait in a server that lists only goals that have begun, as that of roslib.
    assert [goal.status.name for goal in (forgotten, waiting)] == ["LOST", "PENDING"]
    clock.advance(5.1)
    assert waiting.status is GoalStatus.LOST


async def test_feedback_keeps_its_goal_from_being_lost(
    session: FakeSession, client: FibonacciClient, clock: Clock
) -> None:
    active, silent = [await client.send(FibonacciGoal(5)) for _ in range(2)]
    for _ in range(3):
        clock.advance(4)
        receive(session, "feedback", status(active.id, 1), feedback={})
    assert [goal.status.name for goal in (active, silent)] == ["ACTIVE", "LOST"]


async def test_ended_goal_has_no_timer(
    session: FakeSession, client: FibonacciClient, clock: Clock
) -> None:
    goal = await client.send(FibonacciGoal(5))
    assert [timer.id for timer in clock.pending()] == [goal.id]
    receive(session, "result", status(goal.id, 3), result={})
    assert clock.pending() == []


async def test_goal_is_lost_by_the_clock_of_the_loop(
    client: FibonacciClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(topics, "LOST_AFTER", 0.01)
    goal = await client.send(FibonacciGoal(5))
    with pytest.raises(ActionError, match="LOST"):
        await goal.result(timeout=60)


# Waiting for a server


async def test_server_is_available_once_it_has_published_its_status(
    session: FakeSession, client: FibonacciClient
) -> None:
    waiting = asyncio.create_task(client.wait_for_server())
    await asyncio.sleep(0)
    assert not waiting.done()
    receive_status(session)
    async with asyncio.timeout(60):
        await waiting
        await client.wait_for_server(timeout=1)


async def test_wait_for_server_times_out(client: FibonacciClient) -> None:
    with pytest.raises(WaitTimeout, match="while waiting for action server /fibonacci"):
        await client.wait_for_server(timeout=0.001)
    with pytest.raises(ValueError, match="timeout must be a finite number of seconds above 0"):
        await client.wait_for_server(timeout=0)


async def test_server_is_unavailable_after_disconnect(
    session: FakeSession, client: FibonacciClient
) -> None:
    receive_status(session)
    await client.wait_for_server()
    session.on_disconnect()
    with pytest.raises(WaitTimeout):
        await client.wait_for_server(timeout=0.001)


async def test_silent_server_is_unavailable(
    session: FakeSession, client: FibonacciClient, clock: Clock
) -> None:
    receive_status(session)
    clock.advance(4.9)
    await client.wait_for_server(timeout=1)
    clock.advance(0.2)
    with pytest.raises(WaitTimeout):
        await client.wait_for_server(timeout=0.001)


async def test_close_ends_pending_wait_for_server(
    session: FakeSession, client: FibonacciClient
) -> None:
    waiting = asyncio.create_task(client.wait_for_server())
    await asyncio.sleep(0)
    client.close()
    with pytest.raises(NodeClosed, match="the client of /fibonacci was closed"):
        async with asyncio.timeout(60):
            await waiting


@pytest.mark.parametrize("topic", ["status", "feedback", "result", "goal", "cancel"])
async def test_refused_topic_ends_the_client(
    session: FakeSession, client: FibonacciClient, topic: str
) -> None:
    (id_,) = [
        each["id"] for each in sent_operations(session) if each["topic"] == f"/fibonacci/{topic}"
    ]
    goal = await client.send(FibonacciGoal(5))
    waiting = asyncio.create_task(client.wait_for_server())
    await asyncio.sleep(0)
    deliver(session, "status", level="error", id=id_, msg="no")
    async with asyncio.timeout(60):
        for call in (waiting, goal.result(), client.send(FibonacciGoal(5))):
            with pytest.raises(OperationRejected, match="no"):
                await call


async def test_first_refusal_is_the_one_that_is_raised(
    session: FakeSession, client: FibonacciClient
) -> None:
    for each in sent_operations(session):
        deliver(session, "status", level="error", id=each["id"], msg=each["topic"])
    with pytest.raises(OperationRejected, match="/fibonacci/status"):
        await client.wait_for_server()


async def test_server_is_available_once_goals_reach_it(
    session: FakeSession, client: FibonacciClient
) -> None:
    goals, cancels, states, *_ = [each["id"] for each in reconnected(session)]
    waiting = asyncio.create_task(client.wait_for_server(timeout=60))
    await asyncio.sleep(0)
    deliver(session, "peers", id=states, nodes=["/server"])
    for id_ in (goals, cancels):
        receive_status(session)
        await asyncio.sleep(0)
        assert not waiting.done()
        deliver(session, "peers", id=id_, nodes=["/server", "/recorder"])
    receive_status(session)
    await waiting
