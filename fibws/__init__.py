"""The ROS graph over WebSockets."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fibws.errors import (
        ActionError,
        AlreadyOffered,
        FibwsError,
        HubUnreachable,
        InterfaceError,
        InvalidAddress,
        InvalidMessage,
        InvalidName,
        NodeClosed,
        NodeError,
        NodeKilled,
        NodeReplaced,
        OperationRejected,
        ParameterNotSet,
        ServiceError,
        ServiceLost,
        ServiceTimeout,
        UnknownService,
        WaitTimeout,
    )
    from fibws.interfaces import Action, Duration, Message, Service, Time
    from fibws.names import Remapping, parse_remappings
    from fibws.node.actions.actions import Over
    from fibws.node.actions.client import ActionClient, ClientGoal
    from fibws.node.actions.server import ActionServer, Execute, ServerGoal
    from fibws.node.graph import Graph, NodeDetails
    from fibws.node.node import Node
    from fibws.node.params import Params
    from fibws.node.peers import Peers
    from fibws.node.publisher import Publisher
    from fibws.node.rate import Rate
    from fibws.node.services import Handler, HeaderHandler, ServiceServer
    from fibws.node.subscription import Subscription
    from fibws.protocol.goals import GoalStatus

__version__ = "0.1.0"

_HOMES = {
    "fibws.errors": (
        "ActionError",
        "AlreadyOffered",
        "FibwsError",
        "HubUnreachable",
        "InterfaceError",
        "InvalidAddress",
        "InvalidMessage",
        "InvalidName",
        "NodeClosed",
        "NodeError",
        "NodeKilled",
        "NodeReplaced",
        "OperationRejected",
        "ParameterNotSet",
        "ServiceError",
        "ServiceLost",
        "ServiceTimeout",
        "UnknownService",
        "WaitTimeout",
    ),
    "fibws.interfaces": ("Action", "Duration", "Message", "Service", "Time"),
    "fibws.names": ("Remapping", "parse_remappings"),
    "fibws.node.actions.actions": ("Over",),
    "fibws.node.actions.client": ("ActionClient", "ClientGoal"),
    "fibws.node.actions.server": ("ActionServer", "Execute", "ServerGoal"),
    "fibws.node.graph": ("Graph", "NodeDetails"),
    "fibws.node.node": ("Node",),
    "fibws.node.params": ("Params",),
    "fibws.node.peers": ("Peers",),
    "fibws.node.publisher": ("Publisher",),
    "fibws.node.rate": ("Rate",),
    "fibws.node.services": ("Handler", "HeaderHandler", "ServiceServer"),
    "fibws.node.subscription": ("Subscription",),
    "fibws.protocol.goals": ("GoalStatus",),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "Action",
    "ActionClient",
    "ActionError",
    "ActionServer",
    "AlreadyOffered",
    "ClientGoal",
    "Duration",
    "Execute",
    "FibwsError",
    "GoalStatus",
    "Graph",
    "Handler",
    "HeaderHandler",
    "HubUnreachable",
    "InterfaceError",
    "InvalidAddress",
    "InvalidMessage",
    "InvalidName",
    "Message",
    "Node",
    "NodeClosed",
    "NodeDetails",
    "NodeError",
    "NodeKilled",
    "NodeReplaced",
    "OperationRejected",
    "Over",
    "ParameterNotSet",
    "Params",
    "Peers",
    "Publisher",
    "Rate",
    "Remapping",
    "ServerGoal",
    "Service",
    "ServiceError",
    "ServiceLost",
    "ServiceServer",
    "ServiceTimeout",
    "Subscription",
    "Time",
    "UnknownService",
    "WaitTimeout",
    "__version__",
    "parse_remappings",
]


if not TYPE_CHECKING:  # Else type checkers would take every name for a public one.

    def __getattr__(name: str) -> Any:
        """Load a public name when it is first used: the hub needs no node library, nor it a hub."""
        if name not in _HOME:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = getattr(import_module(_HOME[name]), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})
