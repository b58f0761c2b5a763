"""Scripts with actions, and the hub that they meet at."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import TypeAlias

import pytest
from running_programs import Program

from fibws.hub.server import HubServer
from ros1.side_by_side import SCRIPTS

StartScript: TypeAlias = Callable[..., Awaitable[Program]]


@pytest.fixture
async def start_script(hub: HubServer) -> AsyncIterator[StartScript]:
    """Starts scripts by their names, and sees to it that none is left over."""
    programs: list[Program] = []

    async def start(name: str | Path, *arguments: str) -> Program:
        program = await Program.start(
            "fibws.rospy",
            str(SCRIPTS / "actions" / name),
            *arguments,
            FIBWS_HUB=hub.url,
            PYTHONUNBUFFERED="1",
        )
        programs.append(program)
        return program

    yield start
    for program in programs:
        await program.stop()


@pytest.fixture
def script(tmp_path: Path) -> Callable[[str], Path]:
    """Writes a script of the test's own."""

    def write(text: str) -> Path:
        path = tmp_path / "script.py"
        path.write_text(text, "utf-8")
        return path

    return write
