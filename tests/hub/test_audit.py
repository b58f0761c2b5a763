"""Audit events: their fields, their counts, and limits on their lines."""

from __future__ import annotations

import logging
from typing import Any

import pytest

from fibws.hub.audit import Audit, Identity
from fibws.hub.log_text import MAX_LINES, REPEAT_AFTER

GUEST = Identity("guest", "10.0.0.7")


class Clock:
    """A clock that the test sets."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def audit(clock: Clock, caplog: pytest.LogCaptureFixture) -> Audit:
    caplog.set_level(logging.INFO, "fibws.hub.audit")
    return Audit(clock, lambda node: GUEST if node == "/joystick" else Identity())


def events(caplog: pytest.LogCaptureFixture) -> list[dict[str, Any]]:
    """Return the events with their fields, without those that are empty."""
    return [
        {"event": vars(each)["event"], **{k: v for k, v in vars(each)["fields"].items() if v}}
        for each in caplog.records
    ]


def test_refusal_names_the_client_by_its_node(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    audit.refused("right", 'publish /cmd_vel: missing right "publish"', node="/joystick")
    assert events(caplog) == [
        {
            "event": "refused",
            "reason": "right",
            "node": "/joystick",
            "principal": "guest",
            "ip": "10.0.0.7",
        }
    ]
    assert caplog.messages == [
        'Refused /joystick (guest, 10.0.0.7): publish /cmd_vel: missing right "publish".'
    ]


def test_refusal_before_there_is_a_node_names_the_address(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    audit.refused("authentication", "unknown token", ip="10.0.0.8")
    assert events(caplog) == [
        {"event": "refused", "reason": "authentication", "ip": "10.0.0.8"},
    ]


def test_repeated_refusals_are_counted_but_logged_once(
    audit: Audit, clock: Clock, caplog: pytest.LogCaptureFixture
) -> None:
    for _ in range(1000):
        audit.refused("authentication", "unknown token", ip="10.0.0.8")
    assert len(caplog.records) == 1
    clock.now = REPEAT_AFTER
    audit.refused("authentication", "unknown token", ip="10.0.0.8")
    assert "(999 more since the last line)" in caplog.messages[-1]
    assert audit.refusals == {"authentication": 1001, "right": 0, "limit": 0, "origin": 0}


def test_refusals_of_many_clients_are_limited(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    for number in range(1000):
        audit.refused("origin", f"https://{number}.example may not connect", ip=f"10.0.0.{number}")
    assert len(caplog.records) == MAX_LINES
    assert audit.refusals["origin"] == 1000


def test_refusal_may_be_counted_without_a_line(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    audit.count("limit")
    assert (audit.refusals["limit"], caplog.records) == (1, [])


def test_changes_are_recorded_with_their_author(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    audit.login(principal="guest", ip="10.0.0.7")
    audit.parameter_written("/gain", node="/joystick")
    audit.parameter_written("/gain", node="/joystick", deleted=True)
    audit.node_killed("/camera", node="/joystick")
    audit.name_taken(node="/camera", principal="robot", ip="10.0.0.9")
    audit.reloaded("tokens")
    audit.reload_failed("certificates", "file not found")
    joystick = {"node": "/joystick", "principal": "guest", "ip": "10.0.0.7"}
    assert events(caplog) == [
        {"event": "login", "principal": "guest", "ip": "10.0.0.7"},
        {"event": "parameter_set", "parameter": "/gain", **joystick},
        {"event": "parameter_deleted", "parameter": "/gain", **joystick},
        {"event": "node_killed", "killed": "/camera", **joystick},
        {"event": "name_taken", "node": "/camera", "principal": "robot", "ip": "10.0.0.9"},
        {"event": "reloaded", "what": "tokens"},
        {"event": "reload_failed", "what": "certificates", "error": "file not found"},
    ]


def test_text_of_a_client_stays_on_one_line(audit: Audit, caplog: pytest.LogCaptureFixture) -> None:
    audit.refused("right", "publish /a\n[INFO] forged", node="/x")
    audit.parameter_written("/a\x1b[31m", node="/x")
    assert not any("\n" in text or "\x1b" in text for text in caplog.messages)
