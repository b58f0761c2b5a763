"""Action clients: sending goals and following them to their results."""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from collections import deque
from collections.abc import AsyncIterator, Callable, Mapping
from typing import Any, ClassVar, Generic, Self

from fibws.errors import ActionError, NodeClosed, NodeError, WaitTimeout
from fibws.interfaces.message import F, G, R
from fibws.node.checks import check_queue_size, check_timeout
from fibws.node.session import OperationHandler, Session, throw
from fibws.node.types import NodeActionType
from fibws.protocol.goals import GoalStatus
from fibws.public_classes import AsyncContext, Public, made_by

HUB_LOST = "the connection to the hub was lost"


@made_by("ActionClient.send")
class ClientGoal(Public, Generic[R, F]):
    """A goal that was sent: its status, its feedback and its result."""

    _other_names: ClassVar = {
        "get_result": "await goal.result()",
        "get_state": "goal.status",
        "wait_for_result": "await goal.result()",
    }

    # id_: its id.
    # queue_size: how much feedback is kept for a slow reader; then the oldest is dropped.
    # cancel: asks the server to cancel the goal of an id.
    def __init__(self, id_: str, queue_size: int, cancel: Callable[[str], None]) -> None:
        self._id = id_
        self._cancel = cancel
        self._status = GoalStatus.PENDING
        self._feedback: deque[F] = deque(maxlen=queue_size)
        self._dropped = 0
        self._changed = asyncio.Event()
        self._ended = asyncio.Event()
        self._result: R | None = None
        self._error: Exception | None = None

    def __repr__(self) -> str:
        return f"<ClientGoal {self.id} {self.status.name}>"

    @property
    def id(self) -> str:
        """Its id."""
        return self._id

    @property
    def status(self) -> GoalStatus:
        """Its latest known status. Over operations, servers report little but the last one."""
        return self._status

    @property
    def dropped(self) -> int:
        """How much feedback was dropped because it was not read in time."""
        return self._dropped

    async def feedback(self) -> AsyncIterator[F]:
        """Yield the feedback until the goal ends: ``async for ... in goal.feedback()``.

        It stops whether the goal succeeds or fails; `result` then returns or raises at once.
        """
        while True:
            while self._feedback:
                yield self._feedback.popleft()
            if self._ended.is_set():
                return
            self._changed.clear()
            await self._changed.wait()

    async def result(self, *, timeout: float | None = None) -> R:
        """Wait until the goal ends, and return its result.

        Args:
            timeout: most seconds to wait. The goal is not canceled by a timeout, nor by the
                cancellation of this call: use `cancel`.

        Raises:
            ActionError: the goal did not succeed.
            WaitTimeout: the goal did not end in time (a TimeoutError, too).
            NodeClosed: the client or the node was closed; or the error that ended it.
        """
        check_timeout(timeout)
        try:
            async with asyncio.timeout(timeout):
                await self._ended.wait()
        except TimeoutError:
            text = f"timeout exceeded while waiting for the result of goal {self.id}"
            raise WaitTimeout(text) from None
        if self._error is not None:
            throw(self._error)
        assert self._result is not None
        return self._result

    async def cancel(self) -> None:
        """Ask the server to cancel the goal; `result` waits until it has. Ended goals ignore it."""
        if not self._ended.is_set():
            self._cancel(self.id)

    # Called by the client

    def _update(self, status: GoalStatus) -> None:
        """Set the status that the server reported."""
        self._status = status

    def _offer(self, feedback: F) -> None:
        """Queue feedback for the reader."""
        self._dropped += len(self._feedback) == self._feedback.maxlen
        self._feedback.append(feedback)
        self._changed.set()

    def _succeed(self, result: R) -> None:
        """End the goal with its result."""
        self._result = result
        self._end(GoalStatus.SUCCEEDED)

    def _fail(self, status: GoalStatus, error: Exception) -> None:
        """End the goal with an error, which `result` raises."""
        self._error = error
        self._end(status)

    def _end(self, status: GoalStatus) -> None:
        self._status = status
        self._ended.set()
        self._changed.set()


