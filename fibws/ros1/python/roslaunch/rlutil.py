"""Functions for scripts that start launch files."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from time import sleep

import rosgraph

from fibws.ros1.errors import WorkspaceError
from fibws.ros1.launch.launch_files import find_launch_files
from fibws.ros1.workspace.packages import Packages
from roslaunch.core import RLException, generate_run_id

__all__ = ["get_or_generate_uuid", "resolve_launch_arguments"]

POLL = 0.2
"""Seconds between two requests to a hub that does not run yet."""


def resolve_launch_arguments(args: Sequence[str]) -> list[str]:
    """Return the paths of launch files on a command line: PACKAGE FILE or FILE, and further ones.

    Args:
        args: the words; those with ``:=`` are left out.

    Raises:
        RLException: a file is not found.
    """
    words = rosgraph.myargv(args)
    if not words:
        return words
    try:
        return find_launch_files(words, Packages.from_environment())
    except WorkspaceError as error:
        raise RLException(str(error)) from None


def get_or_generate_uuid(options_runid: str | None, options_wait_for_master: bool) -> str:
    """Return an id of a run: that of the hub's parameter ``/run_id``, or a new one.

    Args:
        options_runid: the id, if it is known.
        options_wait_for_master: whether to wait until a hub runs.
    """
    if options_runid:
        return options_runid
    while options_wait_for_master and not rosgraph.is_master_online():
        sleep(POLL)
    with suppress(rosgraph.MasterException, OSError):
        return str(rosgraph.Master("/roslaunch").getParam("/run_id"))
    return generate_run_id()
