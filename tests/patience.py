"""How long tests wait for an event before they fail."""

from __future__ import annotations

PATIENCE = 60
"""Seconds; less than the limit of one test in ``pyproject.toml``, so that the failure is told."""
