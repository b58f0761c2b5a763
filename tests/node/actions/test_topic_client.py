"""A client over topics: what it makes of which message."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from typing import Any

import pytest

from fibws.errors import ActionError, NodeClosed, OperationRejected, WaitTimeout
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions import topic_client
from fibws.node.actions.actions import Actions
from fibws.node.actions.status import GoalStatus
from fibws.node.actions.topic_client import TopicActionClient
from fibws.node.session import Session

from ..conftest import greeted, hears, said
from .conftest import FibonacciType

FibonacciClient = TopicActionClient[FibonacciGoal, FibonacciResult, FibonacciFeedback]


@pytest.fixture
async def client(
    session: Session, actions: Actions, fibonacci: FibonacciType
) -> AsyncIterator[FibonacciClient]:
    async with TopicActionClient(actions, "/fibonacci", fibonacci) as client:
        yield client


def status(id_: str, number: int, text: str = "") -> dict[str, Any]:
    return {"goal_id": {"id": id_}, "status": number, "text": text}


def tell_status(session: Session, *statuses: dict[str, Any]) -> None:
    msg = {"status_list": statuses}
    hears(session, "publish", topic="/fibonacci/status", msg=msg)


def tell(session: Session, kind: str, of: dict[str, Any], **content: Any) -> None:
    hears(session, "publish", topic=f"/fibonacci/{kind}", msg={"status": of, **content})


@pytest.mark.usefixtures("client")
async def test_it_registers_its_topics(session: Session) -> None:
    assert [(each["op"], each["topic"]) for each in greeted(session)] == [
        ("advertise", "/fibonacci/goal"),
        ("advertise", "/fibonacci/cancel"),
        ("subscribe", "/fibonacci/status"),
        ("subscribe", "/fibonacci/feedback"),
        ("subscribe", "/fibonacci/result"),
    ]


async def test_a_goal_and_its_cancel_are_actionlibs(
    session: Session, client: FibonacciClient
) -> None:
    said(session)
    goal = await client.send(FibonacciGoal(5))
    await goal.cancel()
    sent, cancel = said(session)
    assert sent["topic"] == "/fibonacci/goal"
    assert sent["msg"]["goal"] == {"order": 5}
    assert sent["msg"]["goal_id"]["id"] == goal.id == "/node-1-1700000000.500"
    assert sent["msg"]["goal_id"]["stamp"]["secs"] > 1_700_000_000
    assert cancel["topic"] == "/fibonacci/cancel"
    assert cancel["msg"] == {"id": goal.id, "stamp": {"secs": 0, "nsecs": 0}}


async def test_a_goal_is_followed_to_its_result(session: Session, client: FibonacciClient) -> None:
    goal = await client.send(FibonacciGoal(5))
    seen = [goal.status]
    tell_status(session, status("other", 4), status(goal.id, 1))
    seen.append(goal.status)
    tell(session, "feedback", status(goal.id, 6), feedback={"sequence": [0]})
    seen.append(goal.status)
    assert seen == [GoalStatus.PENDING, GoalStatus.ACTIVE, GoalStatus.PREEMPTING]
    tell(session, "result", status(goal.id, 3), result={"sequence": [0, 1]})
    assert [feedback.sequence async for feedback in goal.feedback()] == [[0]]
    assert await goal.result() == FibonacciResult([0, 1])


async def test_two_clients_of_one_action_hear_of_their_own_goals_alone(
    session: Session, actions: Actions, fibonacci: FibonacciType, client: FibonacciClient
) -> None:
    async with TopicActionClient(actions, "/fibonacci", fibonacci) as other:
        goals = [await each.send(FibonacciGoal(5)) for each in (client, other)]
        for number, goal in enumerate(goals):
            tell(session, "result", status(goal.id, 3), result={"sequence": [number]})
        results = [(await goal.result(timeout=60)).sequence for goal in goals]
    assert results == [[0], [1]]


@pytest.mark.parametrize("number", [2, 4, 5, 8])
async def test_a_goal_that_did_not_succeed_says_why(
    session: Session, client: FibonacciClient, number: int
) -> None:
    goal = await client.send(FibonacciGoal(5))
    tell(session, "result", status(goal.id, number, "because"), result={"sequence": [0]})
    with pytest.raises(ActionError, match="because") as error:
        await goal.result()
    assert error.value.status is goal.status is GoalStatus(number)
    assert error.value.result == FibonacciResult([0])


async def test_what_is_said_of_others_goals_is_passed_over(
    session: Session, client: FibonacciClient
) -> None:
    goal = await client.send(FibonacciGoal(5))
    tell(session, "feedback", status("other", 1), feedback={"sequence": [7]})
    tell(session, "result", status("other", 3), result={})
    tell(session, "feedback", status(goal.id, 77), feedback={"sequence": [8]})
    assert goal.status is GoalStatus.PENDING
    tell(session, "result", status(goal.id, 3), result={})
    tell(session, "result", status(goal.id, 4), result={})
    assert [feedback.sequence async for feedback in goal.feedback()] == [[8]]
    assert await goal.result() == FibonacciResult()


# When nothing is heard


class Timer:
    def __init__(self, due: float, look: Callable[[str], None], id_: str) -> None:
        self.due = due
        self.look = look
        self.id = id_
        self.canceled = False

    def cancel(self) -> None:
        self.canceled = True


class Clock:
    """The client's clock, which the test sets."""

    def __init__(self) -> None:
        self.time = 100.0
        self.timers: list[Timer] = []

    def now(self) -> float:
        return self.time

    def later(self, seconds: float, look: Callable[[str], None], id_: str) -> Timer:
        timer = Timer(self.time + seconds, look, id_)
        self.timers.append(timer)
        return timer

    def waiting(self) -> list[Timer]:
        return [timer for timer in self.timers if not timer.canceled]

    def go_on(self, seconds: float) -> None:
        """Let this time pass."""
        end = self.time + seconds
        while due := [timer for timer in self.waiting() if timer.due <= end]:
            timer = min(due, key=lambda timer: timer.due)
            self.time = timer.due
            timer.canceled = True
            timer.look(timer.id)
        self.time = end


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(topic_client, "_now", clock.now)
    monkeypatch.setattr(topic_client, "_later", clock.later)
    return clock


