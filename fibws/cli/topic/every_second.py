"""What the measuring tools share: they subscribe to topics and print a report every second."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import click

from fibws.cli import output
from fibws.cli.topic.target import Target, wait
from fibws.client.hub_client import HubClient, OnMessage

QUEUE_LENGTH = 10_000
"""Messages of a topic that the hub keeps while the tool reads too slowly."""
PERIOD = 1.0
"""Seconds between two reports."""


count_option: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "-n", "count", metavar="COUNT", type=click.IntRange(min=1), help="Exit after COUNT reports."
)


def window_option(
    default: int, *, least: int
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Return the option ``--window``: the number of measurements to use."""
    return click.option(
        "-w",
        "--window",
        metavar="COUNT",
        type=click.IntRange(min=least),
        default=default,
        show_default=True,
        help="Number of latest messages to measure.",
    )


def subscribe(
    client: HubClient, name: str, on_message: OnMessage, *, quiet: bool = False
) -> Target:
    """Subscribe to the raw messages of a topic, and wait until it is published.

    Args:
        name: its global name.
        on_message: called with each message; see `HubClient.subscribe_raw`.
        quiet: print nothing.
    """
    subscribe_raw = partial(client.subscribe_raw, on_message=on_message, queue_length=QUEUE_LENGTH)
    target = wait(client, name, subscribe=subscribe_raw)
    if target.path:
        raise click.UsageError(f"{name} is a field of {target.topic}: name a topic.")
    if not quiet:
        output.line(f"subscribed to [{target.topic}]")
    return target


def report(client: HubClient, show: Callable[[], None], count: int | None = None) -> None:
    """Call ``show`` every second, ``count`` times or until Ctrl-C.

    Raises:
        OperationRejected: the hub refused an operation.
        HubLost: the connection is lost.
    """
    due = time.monotonic()
    while count is None or count > 0:
        due += PERIOD
        if due <= (now := time.monotonic()):
            due = now + PERIOD  # After Ctrl-Z, missed reports are not printed.
        client.process(due - time.monotonic())
        show()
        if count is not None:
            count -= 1
