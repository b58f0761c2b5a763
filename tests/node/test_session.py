"""Sessions of a node: operations and their handlers, without a socket."""

from __future__ import annotations

import asyncio
import logging
import traceback
from collections.abc import Iterator
from typing import Any

import pytest

from fibws.errors import NodeClosed, NodeReplaced, OperationRejected
from fibws.node.session import OperationHandler, Session, Tasks, throw
from fibws.protocol.operations import Operation, Publish, Reply, Unsubscribe

from .conftest import FakeSession, Lines, deliver, reconnected, sent_operations


class Recorder(OperationHandler):
    """A handler of one topic, which records its calls."""

    def __init__(self, session: FakeSession, topic: str) -> None:
        self.topic = topic
        self.notes: list[Any] = []
        session.add_handler(self)

    def _registrations(self) -> Iterator[Operation]:
        yield Unsubscribe(topic=self.topic)

    def _on_reply(self, reply: Reply) -> bool:
        if not isinstance(reply, Publish) or reply.topic != self.topic:
            return False
        self.notes.append(reply.msg)
        return True

    def _on_refusal(self, id_: str, fault: OperationRejected) -> bool:
        if id_ == self.topic:
            self.notes.append(str(fault))
        return id_ == self.topic

    def _on_disconnect(self) -> None:
        self.notes.append("lost")

    def _on_end(self, fault: Exception | None) -> None:
        self.notes.append(fault)


@pytest.fixture
def recorders(session: FakeSession) -> tuple[Recorder, Recorder]:
    return Recorder(session, "/a"), Recorder(session, "/b")


async def test_ids_are_unique(session: FakeSession) -> None:
    assert session.id("advertise", "/a") != session.id("advertise", "/a")


async def test_operations_are_sent_only_while_there_is_a_hub(session: FakeSession) -> None:
    operation = Unsubscribe(topic="/a")
    session.send(operation)
    assert sent_operations(session) == [{"op": "unsubscribe", "topic": "/a"}]
    session.on_disconnect()
    session.send(operation)
    assert sent_operations(session) == []


async def test_all_registrations_are_sent_on_a_new_connection(
    session: FakeSession, recorders: tuple[Recorder, Recorder]
) -> None:
    assert [each["topic"] for each in reconnected(session)] == ["/a", "/b"]


async def test_each_handler_gets_its_own_operations(
    session: FakeSession, recorders: tuple[Recorder, Recorder], lines: Lines
) -> None:
    deliver(session, "publish", topic="/a", msg=1)
    deliver(session, "publish", topic="/b", msg=2)
    assert [each.notes for each in recorders] == [[1], [2]]
    assert lines.seen() == []


async def test_frame_may_hold_several_operations(
    session: FakeSession, recorders: tuple[Recorder, Recorder]
) -> None:
    session.receive_text(
        b'{"op":"publish","topic":"/a","msg":1} {"op":"publish","topic":"/a","msg":2}'
    )
    assert recorders[0].notes == [1, 2]


async def test_late_operations_are_ignored(
    session: FakeSession, recorders: tuple[Recorder, Recorder], lines: Lines
) -> None:
    session.remove_handler(recorders[0])
    deliver(session, "publish", topic="/a", msg=1)
    deliver(session, "action_feedback", action="/gone", id="7")
    assert [each.notes for each in recorders] == [[], []]
    assert lines.seen() == []


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (b"[]", "Expected a JSON object"),
        (b'{"op":"fly"}', "Unknown operation: fly"),
        (b'{"op":"png","data":""}', "a PNG image"),
        (b"\xff", "utf-8"),
    ],
)
async def test_invalid_operations_are_logged(
    session: FakeSession, lines: Lines, text: bytes, reason: str
) -> None:
    session.receive_text(text)
    (line,) = lines.seen()
    assert line.startswith("The hub sent an invalid operation: ")
    assert reason in line


async def test_fragments_are_reassembled(
    session: FakeSession, recorders: tuple[Recorder, Recorder]
) -> None:
    text = '{"op":"publish","topic":"/a","msg":"grüße"}'
    for number, data in enumerate((text[:20], text[20:])):
        assert recorders[0].notes == []
        deliver(session, "fragment", id="f", data=data, num=number, total=2)
    assert recorders[0].notes == ["grüße"]


async def test_fragments_of_a_lost_connection_are_forgotten(
    session: FakeSession, recorders: tuple[Recorder, Recorder], lines: Lines
) -> None:
    text = '{"op":"publish","topic":"/a","msg":1}'
    deliver(session, "fragment", id="f", data=text[:20], num=0, total=2)
    session.on_disconnect()
    deliver(session, "fragment", id="f", data=text[20:], num=1, total=2)
    assert recorders[0].notes == ["lost"]


async def test_refusal_reaches_its_handler(
    session: FakeSession, recorders: tuple[Recorder, Recorder], lines: Lines
) -> None:
    deliver(session, "status", level="error", id="/b", msg="no")
    assert [each.notes for each in recorders] == [[], ["no"]]
    deliver(session, "status", level="warning", id="/b", msg="hm")
    deliver(session, "status", level="error", id="/c", msg="what")
    deliver(session, "status", level="error", msg="how")
    assert [each.notes for each in recorders] == [[], ["no"]]
    assert lines.seen() == ["The hub: hm", "The hub: what", "The hub: how"]


async def test_all_handlers_are_notified_of_disconnects_and_of_the_first_end(
    session: FakeSession, recorders: tuple[Recorder, Recorder]
) -> None:
    fault = NodeReplaced("by another")
    session.on_disconnect()
    session.end(fault)
    session.end()
    assert [each.notes for each in recorders] == 2 * [["lost", fault]]
    assert session.over
    with pytest.raises(NodeReplaced):
        session.check()


