"""The graph as programs see it that are no nodes: names, and what ROS's master is asked."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rosgraph import names
from rosgraph.rosenv import (
    ROS_HOSTNAME,
    ROS_IP,
    ROS_IPV6,
    ROS_MASTER_URI,
    ROS_NAMESPACE,
    get_master_uri,
)

if TYPE_CHECKING:
    from rosgraph.masterapi import Master, MasterError, MasterException, MasterFailure
    from rosgraph.masterapi import is_online as is_master_online

__all__ = [
    "ROS_HOSTNAME",
    "ROS_IP",
    "ROS_IPV6",
    "ROS_MASTER_URI",
    "ROS_NAMESPACE",
    "Master",
    "MasterError",
    "MasterException",
    "MasterFailure",
    "get_master_uri",
    "is_master_online",
    "myargv",
    "names",
]


def myargv(argv: Sequence[str] | None = None) -> list[str]:
    """The command line without what is ROS's."""
    return [each for each in (sys.argv if argv is None else argv) if names.REMAP not in each]


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Load what asks the hub when it is first used."""
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from rosgraph import masterapi

        return getattr(masterapi, {"is_master_online": "is_online"}.get(name, name))
