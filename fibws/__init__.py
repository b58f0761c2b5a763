"""The ROS graph over WebSockets."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fibws.errors import (
        FibwsError,
        HubUnreachable,
        InterfaceError,
        InvalidAddress,
        InvalidMessage,
        InvalidName,
        NodeClosed,
        NodeError,
        NodeReplaced,
        OperationRejected,
    )
    from fibws.interfaces import Duration, Message, Time
    from fibws.names import Remapping, parse_remappings
    from fibws.node.node import Node
    from fibws.node.publisher import Publisher
    from fibws.node.rate import Rate
    from fibws.node.subscription import Subscription

__version__ = "0.1.0"

_HOMES = {
    "fibws.errors": (
        "FibwsError",
        "HubUnreachable",
        "InterfaceError",
        "InvalidAddress",
        "InvalidMessage",
        "InvalidName",
        "NodeClosed",
        "NodeError",
        "NodeReplaced",
        "OperationRejected",
    ),
    "fibws.interfaces": ("Duration", "Message", "Time"),
    "fibws.names": ("Remapping", "parse_remappings"),
    "fibws.node.node": ("Node",),
    "fibws.node.publisher": ("Publisher",),
    "fibws.node.rate": ("Rate",),
    "fibws.node.subscription": ("Subscription",),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "Duration",
    "FibwsError",
    "HubUnreachable",
    "InterfaceError",
    "InvalidAddress",
    "InvalidMessage",
    "InvalidName",
    "Message",
    "Node",
    "NodeClosed",
    "NodeError",
    "NodeReplaced",
    "OperationRejected",
    "Publisher",
    "Rate",
    "Remapping",
    "Subscription",
    "Time",
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