@pytest.mark.parametrize("event", ["message", "refusal", "loss", "end"])
async def test_handler_may_be_removed_while_it_is_called(session: FakeSession, event: str) -> None:
    class Leaver(Recorder):
        """A handler that is removed as soon as anything happens."""

        def _on_reply(self, reply: Reply) -> bool:
            session.remove_handler(self)
            return super()._on_reply(reply)

        def _on_refusal(self, id_: str, fault: OperationRejected) -> bool:
            session.remove_handler(self)
            return super()._on_refusal(id_, fault)

        def _on_disconnect(self) -> None:
            session.remove_handler(self)
            super()._on_disconnect()

        def _on_end(self, fault: Exception | None) -> None:
            session.remove_handler(self)
            session.remove_handler(self)
            super()._on_end(fault)

    leavers = [Leaver(session, f"/{number}") for number in range(3)]
    match event:
        case "message":
            deliver(session, "publish", topic="/2", msg=None)
        case "refusal":
            deliver(session, "status", level="error", id="/2", msg="no")
        case "loss":
            session.on_disconnect()
        case "end":
            session.end()
    assert session.handlers() == []
    assert len(leavers[2].notes) == 1


async def test_no_handler_is_added_after_the_end(session: FakeSession) -> None:
    session.end()
    with pytest.raises(NodeClosed):
        Recorder(session, "/a")


async def test_waiting_raises_before_the_node_is_entered() -> None:
    session = Session(logging.Logger("test"))
    for wait in (session.wait_for_hub, session.ended):
        with pytest.raises(RuntimeError, match="enter the node first: async with node"):
            await wait()
    session.end()
    assert await session.ended()
    with pytest.raises(NodeClosed):
        await session.wait_for_hub()


async def test_node_may_end_without_an_error(session: FakeSession) -> None:
    session.check()
    session.end()
    with pytest.raises(NodeClosed, match="the node has ended"):
        session.check()


async def test_messages_go_to_the_message_handler_first(
    session: FakeSession, recorders: tuple[Recorder, Recorder], lines: Lines
) -> None:
    received: list[tuple[str, Any, dict[str, str] | None]] = []

    def hear(topic: str, message: Any, header: dict[str, str] | None) -> bool:
        received.append((topic, message, header))
        return topic == "/c"

    session.set_message_handlers(hear, session.receive_binary)
    session.receive_text(b'{"op":"publish","topic":"/c","msg":1,"header":{"callerid":"/talker"}}')
    session.receive_text(b'{"op":"publish","topic":"/a","msg":2}')
    assert received == [("/c", 1, {"callerid": "/talker"}), ("/a", 2, None)]
    assert recorders[0].notes == [2], "no other handler received it"
    for wrong in (
        b'"topic":5',
        b'"topic":"/a","header":{"callerid":5}',
        b'"topic":"/a","header":5',
    ):
        session.receive_text(b'{"op":"publish","msg":3,%b}' % wrong)
    assert len(received) == 2
    assert recorders[0].notes == [2, 3, 3], "they come without their headers"
    assert len(lines.seen()) == 1


async def test_status_about_an_unknown_publisher_is_a_detail(
    session: FakeSession, lines: Lines
) -> None:
    session.log.setLevel(logging.INFO)
    deliver(session, "status", level="error", msg="no publisher 7", code="unknown_publisher")
    assert lines.seen() == []
    deliver(session, "status", level="error", msg="no publisher 7")
    assert lines.seen() == ["The hub: no publisher 7"]


async def forever() -> None:
    await asyncio.Event().wait()


async def test_tasks_are_forgotten_once_they_are_done() -> None:
    tasks = Tasks()
    done = asyncio.Event()

    async def wait() -> None:
        await done.wait()

    task = tasks.start(wait(), "waiting")
    assert (task.get_name(), len(tasks)) == ("waiting", 1)
    done.set()
    await tasks.finished()
    assert task.done()
    assert len(tasks) == 0


async def test_tasks_can_be_cancelled_owner_by_owner() -> None:
    tasks = Tasks()
    part, other = Tasks(tasks), Tasks(tasks)
    first, second = part.start(forever(), "first"), other.start(forever(), "second")
    assert len(tasks) == 2
    part.cancel()
    await part.finished()
    assert (first.cancelled(), second.done(), len(tasks)) == (True, False, 1)
    tasks.cancel()
    await tasks.finished()
    assert second.cancelled()


async def test_task_that_cancels_all_does_not_wait_for_itself() -> None:
    tasks = Tasks()

    async def end() -> None:
        tasks.cancel()
        await tasks.finished()

    other = tasks.start(forever(), "other")
    last = tasks.start(end(), "last")
    async with asyncio.timeout(60):
        await asyncio.wait({last})
    assert other.cancelled()
    assert not last.cancelled()


def test_cancelling_no_tasks_does_nothing() -> None:
    Tasks().cancel()


async def test_finished_waits_for_slow_tasks() -> None:
    tasks = Tasks()
    asked, may = asyncio.Event(), asyncio.Event()

    async def slow() -> None:
        try:
            await forever()
        finally:
            asked.set()
            await may.wait()

    task = tasks.start(slow(), "slow")
    await asyncio.sleep(0)
    tasks.cancel()
    ending = asyncio.create_task(tasks.finished())
    await asked.wait()
    assert not ending.done()
    assert await tasks.finished(until=asyncio.get_running_loop().time()) == ["slow"]
    may.set()
    assert await ending == []
    assert task.done()


def test_traceback_does_not_grow() -> None:
    fault = NodeClosed("the node has ended")
    lengths = set()
    for _ in range(3):
        with pytest.raises(NodeClosed):
            throw(fault)
        lengths.add(len(traceback.extract_tb(fault.__traceback__)))
    assert len(lengths) == 1
