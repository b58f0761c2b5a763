"""``fibws topic bw``: the bandwidth of a topic."""

from __future__ import annotations

import time

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.topic.every_second import count_option, report, subscribe, window_option
from fibws.cli.topic.target import global_name
from fibws.client.hub_client import HubClient, RawMessage
from fibws.values.rates import Summary, Window, as_object

WINDOW = 100
UNITS = ((1_000_000, "MB"), (1_000, "KB"), (1, "B"))
"""Units in bytes, the largest first; a report has one unit for all its numbers."""


class Bandwidth:
    """The bandwidth of a topic.

    Args:
        window: number of latest messages to measure.
    """

    def __init__(self, window: int = WINDOW) -> None:
        self._sizes = Window(window)
        self._times = Window(window)

    def receive(self, message: RawMessage) -> None:
        """Count a message that is received now."""
        self.add(len(message.data), time.perf_counter())

    def add(self, size: int, now: float) -> None:
        """Count a message of ``size`` bytes, received at ``now`` in seconds."""
        self._sizes.add(size)
        self._times.add(now)

    def at(self, now: float) -> tuple[float, Summary, int] | None:
        """Return the bytes per second until ``now``, the messages' sizes, and their number.

        Return None for fewer than two messages.
        """
        if len(self._sizes) < 2 or now <= self._times.oldest:
            return None
        rate = self._sizes.total / (now - self._times.oldest)
        return rate, self._sizes.summary(), len(self._sizes)


@click.command()
@click.argument("topic", shell_complete=completers.topics)
@window_option(WINDOW, least=2)
@count_option
@json_option
@with_hub("bw", endless=True)
def command(client: HubClient, topic: str, window: int, count: int | None, as_json: bool) -> None:
    """Show the bandwidth of TOPIC every second.

    Sizes are those of serialized messages, as in rostopic bw. With a plain rosbridge server, or for
    an undefined type, they are those of messages in JSON.
    """
    bandwidth = Bandwidth(window)
    name = global_name(client, topic)
    subscribe(client, name, bandwidth.receive, quiet=as_json)

    def show() -> None:
        measured = bandwidth.at(time.perf_counter())
        if measured is not None and as_json:
            rate, sizes, number = measured
            sizes_ = {"mean": sizes.mean} | as_object(sizes)
            output.as_json({"topic": name, "rate": rate} | sizes_ | {"window": number})
        elif measured is not None:
            output.line(text(*measured))

    report(client, show, count)


def text(rate: float, sizes: Summary, number: int) -> str:
    """Return a rate in bytes per second and message sizes in the format of rostopic bw."""
    factor, unit = next((each for each in UNITS if rate >= each[0]), UNITS[-1])
    average, mean, least, most = (
        f"{each / factor:.2f}{unit}" for each in (rate, sizes.mean, sizes.least, sizes.most)
    )
    return f"average: {average}/s\n\tmean: {mean} min: {least} max: {most} window: {number}"
