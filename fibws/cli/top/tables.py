"""A measure as the tables of a terminal that is so wide and so high."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fibws.cli import output
from fibws.cli.top.measure import Measure
from fibws.cli.top.text import CLIENT_HEADS, TOPIC_HEADS, client_cells, topic_cells

if TYPE_CHECKING:
    from rich.console import RenderableType

FRAME = 8
"""Lines that are no row: the headline and a gap; heads, a rule, what was left out, twice."""
FIRST_TO_GO = {"PUBS": 64, "SUBS": 64, "ADDRESS": 64, "BANDWIDTH": 40, "KEPT": 40}
"""The columns that lines of fewer characters than these have no room for."""
TO_THE_LEFT = {"TOPIC", "NODE", "ADDRESS", "STATE"}


def tables(measure: Measure, head: str, width: int, height: int) -> RenderableType:
    """A measure below a headline, cut to so many characters and lines."""
    from rich.console import Group
    from rich.text import Text

    room = max(2, height - FRAME)
    clients = measure.clients[: max(1, room - len(measure.topics), room // 3)]
    topics = measure.topics[: max(1, room - len(clients))]
    is_measured = measure.seconds > 0
    return Group(
        Text(head, style="dim", no_wrap=True, overflow="ellipsis"),
        Text(),
        _table(
            TOPIC_HEADS,
            [topic_cells(each, is_measured=is_measured) for each in topics],
            [bool(each.dropped) for each in topics],
            width,
        ),
        _left_out(len(measure.topics) - len(topics), "topic"),
        _table(
            CLIENT_HEADS,
            [client_cells(each) for each in clients],
            [each.slow for each in clients],
            width,
        ),
        _left_out(len(measure.clients) - len(clients), "client"),
    )


def _table(
    heads: Sequence[str], rows: Sequence[Sequence[str]], marked: Sequence[bool], width: int
) -> RenderableType:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, expand=True, show_edge=False, padding=(0, 1, 0, 0))
    shown = [width >= FIRST_TO_GO.get(head, 0) for head in heads]
    for number, head in enumerate(heads):
        if shown[number]:
            table.add_column(
                head,
                justify="left" if head in TO_THE_LEFT else "right",
                ratio=1 if number == 0 else None,  # All the room that the others leave is names'.
                no_wrap=True,
                overflow="ellipsis",
            )
    for cells, is_marked in zip(rows, marked, strict=True):
        # Text is taken as it is: no name becomes markup.
        texts = (Text(output.visible(cell, keep="")) for cell in cells)
        row = (text for text, is_shown in zip(texts, shown, strict=True) if is_shown)
        table.add_row(*row, style="bold yellow" if is_marked else None)
    return table


def _left_out(number: int, noun: str) -> RenderableType:
    from rich.text import Text

    return Text(f"and {output.counted(number, f'more {noun}')}" if number else "")
