"""``fibws top``: topics with their rates, and clients, live."""

from __future__ import annotations

import time
from collections.abc import Iterator
from itertools import count

import click

from fibws.cli import output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.top.screen import KEYS, TopScreen
from fibws.cli.top.tables import print_tables
from fibws.client.hub_client import HubClient
from fibws.client.statistics import SORTS, Measurement

STATISTICS = "/rosapi/statistics"


@click.command()
@click.option(
    "-n", "times", metavar="COUNT", type=click.IntRange(1), help="Exit after COUNT measurements."
)
@click.option(
    "-d",
    "delay",
    metavar="SECONDS",
    type=click.FloatRange(0.1, 3600),
    default=1.0,
    show_default=True,
    help="Time between measurements.",
)
@click.option(
    "-s",
    "--sort",
    type=click.Choice(SORTS),
    default="rate",
    show_default=True,
    help="Order of topics.",
)
@json_option
@with_hub("top", endless=True)
def command(client: HubClient, times: int | None, delay: float, sort: str, as_json: bool) -> None:
    """Show topics with their rates, and clients, until q or Ctrl-C.

    PUBS and SUBS are numbers of publishers and subscribers. DROPS are messages dropped because
    subscribers were too slow, in total and (+) since the last measurement. KEPT is the size of a
    client's send queue at the hub; a client is slow while it does not receive it.

    On a terminal, the keys r, b and n sort by rate, bandwidth and name. In a pipe, and with -n,
    measurements are printed as plain text, or with --json as objects.
    """
    if times or as_json or not (output.has_control_sequences() and output.can_show("─…")):
        for measurement in _measurements(client, delay, sort, times):
            output.as_json(measurement.as_json()) if as_json else print_tables(measurement)
    else:
        with TopScreen.open() as screen:
            _watch(client, screen, delay, sort)


def _measurements(
    client: HubClient, delay: float, sort: str, times: int | None
) -> Iterator[Measurement]:
    before = client.call(STATISTICS)
    for _ in range(times) if times else count():
        client.process(delay)
        now = client.call(STATISTICS)
        yield Measurement.between(before, now, exclude=client.node, sort=sort)
        before = now


def _watch(client: HubClient, screen: TopScreen, delay: float, sort: str) -> None:
    before = now = client.call(STATISTICS)
    due = time.monotonic() + delay
    while True:
        measurement = Measurement.between(before, now, exclude=client.node, sort=sort)
        screen.show(measurement, client.url, sort)
        key = screen.wait_for_key(due - time.monotonic(), lambda: client.process(0))
        if key == "q":
            return
        sort = KEYS.get(key, sort)
        if not key:
            before, now = now, client.call(STATISTICS)
            due = max(due, time.monotonic() - delay) + delay
