"""Action servers: executing the goals of an action."""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from inspect import isawaitable
from typing import Any, Generic, Self, TypeAlias

from fibws.errors import AlreadyOffered, NodeError
from fibws.interfaces.message import F, G, R
from fibws.node.actions.status import GoalRecord, Transition
from fibws.node.checks import check_timeout, described, without_surrogates
from fibws.node.session import OperationHandler, Registration, Session, Tasks, throw
from fibws.node.types import NodeActionType
from fibws.protocol.goals import GoalStatus
from fibws.public_classes import Public, made_by

MOST_GOALS = 1000
"""Goals of one server that are executed at once."""

SUPERSEDED = "This goal was canceled because another goal was received by the simple action server"
ENDED = "the action server has ended"


@made_by("an action server")
class ServerGoal(Public, Generic[G, R, F]):
    """A goal to execute, which a server passes to its function.

    The function returns the goal's result. The goal has then succeeded, unless the function called
    `canceled` or `aborted`.
    """

    # record: the goal's public state.
    # request: the goal's message.
    # result: the class of its result.
    # publish: sends feedback of the goal.
    def __init__(
        self,
        record: GoalRecord,
        request: G,
        result: type[R],
        publish: Callable[[ServerGoal[G, R, F], F | Mapping[str, Any]], Awaitable[None]],
    ) -> None:
        self._record = record
        """Its public state."""
        self._request = request
        self._result = result
        self._publish = publish
        self._cancel = asyncio.Event()
        self._ending = (Transition.SUCCEED, "")
        """How the goal ends once the function returns, and the reason."""

    def __repr__(self) -> str:
        return f"<ServerGoal {self.id} {self.status.name}>"

    @property
    def id(self) -> str:
        """Its id."""
        return self._record.id

    @property
    def request(self) -> G:
        """The message that the client sent."""
        return self._request

    @property
    def status(self) -> GoalStatus:
        """Its status, as the client sees it."""
        return self._record.status

    @property
    def cancel_requested(self) -> bool:
        """Whether it should stop: the client canceled it, left, or sent another goal."""
        return self._cancel.is_set()

    async def cancellation(self, *, timeout: float | None = None) -> bool:
        """Wait for a request to cancel, at most ``timeout`` seconds; return whether there is one.

        A function calls this instead of sleeping.
        """
        check_timeout(timeout)
        with suppress(TimeoutError):
            async with asyncio.timeout(timeout):
                await self._cancel.wait()
        return self.cancel_requested

    async def publish_feedback(self, feedback: F | Mapping[str, Any]) -> None:
        """Send feedback to the client; waits while the connection is slow.

        Args:
            feedback: a message, or a dict of its fields.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: it is not feedback of this action.
            RuntimeError: the goal has ended.
        """
        await self._publish(self, feedback)

    def canceled(self, result: R | None = None, text: str = "") -> R:
        """Have the goal end as canceled: ``return goal.canceled(partial_result)``.

        Args:
            result: the result so far; an empty result if left out.
            text: the reason. Operations carry only one of both: the text if there is one.
        """
        return self._end(Transition.CANCEL, result, text)

    def aborted(self, result: R | None = None, text: str = "") -> R:
        """Have the goal end as aborted: ``return goal.aborted(text="the door is shut")``.

        Args:
            result: the result so far; an empty result if left out.
            text: the reason. Operations carry only one of both: the text if there is one.
        """
        return self._end(Transition.ABORT, result, text)

    # Called by the server

    def _request_cancel(self) -> None:
        """Ask the function to stop."""
        self._cancel.set()

    def _end(self, transition: Transition, result: R | None, text: str) -> R:
        self._ending = (transition, text)
        return self._result() if result is None else result


Outcome: TypeAlias = R | Mapping[str, Any]
"""A result: a message, or a dict of its fields."""

Execute: TypeAlias = Callable[[ServerGoal[G, R, F]], Outcome[R] | Awaitable[Outcome[R]]]
"""Executes a goal and returns its result: a plain function or an async one."""


