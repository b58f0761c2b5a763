"""Numbers of bytes, rates and times as the commands print them."""

from __future__ import annotations

import time
from typing import Any


def amount(number: float) -> str:
    """Return a number of bytes as in rostopic bw: ``12.34KB`` are 12 340."""
    for unit, size in (("GB", 1e9), ("MB", 1e6), ("KB", 1e3)):
        if number >= size:
            return f"{number / size:.2f}{unit}"
    return f"{number:.2f}B" if number % 1 else f"{number:.0f}B"


def flow(entry: dict[str, Any], direction: str) -> str:
    """Return the rates of a client or of a link: ``10.0/s 1.20KB/s``.

    Args:
        entry: as in `fibws.client.statistics`.
        direction: ``received`` or ``sent``.
    """
    messages = entry[f"messages_{direction}_per_second"]
    return f"{messages:.1f}/s {amount(entry[f'bytes_{direction}_per_second'])}/s"


def date(since: dict[str, int]) -> str:
    """Return a time of ROS as text, in local time."""
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(since["secs"]))
