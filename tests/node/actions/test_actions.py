"""The servers and clients of one node, as its session knows them."""

from __future__ import annotations

import pytest

from fibws.errors import NodeClosed, OperationRejected
from fibws.node.actions.actions import Actions
from fibws.node.part import Part
from fibws.node.session import Session
from fibws.protocol.operations import ActionFeedback, Reply

from ..conftest import Lines, greeted, hears


class Member(Part):
    """Takes the action or the id of its own name, and leaves when anything else happens."""

    def __init__(self, actions: Actions, name: str) -> None:
        self._actions = actions
        self.name = name
        self.heard: list[object] = []
        actions.join(self)

    def greeting(self) -> list[bytes]:
        return [b'{"op":"%b"}' % self.name.encode()]

    def receive(self, reply: Reply) -> bool:
        if isinstance(reply, ActionFeedback) and reply.action == self.name:
            self.heard.append(reply.values)
            return True
        return False

    def refuse(self, id_: str, fault: OperationRejected) -> bool:
        if id_ == self.name:
            self.heard.append(str(fault))
        return id_ == self.name

    def lose(self) -> None:
        self.heard.append("lost")
        self._actions.leave(self)

    def end(self, fault: Exception | None) -> None:
        self.heard.append("over")
        self._actions.leave(self)


@pytest.fixture
def members(actions: Actions) -> list[Member]:
    return [Member(actions, "a"), Member(actions, "b")]


def test_each_greets_and_hears_what_it_waits_for(session: Session, members: list[Member]) -> None:
    assert greeted(session) == [{"op": "a"}, {"op": "b"}]
    hears(session, "action_feedback", action="b", values=1)
    hears(session, "status", level="error", id="a", msg="no")
    assert [member.heard for member in members] == [["no"], [1]]


def test_goals_have_names_of_their_own_whatever_the_time(actions: Actions) -> None:
    assert [actions.goal_id() for _ in range(2)] == [
        "/node-1-1700000000.500",
        "/node-2-1700000000.500",
    ]


def test_what_comes_too_late_is_no_mystery(
    session: Session, actions: Actions, lines: Lines
) -> None:
    for op in ("action_feedback", "cancel_action_goal"):
        hears(session, op, action="gone", id="1")
    hears(session, "action_result", action="gone", id="1", result=True)
    hears(session, "send_action_goal", action="gone", action_type="a/B", id="1")
    assert lines.seen() == []
    hears(session, "service_response", service="/gone", id="1", result=True)
    assert lines.seen() == ["The hub sent what nobody here waits for: service_response"]


def test_each_may_leave_whenever_it_hears_something(
    session: Session, actions: Actions, members: list[Member]
) -> None:
    session.lose()
    assert [member.heard for member in members] == [["lost"], ["lost"]]
    assert actions.parts() == []
    actions.join(members[0])
    actions.leave(members[1])
    session.end()
    assert [member.heard for member in members] == [["lost", "over"], ["lost"]]
    with pytest.raises(NodeClosed):
        actions.join(members[0])
