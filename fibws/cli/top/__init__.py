"""``fibws top``: what goes on in the graph, live."""

from __future__ import annotations

import time
from collections.abc import Iterator
from itertools import count

import click

from fibws.cli import output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.top.measure import SORTS, Measure
from fibws.cli.top.screen import KEYS, Screen
from fibws.cli.top.text import block
from fibws.client.hub_client import HubClient

STATISTICS = "/rosapi/statistics"


@click.command()
@click.option("-n", "times", metavar="COUNT", type=click.IntRange(1), help="End after so many.")
@click.option(
    "-d",
    "delay",
    metavar="SECONDS",
    type=click.FloatRange(0.1, 3600),
    default=1.0,
    show_default=True,
    help="The time between two looks, which is what a rate is of.",
)
@click.option(
    "-s",
    "--sort",
    type=click.Choice(SORTS),
    default="rate",
    show_default=True,
    help="What the topics are sorted by.",
)
@json_option
@with_hub("top", endless=True)
def command(client: HubClient, times: int | None, delay: float, sort: str, as_json: bool) -> None:
    """Show the topics with their rates and the clients, until q or Ctrl-C.

    PUBS and SUBS are how many nodes publish and subscribe. DROPS are messages that somebody was too
    slow for, in all and (+) since the last look; KEPT is what waits for a client at the hub now,
    and a client is slow as long as it does not take it.

    On a terminal the keys r, b and n sort by rate, bandwidth and name. Elsewhere, and with -n,
    there is a block of plain text for each look, or with --json an object.
    """
    if times or as_json or not (output.has_control_sequences() and output.can_show("─…")):
        for measure in _measures(client, delay, sort, times):
            output.as_json(measure.as_json()) if as_json else block(measure)
    else:
        with Screen.taken() as screen:
            _watch(client, screen, delay, sort)


def _measures(client: HubClient, delay: float, sort: str, times: int | None) -> Iterator[Measure]:
    before = client.call(STATISTICS)
    for _ in range(times) if times else count():
        client.process(delay)
        now = client.call(STATISTICS)
        yield Measure.between(before, now, but=client.node, sort=sort)
        before = now


def _watch(client: HubClient, screen: Screen, delay: float, sort: str) -> None:
    before = now = client.call(STATISTICS)
    due = time.monotonic() + delay
    while True:
        screen.show(Measure.between(before, now, but=client.node, sort=sort), client.url, sort)
        key = screen.wait(due - time.monotonic(), lambda: client.process(0))
        if key == "q":
            return
        sort = KEYS.get(key, sort)
        if not key:
            before, now = now, client.call(STATISTICS)
            due = max(due, time.monotonic() - delay) + delay
