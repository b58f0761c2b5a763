"""Action servers and clients over operations."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from fibws.action.actionlib_tutorials import Fibonacci
from fibws.errors import ActionError, OperationRejected
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions.actions import NodeActions
from fibws.node.actions.client import ActionClient
from fibws.node.actions.operations import OperationActionClient
from fibws.node.actions.server import ActionServer, ServerGoal
from fibws.protocol.goals import GoalStatus

from ..conftest import FakeSession, Lines, deliver, next_operation, reconnected, sent_operations
from .conftest import FibonacciType

FibonacciServer = ActionServer[FibonacciGoal, FibonacciResult, FibonacciFeedback]
FibonacciClient = ActionClient[FibonacciGoal, FibonacciResult, FibonacciFeedback]


# The server


async def execute(
    goal: ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback],
) -> FibonacciResult:
    """Succeeds at once, except for negative orders: those wait for a cancel."""
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
async def server(actions: NodeActions) -> FibonacciServer:
    return actions.serve("/fibonacci", Fibonacci, execute, over="operations")


def receive_goal(
    session: FakeSession, order: Any = 5, id_: str = "action_goal:/fibonacci:1"
) -> None:
    deliver(
        session,
        "send_action_goal",
        id=id_,
        action="/fibonacci",
        action_type="actionlib_tutorials/Fibonacci",
        args={"order": order},
        feedback=True,
    )


def receive_cancel(session: FakeSession, id_: str = "action_goal:/fibonacci:1") -> None:
    deliver(session, "cancel_action_goal", id=id_, action="/fibonacci")


ADVERTISED = {
    "op": "advertise_action",
    "id": "advertise_action:/fibonacci:1",
    "action": "/fibonacci",
    "type": "actionlib_tutorials/Fibonacci",
}


@pytest.mark.usefixtures("server")
async def test_server_is_advertised_on_every_connection(session: FakeSession) -> None:
    assert sent_operations(session) == [ADVERTISED]
    session.on_disconnect()
    assert reconnected(session) == [ADVERTISED]


@pytest.mark.usefixtures("server")
async def test_feedback_and_result_are_sent(session: FakeSession) -> None:
    sent_operations(session)
    receive_goal(session)
    about = {"id": "action_goal:/fibonacci:1", "action": "/fibonacci"}
    assert await next_operation(session) == {
        "op": "action_feedback",
        **about,
        "values": {"sequence": [0]},
    }
    assert await next_operation(session) == {
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
            "actionlib_tutorials/FibonacciResult message requires an int32 for field sequence[0], "
            "but got an int (2147483648 is not in -2147483648..2147483647)",
        ),
    ],
)
async def test_failed_goal_has_a_result_or_a_text(
    session: FakeSession, order: int, status: int, result: bool, values: Any
) -> None:
    sent_operations(session)
    receive_goal(session, order)
    await next_operation(session)
    receive_cancel(session)
    await next_operation(session)
    sent = await next_operation(session)
    assert (sent["status"], sent["result"], sent["values"]) == (status, result, values)


@pytest.mark.usefixtures("server")
async def test_invalid_goal_is_aborted_with_the_reason(session: FakeSession) -> None:
    sent_operations(session)
    receive_goal(session, order="five")
    sent = await next_operation(session)
    assert (sent["op"], sent["status"], sent["result"]) == ("action_result", 6, False)
    assert "FibonacciGoal message requires an int32 for field order" in sent["values"]


@pytest.mark.usefixtures("server")
async def test_operations_of_other_actions_are_ignored(session: FakeSession) -> None:
    sent_operations(session)
    deliver(session, "send_action_goal", id="x", action="/other", action_type="a/B")
    deliver(session, "action_feedback", id="x", action="/fibonacci")
    assert sent_operations(session) == []


@pytest.mark.usefixtures("server")
async def test_disconnect_cancels_goals_and_drops_their_results(
    session: FakeSession,
) -> None:
    sent_operations(session)
    receive_goal(session, order=-1)
    await next_operation(session)
    session.on_disconnect()
    session.reopen()
    receive_goal(session, order=5)
    assert [(await next_operation(session))["op"] for _ in range(2)] == [
        "action_feedback",
        "action_result",
    ]
    await session.tasks.finished()
    assert sent_operations(session) == []


async def test_close_aborts_goals_before_unadvertising(
    session: FakeSession, server: FibonacciServer
) -> None:
    sent_operations(session)
    receive_goal(session, order=-1)
    await next_operation(session)
    server.close()
    result, unadvertise = sent_operations(session)
    assert (result["status"], result["values"]) == (6, "the action server has ended")
    assert unadvertise == {
        "op": "unadvertise_action",
        "id": ADVERTISED["id"],
        "action": "/fibonacci",
    }
    assert reconnected(session) == []


async def test_refusal_by_the_hub_ends_the_server(
    session: FakeSession, server: FibonacciServer
) -> None:
    deliver(session, "status", level="error", id="another", msg="not mine")
    deliver(session, "status", level="error", id=ADVERTISED["id"], msg="no")
    async with asyncio.timeout(60):
        with pytest.raises(OperationRejected, match="no"):
            await server.spin()
    assert reconnected(session) == []


# The client


@pytest.fixture
def client(actions: NodeActions) -> FibonacciClient:
    return actions.client("/fibonacci", Fibonacci, over="operations")


def receive(session: FakeSession, op: str, id_: str, **fields: Any) -> None:
    deliver(session, op, id=id_, action="/fibonacci", **fields)


async def test_goal_and_cancel_are_sent(session: FakeSession, client: FibonacciClient) -> None:
    goal = await client.send(FibonacciGoal(5))
    await goal.cancel()
    assert goal.id == "send_action_goal:/fibonacci:1"
    assert sent_operations(session) == [
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


async def test_feedback_and_result_are_received(
    session: FakeSession, client: FibonacciClient
) -> None:
    goal = await client.send(FibonacciGoal(5))
    receive(session, "action_feedback", "another", values={"sequence": [7]})
    receive(session, "cancel_action_goal", goal.id)
    receive(session, "action_feedback", goal.id, values={"sequence": [0]})
    assert goal.status is GoalStatus.ACTIVE
    receive(session, "action_feedback", goal.id, values={"sequence": [0, 1]})
    receive(session, "action_result", goal.id, values={"sequence": [1]}, status=4, result=True)
    receive(session, "action_result", goal.id, values={"sequence": [2]}, status=4, result=True)
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
async def test_failed_goal_raises_with_status_text_and_result(
    session: FakeSession,
    client: FibonacciClient,
    reply: dict[str, Any],
    status: GoalStatus,
    text: str,
    result: FibonacciResult | None,
) -> None:
    goal = await client.send(FibonacciGoal(5))
    receive(session, "action_result", goal.id, **reply)
    with pytest.raises(ActionError) as error:
        await goal.result()
    assert error.value.status is goal.status is status
    assert (error.value.text, error.value.result) == (text, result)


async def test_invalid_feedback_is_logged_and_invalid_result_raised(
    session: FakeSession, client: FibonacciClient, lines: Lines
) -> None:
    goal = await client.send(FibonacciGoal(5))
    receive(session, "action_feedback", goal.id, values={"sequence": 5})
    receive(session, "action_result", goal.id, values={"sum": 5}, status=4, result=True)
    assert [feedback async for feedback in goal.feedback()] == []
    (line,) = lines.seen()
    assert line.startswith("Dropped feedback of /fibonacci: actionlib_tutorials/FibonacciFeedback")
    with pytest.raises(ActionError, match="does not have a field sum"):
        await goal.result()


async def test_goal_refused_by_the_hub_is_rejected(
    session: FakeSession, client: FibonacciClient
) -> None:
    goal = await client.send(FibonacciGoal(5))
    receive(session, "status", "another", level="error", msg="not this one")
    assert goal.status is GoalStatus.PENDING
    receive(session, "status", goal.id, level="error", msg="no such operation")
    with pytest.raises(ActionError, match="REJECTED: no such operation"):
        await goal.result()


async def test_server_is_available_once_its_cancel_service_is(
    session: FakeSession, fibonacci: FibonacciType
) -> None:
    services: list[str] = []

    async def wait_for_service(name: str, timeout: float | None) -> None:
        services.append(name)

    await OperationActionClient(
        session, "/fibonacci", fibonacci, wait_for_service
    ).wait_for_server()
    assert services == ["/fibonacci/_action/cancel_goal"]
