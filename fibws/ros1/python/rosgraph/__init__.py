"""rosgraph's functions for programs that are not nodes: names, and requests to the master."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from rosgraph import names
from rosgraph.masterapi import Master, MasterError, MasterException, MasterFailure
from rosgraph.masterapi import is_online as is_master_online
from rosgraph.rosenv import (
    ROS_HOSTNAME,
    ROS_IP,
    ROS_IPV6,
    ROS_MASTER_URI,
    ROS_NAMESPACE,
    get_master_uri,
)

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
    """Return the command line without ROS's own arguments."""
    return [each for each in (sys.argv if argv is None else argv) if names.REMAP not in each]
