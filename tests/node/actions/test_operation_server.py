"""A server over operations: what it says to which operation."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from fibws.errors import OperationRejected
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions.actions import Actions
from fibws.node.actions.operation_server import OperationActionServer
from fibws.node.actions.server_goal import ServerGoal
from fibws.node.session import Session

from ..conftest import greeted, hears, said, says
from .conftest import FibonacciType

FibonacciServer = OperationActionServer[FibonacciGoal, FibonacciResult, FibonacciFeedback]


async def execute(
    goal: ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback],
) -> FibonacciResult:
    """Succeeds at once, but for negative orders: those wait to be canceled."""
    await goal.publish_feedback(FibonacciFeedback([0]))
    order = goal.request.order
    if order >= 0:
        return FibonacciResult([0, 1])
    await goal.cancellation()
    await goal.publish_feedback(FibonacciFeedback([1]))
    match order:
        case -1:
            return goal.canceled(FibonacciResult([0]))
        case -2:
            return goal.aborted(FibonacciResult([0]))
        case -3:
            return goal.canceled(FibonacciResult([0]), "as you wish")
    goal.canceled()
    return FibonacciResult([2**31])


@pytest.fixture
async def server(session: Session, actions: Actions, fibonacci: FibonacciType) -> FibonacciServer:
    return OperationActionServer(actions, "/fibonacci", fibonacci, execute, concurrent=True)


def goal(session: Session, order: Any = 5, id_: str = "action_goal:/fibonacci:1") -> None:
    hears(
        session,
        "send_action_goal",
        id=id_,
        action="/fibonacci",
        action_type="actionlib_tutorials/Fibonacci",
        args={"order": order},
        feedback=True,
    )


def cancel(session: Session, id_: str = "action_goal:/fibonacci:1") -> None:
    hears(session, "cancel_action_goal", id=id_, action="/fibonacci")


ADVERTISED = {
    "op": "advertise_action",
    "id": "advertise_action:/fibonacci:1",
    "action": "/fibonacci",
    "type": "actionlib_tutorials/Fibonacci",
}


@pytest.mark.usefixtures("server")
async def test_it_is_told_to_each_hub(session: Session) -> None:
    assert said(session) == [ADVERTISED]
    session.lose()
    assert greeted(session) == [ADVERTISED]


@pytest.mark.usefixtures("server")
async def test_a_goal_has_feedback_and_a_result(session: Session) -> None:
    said(session)
    goal(session)
    about = {"id": "action_goal:/fibonacci:1", "action": "/fibonacci"}
    assert await says(session) == {
        "op": "action_feedback",
        **about,
        "values": {"sequence": [0]},
    }
    assert await says(session) == {
        "op": "action_result",
        **about,
        "values": {"sequence": [0, 1]},
        "status": 4,
        "result": True,
    }


@pytest.mark.usefixtures("server")
@pytest.mark.parametrize(
    ("order", "status", "result", "values"),
    [
        (-1, 5, True, {"sequence": [0]}),
        (-2, 6, True, {"sequence": [0]}),
        (-3, 5, False, "as you wish"),
        (
            -4,
            6,
            False,
            "actionlib_tutorials/FibonacciResult message requires a int32 for field sequence[0], "
            "but got a int (2147483648 is not in -2147483648..2147483647)",
        ),
    ],
)
async def test_a_goal_that_did_not_succeed_has_a_result_or_a_text(
    session: Session, order: int, status: int, result: bool, values: Any
) -> None:
    said(session)
    goal(session, order)
    await says(session)
    cancel(session)
    await says(session)
    told = await says(session)
    assert (told["status"], told["result"], told["values"]) == (status, result, values)


@pytest.mark.usefixtures("server")
async def test_a_goal_that_does_not_fit_is_aborted_with_the_reason(session: Session) -> None:
    said(session)
    goal(session, order="five")
    told = await says(session)
    assert (told["op"], told["status"], told["result"]) == ("action_result", 6, False)
    assert "FibonacciGoal message requires a int32 for field order" in told["values"]


@pytest.mark.usefixtures("server")
async def test_goals_of_other_actions_are_not_its(session: Session) -> None:
    said(session)
    hears(session, "send_action_goal", id="x", action="/other", action_type="a/B")
    hears(session, "action_feedback", id="x", action="/fibonacci")
    assert said(session) == []


@pytest.mark.usefixtures("server")
async def test_a_goal_of_a_lost_hub_is_wanted_no_more_and_not_told_of_to_the_next(
    session: Session,
) -> None:
    said(session)
    goal(session, order=-1)
    await says(session)
    session.lose()
    session.outbox.open()
    goal(session, order=5)
    assert [(await says(session))["op"] for _ in range(2)] == ["action_feedback", "action_result"]
    await session.tasks.finished()
    assert said(session) == []


async def test_when_it_is_closed_goals_are_aborted_before_it_is_taken_back(
    session: Session, server: FibonacciServer
) -> None:
    said(session)
    goal(session, order=-1)
    await says(session)
    server.close()
    result, unadvertise = said(session)
    assert (result["status"], result["values"]) == (6, "the action server has ended")
    assert unadvertise == {
        "op": "unadvertise_action",
        "id": ADVERTISED["id"],
        "action": "/fibonacci",
    }
    assert greeted(session) == []


async def test_a_refusal_by_the_hub_ends_it(session: Session, server: FibonacciServer) -> None:
    hears(session, "status", level="error", id="another", msg="not mine")
    hears(session, "status", level="error", id=ADVERTISED["id"], msg="no")
    async with asyncio.timeout(60):
        with pytest.raises(OperationRejected, match="no"):
            await server.spin()
    assert greeted(session) == []
