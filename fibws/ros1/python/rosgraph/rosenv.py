"""The environment variables that ROS's programs read."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence

ROS_MASTER_URI = "ROS_MASTER_URI"
ROS_IP = "ROS_IP"
ROS_IPV6 = "ROS_IPV6"
ROS_HOSTNAME = "ROS_HOSTNAME"
ROS_NAMESPACE = "ROS_NAMESPACE"

DEFAULT_MASTER_PORT = 11311
DEFAULT_MASTER_URI = f"http://localhost:{DEFAULT_MASTER_PORT}/"


def get_master_uri(env: Mapping[str, str] | None = None, argv: Sequence[str] | None = None) -> str:
    """Return the URI in ``__master:=`` or $ROS_MASTER_URI; the hub's address is $FIBWS_HUB.

    Raises:
        ValueError: ``__master:=`` has no value.
    """
    for argument in sys.argv if argv is None else argv:
        name, mark, value = argument.partition(":=")
        if mark and name == "__master":
            if not value or ":=" in value:
                raise ValueError(f"__master remapping argument '{argument}' improperly specified")
            return value
    return (os.environ if env is None else env).get(ROS_MASTER_URI, DEFAULT_MASTER_URI)
