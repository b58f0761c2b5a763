"""Action servers and their goals, whether over topics or over operations."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import Any

import pytest

from fibws.errors import AlreadyOffered, InvalidMessage, NodeClosed, OperationRejected
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions import server as server_module
from fibws.node.actions.server import ENDED, SUPERSEDED, ActionServer, ServerGoal
from fibws.node.actions.status import GoalRecord, Transition
from fibws.node.session import Session
from fibws.protocol.goals import GoalStatus

from ..conftest import FakeSession, Lines
from ..stubborn import Stubborn
from .conftest import FibonacciType

FibonacciServerGoal = ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback]


# Goals


async def publish(goal: FibonacciServerGoal, feedback: object) -> None:
    raise AssertionError(feedback)


@pytest.fixture
def goal() -> FibonacciServerGoal:
    return ServerGoal(GoalRecord("a"), FibonacciGoal(5), FibonacciResult, publish)


def test_goal_has_id_request_and_status(goal: FibonacciServerGoal) -> None:
    assert (goal.id, goal.request, goal.status) == ("a", FibonacciGoal(5), GoalStatus.PENDING)
    assert repr(goal) == "<ServerGoal a PENDING>"


def test_goal_succeeds_by_default(goal: FibonacciServerGoal) -> None:
    assert goal._ending == (Transition.SUCCEED, "")


def test_goal_can_end_as_canceled_or_aborted_with_or_without_a_result(
    goal: FibonacciServerGoal,
) -> None:
    assert goal.canceled(FibonacciResult([0])) == FibonacciResult([0])
    assert goal._ending == (Transition.CANCEL, "")
    assert goal.aborted(text="no more numbers") == FibonacciResult()
    assert goal._ending == (Transition.ABORT, "no more numbers")


async def test_cancellation_returns_when_cancel_is_requested(goal: FibonacciServerGoal) -> None:
    async with asyncio.timeout(60), asyncio.TaskGroup() as tasks:
        waiting = tasks.create_task(goal.cancellation())
        long = tasks.create_task(goal.cancellation(timeout=60))
        await asyncio.sleep(0)
        goal._request_cancel()
    assert waiting.result() and long.result()
    assert goal.cancel_requested


async def test_cancellation_returns_false_after_its_timeout(goal: FibonacciServerGoal) -> None:
    assert not await goal.cancellation(timeout=0.001)
    assert not goal.cancel_requested
    with pytest.raises(ValueError, match="timeout must be a finite number of seconds above 0"):
        await goal.cancellation(timeout=0)


# Executing goals


class RecordingServer(ActionServer[FibonacciGoal, FibonacciResult, FibonacciFeedback]):
    """A server that records what it sends."""

    def __init__(
        self, session: Session, name: str, type_: FibonacciType, execute: Any, *, concurrent: bool
    ) -> None:
        super().__init__(session, name, type_, execute, concurrent=concurrent)
        self.registered = True
        self.feedback: list[Any] = []
        self.results: dict[str, tuple[str, str, Any]] = {}
        self.statuses: list[list[str]] = []
        self._result_sent = asyncio.Event()

    def goal(self, id_: str, order: int = 5, stamp: int = 0) -> GoalRecord:
        record = GoalRecord(id_, stamp)
        self._receive(record, FibonacciGoal(order))
        return record

    def cancel(self, id_: str) -> None:
        self._cancel(id_)

    def refuse_all(self, error: OperationRejected) -> None:
        self._refuse(error)

    async def result(self, id_: str) -> tuple[str, str, Any]:
        """Status, text and result of a goal, once it has ended."""
        async with asyncio.timeout(60):
            while id_ not in self.results:
                self._result_sent.clear()
                await self._result_sent.wait()
        return self.results[id_]

    def _send_status(self) -> None:
        self.statuses.append([f"{goal.id} {goal.status}" for goal in self._goals.values()])

    def _send_feedback(self, record: GoalRecord, feedback: dict[str, Any]) -> None:
        self.feedback.append((record.id, feedback["sequence"]))

    def _send_result(self, record: GoalRecord, result: dict[str, Any] | None) -> None:
        assert record.id not in self.results, "a goal ends once"
        self.results[record.id] = (
            record.status.name,
            record.text,
            result and result["sequence"],
        )
        self._result_sent.set()

    def _unadvertise(self) -> None:
        self.registered = False


Serve = Callable[..., RecordingServer]


@pytest.fixture
def serve(session: FakeSession, fibonacci: FibonacciType) -> Serve:
    def serve(
        execute: Any, *, concurrent: bool = True, name: str = "/fibonacci"
    ) -> RecordingServer:
        return RecordingServer(session, name, fibonacci, execute, concurrent=concurrent)

    return serve


class Blocking:
    """Executes each goal until the test lets it succeed, or until it is canceled."""

    def __init__(self) -> None:
        self.begun: list[str] = []
        self.goals: dict[str, FibonacciServerGoal] = {}
        self._released: dict[str, asyncio.Event] = {}
        self._changed = asyncio.Event()

    async def __call__(self, goal: FibonacciServerGoal) -> FibonacciResult:
        self.begun.append(goal.id)
        self.goals[goal.id] = goal
        self._changed.set()
        released = self._released.setdefault(goal.id, asyncio.Event())
        waits = [asyncio.create_task(released.wait()), asyncio.create_task(goal.cancellation())]
        try:
            await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for each in waits:
                each.cancel()
        return goal.canceled() if goal.cancel_requested else FibonacciResult([1])

    def release(self, id_: str) -> None:
        self._released.setdefault(id_, asyncio.Event()).set()

    async def begins(self, id_: str) -> None:
        async with asyncio.timeout(60):
            while id_ not in self.begun:
                self._changed.clear()
                await self._changed.wait()


async def test_goal_succeeds_with_the_functions_result(serve: Serve) -> None:
    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        await goal.publish_feedback(FibonacciFeedback([goal.request.order]))
        return FibonacciResult([7])

    server = serve(execute)
    server.goal("a", order=3)
    assert await server.result("a") == ("SUCCEEDED", "", [7])
    assert server.feedback == [("a", [3])]
    assert server.statuses == [["a ACTIVE"]]


async def test_function_can_abort_or_cancel_its_goal(serve: Serve) -> None:
    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        if goal.request.order < 0:
            return goal.aborted(text="negative")
        goal.canceled(text="enough")
        return FibonacciResult([4])

    server = serve(execute)
    server.goal("a", order=-1)
    server.goal("b", order=1)
    assert await server.result("a") == ("ABORTED", "negative", [])
    assert await server.result("b") == ("PREEMPTED", "enough", [4])


@pytest.mark.parametrize("result", [FibonacciResult([7]), {"sequence": [7]}])
async def test_function_may_be_synchronous_and_return_a_dict(serve: Serve, result: Any) -> None:
    server = serve(lambda goal: result)
    server.goal("a")
    assert await server.result("a") == ("SUCCEEDED", "", [7])


async def test_feedback_may_be_a_dict(serve: Serve) -> None:
    async def execute(goal: FibonacciServerGoal) -> dict[str, list[int]]:
        await goal.publish_feedback({"sequence": [1, 2]})
        return {}

    server = serve(execute)
    server.goal("a")
    assert await server.result("a") == ("SUCCEEDED", "", [])
    assert server.feedback == [("a", [1, 2])]


def test_execute_must_be_callable(serve: Serve) -> None:
    with pytest.raises(TypeError, match="execute must be callable, got None"):
        serve(None)
    serve(Blocking())


async def test_exception_in_the_function_is_logged_with_its_traceback(
    serve: Serve, session: FakeSession
) -> None:
    async def execute(goal: FibonacciServerGoal) -> Any:
        if goal.request.order == 0:
            return 5
        return 1 / 0

    class Recorder(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            records.append(record)

    records: list[logging.LogRecord] = []
    session.log.addHandler(Recorder())
    server = serve(execute)
    for order in (0, 1):
        server.goal(str(order), order=order)
        await server.result(str(order))
    wrong, broken = records
    assert wrong.exc_info is None
    assert broken.exc_info is not None and broken.exc_info[0] is ZeroDivisionError


@pytest.mark.parametrize("is_logged", [False, True])
async def test_broken_pipe_ends_the_node(
    serve: Serve, session: FakeSession, is_logged: bool
) -> None:
    class Broken(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            raise BrokenPipeError

    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        raise ValueError if is_logged else BrokenPipeError

    session.log.addHandler(Broken())
    server = serve(execute)
    server.goal("a")
    assert await server.result("a") == ("ABORTED", ENDED, None)
    with pytest.raises(BrokenPipeError):
        await server.spin()
    with pytest.raises(BrokenPipeError):
        await session.ended()


async def test_exception_aborts_only_its_goal(serve: Serve, lines: Lines) -> None:
    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        if goal.request.order == 0:
            raise ValueError
        if goal.request.order < 0:
            raise ValueError(f"order {goal.request.order} is negative \udc80")
        return FibonacciResult()

    server = serve(execute)
    server.goal("a", order=-1)
    assert await server.result("a") == ("ABORTED", "ValueError: order -1 is negative ?", None)
    assert (
        await lines.next() == "/fibonacci: goal a was aborted: ValueError: order -1 is negative ?"
    )
    server.goal("b", order=0)
    assert await server.result("b") == ("ABORTED", "ValueError", None)
    server.goal("c")
    assert (await server.result("c"))[0] == "SUCCEEDED"


@pytest.mark.parametrize(
    ("result", "text"),
    [
        (None, "expected [actionlib_tutorials/FibonacciResult] but got [NoneType]"),
        (FibonacciResult([2**31]), "requires an int32 for field sequence[0]"),
    ],
)
async def test_invalid_result_aborts_the_goal(
    serve: Serve, result: Any, text: str, lines: Lines
) -> None:
    async def execute(goal: FibonacciServerGoal) -> Any:
        return result

    server = serve(execute)
    server.goal("a")
    status, reason, values = await server.result("a")
    assert (status, values) == ("ABORTED", None)
    assert text in reason
    assert text in await lines.next()


async def test_invalid_feedback_raises_in_the_function(serve: Serve) -> None:
    errors: list[Exception] = []

    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        wrong: Any = FibonacciResult()
        for feedback in (FibonacciFeedback([2**31]), wrong):
            try:
                await goal.publish_feedback(feedback)
            except (InvalidMessage, TypeError) as error:
                errors.append(error)
        return FibonacciResult()

    server = serve(execute)
    server.goal("a")
    assert (await server.result("a"))[0] == "SUCCEEDED"
    assert [type(error) for error in errors] == [InvalidMessage, TypeError]
    assert server.feedback == []


async def test_feedback_after_the_end_is_refused(serve: Serve) -> None:
    kept: list[FibonacciServerGoal] = []

    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        kept.append(goal)
        return FibonacciResult()

    server = serve(execute)
    server.goal("a")
    await server.result("a")
    with pytest.raises(RuntimeError, match="goal a of /fibonacci has ended"):
        await kept[0].publish_feedback(FibonacciFeedback())


async def test_feedback_waits_for_a_slow_connection(serve: Serve, session: FakeSession) -> None:
    session.fill()
    waiting = asyncio.Event()

    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        waiting.set()
        await goal.publish_feedback(FibonacciFeedback([1]))
        return FibonacciResult()

    server = serve(execute)
    server.goal("a")
    await waiting.wait()
    await asyncio.sleep(0)
    assert (server.feedback, server.results) == ([], {})
    session.drain()
    await server.result("a")
    assert server.feedback == [("a", [1])]


async def test_cancelled_future_in_the_function_aborts_the_goal(
    serve: Serve,
) -> None:
    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        future = asyncio.get_running_loop().create_future()
        future.cancel()
        await future
        raise AssertionError

    server = serve(execute)
    server.goal("a")
    assert await server.result("a") == ("ABORTED", "it was interrupted", None)


async def test_concurrent_goals_are_executed_at_the_same_time(serve: Serve) -> None:
    execute = Blocking()
    server = serve(execute)
    server.goal("a")
    server.goal("b")
    await execute.begins("b")
    execute.release("b")
    assert (await server.result("b"))[0] == "SUCCEEDED"
    assert server.results.keys() == {"b"}
    execute.release("a")
    assert (await server.result("a"))[0] == "SUCCEEDED"


async def test_cancel_concerns_only_its_goal(serve: Serve) -> None:
    execute = Blocking()
    server = serve(execute)
    server.goal("a")
    server.goal("b")
    await execute.begins("b")
    server.cancel("a")
    assert server.statuses[-1] == ["a PREEMPTING", "b ACTIVE"]
    assert await server.result("a") == ("PREEMPTED", "", [])
    assert not execute.goals["b"].cancel_requested
    sent = len(server.statuses)
    server.cancel("a")
    server.cancel("unknown")
    assert len(server.statuses) == sent
    execute.release("b")
    await server.result("b")


async def test_function_may_succeed_after_a_cancel(serve: Serve) -> None:
    begun = asyncio.Event()

    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        begun.set()
        await goal.cancellation()
        return FibonacciResult([1])

    server = serve(execute)
    server.goal("a")
    await begun.wait()
    for _ in range(2):
        server.cancel("a")
    assert server.statuses[1:] == [["a PREEMPTING"]]
    assert await server.result("a") == ("SUCCEEDED", "", [1])


async def test_number_of_goals_at_once_is_limited(
    serve: Serve, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server_module, "MOST_GOALS", 2)
    execute = Blocking()
    server = serve(execute)
    for id_ in ("a", "b", "c"):
        server.goal(id_)
    assert await server.result("c") == ("REJECTED", "too many goals at once (limit 2)", None)
    execute.release("a")
    await server.result("a")
    await asyncio.sleep(0)
    server.goal("d")
    await execute.begins("d")
    assert "d" not in server.results
    server.close()


# One goal at a time, as with actionlib's SimpleActionServer


async def test_new_goal_cancels_the_current_one_and_begins_after_it(
    serve: Serve,
) -> None:
    execute = Blocking()
    server = serve(execute, concurrent=False)
    server.goal("a", stamp=1)
    await execute.begins("a")
    b = server.goal("b", stamp=1)
    assert execute.goals["a"].cancel_requested
    assert (execute.goals["a"].status.name, b.status.name) == ("ACTIVE", "PENDING")
    assert await server.result("a") == ("PREEMPTED", "", [])
    await execute.begins("b")
    execute.release("b")
    assert (await server.result("b"))[0] == "SUCCEEDED"
    assert execute.begun == ["a", "b"]


async def test_only_the_newest_waiting_goal_is_kept(serve: Serve) -> None:
    execute = Blocking()
    server = serve(execute, concurrent=False)
    for id_, stamp in (("a", 2), ("b", 3), ("older", 1), ("c", 3)):
        server.goal(id_, stamp=stamp)
    assert await server.result("b") == ("RECALLED", SUPERSEDED, None)
    assert await server.result("older") == ("RECALLED", SUPERSEDED, None)
    await execute.begins("c")
    assert execute.begun == ["a", "c"]
    execute.release("c")
    await server.result("c")


async def test_waiting_goal_is_recalled_when_canceled(serve: Serve) -> None:
    async def stubborn(goal: FibonacciServerGoal) -> FibonacciResult:
        await free.wait()
        return FibonacciResult()

    free = asyncio.Event()
    server = serve(stubborn, concurrent=False)
    server.goal("a")
    server.goal("b")
    server.cancel("b")
    assert await server.result("b") == ("RECALLED", "", None)
    free.set()
    assert (await server.result("a"))[0] == "SUCCEEDED"
    assert server.results.keys() == {"a", "b"}


async def test_ended_goal_does_not_block_older_goals(serve: Serve) -> None:
    execute = Blocking()
    server = serve(execute, concurrent=False)
    for id_, stamp in (("a", 9), ("from an earlier clock", 1)):
        execute.release(id_)
        server.goal(id_, stamp=stamp)
        assert (await server.result(id_))[0] == "SUCCEEDED"


# The end of the server


async def test_leaving_the_server_ends_its_goals_and_their_tasks(serve: Serve) -> None:
    execute, over = Blocking(), asyncio.Event()

    async def execute_and_note(goal: FibonacciServerGoal) -> FibonacciResult:
        try:
            return await execute(goal)
        finally:
            over.set()

    async with serve(execute_and_note, concurrent=False) as server:
        server.goal("a")
        await execute.begins("a")
        server.goal("b")
    assert over.is_set()
    assert not server.registered
    assert server.results == {"a": ("ABORTED", ENDED, None), "b": ("REJECTED", ENDED, None)}
    server.close()
    await server.spin()


async def test_leaving_the_server_waits_for_its_handlers_for_a_while(
    serve: Serve, lines: Lines, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fibws.node.session.HANDLER_TIMEOUT", 0.0)
    handler = Stubborn()
    async with serve(handler) as server:
        server.goal("a")
        await handler.begun.wait()
    assert server.results == {"a": ("ABORTED", ENDED, None)}
    (line,) = lines.seen()
    assert "handler of action /fibonacci (goal a)" in line
    await handler.ends()


async def test_close_aborts_goal_whose_task_has_not_begun(serve: Serve) -> None:
    execute = Blocking()
    async with serve(execute) as server:
        server.goal("a")
    assert server.results == {"a": ("ABORTED", ENDED, None)}
    assert execute.begun == []


async def test_function_may_close_its_server(serve: Serve) -> None:
    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        server.close()
        return FibonacciResult()

    server = serve(execute)
    server.goal("a")
    await server.spin()
    assert server.results == {"a": ("ABORTED", ENDED, None)}


async def test_end_of_the_node_ends_the_server(serve: Serve, session: FakeSession) -> None:
    execute = Blocking()
    server = serve(execute)
    server.goal("a")
    await execute.begins("a")
    session.end(OperationRejected("because"))
    with pytest.raises(OperationRejected, match="because"):
        await server.spin()
    await session.tasks.finished()
    assert server.results == {"a": ("ABORTED", ENDED, None)}


async def test_refusal_is_logged_and_raised_by_spin(serve: Serve, lines: Lines) -> None:
    server = serve(Blocking())
    for _ in range(2):
        server.refuse_all(OperationRejected("no room"))
    assert await lines.next() == "The hub refused the action server /fibonacci: no room"
    assert lines.seen() == []
    with pytest.raises(OperationRejected, match="no room"):
        await server.spin()


async def test_second_server_of_an_action_is_refused(serve: Serve) -> None:
    server = serve(Blocking())
    with pytest.raises(AlreadyOffered, match="/fibonacci"):
        serve(Blocking())
    serve(Blocking(), name="/other")
    server.close()
    serve(Blocking())


async def test_server_after_the_end_of_the_node_is_refused(
    serve: Serve, session: FakeSession
) -> None:
    session.end()
    with pytest.raises(NodeClosed):
        serve(Blocking())


async def test_server_has_name_and_type(serve: Serve) -> None:
    server = serve(Blocking())
    assert (server.name, server.type) == ("/fibonacci", "actionlib_tutorials/Fibonacci")
    assert repr(server) == "<ActionServer /fibonacci [actionlib_tutorials/Fibonacci]>"
