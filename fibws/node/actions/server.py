"""The serving end of an action."""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from collections.abc import Awaitable, Callable, Mapping
from inspect import isawaitable
from typing import Any, Generic, Self, TypeAlias

from fibws.errors import AlreadyOffered, NodeError
from fibws.interfaces.message import F, G, R
from fibws.node.actions.action_type import ActionType
from fibws.node.actions.actions import Actions
from fibws.node.actions.record import Record
from fibws.node.actions.server_goal import ServerGoal
from fibws.node.actions.status import Transition
from fibws.node.fault import throw
from fibws.node.part import Part
from fibws.node.tasks import Tasks
from fibws.node.text import sendable

Outcome: TypeAlias = R | Mapping[str, Any]
"""A result: whole, or its fields by name."""

Execute: TypeAlias = Callable[[ServerGoal[G, R, F]], Outcome[R] | Awaitable[Outcome[R]]]
"""Pursues a goal, and returns the result: a plain function or an async one."""

MOST_GOALS = 1000
"""How many goals are pursued at once."""

SUPERSEDED = "This goal was canceled because another goal was received by the simple action server"
ENDED = "the action server has ended"


class ActionServer(Part, Generic[G, R, F]):
    """Pursues the goals of one action, each in a task of its own.

    Leave it with `close`, or by ``async with``, to end it before the node does. Goals that are
    still pursued are then aborted, and their tasks canceled. When the hub is lost, goals that came
    over topics go on, as in ROS; those that came over operations are wanted no more, since nobody
    can hear of them again.

    Args:
        actions: the node's.
        name: the action's global name.
        type_: the action's type.
        execute: what pursues a goal. An exception in it aborts the goal, with its text; but a
            BrokenPipeError, of a program whose reader has left, ends the node.
        concurrent: whether goals are pursued side by side. If not, it is as with actionlib's
            SimpleActionServer: a new goal has the one before it canceled, and begins thereafter.
    """

    def __init__(
        self,
        actions: Actions,
        name: str,
        type_: ActionType[G, R, F],
        execute: Execute[G, R, F],
        *,
        concurrent: bool,
    ) -> None:
        if not callable(execute):
            raise TypeError(f"{name}: what pursues goals is a function, not {execute!r}")
        for other in actions.session.parts():
            if type(other) is type(self) and other.name == name:
                raise AlreadyOffered(name)
        self._actions = actions
        self._session = actions.session
        self._name = name
        self._type = type_
        self._execute = execute
        self._concurrent = concurrent
        self._goals: dict[str, ServerGoal[G, R, F]] = {}
        """Those whose end somebody waits for."""
        self._tasks = Tasks(actions.session.tasks)
        self._current: ServerGoal[G, R, F] | None = None
        self._next: ServerGoal[G, R, F] | None = None
        self._ended = asyncio.Event()
        self._fault: Exception | None = None
        self._session.join(self)

    def __repr__(self) -> str:
        return f"<ActionServer {self.name} [{self.type}]>"

    @property
    def name(self) -> str:
        """The action's global name."""
        return self._name

    @property
    def type(self) -> str:
        """The action's type, such as ``actionlib_tutorials/Fibonacci``."""
        return self._type.name

    async def spin(self) -> None:
        """Wait until the server or its node ends; raise the reason if something was the matter.

        Raises:
            OperationRejected: the hub refused the server, so that nobody can send it goals.
        """
        await self._ended.wait()
        if self._fault is not None:
            throw(self._fault)

    def close(self) -> None:
        """Pursue no more goals. Does nothing when called again."""
        if not self._ended.is_set():
            self._close(None)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()
        await self._tasks.finished()

    def end(self, fault: Exception | None) -> None:
        """No goal will come any more, because of ``fault`` if there is one."""
        self._fault = fault
        self._ended.set()
        for goal in list(self._goals.values()):
            self._finish(
                goal, Transition.REJECT if goal is self._next else Transition.ABORT, text=ENDED
            )
        self._next = None
        self._tasks.cancel()

    # What comes from the graph

    def _receive(self, record: Record, request: G) -> None:
        """Begin with a goal, or have it wait, or refuse it."""
        goal = ServerGoal(record, request, self._type.result.message_class, self._feedback)
        self._goals[record.id] = goal
        if len(self._tasks) >= MOST_GOALS:
            self._finish(goal, Transition.REJECT, text=f"{MOST_GOALS} goals are pursued already")
        elif self._concurrent or self._current is None:
            self._start(goal)
        else:
            self._line_up(goal, self._current)

    def _cancel(self, id_: str) -> None:
        """A goal is wanted no more, if it still is pursued."""
        goal = self._goals.get(id_)
        if goal is None:
            return
        if goal is self._next:
            self._next = None
            self._finish(goal, Transition.CANCEL)
        else:
            if goal.record.go(Transition.CANCEL_REQUEST):
                self._tell_status()
            goal.want_no_more()

    # What becomes of goals

    def _line_up(self, goal: ServerGoal[G, R, F], current: ServerGoal[G, R, F]) -> None:
        """Have a goal begin after the current one, which has to end: only the latest one counts."""
        latest = self._next or current
        if goal.record.stamp < latest.record.stamp:
            self._finish(goal, Transition.CANCEL, text=SUPERSEDED)
            return
        if self._next is not None:
            self._finish(self._next, Transition.CANCEL, text=SUPERSEDED)
        self._next = goal
        current.want_no_more()

    def _start(self, goal: ServerGoal[G, R, F]) -> None:
        self._current = goal
        goal.record.go(Transition.ACCEPT)
        self._tell_status()
        self._tasks.start(self._pursue(goal), f"goal {goal.id} of {self.name}")

    async def _pursue(self, goal: ServerGoal[G, R, F]) -> None:
        try:
            transition, values, text = await self._outcome(goal)
        except BrokenPipeError as error:
            # Nobody reads what the program prints, as behind `| head`: that ends it everywhere.
            self._session.end(error)
            return
        self._finish(goal, transition, values, text)
        if goal is self._current:
            self._current = None
            if self._next is not None:
                goal, self._next = self._next, None
                self._start(goal)

    async def _outcome(
        self, goal: ServerGoal[G, R, F]
    ) -> tuple[Transition, dict[str, Any] | None, str]:
        """How a goal ends, its result if it has one, and why."""
        try:
            result = self._execute(goal)
            if isawaitable(result):
                result = await result
        except BrokenPipeError:
            raise
        except Exception as error:
            text = sendable(str(error) or type(error).__name__)
            self._log_abort(goal, text, error)
            return Transition.ABORT, None, text
        except asyncio.CancelledError:
            # Of a task that the function waited for; or of this one, whose goal has ended then.
            return Transition.ABORT, None, "it was interrupted"
        transition, text = goal.ending
        try:
            return transition, self._type.result.write(result), sendable(text)
        except Exception as error:
            text = sendable(str(error))
            self._log_abort(goal, text)
            return Transition.ABORT, None, text

    def _log_abort(
        self, goal: ServerGoal[G, R, F], text: str, error: Exception | None = None
    ) -> None:
        self._session.log.error(
            "%s: goal %s was aborted: %s", self.name, goal.id, text, exc_info=error
        )

    def _finish(
        self,
        goal: ServerGoal[G, R, F],
        transition: Transition,
        values: dict[str, Any] | None = None,
        text: str = "",
    ) -> None:
        """End a goal, once."""
        if self._goals.get(goal.id) is goal:
            del self._goals[goal.id]
            goal.record.go(transition, text)
            self._tell_result(goal.record, values)

    async def _feedback(self, goal: ServerGoal[G, R, F], feedback: F | Mapping[str, Any]) -> None:
        values = self._type.feedback.write(feedback)
        if goal.status.is_final:
            raise RuntimeError(f"goal {goal.id} of {self.name} has ended")
        await self._session.outbox.room()
        if self._goals.get(goal.id) is goal:
            self._tell_feedback(goal.record, values)

    def _refuse(self, fault: NodeError) -> None:
        """The hub does not have this server; its owner may not be waiting for that."""
        if not self._ended.is_set():
            self._session.log.error("The hub refused the action server %s: %s", self.name, fault)
            self._close(fault)

    def _close(self, fault: Exception | None) -> None:
        self.end(fault)
        self._session.leave(self)
        self._unadvertise()

    # How the graph hears of it

    @abstractmethod
    def _tell_status(self) -> None:
        """A goal's status has changed."""

    @abstractmethod
    def _tell_feedback(self, record: Record, feedback: dict[str, Any]) -> None:
        """A goal has come as far as ``feedback`` says."""

    @abstractmethod
    def _tell_result(self, record: Record, result: dict[str, Any] | None) -> None:
        """A goal has ended; without a result if something went wrong."""

    @abstractmethod
    def _unadvertise(self) -> None:
        """Take the registrations back."""