@made_by("Node.action_client")
class ActionClient(OperationHandler, AsyncContext, Generic[G, R, F]):
    """Sends goals to the server of one action.

    To stop before the node ends, call `close` or use ``async with``.
    """

    _hints: ClassVar = {"send": 'a goal is one value, such as a dict: client.send({"order": 5})'}
    _other_names: ClassVar = {
        "get_result": "goal = await client.send(goal), await goal.result()",
        "send_goal": "await client.send(goal)",
        "send_goal_async": "await client.send(goal)",
        "wait_for_result": "goal = await client.send(goal), await goal.result()",
    }

    # session: the node's session.
    # name: the action's global name.
    # type_: the action's type.
    def __init__(self, session: Session, name: str, type_: NodeActionType[G, R, F]) -> None:
        self._session = session
        self._name = name
        self._type = type_
        self._goals: dict[str, ClientGoal[R, F]] = {}
        """The goals that have not ended, by their ids."""
        self._waits: set[asyncio.Timeout] = set()
        """The timeouts of pending calls of `wait_for_server`; `_stop` lets them expire."""
        self._error: Exception | None = None
        self._session.add_handler(self)

    def __repr__(self) -> str:
        return f"<ActionClient {self.name} [{self.type}]>"

    @property
    def name(self) -> str:
        """The action's global name."""
        return self._name

    @property
    def type(self) -> str:
        """The action's type, such as ``actionlib_tutorials/Fibonacci``."""
        return self._type.name

    async def send(
        self, goal: G | Mapping[str, Any], *, queue_size: int = 1000
    ) -> ClientGoal[R, F]:
        """Send a goal; waits until there is a hub.

        Without a server (see `wait_for_server`) the goal fails: over operations at once, over
        topics after 5 s without a message about it.

        Args:
            goal: the goal, as a message or a dict of its fields.
            queue_size: how much feedback is kept for a slow reader; then the oldest is dropped.

        Raises:
            InvalidMessage: a field does not fit the type.
            MessageTooLarge: the hub does not take a goal of this size.
            TypeError: it is not a goal of this action.
            ValueError: ``queue_size`` is less than 1.
            OperationRejected: the hub refused one of the action's topics to this client.
            NodeClosed: the client or its node was closed.
        """
        check_queue_size(queue_size)
        values = self._type.goal.write(goal)
        await self._session.wait_for_hub()
        self._check()
        id_ = self._new_id()
        sent = self._goals[id_] = ClientGoal[R, F](id_, queue_size, self._send_cancel)
        try:
            self._send_goal(id_, values)
        except BaseException:
            del self._goals[id_]
            raise
        return sent

    async def wait_for_server(self, *, timeout: float | None = None) -> None:
        """Wait until the action has a server, and for the hub before that.

        Args:
            timeout: most seconds to wait; None waits without a limit.

        Raises:
            WaitTimeout: there was no server in time.
            OperationRejected: the hub refused one of the action's topics to this client.
            NodeClosed: the client or its node was closed.
        """
        check_timeout(timeout)
        self._check()
        wait = asyncio.timeout(timeout)
        self._waits.add(wait)
        try:
            async with wait:
                await self._session.wait_for_hub()
                await self._server_available()
        except TimeoutError:
            self._check()
            text = f"timeout exceeded while waiting for action server {self.name}"
            raise WaitTimeout(text) from None
        finally:
            self._waits.discard(wait)

    def close(self) -> None:
        """Stop following all goals; they are not canceled. Does nothing when called again."""
        if self._error is None:
            self._close(NodeClosed(f"the client of {self.name} was closed"))

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()

    # Called by the session

    def _on_disconnect(self) -> None:
        """Fail all goals: their results went to the lost connection."""
        for goal in list(self._goals.values()):
            self._fail(goal, GoalStatus.LOST, HUB_LOST)

    def _on_end(self, error: Exception | None) -> None:
        """Stop, as the node has ended."""
        self._stop(error or NodeClosed("the node has ended"))

    # Used by subclasses

    def _refuse(self, error: NodeError) -> None:
        """Close the client because the hub refused a topic."""
        if self._error is None:
            self._close(error)

    def _succeed(self, goal: ClientGoal[R, F], result: R) -> None:
        self._forget(goal)
        goal._succeed(result)

    def _fail(
        self, goal: ClientGoal[R, F], status: GoalStatus, text: str, result: R | None = None
    ) -> None:
        self._forget(goal)
        goal._fail(status, ActionError(self.name, status, text, result))

    def _forget(self, goal: ClientGoal[R, F]) -> None:
        """Remove a goal that ends; every goal that ends is passed to this once."""
        del self._goals[goal.id]

    # Implemented by subclasses

    @abstractmethod
    async def _server_available(self) -> None:
        """Wait until the action has a server."""

    @abstractmethod
    def _new_id(self) -> str:
        """Return an id for a new goal."""

    @abstractmethod
    def _send_goal(self, id_: str, goal: dict[str, Any]) -> None:
        """Send a goal to the server."""

    @abstractmethod
    def _send_cancel(self, id_: str) -> None:
        """Ask the server to cancel a goal."""

    @abstractmethod
    def _unadvertise(self) -> None:
        """Take all registrations back."""

    def _check(self) -> None:
        if self._error is not None:
            throw(self._error)

    def _close(self, error: Exception) -> None:
        self._stop(error)
        self._session.remove_handler(self)
        self._unadvertise()

    def _stop(self, error: Exception) -> None:
        self._error = error
        for wait in self._waits:
            if not wait.expired():
                wait.reschedule(0)  # A time in the past: it expires at once.
        for goal in list(self._goals.values()):
            self._forget(goal)
            goal._fail(GoalStatus.LOST, error)
