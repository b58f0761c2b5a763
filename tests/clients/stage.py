"""Runs a client's scenarios with a hub of their own, and keeps the observations."""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from patience import PATIENCE

from fibws.access.rights import RIGHTS, Rights
from fibws.access.token_file import TokenFile

from . import runtimes
from .casts import Cast
from .programs import Hub, running

PLAY_PATIENCE = 1.5 * PATIENCE
"""Seconds for all scenarios of a cast, each of which gives up by itself after `PATIENCE`."""


@dataclass
class Observations:
    """A client's observations in its scenarios, and the complaints of client and hub."""

    saw: dict[str, Any] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)
    complaints: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    """The errors in the hub's log."""

    def of(self, scenario: str) -> Any:
        """Return the observation of a scenario.

        Raises:
            AssertionError: it failed, did not come to its end, or is none.
        """
        assert scenario not in self.failed, self.failed[scenario]
        assert scenario in self.saw, f"{scenario!r} did not end: {self.complaints} {self.faults}"
        return self.saw[scenario]


async def play(cast: Cast) -> Observations:
    """Have a client play its scenarios, all at once, at a hub of its own."""
    observations = Observations()
    lines: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
    async with AsyncExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory()))
        token = _add_token(folder / "tokens.toml") if cast.wants_token else ""
        hub = await stack.enter_async_context(Hub(folder / "tokens.toml" if token else None))
        url = f"{hub.url}/?token={token}" if token else hub.url
        if cast.programs:
            await stack.enter_async_context(running(cast.programs, hub.url))
        await stack.enter_async_context(runtimes.run(cast, url, lines.put_nowait))
        try:
            async with asyncio.timeout(PLAY_PATIENCE):
                await _watch(lines, hub, observations)
        except TimeoutError:
            pass  # The test of each unfinished scenario fails.
    observations.faults = [line for line in hub.log if "ERROR" in line or "Traceback" in line]
    return observations


def _add_token(path: Path) -> str:
    """Return a new token, which may use all names below /allowed."""
    rights = Rights({right: ("/allowed/**",) for right in RIGHTS[:-1]})
    return TokenFile(path).add("client", rights)


async def _watch(
    lines: asyncio.Queue[dict[str, Any]], hub: Hub, observations: Observations
) -> None:
    while True:
        match await lines.get():
            case {"scenario": str(scenario), "saw": saw}:
                observations.saw[scenario] = saw
            case {"scenario": str(scenario), "failed": str(reason)}:
                observations.failed[scenario] = reason
            case {"complaint": str(complaint)}:
                observations.complaints.append(complaint)
            case {"restart": True}:
                await hub.restart()
            case {"done": True}:
                return
            case line:
                raise ValueError(line)
