"""A hub that programs of an installed ROS take for their master."""

from __future__ import annotations

import os
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from .world import World, missing_programs, world


@pytest.fixture
async def ros(tmp_path: Path) -> AsyncIterator[World]:
    """A hub, and how programs are started beside it."""
    missing = missing_programs()
    if missing is not None:
        if os.environ.get("CI") == "true":
            pytest.fail(missing)
        pytest.skip(missing)
    async with world(tmp_path) as started:
        yield started
