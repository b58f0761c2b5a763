"""Checks of the links to other hubs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fibws.cli.doctor.finding import Finding, join_names, ok, warning
from fibws.cli.output import counted
from fibws.command_names import command_name

MOST_OFFSET = 1.0
"""Seconds by which the clocks of two hubs may differ."""


def checks(before: dict[str, Any], now: dict[str, Any]) -> Iterator[Finding]:
    """Yield the findings about the links; none for a hub without any.

    Args:
        before: an older response of /rosapi/hubs.
        now: the newest one.
    """
    links = now["links"]
    if not links:
        return
    problems = [*down(links), *clocks(links), *losses(before["links"], links)]
    names = join_names(sorted({each["name"] for each in links}))
    yield from problems or [ok("hubs", f"{counted(len(links), 'link')} to other hubs: {names}")]


def down(links: list[dict[str, Any]]) -> Iterator[Finding]:
    """Find links that are not connected."""
    for link in links:
        if link["fault"]:
            yield warning(
                "hubs",
                f"The hub is not joined to {link['address'] or 'another one'}: {link['fault']}",
                "Does that hub run, and does a firewall or a proxy let this one reach it?",
            )


def clocks(links: list[dict[str, Any]]) -> Iterator[Finding]:
    """Find hubs whose clocks differ from this hub's."""
    for link in links:
        if abs(link["clock_offset"]) > MOST_OFFSET:
            yield warning(
                "hubs",
                f"The clock of hub {link['name']} differs by {link['clock_offset']:+.1f} s",
                "Stamps of its messages are off by that; synchronize the clocks (NTP).",
            )


def losses(before: list[dict[str, Any]], now: list[dict[str, Any]]) -> Iterator[Finding]:
    """Find links that drop or lose messages at present."""
    older = {each["id"]: each for each in before}
    for link in now:
        past = older.get(link["id"], link)
        gone = sum(link[name] - past[name] for name in ("dropped", "lost"))
        if gone > 0:
            yield warning(
                "hubs",
                f"The link to hub {link['name']} is too slow: it drops messages",
                f"To see how many: {command_name('hub list')} --watch. Export or import less.",
            )
