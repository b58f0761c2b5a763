"""The tables of `fibws top`: plain text for pipes, and rich tables that fit a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fibws.cli import output
from fibws.cli.quantities import amount
from fibws.client.statistics import ClientQueue, Measurement, TopicRates

if TYPE_CHECKING:
    from rich.console import RenderableType

TOPIC_HEADS = ("TOPIC", "RATE", "BANDWIDTH", "PUBS", "SUBS", "DROPS")
CLIENT_HEADS = ("NODE", "ADDRESS", "KEPT", "DROPS", "STATE")


def topic_cells(topic: TopicRates, *, is_measured: bool = True) -> tuple[str, ...]:
    """Return the cells of a topic's row, under `TOPIC_HEADS`; rates only if ``is_measured``."""
    grown = f" (+{topic.dropped})" if topic.dropped else ""
    return (
        topic.topic,
        f"{topic.rate:.2f}Hz" if is_measured else "-",
        f"{amount(topic.bandwidth)}/s" if is_measured else "-",
        str(topic.publishers),
        str(topic.subscribers),
        f"{topic.dropped_in_all}{grown}",
    )


def client_cells(client: ClientQueue) -> tuple[str, ...]:
    """Return the cells of a client's row, under `CLIENT_HEADS`."""
    state = "slow" if client.slow else "ok"
    return client.node, client.address, amount(client.kept_bytes), str(client.dropped), state


def print_tables(measurement: Measurement) -> None:
    """Print a measurement as two plain tables, each followed by an empty line."""
    output.table(TOPIC_HEADS, map(topic_cells, measurement.topics))
    output.line()
    output.table(CLIENT_HEADS, map(client_cells, measurement.clients))
    output.line()


FRAME = 8
"""Lines without rows: the heading and an empty line; twice heads, a rule and a remainder."""
MIN_WIDTHS = {"PUBS": 64, "SUBS": 64, "ADDRESS": 64, "BANDWIDTH": 40, "KEPT": 40}
"""Columns that are left out on narrower terminals."""
LEFT_ALIGNED = {"TOPIC", "NODE", "ADDRESS", "STATE"}


def tables(measurement: Measurement, heading: str, width: int, height: int) -> RenderableType:
    """Return a measurement below a heading, cut to a terminal's width and height."""
    from rich.console import Group
    from rich.text import Text

    room = max(2, height - FRAME)
    clients = measurement.clients[: max(1, room - len(measurement.topics), room // 3)]
    topics = measurement.topics[: max(1, room - len(clients))]
    is_measured = measurement.seconds > 0
    return Group(
        Text(heading, style="dim", no_wrap=True, overflow="ellipsis"),
        Text(),
        _table(
            TOPIC_HEADS,
            [topic_cells(each, is_measured=is_measured) for each in topics],
            [bool(each.dropped) for each in topics],
            width,
        ),
        _remainder(len(measurement.topics) - len(topics), "topic"),
        _table(
            CLIENT_HEADS,
            [client_cells(each) for each in clients],
            [each.slow for each in clients],
            width,
        ),
        _remainder(len(measurement.clients) - len(clients), "client"),
    )


def _table(
    heads: Sequence[str], rows: Sequence[Sequence[str]], marked: Sequence[bool], width: int
) -> RenderableType:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, expand=True, show_edge=False, padding=(0, 1, 0, 0))
    shown = [width >= MIN_WIDTHS.get(head, 0) for head in heads]
    for number, head in enumerate(heads):
        if shown[number]:
            table.add_column(
                head,
                justify="left" if head in LEFT_ALIGNED else "right",
                ratio=1 if number == 0 else None,  # Names have the remaining width.
                no_wrap=True,
                overflow="ellipsis",
            )
    for cells, is_marked in zip(rows, marked, strict=True):
        # Text does not interpret markup in names.
        texts = (Text(output.visible(cell, keep="")) for cell in cells)
        row = (text for text, is_shown in zip(texts, shown, strict=True) if is_shown)
        table.add_row(*row, style="bold yellow" if is_marked else None)
    return table


def _remainder(number: int, noun: str) -> RenderableType:
    from rich.text import Text

    return Text(f"and {output.counted(number, f'more {noun}')}" if number else "")