@made_by("Node.action_server")
class ActionServer(OperationHandler, Registration, Generic[G, R, F]):
    """Executes the goals of one action, each in a task of its own.

    To stop before the node ends, call `close` or use ``async with``: goals that are being executed
    are aborted, and their tasks canceled. When the hub is lost, goals over topics continue, as in
    ROS; goals over operations are asked to stop, because their results cannot be delivered.

    Raises:
        TypeError: ``execute`` is not callable.
        AlreadyOffered: the node already has a server of this action.
    """

    # session: the node's session.
    # name: the action's global name.
    # type_: the action's type.
    # execute: executes a goal. If it raises an exception the goal is aborted, with the
    #     exception's text; BrokenPipeError, however, ends the node: stdout has no reader.
    # concurrent: whether goals are executed at the same time. If not, a new goal cancels the
    #     current one and begins when that has ended, as with actionlib's SimpleActionServer.
    def __init__(
        self,
        session: Session,
        name: str,
        type_: NodeActionType[G, R, F],
        execute: Execute[G, R, F],
        *,
        concurrent: bool,
    ) -> None:
        if not callable(execute):
            raise TypeError(f"{name}: execute must be callable, got {execute!r}")
        for other in session.handlers():
            if type(other) is type(self) and other.name == name:
                raise AlreadyOffered(name)
        self._session = session
        self._name = name
        self._type = type_
        self._execute = execute
        self._concurrent = concurrent
        self._goals: dict[str, ServerGoal[G, R, F]] = {}
        """The goals whose result has not been sent, by their ids."""
        self._tasks = Tasks(session.tasks)
        self._current: ServerGoal[G, R, F] | None = None
        """The goal that began last, until it ends."""
        self._next: ServerGoal[G, R, F] | None = None
        """The goal that begins when the current one has ended."""
        self._ended = asyncio.Event()
        self._error: Exception | None = None
        self._session.add_handler(self)

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

    @property
    def fault(self) -> Exception | None:
        """The error that ended the server, such as the hub's refusal; usually None."""
        return self._error

    async def spin(self) -> None:
        """Wait until the server or its node ends; raise the error that ended it, if any.

        Raises:
            OperationRejected: the hub refused the server, so that it gets no goals.
        """
        await self._ended.wait()
        if self._error is not None:
            throw(self._error)

    def close(self) -> None:
        """End the server and all its goals. Does nothing when called again."""
        if not self._ended.is_set():
            self._close(None)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()
        await self._session.end_of(self._tasks)

    # Called by the session

    def _on_end(self, error: Exception | None) -> None:
        """Abort all goals that have begun, and reject the one that has not."""
        self._error = error
        self._ended.set()
        for goal in list(self._goals.values()):
            self._finish(
                goal, Transition.REJECT if goal is self._next else Transition.ABORT, text=ENDED
            )
        self._next = None
        self._tasks.cancel()

    # Used by subclasses

    def _receive(self, record: GoalRecord, request: G) -> None:
        """Start a new goal, or let it wait for the current one, or reject it."""
        goal = ServerGoal(record, request, self._type.result.message_class, self._publish_feedback)
        self._goals[record.id] = goal
        if len(self._tasks) >= MOST_GOALS:
            text = f"too many goals at once (limit {MOST_GOALS})"
            self._finish(goal, Transition.REJECT, text=text)
        elif self._concurrent or self._current is None:
            self._start(goal)
        else:
            self._start_after(self._current, goal)

    def _cancel(self, id_: str) -> None:
        """Cancel a goal, unless it has ended."""
        goal = self._goals.get(id_)
        if goal is None:
            return
        if goal is self._next:
            self._next = None
            self._finish(goal, Transition.CANCEL)
        else:
            if goal._record.go(Transition.CANCEL_REQUEST):
                self._send_status()
            goal._request_cancel()

    def _refuse(self, error: NodeError) -> None:
        """Close the server because the hub refused it; log it if nobody may be waiting for it."""
        if not self._ended.is_set():
            if not self._is_awaited:
                log = self._session.log
                log.error("The hub refused the action server %s: %s", self.name, error)
            self._close(error)

    # Implemented by subclasses

    @abstractmethod
    def _send_status(self) -> None:
        """Send the status of all goals, because that of one has changed."""

    @abstractmethod
    def _send_feedback(self, record: GoalRecord, feedback: dict[str, Any]) -> None:
        """Send feedback of a goal."""

    @abstractmethod
    def _send_result(self, record: GoalRecord, result: dict[str, Any] | None) -> None:
        """Send the result of a goal that has ended; None if it has no result."""

    @abstractmethod
    def _unadvertise(self) -> None:
        """Take all registrations back."""

    # Executing goals

    def _start_after(self, current: ServerGoal[G, R, F], goal: ServerGoal[G, R, F]) -> None:
        """Let a goal begin when the current one, which is canceled, has ended.

        Only the newest goal waits; older ones are canceled.
        """
        newest = self._next or current
        if goal._record.stamp < newest._record.stamp:
            self._finish(goal, Transition.CANCEL, text=SUPERSEDED)
            return
        if self._next is not None:
            self._finish(self._next, Transition.CANCEL, text=SUPERSEDED)
        self._next = goal
        current._request_cancel()

    def _start(self, goal: ServerGoal[G, R, F]) -> None:
        self._current = goal
        goal._record.go(Transition.ACCEPT)
        self._send_status()
        name = f"the handler of action {self.name} (goal {goal.id})"
        self._tasks.start(self._run(goal), name)

    async def _run(self, goal: ServerGoal[G, R, F]) -> None:
        """Execute a goal, send its result, and start the goal that waits for its end."""
        try:
            transition, values, text = await self._outcome(goal)
        except BrokenPipeError as error:
            # Stdout has no reader, as behind `| head`: that ends a program everywhere.
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
        """Call the function; return how the goal ends, its result if it has one, and the reason."""
        try:
            result = self._execute(goal)
            if isawaitable(result):
                result = await result
        except BrokenPipeError:
            raise
        except Exception as error:
            text = described(error)
            self._log_abort(goal, text, error)
            return Transition.ABORT, None, text
        except asyncio.CancelledError:
            # Of a task that the function awaited; or of this task, whose goal has ended by then.
            return Transition.ABORT, None, "it was interrupted"
        transition, text = goal._ending
        try:
            return transition, self._type.result.write(result), without_surrogates(text)
        except Exception as error:
            text = without_surrogates(str(error))
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
        """End a goal and send its result, unless that was done before."""
        if self._goals.get(goal.id) is goal:
            del self._goals[goal.id]
            goal._record.go(transition, text)
            self._send_result(goal._record, values)

    async def _publish_feedback(
        self, goal: ServerGoal[G, R, F], feedback: F | Mapping[str, Any]
    ) -> None:
        values = self._type.feedback.write(feedback)
        if goal.status.is_final:
            raise RuntimeError(f"goal {goal.id} of {self.name} has ended")
        await self._session.outgoing.room()
        if self._goals.get(goal.id) is goal:
            self._send_feedback(goal._record, values)

    def _close(self, error: Exception | None) -> None:
        self._on_end(error)
        self._session.remove_handler(self)
        self._unadvertise()
