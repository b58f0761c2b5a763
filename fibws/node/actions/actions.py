"""Creating the action servers and action clients of a node."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Literal, TypeAlias

from fibws.interfaces import Action
from fibws.interfaces.message import F, G, R
from fibws.node.actions.client import ActionClient
from fibws.node.actions.operations import OperationActionClient, OperationActionServer
from fibws.node.actions.server import ActionServer, Execute
from fibws.node.actions.topics import GoalIdGenerator, TopicActionClient, TopicActionServer
from fibws.node.session import Session
from fibws.node.topics import NodeTopics
from fibws.node.types import NodeActionType, NodeTypes

Over: TypeAlias = Literal["topics", "operations"]
"""How goals travel: over topics as in ROS 1's actionlib, or over rosbridge's operations for the
actions of ROS 2."""


class NodeActions:
    """Creates a node's action servers and action clients.

    Args:
        node: the node's global name.
        session: the node's session, whose ``topics`` and ``types`` these are.
        wait_for_service: waits for the service of a global name, at most so many seconds.
        now: returns the time in nanoseconds since 1970.
    """

    def __init__(
        self,
        node: str,
        session: Session,
        topics: NodeTopics,
        types: NodeTypes,
        wait_for_service: Callable[[str, float | None], Awaitable[None]],
        now: Callable[[], int],
    ) -> None:
        self._session = session
        self._topics = topics
        self._types = types
        self._wait_for_service = wait_for_service
        self._goal_ids = GoalIdGenerator(node, now)

    def serve(
        self,
        name: str,
        action: type[Action[G, R, F]],
        execute: Execute[G, R, F],
        *,
        over: Over,
        concurrent: bool | None = None,
    ) -> ActionServer[G, R, F]:
        """Serve an action by its global name; see `Node.action_server`."""
        _check(over)
        type_ = NodeActionType(self._types, action)
        if concurrent is None:
            concurrent = over == "operations"
        if over == "operations":
            return OperationActionServer(self._session, name, type_, execute, concurrent=concurrent)
        return TopicActionServer(
            self._session,
            name,
            type_,
            execute,
            concurrent=concurrent,
            topics=self._topics,
            types=self._types,
            goal_ids=self._goal_ids,
        )

    def client(
        self, name: str, action: type[Action[G, R, F]], *, over: Over
    ) -> ActionClient[G, R, F]:
        """Return a client of an action by its global name; see `Node.action_client`."""
        _check(over)
        type_ = NodeActionType(self._types, action)
        if over == "operations":
            return OperationActionClient(self._session, name, type_, self._wait_for_service)
        return TopicActionClient(
            self._session,
            name,
            type_,
            topics=self._topics,
            types=self._types,
            goal_ids=self._goal_ids,
        )


def _check(over: str) -> None:
    if over not in ("topics", "operations"):
        raise ValueError(f'over must be "topics" or "operations", got {over!r}')
