"""What is left of ROS's oldest Python module: what the first line of many a script asks for."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from roslib.launcher import load_manifest

__all__ = ["is_interactive", "load_manifest", "set_interactive"]

_MODULES = {"launcher", "message", "packages", "rostime", "scriptutil"}

_interactive = False


def set_interactive(interactive: bool) -> None:
    """Say whether the script runs in a Python shell."""
    global _interactive
    _interactive = interactive


def is_interactive() -> bool:
    """Whether the script has said that it runs in a Python shell."""
    return _interactive


def __getattr__(name: str) -> Any:
    """A module of roslib: scripts use ``roslib.message`` after ``import roslib`` alone."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module(f"roslib.{name}")
