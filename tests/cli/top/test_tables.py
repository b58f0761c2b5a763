"""The tables of a terminal, drawn on one that is not there."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from fibws.cli.top.measure import Client, Measure, Topic
from fibws.cli.top.tables import tables


def drawn(measure: Measure, width: int = 80, height: int = 24, *, colours: bool = False) -> str:
    console = Console(
        file=io.StringIO(), width=width, height=height, force_terminal=colours, highlight=False
    )
    console.print(tables(measure, "ws://hub", width, height))
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def measure(topics: int = 1, clients: int = 1, *, dropped: int = 0, slow: bool = False) -> Measure:
    return Measure(
        0,
        1,
        [Topic(f"/topic_{number}", 1, 10, 1, 1, dropped, dropped) for number in range(topics)],
        [Client(f"/node_{number}", "127.0.0.1:5", 0, 0, slow) for number in range(clients)],
    )


def test_there_is_a_table_of_topics_and_one_of_clients() -> None:
    lines = [" ".join(line.split()) for line in drawn(measure()).splitlines()]
    assert lines[0] == "ws://hub"
    assert "TOPIC RATE BANDWIDTH PUBS SUBS DROPS" in lines
    assert "/topic_0 1.00Hz 10B/s 1 1 0" in lines
    assert "NODE ADDRESS KEPT DROPS STATE" in lines
    assert "/node_0 127.0.0.1:5 0B 0 ok" in lines


@pytest.mark.parametrize("height", [12, 24, 60])
@pytest.mark.parametrize(("topics", "clients"), [(1, 200), (300, 1), (300, 200), (5, 5)])
def test_they_are_no_higher_than_the_terminal(height: int, topics: int, clients: int) -> None:
    text = drawn(measure(topics, clients), height=height)
    assert len(text.splitlines()) <= height
    assert "/topic_0" in text
    assert "/node_0" in text
    shown = text.count("/topic_")
    if shown < topics:
        assert f"and {topics - shown} more topic" in text


@pytest.mark.parametrize("width", [24, 40, 63, 64, 200])
def test_they_are_no_wider_than_the_terminal(width: int) -> None:
    text = drawn(measure(), width=width)
    assert max(map(len, text.splitlines())) <= width
    assert ("PUBS" in text) == (width >= 64)
    assert ("BANDWIDTH" in text) == (width >= 40)
    assert "/topic_0" in text


def test_drops_and_slow_clients_stand_out() -> None:
    mark = "\x1b[1;33m"
    assert mark not in drawn(measure(), colours=True)
    assert mark in drawn(measure(dropped=1), colours=True)
    assert mark in drawn(measure(slow=True), colours=True)


def test_no_name_is_markup_or_moves_the_cursor() -> None:
    name = "[bold]x[/bold]\x1b[2J"
    text = drawn(Measure(0, 1, [Topic(name, 0, 0, 0, 0, 0, 0)], []), width=200)
    assert r"[bold]x[/bold]\x1b[2J" in text
    assert "\x1b" not in text
