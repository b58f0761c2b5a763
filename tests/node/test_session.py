"""A node's side of the conversation: text in, text out, no socket and no loop."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Any

import pytest

from fibws.errors import NodeClosed, NodeReplaced, OperationRejected
from fibws.node.part import Part
from fibws.node.session import Session
from fibws.protocol.operations import Publish, Reply, Unsubscribe

from .conftest import Lines, hears, said


class Ear(Part):
    """A part that hears one topic, and notes what happens to it."""

    def __init__(self, session: Session, topic: str) -> None:
        self.topic = topic
        self.notes: list[Any] = []
        session.join(self)

    def greeting(self) -> Iterator[bytes]:
        yield self.topic.encode()

    def receive(self, reply: Reply) -> bool:
        if not isinstance(reply, Publish) or reply.topic != self.topic:
            return False
        self.notes.append(reply.msg)
        return True

    def refuse(self, id_: str, fault: OperationRejected) -> bool:
        if id_ == self.topic:
            self.notes.append(str(fault))
        return id_ == self.topic

    def lose(self) -> None:
        self.notes.append("lost")

    def end(self, fault: Exception | None) -> None:
        self.notes.append(fault)


@pytest.fixture
def ears(session: Session) -> tuple[Ear, Ear]:
    return Ear(session, "/a"), Ear(session, "/b")


def test_ids_differ(session: Session) -> None:
    assert session.id("advertise", "/a") != session.id("advertise", "/a")


def test_only_a_hub_that_is_there_is_told(session: Session) -> None:
    operation = Unsubscribe(topic="/a")
    session.say(operation)
    assert said(session) == [{"op": "unsubscribe", "topic": "/a"}]
    session.lose()
    session.say(operation)
    assert said(session) == []


def test_a_greeting_is_what_all_parts_have_to_say(session: Session, ears: tuple[Ear, Ear]) -> None:
    assert session.greeting() == [b"/a", b"/b"]


def test_each_part_gets_what_is_its_own(
    session: Session, ears: tuple[Ear, Ear], lines: Lines
) -> None:
    hears(session, "publish", topic="/a", msg=1)
    hears(session, "publish", topic="/b", msg=2)
    assert [ear.notes for ear in ears] == [[1], [2]]
    assert lines.seen() == []


def test_a_frame_may_hold_several_operations(session: Session, ears: tuple[Ear, Ear]) -> None:
    session.receive(b'{"op":"publish","topic":"/a","msg":1} {"op":"publish","topic":"/a","msg":2}')
    assert ears[0].notes == [1, 2]


def test_what_comes_too_late_is_no_mystery(
    session: Session, ears: tuple[Ear, Ear], lines: Lines
) -> None:
    session.leave(ears[0])
    hears(session, "publish", topic="/a", msg=1)
    hears(session, "action_feedback", action="/gone", id="7")
    assert [ear.notes for ear in ears] == [[], []]
    assert lines.seen() == []


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (b"[]", "Expected a JSON object"),
        (b'{"op":"fly"}', "Unknown operation: fly"),
        (b'{"op":"png","data":""}', "an image of an operation"),
        (b"\xff", "utf-8"),
    ],
)
def test_what_is_not_understood_goes_to_the_log(
    session: Session, lines: Lines, text: bytes, reason: str
) -> None:
    session.receive(text)
    (line,) = lines.seen()
    assert line.startswith("The hub sent what this node does not understand: ")
    assert reason in line


def test_fragments_are_put_together(session: Session, ears: tuple[Ear, Ear]) -> None:
    text = '{"op":"publish","topic":"/a","msg":"grüße"}'
    for number, data in enumerate((text[:20], text[20:])):
        assert ears[0].notes == []
        hears(session, "fragment", id="f", data=data, num=number, total=2)
    assert ears[0].notes == ["grüße"]


def test_half_a_message_is_of_no_use_to_the_next_connection(
    session: Session, ears: tuple[Ear, Ear], lines: Lines
) -> None:
    text = '{"op":"publish","topic":"/a","msg":1}'
    hears(session, "fragment", id="f", data=text[:20], num=0, total=2)
    session.lose()
    hears(session, "fragment", id="f", data=text[20:], num=1, total=2)
    assert ears[0].notes == ["lost"]


def test_a_refusal_reaches_whom_it_concerns(
    session: Session, ears: tuple[Ear, Ear], lines: Lines
) -> None:
    hears(session, "status", level="error", id="/b", msg="no")
    assert [ear.notes for ear in ears] == [[], ["no"]]
    hears(session, "status", level="warning", id="/b", msg="hm")
    hears(session, "status", level="error", id="/c", msg="what")
    hears(session, "status", level="error", msg="how")
    assert [ear.notes for ear in ears] == [[], ["no"]]
    assert lines.seen() == ["The hub: hm", "The hub: what", "The hub: how"]


def test_all_parts_hear_of_a_loss_and_of_the_first_end(
    session: Session, ears: tuple[Ear, Ear]
) -> None:
    fault = NodeReplaced("by another")
    session.lose()
    session.end(fault)
    session.end()
    assert [ear.notes for ear in ears] == 2 * [["lost", fault]]
    assert session.over
    with pytest.raises(NodeReplaced):
        session.check()


@pytest.mark.parametrize("event", ["message", "refusal", "loss", "end"])
def test_a_part_may_leave_whenever_it_hears_something(session: Session, event: str) -> None:
    class Leaver(Ear):
        """A part that leaves as soon as anything happens."""

        def receive(self, reply: Reply) -> bool:
            session.leave(self)
            return super().receive(reply)

        def refuse(self, id_: str, fault: OperationRejected) -> bool:
            session.leave(self)
            return super().refuse(id_, fault)

        def lose(self) -> None:
            session.leave(self)
            super().lose()

        def end(self, fault: Exception | None) -> None:
            session.leave(self)
            session.leave(self)
            super().end(fault)

    leavers = [Leaver(session, f"/{number}") for number in range(3)]
    match event:
        case "message":
            hears(session, "publish", topic="/2", msg=None)
        case "refusal":
            hears(session, "status", level="error", id="/2", msg="no")
        case "loss":
            session.lose()
        case "end":
            session.end()
    assert session.parts() == []
    assert len(leavers[2].notes) == 1


def test_nobody_joins_once_the_node_has_ended(session: Session) -> None:
    session.end()
    with pytest.raises(NodeClosed):
        Ear(session, "/a")


async def test_a_node_that_was_not_entered_says_so_to_who_waits() -> None:
    session = Session(logging.Logger("test"))
    for wait in (session.wait_for_hub, session.ended):
        with pytest.raises(RuntimeError, match="enter the node first: async with node"):
            await wait()
    session.end()
    assert await session.ended()
    with pytest.raises(NodeClosed):
        await session.wait_for_hub()


def test_the_end_may_be_nobodys_fault(session: Session) -> None:
    session.check()
    session.end()
    with pytest.raises(NodeClosed, match="the node has ended"):
        session.check()


def test_a_message_goes_straight_to_who_hears_messages(
    session: Session, ears: tuple[Ear, Ear], lines: Lines
) -> None:
    heard: list[tuple[str, Any, dict[str, str] | None]] = []

    def hear(topic: str, message: Any, header: dict[str, str] | None) -> bool:
        heard.append((topic, message, header))
        return topic == "/c"

    session.hand_messages_to(hear)
    session.receive(b'{"op":"publish","topic":"/c","msg":1,"header":{"callerid":"/talker"}}')
    session.receive(b'{"op":"publish","topic":"/a","msg":2}')
    assert heard == [("/c", 1, {"callerid": "/talker"}), ("/a", 2, None)]
    assert ears[0].notes == [2], "nobody else wanted it"
    for wrong in (
        b'"topic":5',
        b'"topic":"/a","header":{"callerid":5}',
        b'"topic":"/a","header":5',
    ):
        session.receive(b'{"op":"publish","msg":3,%b}' % wrong)
    assert len(heard) == 2
    assert ears[0].notes == [2, 3, 3], "they come without their headers"
    assert len(lines.seen()) == 1
