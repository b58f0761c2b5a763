"""A goal that was sent, whichever way."""

from __future__ import annotations

import asyncio
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
from fibws.node.actions.actions import Actions
from fibws.node.actions.client import ActionClient, ClientGoal
from fibws.node.actions.status import GoalStatus
from fibws.node.session import Session

from .conftest import FibonacciType

FibonacciClientGoal = ClientGoal[FibonacciResult, FibonacciFeedback]


class Told(ActionClient[FibonacciGoal, FibonacciResult, FibonacciFeedback]):
    """A client that remembers what it has told the graph."""

    def open(self) -> None:
        self.told: list[Any] = []

    def refuse_all(self, fault: NodeError) -> None:
        self._refuse(fault)

    def succeed(self, goal: FibonacciClientGoal) -> None:
        self._succeed(goal, FibonacciResult([1]))

    def fail(self, goal: FibonacciClientGoal, *why: Any) -> None:
        self._fail(goal, *why)

    async def wait_for_server(self, timeout: float | None = None) -> None:
        raise AssertionError

    def _new_id(self) -> str:
        return f"goal {len(self.told)}"

    def _tell_goal(self, id_: str, goal: dict[str, Any]) -> None:
        self.told.append((id_, goal))

    def _tell_cancel(self, id_: str) -> None:
        self.told.append((id_, "cancel"))

    def _unadvertise(self) -> None:
        self.told.append("unadvertise")


@pytest.fixture
def client(actions: Actions, fibonacci: FibonacciType) -> Told:
    client = Told(actions, "/fibonacci", fibonacci)
    client.open()
    return client


async def test_a_goal_is_sent_and_may_be_canceled_until_it_ends(client: Told) -> None:
    goal = await client.send(FibonacciGoal(5))
    assert (goal.id, goal.status) == ("goal 0", GoalStatus.PENDING)
    assert repr(goal) == "<ClientGoal goal 0 PENDING>"
    await goal.cancel()
    client.succeed(goal)
    await goal.cancel()
    assert client.told == [("goal 0", {"order": 5}), ("goal 0", "cancel")]


async def test_its_result_is_there_for_all_who_wait_and_who_ask_later(client: Told) -> None:
    goal = await client.send({"order": 5})
    async with asyncio.timeout(5), asyncio.TaskGroup() as tasks:
        results = [tasks.create_task(goal.result()) for _ in range(2)]
        await asyncio.sleep(0)
        client.succeed(goal)
    assert [each.result() for each in results] == [FibonacciResult([1])] * 2
    assert await goal.result(timeout=1) == FibonacciResult([1])
    assert goal.status is GoalStatus.SUCCEEDED


async def test_what_became_of_it_is_told_as_often_as_it_is_asked(client: Told) -> None:
    goal = await client.send(FibonacciGoal(5))
    client.fail(goal, GoalStatus.ABORTED, "no more numbers", FibonacciResult([0]))
    for _ in range(2):
        with pytest.raises(ActionError, match="/fibonacci: ABORTED: no more numbers") as error:
            await goal.result()
    fault = error.value
    assert (fault.action, fault.status, fault.text) == (
        "/fibonacci",
        GoalStatus.ABORTED,
        "no more numbers",
    )
    assert fault.result == FibonacciResult([0])


async def test_an_error_without_a_text_names_the_status(client: Told) -> None:
    goal = await client.send(FibonacciGoal(5))
    client.fail(goal, GoalStatus.PREEMPTED, "")
    with pytest.raises(ActionError, match=r"^/fibonacci: PREEMPTED$"):
        await goal.result()


async def test_a_goal_goes_on_when_nobody_waits_for_it_any_more(client: Told) -> None:
    goal = await client.send(FibonacciGoal(5))
    with pytest.raises(TimeoutError, match="while waiting for the result of goal goal 0"):
        await goal.result(timeout=0.001)
    waiting = asyncio.create_task(goal.result())
    await asyncio.sleep(0)
    waiting.cancel()
    with pytest.raises(asyncio.CancelledError):
        await waiting
    client.succeed(goal)
    assert await goal.result() == FibonacciResult([1])
    with pytest.raises(WaitTimeout):
        await (await client.send(FibonacciGoal(5))).result(timeout=0.001)
    with pytest.raises(ValueError, match="a timeout is a number of seconds above 0"):
        await goal.result(timeout=-1)


