"""A client over operations: what it makes of which operation."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import ActionError
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions.actions import Actions
from fibws.node.actions.operation_client import OperationActionClient
from fibws.node.actions.status import GoalStatus
from fibws.node.session import Session

from ..conftest import Lines, hears, said
from .conftest import FibonacciType

FibonacciClient = OperationActionClient[FibonacciGoal, FibonacciResult, FibonacciFeedback]


@pytest.fixture
def client(actions: Actions, fibonacci: FibonacciType) -> FibonacciClient:
    return OperationActionClient(actions, "/fibonacci", fibonacci)


def tell(session: Session, op: str, id_: str, **fields: Any) -> None:
    hears(session, op, id=id_, action="/fibonacci", **fields)


async def test_a_goal_and_its_cancel_are_operations(
    session: Session, client: FibonacciClient
) -> None:
    goal = await client.send(FibonacciGoal(5))
    await goal.cancel()
    assert goal.id == "send_action_goal:/fibonacci:1"
    assert said(session) == [
        {
            "op": "send_action_goal",
            "id": goal.id,
            "action": "/fibonacci",
            "action_type": "actionlib_tutorials/Fibonacci",
            "args": {"order": 5},
            "feedback": True,
        },
        {"op": "cancel_action_goal", "id": goal.id, "action": "/fibonacci"},
    ]


async def test_a_goal_is_followed_to_its_result(session: Session, client: FibonacciClient) -> None:
    goal = await client.send(FibonacciGoal(5))
    tell(session, "action_feedback", "another", values={"sequence": [7]})
    tell(session, "cancel_action_goal", goal.id)
    tell(session, "action_feedback", goal.id, values={"sequence": [0]})
    assert goal.status is GoalStatus.ACTIVE
    tell(session, "action_feedback", goal.id, values={"sequence": [0, 1]})
    tell(session, "action_result", goal.id, values={"sequence": [1]}, status=4, result=True)
    tell(session, "action_result", goal.id, values={"sequence": [2]}, status=4, result=True)
    assert [feedback.sequence async for feedback in goal.feedback()] == [[0], [0, 1]]
    assert await goal.result() == FibonacciResult([1])


@pytest.mark.parametrize(
    ("reply", "status", "text", "result"),
    [
        ({"status": 5, "result": True, "values": {}}, GoalStatus.PREEMPTED, "", FibonacciResult()),
        (
            {"status": 6, "result": True, "values": {"sequence": [3]}},
            GoalStatus.ABORTED,
            "",
            FibonacciResult([3]),
        ),
        ({"status": 6, "result": False, "values": "no"}, GoalStatus.ABORTED, "no", None),
        ({"status": 0, "result": False, "values": {"a": 1}}, GoalStatus.LOST, '{"a":1}', None),
    ],
)
async def test_a_goal_that_did_not_succeed_says_why(
    session: Session,
    client: FibonacciClient,
    reply: dict[str, Any],
    status: GoalStatus,
    text: str,
    result: FibonacciResult | None,
) -> None:
    goal = await client.send(FibonacciGoal(5))
    tell(session, "action_result", goal.id, **reply)
    with pytest.raises(ActionError) as error:
        await goal.result()
    assert error.value.status is goal.status is status
    assert (error.value.text, error.value.result) == (text, result)


async def test_what_does_not_fit_the_type_is_named(
    session: Session, client: FibonacciClient, lines: Lines
) -> None:
    goal = await client.send(FibonacciGoal(5))
    tell(session, "action_feedback", goal.id, values={"sequence": 5})
    tell(session, "action_result", goal.id, values={"sum": 5}, status=4, result=True)
    assert [feedback async for feedback in goal.feedback()] == []
    (line,) = lines.seen()
    assert line.startswith("Dropped feedback of /fibonacci: actionlib_tutorials/FibonacciFeedback")
    with pytest.raises(ActionError, match="does not have a field sum"):
        await goal.result()


async def test_a_goal_that_the_hub_refuses_is_rejected(
    session: Session, client: FibonacciClient
) -> None:
    goal = await client.send(FibonacciGoal(5))
    tell(session, "status", "another", level="error", msg="not this one")
    assert goal.status is GoalStatus.PENDING
    tell(session, "status", goal.id, level="error", msg="no such operation")
    with pytest.raises(ActionError, match="REJECTED: no such operation"):
        await goal.result()


async def test_a_server_is_there_if_the_service_that_cancels_goals_is(
    actions: Actions, client: FibonacciClient
) -> None:
    asked: list[str] = []

    async def wait(name: str, within: float | None) -> None:
        asked.append(name)

    actions.wait_for_service = wait
    await client.wait_for_server()
    assert asked == ["/fibonacci/_action/cancel_goal"]
