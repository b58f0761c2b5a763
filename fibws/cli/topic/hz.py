"""``fibws topic hz``: the publishing rate of topics."""

from __future__ import annotations

import time
from collections.abc import Sequence

import click

from fibws.cli import complete, output
from fibws.cli.link import Link, RawMessage
from fibws.cli.tool import json_option, linked
from fibws.cli.topic.every_second import count_option, report, subscribe, window_option
from fibws.cli.topic.target import global_name
from fibws.cli.topic.window import MOST, Summary, Window, as_object, in_seconds

HEADS = ("topic", "rate", "min_delta", "max_delta", "std_dev", "window")


class Rate:
    """The rate of a topic.

    Args:
        window: number of latest messages to measure.
    """

    def __init__(self, window: int = MOST) -> None:
        self._deltas = Window(window - 1)
        self._last: float | None = None
        self._reported: float | None = None

    def receive(self, message: RawMessage) -> None:
        """Count a message that is received now."""
        self.add(time.perf_counter())

    def add(self, now: float) -> None:
        """Count a message that is received at ``now``, in seconds."""
        if self._last is not None:
            self._deltas.add(now - self._last)
        self._last = now

    def poll(self) -> tuple[float, Summary, int] | None:
        """Return the rate in Hz, the seconds between messages, and the number of messages.

        Return None if there is no new message since the last poll, or only one message so far.
        """
        if not self._deltas or self._last == self._reported:
            return None
        self._reported = self._last
        summary = self._deltas.summary()
        return 1 / summary.mean if summary.mean > 0 else 0.0, summary, len(self._deltas) + 1


@click.command()
@click.argument(
    "topics", metavar="TOPIC...", nargs=-1, required=True, shell_complete=complete.topics
)
@window_option(MOST, least=2)
@count_option
@json_option
@linked("hz", endless=True)
def command(
    link: Link, topics: tuple[str, ...], window: int, count: int | None, as_json: bool
) -> None:
    """Show the publishing rate of each TOPIC every second."""
    rates: dict[str, Rate] = {}
    for topic in topics:
        name = global_name(link, topic)
        rates[name] = Rate(window)
        subscribe(link, name, rates[name].receive, quiet=as_json)
    report(link, lambda: show(rates, as_json=as_json), count)


def show(rates: dict[str, Rate], *, as_json: bool = False) -> None:
    """Print the rates of topics with new messages in the format of rostopic hz."""
    polled = {topic: found for topic, rate in rates.items() if (found := rate.poll()) is not None}
    if as_json:
        for topic, (rate, deltas, number) in polled.items():
            output.as_json({"topic": topic, "rate": rate} | as_object(deltas) | {"window": number})
    elif not polled:
        output.line("no new messages")
    elif len(rates) == 1:
        for rate, deltas, number in polled.values():
            output.line(f"average rate: {rate:.3f}\n\t{in_seconds(deltas)} window: {number}")
    else:
        output.line(table([_row(topic, *each) for topic, each in polled.items()]))


def _row(topic: str, rate: float, deltas: Summary, number: int) -> list[str]:
    numbers = (rate, deltas.least, deltas.most, deltas.deviation)
    return [topic, *(f"{each:.4}" for each in numbers), str(number)]


def table(rows: Sequence[Sequence[str]]) -> str:
    """Return rows under `HEADS`, in the format of rostopic hz for several topics."""
    widths = [max(len(each[i]) for each in (HEADS, *rows)) for i in range(len(HEADS))]
    lines = [
        "   ".join(head.center(width) for head, width in zip(HEADS, widths, strict=True)),
        "=" * (sum(widths) + 3 * (len(widths) - 1)),
        *("   ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) for row in rows),
    ]
    return "\n".join(lines) + "\n"
