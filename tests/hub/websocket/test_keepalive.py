"""Keepalive deadlines, with given times."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.hub.settings import Settings
from fibws.hub.websocket.keepalive import Keepalive
from fibws.protocol.websocket import SILENT, STALLED


def opened(**settings: Any) -> Keepalive:
    """Return the deadlines of a client that opened at 0: a ping every 20 s, all others 5 s."""
    five = dict.fromkeys(["ping_timeout", "stall_timeout", "open_timeout", "close_timeout"], 5.0)
    keepalive = Keepalive(Settings(**{"ping_interval": 20.0, **five, **settings}), now=0)
    keepalive.opened()
    return keepalive


def test_quiet_client_needs_no_ping_yet() -> None:
    assert opened().verdict(19, unsent=0) is None


def test_handshake_must_end_in_time() -> None:
    keepalive = Keepalive(Settings(open_timeout=5), now=10)
    assert keepalive.verdict(15, unsent=0) is None
    assert keepalive.verdict(15.1, unsent=0) == "abort"


def test_client_of_a_large_file_has_time_for_each_piece() -> None:
    keepalive = Keepalive(Settings(open_timeout=5), now=10)
    keepalive.paused(14, unsent=100)
    assert keepalive.verdict(18, unsent=100) is None
    assert keepalive.verdict(19, unsent=50) is None
    keepalive.paused(23, unsent=100)
    assert keepalive.verdict(28, unsent=100) is None
    assert keepalive.verdict(28.1, unsent=100) == "abort"


def test_client_that_reads_a_large_file_at_once_has_time_for_each_piece() -> None:
    keepalive = Keepalive(Settings(open_timeout=5), now=10)
    keepalive.sends(14)
    assert keepalive.verdict(18, unsent=0) is None
    assert keepalive.verdict(19.1, unsent=0) == "abort"


def test_client_is_pinged_in_every_interval() -> None:
    keepalive = opened()
    pinged = []
    for now in range(61):
        if keepalive.verdict(now, unsent=0) == "ping":
            pinged.append(now)
            keepalive.ponged()
    assert pinged == [20, 40, 60]


def test_no_ping_is_due_with_ping_interval_0() -> None:
    assert opened(ping_interval=0.0).verdict(1e6, unsent=0) is None


def test_client_that_does_not_answer_a_ping_is_silent() -> None:
    keepalive = opened()
    assert keepalive.verdict(20, unsent=0) == "ping"
    assert keepalive.verdict(25, unsent=0) is None
    assert keepalive.verdict(25.1, unsent=0) is SILENT


def test_second_ping_waits_for_the_first_pong() -> None:
    keepalive = opened(ping_interval=2.0)
    assert keepalive.verdict(2, unsent=0) == "ping"
    assert keepalive.verdict(4, unsent=0) is None


def test_client_that_stops_reading_is_stalled() -> None:
    keepalive = opened()
    keepalive.paused(1, unsent=100)
    assert keepalive.verdict(6, unsent=100) is None
    assert keepalive.verdict(6.1, unsent=100) is STALLED


def test_client_that_reads_again_is_not_stalled() -> None:
    keepalive = opened()
    keepalive.paused(1, unsent=100)
    keepalive.resumed()
    assert keepalive.verdict(7, unsent=0) is None


def test_slow_reader_is_neither_stalled_nor_silent() -> None:
    keepalive = opened()
    assert keepalive.verdict(20, unsent=0) == "ping"
    keepalive.paused(20, unsent=100)
    verdicts = [keepalive.verdict(20 + 4 * step, unsent=100 - step) for step in range(1, 20)]
    assert set(verdicts) == {None}


def test_no_ping_is_sent_behind_unsent_bytes() -> None:
    keepalive = opened(stall_timeout=100.0)
    keepalive.paused(19, unsent=100)
    assert keepalive.verdict(20, unsent=100) is None


@pytest.mark.parametrize("paused", [False, True])
def test_closing_client_has_close_timeout_to_answer(paused: bool) -> None:
    keepalive = opened(stall_timeout=100.0)
    if paused:
        keepalive.paused(1, unsent=100)
    keepalive.closing(2)
    assert keepalive.verdict(7, unsent=100) is None
    assert keepalive.verdict(7.1, unsent=100) == "abort"


def test_busy_hub_extends_the_deadlines() -> None:
    """The hub may not have read the pong yet."""
    keepalive = Keepalive(Settings(ping_interval=1, ping_timeout=1), 0)
    keepalive.opened()
    assert keepalive.verdict(1, 0) == "ping"
    keepalive.excuse(5)
    assert keepalive.verdict(6.5, 0) is None
    assert keepalive.verdict(7.5, 0) is SILENT


def test_busy_hub_extends_the_deadline_of_the_handshake() -> None:
    keepalive = Keepalive(Settings(open_timeout=5), now=10)
    keepalive.excuse(60)
    assert keepalive.verdict(75, unsent=0) is None
    assert keepalive.verdict(75.1, unsent=0) == "abort"


def test_busy_hub_extends_the_deadline_of_a_client_that_does_not_read() -> None:
    keepalive = opened()
    keepalive.paused(1, unsent=100)
    keepalive.excuse(60)
    assert keepalive.verdict(66, unsent=100) is None
    assert keepalive.verdict(66.1, unsent=100) is STALLED


def test_busy_hub_extends_the_deadline_of_the_close_handshake() -> None:
    keepalive = opened()
    keepalive.closing(2)
    keepalive.excuse(60)
    assert keepalive.verdict(67, unsent=0) is None
    assert keepalive.verdict(67.1, unsent=0) == "abort"


def test_client_of_which_not_all_is_read_is_alive() -> None:
    keepalive = opened()
    assert keepalive.verdict(20, unsent=0) == "ping"
    keepalive.behind(24)
    assert keepalive.verdict(29, unsent=0) is None
    assert keepalive.verdict(29.1, unsent=0) is SILENT
