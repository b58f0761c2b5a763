"""The parts of roslib that scripts still use, such as ``roslib.load_manifest``."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from roslib.launcher import load_manifest

__all__ = ["is_interactive", "load_manifest", "set_interactive"]

_MODULES = {"launcher", "message", "msgs", "names", "packages", "rostime", "scriptutil", "srvs"}

_interactive = False


def set_interactive(interactive: bool) -> None:
    """Set whether the script runs in a Python shell."""
    global _interactive
    _interactive = interactive


def is_interactive() -> bool:
    """Return whether the script runs in a Python shell."""
    return _interactive


def __getattr__(name: str) -> Any:
    """Import a module of roslib: scripts use ``roslib.message`` after ``import roslib``."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module(f"roslib.{name}")
