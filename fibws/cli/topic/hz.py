"""``fibws topic hz``: the publishing rate of topics."""

from __future__ import annotations

import time

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.topic.every_second import count_option, report, subscribe, window_option
from fibws.cli.topic.target import global_name
from fibws.client.hub_client import HubClient, OnMessage
from fibws.values.rates import MOST, Rate, as_object, poll, rates_text


@click.command()
@click.argument(
    "topics", metavar="TOPIC...", nargs=-1, required=True, shell_complete=completers.topics
)
@window_option(MOST, least=2)
@count_option
@json_option
@with_hub("hz", endless=True)
def command(
    client: HubClient, topics: tuple[str, ...], window: int, count: int | None, as_json: bool
) -> None:
    """Show the publishing rate of each TOPIC every second."""
    rates: dict[str, Rate] = {}
    for topic in topics:
        name = global_name(client, topic)
        rates[name] = Rate(window)
        subscribe(client, name, _counter(rates[name]), quiet=as_json)

    def show() -> None:
        polled = poll(rates)
        if not as_json:
            output.line(rates_text(polled, len(rates)))
        for topic, (rate, deltas, number) in polled.items() if as_json else ():
            output.as_json({"topic": topic, "rate": rate} | as_object(deltas) | {"window": number})

    report(client, show, count)


def _counter(rate: Rate) -> OnMessage:
    def count(message: object) -> None:
        rate.add(time.perf_counter())

    return count
