"""Telling the hub of what the program offers."""

from __future__ import annotations

from collections.abc import Coroutine
from typing import Any

from rospy import core


def register(kind: str, name: str, registering: Coroutine[Any, Any, None]) -> None:
    """Wait until the hub was told; if a name is not legal, only the log says so, as in ROS.

    Args:
        kind: what is registered.
        name: its global name.
        registering: tells the hub, in the node's loop.
    """
    from fibws.errors import InvalidName

    try:
        core.background.call(registering)
    except InvalidName as fault:
        from rospy import logfatal

        logfatal(f"unable to register {kind} [{name}] with master: {fault}")