async def test_without_a_server_a_goal_is_lost(client: FibonacciClient, clock: Clock) -> None:
    goal = await client.send(FibonacciGoal(5))
    clock.go_on(4.9)
    assert goal.status is GoalStatus.PENDING
    clock.go_on(0.2)
    with pytest.raises(ActionError, match="LOST: nothing was heard of it for 5 s"):
        await goal.result()


async def test_a_goal_that_its_server_forgets_is_lost(
    session: Session, client: FibonacciClient, clock: Clock
) -> None:
    forgotten, waiting = [await client.send(FibonacciGoal(5)) for _ in range(2)]
    tell_status(session, status(forgotten.id, 1))
    for _ in range(30):
        clock.go_on(0.2)
        tell_status(session)
    # The other one may be in the queue of a server that lists only what it has begun, as roslib's.
    assert [goal.status.name for goal in (forgotten, waiting)] == ["LOST", "PENDING"]
    clock.go_on(5.1)
    assert waiting.status is GoalStatus.LOST


async def test_a_goal_that_is_heard_of_is_not_lost(
    session: Session, client: FibonacciClient, clock: Clock
) -> None:
    heard, silent = [await client.send(FibonacciGoal(5)) for _ in range(2)]
    for _ in range(3):
        clock.go_on(4)
        tell(session, "feedback", status(heard.id, 1), feedback={})
    assert [goal.status.name for goal in (heard, silent)] == ["ACTIVE", "LOST"]


async def test_nobody_looks_after_a_goal_that_has_ended(
    session: Session, client: FibonacciClient, clock: Clock
) -> None:
    goal = await client.send(FibonacciGoal(5))
    assert [timer.id for timer in clock.waiting()] == [goal.id]
    tell(session, "result", status(goal.id, 3), result={})
    assert clock.waiting() == []


async def test_time_passes_by_the_loops_clock(
    client: FibonacciClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(topic_client, "LOST_AFTER", 0.01)
    goal = await client.send(FibonacciGoal(5))
    with pytest.raises(ActionError, match="LOST"):
        await goal.result(timeout=60)


# The server


async def test_a_server_is_there_once_it_has_told_its_status(
    session: Session, client: FibonacciClient
) -> None:
    waiting = asyncio.create_task(client.wait_for_server())
    await asyncio.sleep(0)
    assert not waiting.done()
    tell_status(session)
    async with asyncio.timeout(60):
        await waiting
        await client.wait_for_server(timeout=1)


async def test_a_server_that_is_not_there_is_waited_for_so_long(client: FibonacciClient) -> None:
    with pytest.raises(WaitTimeout, match="while waiting for action server /fibonacci"):
        await client.wait_for_server(timeout=0.001)
    with pytest.raises(ValueError, match="a timeout is a number of seconds above 0"):
        await client.wait_for_server(timeout=0)


async def test_a_server_of_a_lost_hub_is_there_no_more(
    session: Session, client: FibonacciClient
) -> None:
    tell_status(session)
    await client.wait_for_server()
    session.lose()
    with pytest.raises(WaitTimeout):
        await client.wait_for_server(timeout=0.001)


async def test_a_server_that_falls_silent_is_there_no_more(
    session: Session, client: FibonacciClient, clock: Clock
) -> None:
    tell_status(session)
    clock.go_on(4.9)
    await client.wait_for_server(timeout=1)
    clock.go_on(0.2)
    with pytest.raises(WaitTimeout):
        await client.wait_for_server(timeout=0.001)


async def test_who_waits_for_a_server_hears_of_the_end(
    session: Session, client: FibonacciClient
) -> None:
    waiting = asyncio.create_task(client.wait_for_server())
    await asyncio.sleep(0)
    client.close()
    with pytest.raises(NodeClosed, match="the client of /fibonacci was closed"):
        async with asyncio.timeout(60):
            await waiting


@pytest.mark.parametrize("topic", ["status", "feedback", "result", "goal", "cancel"])
async def test_a_topic_that_the_hub_refuses_ends_it(
    session: Session, client: FibonacciClient, topic: str
) -> None:
    (id_,) = [each["id"] for each in said(session) if each["topic"] == f"/fibonacci/{topic}"]
    goal = await client.send(FibonacciGoal(5))
    waiting = asyncio.create_task(client.wait_for_server())
    await asyncio.sleep(0)
    hears(session, "status", level="error", id=id_, msg="no")
    async with asyncio.timeout(60):
        for told in (waiting, goal.result(), client.send(FibonacciGoal(5))):
            with pytest.raises(OperationRejected, match="no"):
                await told


async def test_what_is_refused_twice_has_ended_once(
    session: Session, client: FibonacciClient
) -> None:
    for each in said(session):
        hears(session, "status", level="error", id=each["id"], msg=each["topic"])
    with pytest.raises(OperationRejected, match="/fibonacci/status"):
        await client.wait_for_server()
