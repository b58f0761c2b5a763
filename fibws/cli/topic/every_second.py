"""How the tools that measure go on: they hear topics, and say once a second what they heard."""

from __future__ import annotations

import time
from collections.abc import Callable

import click

from fibws.cli import output
from fibws.cli.link import Hear, Link
from fibws.cli.topic.target import Target, wait

QUEUE_LENGTH = 10_000
"""Messages that the hub is to keep where it is quicker than the tool."""
PERIOD = 1.0
"""Seconds between two reports."""


count_option: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "-n", "count", metavar="COUNT", type=click.IntRange(min=1), help="End after so many reports."
)


def window_option(
    default: int, *, least: int
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """The option ``--window``: how many measurements count."""
    return click.option(
        "-w",
        "--window",
        metavar="COUNT",
        type=click.IntRange(min=least),
        default=default,
        show_default=True,
        help="The newest messages that count.",
    )


def hear(link: Link, name: str, heard: Hear, *, quiet: bool = False) -> Target:
    """Have the messages of a topic given to ``heard``, once somebody publishes it.

    Args:
        name: its global name.
        heard: is given the JSON text of each.
        quiet: say nothing of it.
    """
    link.hear(name, heard)
    target = wait(link, name, queue_length=QUEUE_LENGTH)
    if target.path:
        raise click.UsageError(f"{name} is a field of {target.topic}: name a topic.")
    if not quiet:
        output.line(f"subscribed to [{target.topic}]")
    return target


def report(link: Link, show: Callable[[], None], count: int | None = None) -> None:
    """Call ``show`` once a second and ``count`` times, or until Ctrl-C.

    Raises:
        OperationRejected: the hub has refused something.
        HubLost: there is no hub any more.
    """
    due = time.monotonic()
    while count is None or count > 0:
        due += PERIOD
        if due <= (now := time.monotonic()):
            due = now + PERIOD  # Whoever was stopped, by Ctrl-Z, does not make up for it.
        link.heed(due - time.monotonic())
        show()
        if count is not None:
            count -= 1
