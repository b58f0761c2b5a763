"""``fibws topic bw``: how many bytes a second a topic has."""

from __future__ import annotations

import time

import click

from fibws.cli import complete, output
from fibws.cli.link import Link
from fibws.cli.tool import json_option, linked
from fibws.cli.topic.every_second import count_option, hear, report, window_option
from fibws.cli.topic.target import global_name
from fibws.cli.topic.window import Summary, Window, as_object

WINDOW = 100
UNITS = ((1_000_000, "MB"), (1_000, "KB"), (1, "B"))
"""Bytes, largest first; a topic has one unit for all its numbers."""


class Bandwidth:
    """How many bytes come, and when.

    Args:
        window: the newest messages that count.
    """

    def __init__(self, window: int = WINDOW) -> None:
        self._sizes = Window(window)
        self._times = Window(window)

    def hear(self, message: bytes) -> None:
        """Take note that a message has come now."""
        self.take(len(message), time.perf_counter())

    def take(self, size: int, now: float) -> None:
        """Take note that so many bytes have come at this time, in seconds."""
        self._sizes.add(size)
        self._times.add(now)

    def at(self, now: float) -> tuple[float, Summary, int] | None:
        """Bytes a second until now, what the messages' sizes are like, and how many they are.

        None if there are fewer than two.
        """
        if len(self._sizes) < 2 or now <= self._times.oldest:
            return None
        rate = self._sizes.total / (now - self._times.oldest)
        return rate, self._sizes.summary(), len(self._sizes)


@click.command()
@click.argument("topic", shell_complete=complete.topics)
@window_option(WINDOW, least=2)
@count_option
@json_option
@linked("bw", endless=True)
def command(link: Link, topic: str, window: int, count: int | None, as_json: bool) -> None:
    """Show once a second how many bytes a second TOPIC has.

    They are those of the messages in JSON, as the hub sends them here.
    """
    bandwidth = Bandwidth(window)
    name = global_name(link, topic)
    hear(link, name, bandwidth.hear, quiet=as_json)

    def show() -> None:
        news = bandwidth.at(time.perf_counter())
        if news is not None and as_json:
            rate, sizes, number = news
            sizes_ = {"mean": sizes.mean} | as_object(sizes)
            output.as_json({"topic": name, "rate": rate} | sizes_ | {"window": number})
        elif news is not None:
            output.line(text(*news))

    report(link, show, count)


def text(rate: float, sizes: Summary, number: int) -> str:
    """A rate in bytes a second, and the sizes of messages, as rostopic bw prints them."""
    factor, unit = next((each for each in UNITS if rate >= each[0]), UNITS[-1])
    average, mean, least, most = (
        f"{each / factor:.2f}{unit}" for each in (rate, sizes.mean, sizes.least, sizes.most)
    )
    return f"average: {average}/s\n\tmean: {mean} min: {least} max: {most} window: {number}"
