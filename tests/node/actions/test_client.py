"""A client, whichever way its goals travel."""

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
from fibws.node.actions.actions import Actions
from fibws.node.actions.client import ActionClient
from fibws.node.actions.client_goal import ClientGoal
from fibws.node.actions.status import GoalStatus
from fibws.node.session import Session
from fibws.node.topics import Topics
from fibws.node.types import Types

from .conftest import NOW, FibonacciType, no_services

FibonacciClientGoal = ClientGoal[FibonacciResult, FibonacciFeedback]


class Told(ActionClient[FibonacciGoal, FibonacciResult, FibonacciFeedback]):
    """A client that remembers what it has told the graph."""

    def open(self) -> None:
        self.told: list[Any] = []
        self.server = asyncio.Event()

    def refuse_all(self, fault: NodeError) -> None:
        self._refuse(fault)

    def succeed(self, goal: FibonacciClientGoal) -> None:
        self._succeed(goal, FibonacciResult([1]))

    def fail(self, goal: FibonacciClientGoal, *why: Any) -> None:
        self._fail(goal, *why)

    async def _served(self) -> None:
        await self.server.wait()

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
    async with asyncio.timeout(60):
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
    await session.wait_for_hub()
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


async def test_a_server_is_waited_for(client: Told) -> None:
    async with asyncio.timeout(60), asyncio.TaskGroup() as tasks:
        tasks.create_task(client.wait_for_server())
        await asyncio.sleep(0)
        client.server.set()
    await client.wait_for_server(timeout=60)


async def test_a_server_that_is_not_there_is_waited_for_so_long(client: Told) -> None:
    with pytest.raises(WaitTimeout, match="while waiting for action server /fibonacci"):
        await client.wait_for_server(timeout=0.001)
    with pytest.raises(ValueError, match="a timeout is a number of seconds above 0"):
        await client.wait_for_server(timeout=0)


async def test_who_waits_for_a_server_hears_of_the_end(client: Told) -> None:
    waiting = [asyncio.create_task(client.wait_for_server(timeout=t)) for t in (None, 60)]
    await asyncio.sleep(0)
    client.close()
    async with asyncio.timeout(60):
        for each in waiting:
            with pytest.raises(NodeClosed, match="the client of /fibonacci was closed"):
                await each
    with pytest.raises(NodeClosed, match="the client of /fibonacci was closed"):
        await client.wait_for_server()


async def test_an_end_as_the_time_is_up_is_an_end(
    client: Told, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def served() -> None:
        try:
            await client.server.wait()
        finally:
            client.close()

    monkeypatch.setattr(client, "_served", served)
    with pytest.raises(NodeClosed):
        await client.wait_for_server(timeout=0.001)


async def test_before_the_node_is_entered_there_is_no_server_to_wait_for(
    types: Types, fibonacci: FibonacciType
) -> None:
    session = Session(logging.Logger("test"))
    actions = Actions("/node", session, Topics(session), types, no_services, lambda: NOW)
    client = Told(actions, "/fibonacci", fibonacci)
    for waiting in (client.wait_for_server(), client.send({"order": 5})):
        with pytest.raises(RuntimeError, match="enter the node first"):
            await waiting


async def test_a_burst_of_feedback_waits_for_its_reader(client: Told) -> None:
    goal = await client.send(FibonacciGoal(5))
    for number in range(1000):
        goal.offer(FibonacciFeedback([number]))
    client.succeed(goal)
    assert len([feedback async for feedback in goal.feedback()]) == 1000


async def test_it_says_what_it_is(client: Told) -> None:
    assert (client.name, client.type) == ("/fibonacci", "actionlib_tutorials/Fibonacci")
    assert repr(client) == "<ActionClient /fibonacci [actionlib_tutorials/Fibonacci]>"
