"""What ``fibws top`` says of a number, and its plain tables."""

from __future__ import annotations

import pytest

from fibws.cli.top.measure import Client, Measure, Topic
from fibws.cli.top.text import amount, block, client_cells, topic_cells

TOPIC = Topic("/t", 10.5, 2050, 2, 1, 0, 8)


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


def test_a_topic_is_a_row() -> None:
    assert topic_cells(TOPIC) == ("/t", "10.50Hz", "2.05KB/s", "2", "1", "8")
    assert topic_cells(TOPIC, is_measured=False)[1:3] == ("-", "-")


def test_new_drops_are_told() -> None:
    assert topic_cells(Topic("/t", 0, 0, 0, 1, 3, 8))[-1] == "8 (+3)"


@pytest.mark.parametrize(("slow", "state"), [(True, "slow"), (False, "ok")])
def test_a_client_is_a_row(slow: bool, state: str) -> None:
    assert client_cells(Client("/a", "::1", 2000, 4, slow)) == ("/a", "::1", "2.00KB", "4", state)


def test_a_block_is_two_tables(capsys: pytest.CaptureFixture[str]) -> None:
    block(Measure(0, 1, [TOPIC], [Client("/a", "127.0.0.1:5", 0, 0, False)]))
    assert capsys.readouterr().out == (
        "TOPIC  RATE     BANDWIDTH  PUBS  SUBS  DROPS\n"
        "/t     10.50Hz  2.05KB/s   2     1     8\n"
        "\n"
        "NODE  ADDRESS      KEPT  DROPS  STATE\n"
        "/a    127.0.0.1:5  0B    0      ok\n"
        "\n"
    )
