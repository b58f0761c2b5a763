"""The asking end of an action."""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from collections.abc import Mapping
from typing import Any, Generic, Self

from fibws.errors import ActionError, NodeClosed, NodeError, WaitTimeout
from fibws.interfaces.message import F, G, R
from fibws.node.actions.action_type import ActionType
from fibws.node.actions.actions import Actions
from fibws.node.actions.client_goal import ClientGoal
from fibws.node.actions.status import GoalStatus
from fibws.node.fault import throw
from fibws.node.limits import check_queue_size, check_timeout
from fibws.node.part import Part

HUB_LOST = "the connection to the hub was lost"


class ActionClient(Part, Generic[G, R, F]):
    """Sends goals to the server of one action.

    Leave it with `close`, or by ``async with``, to hear no more before the node ends.

    Args:
        actions: the node's.
        name: the action's global name.
        type_: the action's type.
    """

    def __init__(self, actions: Actions, name: str, type_: ActionType[G, R, F]) -> None:
        self._actions = actions
        self._session = actions.session
        self._name = name
        self._type = type_
        self._goals: dict[str, ClientGoal[R, F]] = {}
        self._waits: set[asyncio.Timeout] = set()
        """Those who wait for a server, until the end of this client."""
        self._fault: Exception | None = None
        self._session.join(self)

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

        Without a server, of which `wait_for_server` tells, the goal fails: over operations at once,
        over topics when nothing was heard for 5 s.

        Args:
            goal: what is wanted: a message, or a dict of its fields.
            queue_size: how much feedback waits for a slow reader; then the newest stays.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: it is no goal of this action.
            ValueError: ``queue_size`` is less than 1.
            OperationRejected: the hub did not let this client have the action's topics.
            NodeClosed: the client or its node was closed.
        """
        check_queue_size(queue_size)
        values = self._type.goal.write(goal)
        await self._session.wait_for_hub()
        self._check()
        id_ = self._new_id()
        sent = self._goals[id_] = ClientGoal[R, F](id_, queue_size, self._tell_cancel)
        self._tell_goal(id_, values)
        return sent

    async def wait_for_server(self, *, timeout: float | None = None) -> None:
        """Wait until the action has a server, on a hub that may not be there yet either.

        Args:
            timeout: the most seconds to wait; None for ever.

        Raises:
            WaitTimeout: there was none in time.
            OperationRejected: the hub did not let this client have the action's topics.
            NodeClosed: the client or its node was closed.
        """
        check_timeout(timeout)
        self._check()
        wait = asyncio.timeout(timeout)
        self._waits.add(wait)
        try:
            async with wait:
                await self._session.wait_for_hub()
                await self._served()
        except TimeoutError:
            self._check()
            text = f"timeout exceeded while waiting for action server {self.name}"
            raise WaitTimeout(text) from None
        finally:
            self._waits.discard(wait)

    def close(self) -> None:
        """Hear no more of any goal, which go on. Does nothing when called again."""
        if self._fault is None:
            self._close(NodeClosed(f"the client of {self.name} was closed"))

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()

    def lose(self) -> None:
        """Nobody can tell what becomes of the goals that the lost hub knew of."""
        for goal in list(self._goals.values()):
            self._fail(goal, GoalStatus.LOST, HUB_LOST)

    def end(self, fault: Exception | None) -> None:
        """The node is over."""
        self._stop(fault or NodeClosed("the node has ended"))

    def _check(self) -> None:
        if self._fault is not None:
            throw(self._fault)

    def _refuse(self, fault: NodeError) -> None:
        """The hub does not let this client have what it needs."""
        if self._fault is None:
            self._close(fault)

    def _close(self, fault: Exception) -> None:
        self._stop(fault)
        self._session.leave(self)
        self._unadvertise()

    def _stop(self, fault: Exception) -> None:
        self._fault = fault
        for wait in self._waits:
            if not wait.expired():
                wait.reschedule(0)  # Which ends it at once.
        for goal in list(self._goals.values()):
            self._forget(goal)
            goal.fail(GoalStatus.LOST, fault)

    @abstractmethod
    async def _served(self) -> None:
        """Wait until the action has a server."""

    # What is heard of goals

    def _succeed(self, goal: ClientGoal[R, F], result: R) -> None:
        self._forget(goal)
        goal.succeed(result)

    def _fail(
        self, goal: ClientGoal[R, F], status: GoalStatus, text: str, result: R | None = None
    ) -> None:
        self._forget(goal)
        goal.fail(status, ActionError(self.name, status, text, result))

    def _forget(self, goal: ClientGoal[R, F]) -> None:
        """A goal has ended."""
        del self._goals[goal.id]

    # What the graph is told

    @abstractmethod
    def _new_id(self) -> str:
        """What a new goal is called."""

    @abstractmethod
    def _tell_goal(self, id_: str, goal: dict[str, Any]) -> None:
        """A goal is wanted."""

    @abstractmethod
    def _tell_cancel(self, id_: str) -> None:
        """A goal is wanted no more."""

    @abstractmethod
    def _unadvertise(self) -> None:
        """Take the registrations back."""
