"""A server over topics: what it says to which message."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from fibws.errors import OperationRejected
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions import topic_server
from fibws.node.actions.actions import Actions
from fibws.node.actions.server_goal import ServerGoal
from fibws.node.actions.topic_server import TopicActionServer
from fibws.node.session import Session

from ..conftest import greeted, hears, said, says
from .conftest import NOW, FibonacciType

FibonacciServer = TopicActionServer[FibonacciGoal, FibonacciResult, FibonacciFeedback]

STAMP = {"secs": NOW // 1_000_000_000, "nsecs": NOW % 1_000_000_000}


async def execute(
    goal: ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback],
) -> FibonacciResult:
    """Succeeds at once, but for negative orders: those wait to be canceled."""
    await goal.publish_feedback(FibonacciFeedback([0]))
    if goal.request.order < 0:
        await goal.cancellation()
        return goal.canceled(text="as you wish")
    return FibonacciResult([0, 1])


@pytest.fixture
async def server(
    session: Session, actions: Actions, fibonacci: FibonacciType, monkeypatch: pytest.MonkeyPatch
) -> FibonacciServer:
    monkeypatch.setattr(topic_server, "STATUS_PERIOD", 0.02)
    return TopicActionServer(actions, "/fibonacci", fibonacci, execute, concurrent=True)


def goal(session: Session, id_: str = "a", order: int = 5, **stamp: int) -> None:
    msg = {"goal_id": {"id": id_, "stamp": stamp}, "goal": {"order": order}}
    hears(session, "publish", topic="/fibonacci/goal", msg=msg)


def cancel(session: Session, **goal_id: Any) -> None:
    hears(session, "publish", topic="/fibonacci/cancel", msg=goal_id)


async def published(session: Session, kind: str) -> dict[str, Any]:
    """The next message on one of the topics."""
    while True:
        operation = await says(session)
        if operation["op"] == "publish" and operation["topic"] == f"/fibonacci/{kind}":
            message: dict[str, Any] = operation["msg"]
            return message


async def status_of(session: Session, status: int) -> list[dict[str, Any]]:
    """The first status in which a goal has this number."""
    while True:
        listed: list[dict[str, Any]] = (await published(session, "status"))["status_list"]
        if any(each["status"] == status for each in listed):
            return listed


@pytest.mark.usefixtures("server")
async def test_it_registers_its_topics_and_tells_its_status_at_once(session: Session) -> None:
    registered = [(each["op"], each["topic"]) for each in greeted(session) if "id" in each]
    assert registered == [
        ("advertise", "/fibonacci/status"),
        ("advertise", "/fibonacci/result"),
        ("advertise", "/fibonacci/feedback"),
        ("subscribe", "/fibonacci/goal"),
        ("subscribe", "/fibonacci/cancel"),
    ]
    assert (await published(session, "status"))["status_list"] == []


@pytest.mark.usefixtures("server")
async def test_a_goal_has_feedback_and_a_result_and_is_listed_thereafter(session: Session) -> None:
    goal(session, secs=7, nsecs=8)
    goal_id = {"id": "a", "stamp": {"secs": 7, "nsecs": 8}}
    feedback = await published(session, "feedback")
    assert feedback["status"] == {"goal_id": goal_id, "status": 1, "text": ""}
    assert feedback["feedback"] == {"sequence": [0]}
    result = await published(session, "result")
    assert result["status"] == {"goal_id": goal_id, "status": 3, "text": ""}
    assert result["result"] == {"sequence": [0, 1]}
    assert await status_of(session, 3) == [{"goal_id": goal_id, "status": 3, "text": ""}]


@pytest.mark.usefixtures("server")
async def test_it_tells_its_status_again_and_again(session: Session) -> None:
    for _ in range(3):
        await published(session, "status")


@pytest.mark.usefixtures("server")
async def test_what_a_goals_id_leaves_out_is_made_up(session: Session) -> None:
    goal(session, id_="")
    goal(session, id_="")
    ids = [(await published(session, "result"))["status"]["goal_id"] for _ in range(2)]
    assert ids == [
        {"id": "/node-1-1700000000.500", "stamp": STAMP},
        {"id": "/node-2-1700000000.500", "stamp": STAMP},
    ]


@pytest.mark.usefixtures("server")
async def test_a_goal_that_comes_twice_counts_once(session: Session) -> None:
    goal(session)
    goal(session)
    goal(session, id_="b")
    ids = [(await published(session, "result"))["status"]["goal_id"]["id"] for _ in range(2)]
    assert ids == ["a", "b"]


@pytest.mark.usefixtures("server")
@pytest.mark.parametrize(
    "goal_id",
    [{"id": "a"}, {}, {"stamp": {"secs": 7, "nsecs": 0}}, {"id": "b", "stamp": {"secs": 8}}],
)
async def test_a_cancel_by_name_or_time_or_of_all_reaches_the_goal(
    session: Session, goal_id: dict[str, Any]
) -> None:
    goal(session, order=-1, secs=7)
    await published(session, "feedback")
    cancel(session, **goal_id)
    result = await published(session, "result")
    assert (result["status"]["status"], result["status"]["text"]) == (2, "as you wish")
    assert result["result"] == {"sequence": []}


@pytest.mark.usefixtures("server")
async def test_a_cancel_that_means_other_goals_does_not_reach_it(session: Session) -> None:
    goal(session, order=-1, secs=7)
    await published(session, "feedback")
    cancel(session, id="b")
    cancel(session, stamp={"secs": 6, "nsecs": 999_999_999})
    listed = await status_of(session, 7)
    assert [(each["goal_id"]["id"], each["status"]) for each in listed] == [("a", 1), ("b", 7)]


@pytest.mark.usefixtures("server")
async def test_a_goal_that_was_canceled_before_it_came_is_recalled(session: Session) -> None:
    cancel(session, id="a")
    goal(session)
    result = await published(session, "result")
    assert (result["status"]["status"], result["result"]) == (8, {"sequence": []})


async def test_when_it_is_closed_goals_are_aborted_and_topics_left(
    session: Session, server: FibonacciServer
) -> None:
    goal(session, order=-1)
    await published(session, "feedback")
    server.close()
    result = await published(session, "result")
    assert (result["status"]["status"], result["status"]["text"]) == (
        4,
        "the action server has ended",
    )
    left = sorted(each["op"] for each in said(session))
    assert left == ["unadvertise"] * 3 + ["unsubscribe"] * 2
    await session.tasks.finished()


@pytest.mark.usefixtures("server")
async def test_at_the_nodes_end_goals_have_their_result_yet(session: Session) -> None:
    goal(session, order=-1)
    await published(session, "feedback")
    session.end()
    assert (await published(session, "result"))["status"]["status"] == 4
    await session.tasks.finished()


@pytest.mark.usefixtures("server")
async def test_without_a_hub_goals_go_on_and_status_is_saved(session: Session) -> None:
    goal(session, order=-1)
    await published(session, "feedback")
    session.lose()
    said(session)
    cancel(session, id="a")
    await published(session, "result")
    await asyncio.sleep(0)
    assert said(session) == []
    session.outbox.open()
    assert [each["status"] for each in await status_of(session, 2)] == [2]


@pytest.mark.parametrize("topic", ["/fibonacci/goal", "/fibonacci/status", "/fibonacci/result"])
async def test_a_topic_that_the_hub_refuses_ends_it(
    session: Session, server: FibonacciServer, topic: str
) -> None:
    (id_,) = [each["id"] for each in greeted(session) if "id" in each and each["topic"] == topic]
    hears(session, "status", level="error", id=id_, msg="no")
    goal(session)
    async with asyncio.timeout(60):
        with pytest.raises(OperationRejected, match="no"):
            await server.spin()
    await session.tasks.finished()
