"""Action servers over topics."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from fibws.action.actionlib_tutorials import Fibonacci
from fibws.errors import OperationRejected
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions import topics
from fibws.node.actions.actions import NodeActions
from fibws.node.actions.server import ActionServer, ServerGoal

from ..conftest import FakeSession, deliver, next_operation, reconnected, sent_operations
from .conftest import NOW

FibonacciServer = ActionServer[FibonacciGoal, FibonacciResult, FibonacciFeedback]

STAMP = {"secs": NOW // 1_000_000_000, "nsecs": NOW % 1_000_000_000}


async def execute(
    goal: ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback],
) -> FibonacciResult:
    """Succeeds at once, except for negative orders: those wait for a cancel."""
    await goal.publish_feedback(FibonacciFeedback([0]))
    if goal.request.order < 0:
        await goal.cancellation()
        return goal.canceled(text="as you wish")
    return FibonacciResult([0, 1])


@pytest.fixture
async def server(actions: NodeActions, monkeypatch: pytest.MonkeyPatch) -> FibonacciServer:
    monkeypatch.setattr(topics, "STATUS_PERIOD", 0.02)
    return actions.serve("/fibonacci", Fibonacci, execute, over="topics", concurrent=True)


def receive_goal(session: FakeSession, id_: str = "a", order: int = 5, **stamp: int) -> None:
    msg = {"goal_id": {"id": id_, "stamp": stamp}, "goal": {"order": order}}
    deliver(session, "publish", topic="/fibonacci/goal", msg=msg)


def receive_cancel(session: FakeSession, **goal_id: Any) -> None:
    deliver(session, "publish", topic="/fibonacci/cancel", msg=goal_id)


async def published(session: FakeSession, kind: str) -> dict[str, Any]:
    """The next message that is published on one of the topics."""
    while True:
        operation = await next_operation(session)
        if operation["op"] == "publish" and operation["topic"] == f"/fibonacci/{kind}":
            message: dict[str, Any] = operation["msg"]
            return message


async def status_of(session: FakeSession, status: int) -> list[dict[str, Any]]:
    """The next published status list in which a goal has this status."""
    while True:
        listed: list[dict[str, Any]] = (await published(session, "status"))["status_list"]
        if any(each["status"] == status for each in listed):
            return listed


@pytest.mark.usefixtures("server")
async def test_server_registers_its_topics_and_publishes_its_status(session: FakeSession) -> None:
    registered = [(each["op"], each["topic"]) for each in reconnected(session) if "id" in each]
    assert registered == [
        ("advertise", "/fibonacci/status"),
        ("advertise", "/fibonacci/result"),
        ("advertise", "/fibonacci/feedback"),
        ("subscribe", "/fibonacci/goal"),
        ("subscribe", "/fibonacci/cancel"),
    ]
    assert (await published(session, "status"))["status_list"] == []


@pytest.mark.usefixtures("server")
async def test_goal_has_feedback_and_a_result_and_stays_in_the_status(
    session: FakeSession,
) -> None:
    receive_goal(session, secs=7, nsecs=8)
    goal_id = {"id": "a", "stamp": {"secs": 7, "nsecs": 8}}
    feedback = await published(session, "feedback")
    assert feedback["status"] == {"goal_id": goal_id, "status": 1, "text": ""}
    assert feedback["feedback"] == {"sequence": [0]}
    result = await published(session, "result")
    assert result["status"] == {"goal_id": goal_id, "status": 3, "text": ""}
    assert result["result"] == {"sequence": [0, 1]}
    assert await status_of(session, 3) == [{"goal_id": goal_id, "status": 3, "text": ""}]


@pytest.mark.usefixtures("server")
async def test_status_is_published_periodically(session: FakeSession) -> None:
    for _ in range(3):
        await published(session, "status")


@pytest.mark.usefixtures("server")
async def test_goal_without_id_and_stamp_gets_them(session: FakeSession) -> None:
    receive_goal(session, id_="")
    receive_goal(session, id_="")
    ids = [(await published(session, "result"))["status"]["goal_id"] for _ in range(2)]
    assert ids == [
        {"id": "/node-1-1700000000.500", "stamp": STAMP},
        {"id": "/node-2-1700000000.500", "stamp": STAMP},
    ]


@pytest.mark.usefixtures("server")
async def test_duplicate_goal_is_ignored(session: FakeSession) -> None:
    receive_goal(session)
    receive_goal(session)
    receive_goal(session, id_="b")
    ids = [(await published(session, "result"))["status"]["goal_id"]["id"] for _ in range(2)]
    assert ids == ["a", "b"]


@pytest.mark.usefixtures("server")
@pytest.mark.parametrize(
    "goal_id",
    [{"id": "a"}, {}, {"stamp": {"secs": 7, "nsecs": 0}}, {"id": "b", "stamp": {"secs": 8}}],
)
async def test_goal_is_canceled_by_id_by_time_or_with_all_others(
    session: FakeSession, goal_id: dict[str, Any]
) -> None:
    receive_goal(session, order=-1, secs=7)
    await published(session, "feedback")
    receive_cancel(session, **goal_id)
    result = await published(session, "result")
    assert (result["status"]["status"], result["status"]["text"]) == (2, "as you wish")
    assert result["result"] == {"sequence": []}


@pytest.mark.usefixtures("server")
async def test_cancel_of_other_goals_is_ignored(session: FakeSession) -> None:
    receive_goal(session, order=-1, secs=7)
    await published(session, "feedback")
    receive_cancel(session, id="b")
    receive_cancel(session, stamp={"secs": 6, "nsecs": 999_999_999})
    listed = await status_of(session, 7)
    assert [(each["goal_id"]["id"], each["status"]) for each in listed] == [("a", 1), ("b", 7)]


@pytest.mark.usefixtures("server")
async def test_goal_canceled_before_its_arrival_is_recalled(session: FakeSession) -> None:
    receive_cancel(session, id="a")
    receive_goal(session)
    result = await published(session, "result")
    assert (result["status"]["status"], result["result"]) == (8, {"sequence": []})


async def test_close_aborts_goals_and_unregisters_topics(
    session: FakeSession, server: FibonacciServer
) -> None:
    receive_goal(session, order=-1)
    await published(session, "feedback")
    server.close()
    result = await published(session, "result")
    assert (result["status"]["status"], result["status"]["text"]) == (
        4,
        "the action server has ended",
    )
    operations = sorted(each["op"] for each in sent_operations(session))
    assert operations == ["unadvertise"] * 3 + ["unsubscribe"] * 2
    await session.tasks.finished()


@pytest.mark.usefixtures("server")
async def test_end_of_the_node_sends_results_of_goals(session: FakeSession) -> None:
    receive_goal(session, order=-1)
    await published(session, "feedback")
    session.end()
    assert (await published(session, "result"))["status"]["status"] == 4
    await session.tasks.finished()


@pytest.mark.usefixtures("server")
async def test_goals_continue_without_a_hub_but_no_status_is_queued(session: FakeSession) -> None:
    receive_goal(session, order=-1)
    await published(session, "feedback")
    session.on_disconnect()
    sent_operations(session)
    receive_cancel(session, id="a")
    for _ in range(10):  # Let the tasks of the goal and of the status run.
        await asyncio.sleep(0)
    assert session.outgoing.unsent() == {"/fibonacci/result": 1}
    session.reopen()
    await published(session, "result")
    assert [each["status"] for each in await status_of(session, 2)] == [2]


@pytest.mark.parametrize("topic", ["/fibonacci/goal", "/fibonacci/status", "/fibonacci/result"])
async def test_refused_topic_ends_the_server(
    session: FakeSession, server: FibonacciServer, topic: str
) -> None:
    (id_,) = [
        each["id"] for each in reconnected(session) if "id" in each and each["topic"] == topic
    ]
    deliver(session, "status", level="error", id=id_, msg="no")
    receive_goal(session)
    async with asyncio.timeout(60):
        with pytest.raises(OperationRejected, match="no"):
            await server.spin()
    await session.tasks.finished()