async def test_feedback_is_heard_until_the_goal_ends(client: Told) -> None:
    goal = await client.send(FibonacciGoal(5))
    heard: list[list[int]] = []

    async def listen() -> None:
        async for feedback in goal.feedback():
            heard.append(feedback.sequence)

    async with asyncio.timeout(5), asyncio.TaskGroup() as tasks:
        tasks.create_task(listen())
        for number in range(3):
            await asyncio.sleep(0)
            goal.offer(FibonacciFeedback([number]))
        client.fail(goal, GoalStatus.ABORTED, "")
    assert heard == [[0], [1], [2]]


async def test_who_reads_feedback_too_slowly_gets_the_newest(client: Told) -> None:
    goal = await client.send(FibonacciGoal(5), queue_size=2)
    for number in range(5):
        goal.offer(FibonacciFeedback([number]))
    client.succeed(goal)
    assert [feedback.sequence async for feedback in goal.feedback()] == [[3], [4]]
    assert goal.dropped == 3


async def test_what_is_no_goal_is_refused_in_the_programs_own_line(client: Told) -> None:
    with pytest.raises(InvalidMessage, match="order"):
        await client.send(FibonacciGoal(2**31))
    wrong: Any = FibonacciResult()
    with pytest.raises(TypeError, match="FibonacciGoal"):
        await client.send(wrong)
    with pytest.raises(ValueError, match="queue_size is at least 1"):
        await client.send(FibonacciGoal(), queue_size=0)
    assert client.told == []


async def test_a_goal_waits_for_the_hub(client: Told, session: Session) -> None:
    session.lose()
    sending = asyncio.create_task(client.send(FibonacciGoal(5)))
    await asyncio.sleep(0)
    assert client.told == []
    session.outbox.open()
    async with asyncio.timeout(5):
        goal = await sending
    assert client.told == [(goal.id, {"order": 5})]


async def test_nothing_is_sent_for_who_does_not_wait_for_the_hub(
    client: Told, session: Session
) -> None:
    session.lose()
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.001):
            await client.send(FibonacciGoal(5))
    session.outbox.open()
    await session.hub()
    assert client.told == []


async def test_when_the_hub_is_lost_so_are_all_goals(client: Told, session: Session) -> None:
    goals = [await client.send(FibonacciGoal(5)) for _ in range(2)]
    session.lose()
    for goal in goals:
        with pytest.raises(ActionError, match="LOST: the connection to the hub was lost"):
            await goal.result()
        assert [feedback async for feedback in goal.feedback()] == []
    session.outbox.open()
    assert (await client.send(FibonacciGoal(5))).status is GoalStatus.PENDING


async def test_a_client_that_is_left_hears_no_more(client: Told) -> None:
    async with client:
        goal = await client.send(FibonacciGoal(5))
    client.close()
    assert client.told[1:] == ["unadvertise"]
    with pytest.raises(NodeClosed, match="the client of /fibonacci was closed"):
        await goal.result()
    with pytest.raises(NodeClosed, match="the client of /fibonacci was closed"):
        await client.send(FibonacciGoal(5))


@pytest.mark.parametrize("fault", [None, OperationRejected("because")])
async def test_the_nodes_end_is_told_to_all_who_wait(
    client: Told, session: Session, fault: OperationRejected | None
) -> None:
    goal = await client.send(FibonacciGoal(5))
    session.end(fault)
    with pytest.raises(NodeError, match="because" if fault else "the node has ended"):
        await goal.result()
    with pytest.raises(NodeError, match="because" if fault else "the node has ended"):
        await client.send(FibonacciGoal(5))


async def test_a_refusal_of_what_it_needs_is_told_to_all_who_wait(client: Told) -> None:
    goal = await client.send(FibonacciGoal(5))
    client.refuse_all(OperationRejected("no"))
    with pytest.raises(OperationRejected, match="no"):
        await goal.result()
    with pytest.raises(OperationRejected, match="no"):
        await client.send(FibonacciGoal(5))


async def test_it_says_what_it_is(client: Told) -> None:
    assert (client.name, client.type) == ("/fibonacci", "actionlib_tutorials/Fibonacci")
    assert repr(client) == "<ActionClient /fibonacci [actionlib_tutorials/Fibonacci]>"
