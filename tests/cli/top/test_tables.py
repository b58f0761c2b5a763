"""Plain tables, and those of a terminal."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from fibws.cli.quantities import amount
from fibws.cli.top.tables import client_cells, print_tables, tables, topic_cells
from fibws.client.statistics import ClientQueue, Measurement, TopicRates

TOPIC = TopicRates("/t", 10.5, 2050, 2, 1, 0, 8)


def drawn(
    measurement: Measurement, width: int = 80, height: int = 24, *, colours: bool = False
) -> str:
    console = Console(
        file=io.StringIO(), width=width, height=height, force_terminal=colours, highlight=False
    )
    console.print(tables(measurement, "ws://hub", width, height))
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def measurement(
    topics: int = 1, clients: int = 1, *, dropped: int = 0, slow: bool = False
) -> Measurement:
    return Measurement(
        0,
        1,
        [TopicRates(f"/topic_{number}", 1, 10, 1, 1, dropped, dropped) for number in range(topics)],
        [ClientQueue(f"/node_{number}", "127.0.0.1:5", 0, 0, slow) for number in range(clients)],
    )


def test_topics_and_clients_have_a_table_each() -> None:
    lines = [" ".join(line.split()) for line in drawn(measurement()).splitlines()]
    assert lines[0] == "ws://hub"
    assert "TOPIC RATE BANDWIDTH PUBS SUBS DROPS" in lines
    assert "/topic_0 1.00Hz 10B/s 1 1 0" in lines
    assert "NODE ADDRESS KEPT DROPS STATE" in lines
    assert "/node_0 127.0.0.1:5 0B 0 ok" in lines


@pytest.mark.parametrize("height", [12, 24, 60])
@pytest.mark.parametrize(("topics", "clients"), [(1, 200), (300, 1), (300, 200), (5, 5)])
def test_tables_fit_the_terminal_s_height(height: int, topics: int, clients: int) -> None:
    text = drawn(measurement(topics, clients), height=height)
    assert len(text.splitlines()) <= height
    assert "/topic_0" in text
    assert "/node_0" in text
    shown = text.count("/topic_")
    if shown < topics:
        assert f"and {topics - shown} more topic" in text


@pytest.mark.parametrize("width", [24, 40, 63, 64, 200])
def test_tables_fit_the_terminal_s_width(width: int) -> None:
    text = drawn(measurement(), width=width)
    assert max(map(len, text.splitlines())) <= width
    assert ("PUBS" in text) == (width >= 64)
    assert ("BANDWIDTH" in text) == (width >= 40)
    assert "/topic_0" in text


def test_drops_and_slow_clients_are_marked() -> None:
    mark = "\x1b[1;33m"
    assert mark not in drawn(measurement(), colours=True)
    assert mark in drawn(measurement(dropped=1), colours=True)
    assert mark in drawn(measurement(slow=True), colours=True)


def test_markup_and_control_characters_in_names_are_printed() -> None:
    name = "[bold]x[/bold]\x1b[2J"
    text = drawn(Measurement(0, 1, [TopicRates(name, 0, 0, 0, 0, 0, 0)], []), width=200)
    assert r"[bold]x[/bold]\x1b[2J" in text
    assert "\x1b" not in text


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (0, "0B"),
        (999, "999B"),
        (12.5, "12.50B"),
        (12340, "12.34KB"),
        (5e6, "5.00MB"),
        (7.2e9, "7.20GB"),
    ],
)
def test_bytes_have_units(number: float, text: str) -> None:
    assert amount(number) == text


def test_row_of_a_topic() -> None:
    assert topic_cells(TOPIC) == ("/t", "10.50Hz", "2.05KB/s", "2", "1", "8")
    assert topic_cells(TOPIC, is_measured=False)[1:3] == ("-", "-")


def test_new_drops_are_shown() -> None:
    assert topic_cells(TopicRates("/t", 0, 0, 0, 1, 3, 8))[-1] == "8 (+3)"


@pytest.mark.parametrize(("slow", "state"), [(True, "slow"), (False, "ok")])
def test_row_of_a_client(slow: bool, state: str) -> None:
    assert client_cells(ClientQueue("/a", "::1", 2000, 4, slow)) == (
        "/a",
        "::1",
        "2.00KB",
        "4",
        state,
    )


def test_plain_text_is_two_tables(capsys: pytest.CaptureFixture[str]) -> None:
    print_tables(Measurement(0, 1, [TOPIC], [ClientQueue("/a", "127.0.0.1:5", 0, 0, False)]))
    assert capsys.readouterr().out == (
        "TOPIC  RATE     BANDWIDTH  PUBS  SUBS  DROPS\n"
        "/t     10.50Hz  2.05KB/s   2     1     8\n"
        "\n"
        "NODE  ADDRESS      KEPT  DROPS  STATE\n"
        "/a    127.0.0.1:5  0B    0      ok\n"
        "\n"
    )
