"""What a server makes of goals, however it hears of them."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import Any

import pytest

from fibws.errors import AlreadyOffered, InvalidMessage, NodeClosed, OperationRejected
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.node.actions import server as server_module
from fibws.node.actions.actions import Actions
from fibws.node.actions.record import Record
from fibws.node.actions.server import ENDED, SUPERSEDED, ActionServer
from fibws.node.actions.server_goal import ServerGoal
from fibws.node.outbox import FRAME_COST, LIMIT
from fibws.node.session import Session

from ..conftest import Lines
from .conftest import FibonacciType

FibonacciServerGoal = ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback]


class Told(ActionServer[FibonacciGoal, FibonacciResult, FibonacciFeedback]):
    """A server that remembers what it has told the graph."""

    registered = True

    def open(self) -> None:
        self.feedback: list[Any] = []
        self.results: dict[str, tuple[str, str, Any]] = {}
        self.stati: list[list[str]] = []
        self.over = asyncio.Event()

    def goal(self, id_: str, order: int = 5, stamp: int = 0) -> Record:
        record = Record(id_, stamp)
        self._receive(record, FibonacciGoal(order))
        return record

    def cancel(self, id_: str) -> None:
        self._cancel(id_)

    def refuse_all(self, fault: OperationRejected) -> None:
        self._refuse(fault)

    async def ended(self, id_: str) -> tuple[str, str, Any]:
        """Status, text and result of a goal, once it has ended."""
        async with asyncio.timeout(60):
            while id_ not in self.results:
                self.over.clear()
                await self.over.wait()
        return self.results[id_]

    def _tell_status(self) -> None:
        self.stati.append([f"{goal.id} {goal.status}" for goal in self._goals.values()])

    def _tell_feedback(self, record: Record, feedback: dict[str, Any]) -> None:
        self.feedback.append((record.id, feedback["sequence"]))

    def _tell_result(self, record: Record, result: dict[str, Any] | None) -> None:
        assert record.id not in self.results, "a goal ends once"
        self.results[record.id] = (
            record.status.name,
            record.text,
            result and result["sequence"],
        )
        self.over.set()

    def _unadvertise(self) -> None:
        self.registered = False


Serve = Callable[..., Told]


@pytest.fixture
def serve(actions: Actions, fibonacci: FibonacciType) -> Serve:
    def serve(execute: Any, *, concurrent: bool = True, name: str = "/fibonacci") -> Told:
        server = Told(actions, name, fibonacci, execute, concurrent=concurrent)
        server.open()
        return server

    return serve


class Patient:
    """Pursues goals until the test lets each one succeed, or it is wanted no more."""

    def __init__(self) -> None:
        self.begun: list[str] = []
        self.goals: dict[str, FibonacciServerGoal] = {}
        self._free: dict[str, asyncio.Event] = {}
        self._news = asyncio.Event()

    async def __call__(self, goal: FibonacciServerGoal) -> FibonacciResult:
        self.begun.append(goal.id)
        self.goals[goal.id] = goal
        self._news.set()
        free = self._free.setdefault(goal.id, asyncio.Event())
        wakers = [asyncio.create_task(free.wait()), asyncio.create_task(goal.cancellation())]
        try:
            await asyncio.wait(wakers, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for waker in wakers:
                waker.cancel()
        return goal.canceled() if goal.cancel_requested else FibonacciResult([1])

    def free(self, id_: str) -> None:
        self._free.setdefault(id_, asyncio.Event()).set()

    async def begins(self, id_: str) -> None:
        async with asyncio.timeout(60):
            while id_ not in self.begun:
                self._news.clear()
                await self._news.wait()


async def test_a_goal_succeeds_with_what_the_function_returns(serve: Serve) -> None:
    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        await goal.publish_feedback(FibonacciFeedback([goal.request.order]))
        return FibonacciResult([7])

    server = serve(execute)
    server.goal("a", order=3)
    assert await server.ended("a") == ("SUCCEEDED", "", [7])
    assert server.feedback == [("a", [3])]
    assert server.stati == [["a ACTIVE"]]


async def test_a_goal_ends_as_the_function_says(serve: Serve) -> None:
    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        if goal.request.order < 0:
            return goal.aborted(text="negative")
        goal.canceled(text="enough")
        return FibonacciResult([4])

    server = serve(execute)
    server.goal("a", order=-1)
    server.goal("b", order=1)
    assert await server.ended("a") == ("ABORTED", "negative", [])
    assert await server.ended("b") == ("PREEMPTED", "enough", [4])


@pytest.mark.parametrize("result", [FibonacciResult([7]), {"sequence": [7]}])
async def test_the_function_may_be_a_plain_one_and_give_a_dict(serve: Serve, result: Any) -> None:
    server = serve(lambda goal: result)
    server.goal("a")
    assert await server.ended("a") == ("SUCCEEDED", "", [7])


async def test_feedback_may_be_a_dict(serve: Serve) -> None:
    async def execute(goal: FibonacciServerGoal) -> dict[str, list[int]]:
        await goal.publish_feedback({"sequence": [1, 2]})
        return {}

    server = serve(execute)
    server.goal("a")
    assert await server.ended("a") == ("SUCCEEDED", "", [])
    assert server.feedback == [("a", [1, 2])]


def test_what_is_no_function_is_refused_at_once(serve: Serve) -> None:
    with pytest.raises(TypeError, match="what pursues goals is a function, not None"):
        serve(None)
    serve(Patient())


async def test_an_error_in_the_function_is_logged_with_its_traceback(
    serve: Serve, session: Session
) -> None:
    async def execute(goal: FibonacciServerGoal) -> Any:
        if goal.request.order == 0:
            return 5
        return 1 / 0

    class Kept(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            records.append(record)

    records: list[logging.LogRecord] = []
    session.log.addHandler(Kept())
    server = serve(execute)
    for order in (0, 1):
        server.goal(str(order), order=order)
        await server.ended(str(order))
    wrong, broken = records
    assert wrong.exc_info is None
    assert broken.exc_info is not None and broken.exc_info[0] is ZeroDivisionError


@pytest.mark.parametrize("is_logged", [False, True])
async def test_when_nobody_reads_what_the_program_prints_the_node_ends(
    serve: Serve, session: Session, is_logged: bool
) -> None:
    class Broken(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            raise BrokenPipeError

    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        raise ValueError if is_logged else BrokenPipeError

    session.log.addHandler(Broken())
    server = serve(execute)
    server.goal("a")
    assert await server.ended("a") == ("ABORTED", ENDED, None)
    with pytest.raises(BrokenPipeError):
        await server.spin()
    with pytest.raises(BrokenPipeError):
        await session.ended()


async def test_an_error_aborts_its_goal_alone(serve: Serve, lines: Lines) -> None:
    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        if goal.request.order == 0:
            raise ValueError
        if goal.request.order < 0:
            raise ValueError(f"order {goal.request.order} is negative \udc80")
        return FibonacciResult()

    server = serve(execute)
    server.goal("a", order=-1)
    assert await server.ended("a") == ("ABORTED", "order -1 is negative ?", None)
    assert await lines.next() == "/fibonacci: goal a was aborted: order -1 is negative ?"
    server.goal("b", order=0)
    assert await server.ended("b") == ("ABORTED", "ValueError", None)
    server.goal("c")
    assert (await server.ended("c"))[0] == "SUCCEEDED"


@pytest.mark.parametrize(
    ("result", "text"),
    [
        (None, "expected [actionlib_tutorials/FibonacciResult] but got [NoneType]"),
        (FibonacciResult([2**31]), "requires a int32 for field sequence[0]"),
    ],
)
async def test_a_result_that_is_none_aborts_the_goal(
    serve: Serve, result: Any, text: str, lines: Lines
) -> None:
    async def execute(goal: FibonacciServerGoal) -> Any:
        return result

    server = serve(execute)
    server.goal("a")
    status, said, values = await server.ended("a")
    assert (status, values) == ("ABORTED", None)
    assert text in said
    assert text in await lines.next()


async def test_feedback_that_does_not_fit_raises_in_the_functions_own_line(serve: Serve) -> None:
    faults: list[Exception] = []

    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        wrong: Any = FibonacciResult()
        for feedback in (FibonacciFeedback([2**31]), wrong):
            try:
                await goal.publish_feedback(feedback)
            except (InvalidMessage, TypeError) as fault:
                faults.append(fault)
        return FibonacciResult()

    server = serve(execute)
    server.goal("a")
    assert (await server.ended("a"))[0] == "SUCCEEDED"
    assert [type(fault) for fault in faults] == [InvalidMessage, TypeError]
    assert server.feedback == []


async def test_there_is_no_feedback_after_the_end(serve: Serve) -> None:
    kept: list[FibonacciServerGoal] = []

    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        kept.append(goal)
        return FibonacciResult()

    server = serve(execute)
    server.goal("a")
    await server.ended("a")
    with pytest.raises(RuntimeError, match="goal a of /fibonacci has ended"):
        await kept[0].publish_feedback(FibonacciFeedback())


async def test_feedback_waits_for_a_slow_connection(serve: Serve, session: Session) -> None:
    session.outbox.put(b" " * (LIMIT - FRAME_COST))
    waits = asyncio.Event()

    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        waits.set()
        await goal.publish_feedback(FibonacciFeedback([1]))
        return FibonacciResult()

    server = serve(execute)
    server.goal("a")
    await waits.wait()
    await asyncio.sleep(0)
    assert (server.feedback, server.results) == ([], {})
    session.outbox.pop()
    await server.ended("a")
    assert server.feedback == [("a", [1])]


async def test_a_function_that_is_interrupted_by_its_own_helpers_aborts_the_goal(
    serve: Serve,
) -> None:
    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        helper = asyncio.get_running_loop().create_future()
        helper.cancel()
        await helper
        raise AssertionError

    server = serve(execute)
    server.goal("a")
    assert await server.ended("a") == ("ABORTED", "it was interrupted", None)


async def test_goals_are_pursued_side_by_side(serve: Serve) -> None:
    execute = Patient()
    server = serve(execute)
    server.goal("a")
    server.goal("b")
    await execute.begins("b")
    execute.free("b")
    assert (await server.ended("b"))[0] == "SUCCEEDED"
    assert server.results.keys() == {"b"}
    execute.free("a")
    assert (await server.ended("a"))[0] == "SUCCEEDED"


async def test_a_cancel_reaches_its_goal_alone(serve: Serve) -> None:
    execute = Patient()
    server = serve(execute)
    server.goal("a")
    server.goal("b")
    await execute.begins("b")
    server.cancel("a")
    assert server.stati[-1] == ["a PREEMPTING", "b ACTIVE"]
    assert await server.ended("a") == ("PREEMPTED", "", [])
    assert not execute.goals["b"].cancel_requested
    told = len(server.stati)
    server.cancel("a")
    server.cancel("unknown")
    assert len(server.stati) == told
    execute.free("b")
    await server.ended("b")


async def test_a_function_may_succeed_in_spite_of_a_cancel(serve: Serve) -> None:
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
    assert server.stati[1:] == [["a PREEMPTING"]]
    assert await server.ended("a") == ("SUCCEEDED", "", [1])


async def test_there_is_a_limit_to_goals_at_once(
    serve: Serve, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server_module, "MOST_GOALS", 2)
    execute = Patient()
    server = serve(execute)
    for id_ in ("a", "b", "c"):
        server.goal(id_)
    assert await server.ended("c") == ("REJECTED", "2 goals are pursued already", None)
    execute.free("a")
    await server.ended("a")
    await asyncio.sleep(0)
    server.goal("d")
    await execute.begins("d")
    assert "d" not in server.results
    server.close()


# actionlib's SimpleActionServer


async def test_a_new_goal_has_the_one_before_it_canceled_and_begins_after_that(
    serve: Serve,
) -> None:
    execute = Patient()
    server = serve(execute, concurrent=False)
    server.goal("a", stamp=1)
    await execute.begins("a")
    b = server.goal("b", stamp=1)
    assert execute.goals["a"].cancel_requested
    assert (execute.goals["a"].status.name, b.status.name) == ("ACTIVE", "PENDING")
    assert await server.ended("a") == ("PREEMPTED", "", [])
    await execute.begins("b")
    execute.free("b")
    assert (await server.ended("b"))[0] == "SUCCEEDED"
    assert execute.begun == ["a", "b"]


async def test_of_the_goals_that_wait_only_the_newest_counts(serve: Serve) -> None:
    execute = Patient()
    server = serve(execute, concurrent=False)
    for id_, stamp in (("a", 2), ("b", 3), ("older", 1), ("c", 3)):
        server.goal(id_, stamp=stamp)
    assert await server.ended("b") == ("RECALLED", SUPERSEDED, None)
    assert await server.ended("older") == ("RECALLED", SUPERSEDED, None)
    await execute.begins("c")
    assert execute.begun == ["a", "c"]
    execute.free("c")
    await server.ended("c")


async def test_a_goal_that_waits_is_recalled_when_it_is_canceled(serve: Serve) -> None:
    async def stubborn(goal: FibonacciServerGoal) -> FibonacciResult:
        await free.wait()
        return FibonacciResult()

    free = asyncio.Event()
    server = serve(stubborn, concurrent=False)
    server.goal("a")
    server.goal("b")
    server.cancel("b")
    assert await server.ended("b") == ("RECALLED", "", None)
    free.set()
    assert (await server.ended("a"))[0] == "SUCCEEDED"
    assert server.results.keys() == {"a", "b"}


async def test_after_its_end_a_goal_stands_in_nobodys_way(serve: Serve) -> None:
    execute = Patient()
    server = serve(execute, concurrent=False)
    for id_, stamp in (("a", 9), ("from an earlier clock", 1)):
        execute.free(id_)
        server.goal(id_, stamp=stamp)
        assert (await server.ended(id_))[0] == "SUCCEEDED"


# Its end


async def test_when_it_is_left_its_goals_are_aborted_and_their_tasks_over(serve: Serve) -> None:
    execute, over = Patient(), asyncio.Event()

    async def pursue(goal: FibonacciServerGoal) -> FibonacciResult:
        try:
            return await execute(goal)
        finally:
            over.set()

    async with serve(pursue, concurrent=False) as server:
        server.goal("a")
        await execute.begins("a")
        server.goal("b")
    assert over.is_set()
    assert not server.registered
    assert server.results == {"a": ("ABORTED", ENDED, None), "b": ("REJECTED", ENDED, None)}
    server.close()
    await server.spin()


async def test_a_goal_that_had_no_time_to_begin_is_aborted_as_well(serve: Serve) -> None:
    execute = Patient()
    async with serve(execute) as server:
        server.goal("a")
    assert server.results == {"a": ("ABORTED", ENDED, None)}
    assert execute.begun == []


async def test_a_goal_may_end_its_server(serve: Serve) -> None:
    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        server.close()
        return FibonacciResult()

    server = serve(execute)
    server.goal("a")
    await server.spin()
    assert server.results == {"a": ("ABORTED", ENDED, None)}


async def test_the_nodes_end_is_its_end(serve: Serve, session: Session) -> None:
    execute = Patient()
    server = serve(execute)
    server.goal("a")
    await execute.begins("a")
    fault = OperationRejected("because")
    session.end(fault)
    with pytest.raises(OperationRejected, match="because"):
        await server.spin()
    await session.tasks.finished()
    assert server.results == {"a": ("ABORTED", ENDED, None)}


async def test_a_refusal_is_told_to_the_log_and_to_who_waits(serve: Serve, lines: Lines) -> None:
    server = serve(Patient())
    for _ in range(2):
        server.refuse_all(OperationRejected("no room"))
    assert await lines.next() == "The hub refused the action server /fibonacci: no room"
    assert lines.seen() == []
    with pytest.raises(OperationRejected, match="no room"):
        await server.spin()


async def test_a_node_serves_an_action_once(serve: Serve) -> None:
    server = serve(Patient())
    with pytest.raises(AlreadyOffered, match="/fibonacci: this node offers it already"):
        serve(Patient())
    serve(Patient(), name="/other")
    server.close()
    serve(Patient())


async def test_after_the_nodes_end_there_is_none(serve: Serve, session: Session) -> None:
    session.end()
    with pytest.raises(NodeClosed):
        serve(Patient())


async def test_it_says_what_it_is(serve: Serve) -> None:
    server = serve(Patient())
    assert (server.name, server.type) == ("/fibonacci", "actionlib_tutorials/Fibonacci")
    assert repr(server) == "<ActionServer /fibonacci [actionlib_tutorials/Fibonacci]>"
