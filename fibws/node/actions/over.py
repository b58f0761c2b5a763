"""The two ways in which goals travel."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

from fibws.interfaces import Action
from fibws.interfaces.message import F, G, R
from fibws.node.actions.action_type import ActionType
from fibws.node.actions.actions import Actions
from fibws.node.actions.client import ActionClient
from fibws.node.actions.operation_client import OperationActionClient
from fibws.node.actions.operation_server import OperationActionServer
from fibws.node.actions.server import ActionServer, Execute
from fibws.node.actions.topic_client import TopicActionClient
from fibws.node.actions.topic_server import TopicActionServer

Over: TypeAlias = Literal["topics", "operations"]
"""``topics`` as actionlib does, in ROS 1; ``operations`` as rosbridge does for ROS 2."""


_SERVERS: dict[str, type[ActionServer[Any, Any, Any]]] = {
    "topics": TopicActionServer,
    "operations": OperationActionServer,
}
_CLIENTS: dict[str, type[ActionClient[Any, Any, Any]]] = {
    "topics": TopicActionClient,
    "operations": OperationActionClient,
}


def serve(
    actions: Actions,
    name: str,
    action: type[Action[G, R, F]],
    execute: Execute[G, R, F],
    over: Over,
    concurrent: bool | None,
) -> ActionServer[G, R, F]:
    """Serve an action by its global name; see `Node.action_server`."""
    _check(over)
    if concurrent is None:
        concurrent = over == "operations"
    type_ = ActionType(actions.types, action)
    return _SERVERS[over](actions, name, type_, execute, concurrent=concurrent)


def client(
    actions: Actions, name: str, action: type[Action[G, R, F]], over: Over
) -> ActionClient[G, R, F]:
    """Send goals to an action by its global name; see `Node.action_client`."""
    _check(over)
    return _CLIENTS[over](actions, name, ActionType(actions.types, action))


def _check(over: str) -> None:
    if over not in _SERVERS:
        raise ValueError(f'goals go over "topics" or over "operations", not over {over!r}')
