"""What actionlib raises."""

from __future__ import annotations


class ActionException(Exception):
    """A class was given that is no action."""
