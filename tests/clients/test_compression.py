"""Compressed messages of the client `ws`, which most programs for Node.js use."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

import pytest
from conftest import StartHub
from patience import PATIENCE

SIZES = [5, 3000, 20_000, 700_000, 10]


@pytest.mark.npm
@pytest.mark.usefixtures("npm_packages")
async def test_long_texts_are_compressed_in_both_directions(start_hub: StartHub) -> None:
    hub = await start_hub(deflate="always")
    program = str(Path(__file__).parent / "compression.mjs")
    process = await asyncio.create_subprocess_exec(
        *("node", program, hub.url, *map(str, SIZES)), stdout=asyncio.subprocess.PIPE
    )
    async with asyncio.timeout(PATIENCE):
        output, _ = await process.communicate()
    seen = json.loads(output)
    assert seen["extensions"] == "permessage-deflate"
    assert seen["received"] == SIZES
    assert (seen["code"], seen["reason"]) == (1005, "")
