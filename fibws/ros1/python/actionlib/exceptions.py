"""The errors of actionlib."""

from __future__ import annotations


class ActionException(Exception):
    """A class is not an action."""
