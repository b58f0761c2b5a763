"""The port at which nodes of an installed ROS 1 look for their master."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable
from urllib.parse import urlsplit

from fibws.hub_address import LOOPBACK

MASTER = "ROS_MASTER_URI"
DEFAULT_PORT = 11311


def master_options(warn: Callable[[str], object]) -> list[str]:
    """Return the options with which a hub is the master; none, with a warning, if it cannot be.

    It cannot be if the port is not free.
    """
    port = DEFAULT_PORT
    try:
        master = urlsplit(os.environ.get(MASTER, ""))
        if master.hostname in (*LOOPBACK, socket.gethostname()):
            port = master.port or port
    except ValueError:
        pass  # Programs of ROS report an invalid URI themselves.
    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((LOOPBACK[0], port))
        except OSError as error:
            warn(
                f"ROS 1 nodes cannot join: port {port} is not free ({error.strerror}). Is a "
                "roscore running?"
            )
            return []
    return ["--ros1", str(port)]
