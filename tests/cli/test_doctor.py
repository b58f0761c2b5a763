"""``fibws doctor`` at a real hub."""

from __future__ import annotations

import json
from collections.abc import Mapping

import pytest
from click.testing import CliRunner
from hub_in_thread import HubThread, Publish, Run

from fibws.cli import doctor
from fibws.cli.commands import command
from fibws.cli.doctor.finding import Finding, join_names


@pytest.fixture(autouse=True)
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "INTERVAL", 0.0)
    for name in ("ROS_MASTER_URI", "ROS_NAMESPACE", "FIBWS_INTERFACES"):
        monkeypatch.delenv(name, raising=False)


def test_setup_without_problems(run: Run) -> None:
    result = run("doctor")
    assert result.exit_code == 0, result.output
    *lines, empty, last = result.output.splitlines()
    assert empty == "" and "fine" in last and "15" in last
    checks = [line[11:22].rstrip() for line in lines if line[0] != " "]
    assert checks == [
        *("python", "packages", "terminal", "environment"),
        *("hub", "version", "token", "round trip", "clock"),
        *("graph", "types", "conflicts", "ends", "names", "clients"),
    ]


def test_warning_is_not_a_failure(run: Run, publish: Publish) -> None:
    publish("/chatter", "std_msgs/String", {"data": "hello"})
    result = run("doctor")
    assert result.exit_code == 0
    assert any(
        line.startswith("! warning  ends") and "/chatter" in line
        for line in result.output.splitlines()
    )


def test_missing_hub_is_a_failure_with_advice(hub: HubThread, run: Run) -> None:
    hub.stop()
    result = run("doctor")
    assert result.exit_code == 1
    first, second, _, last = result.output.splitlines()[-4:]
    assert last.startswith("1 problem")
    assert first.startswith("✗ wrong    hub          ") and hub.url in first
    assert second.startswith(" " * 24) and "fibws hub" in second


def test_json_is_one_finding_per_line(run: Run) -> None:
    found = [json.loads(line) for line in run("doctor", "--json").output.splitlines()]
    assert found[0].keys() == {"check", "verdict", "text", "advice"}
    assert {finding["verdict"] for finding in found} <= {"ok", "warning", "wrong"}
    assert found[-1]["check"] == "clients"


def test_lost_hub_is_a_finding(hub: HubThread, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def version(url: str, headers: Mapping[str, str]) -> Finding:
        hub.stop()
        return Finding("version", "ok", "the same")

    monkeypatch.setattr("fibws.cli.doctor.hub.version", version)
    result = run("doctor")
    assert result.exit_code == 1
    assert any(
        line.startswith("✗ wrong    hub ") and hub.url in line
        for line in result.output.splitlines()
    )


def test_signs_are_ascii_if_the_encoding_lacks_others(hub: HubThread) -> None:
    result = CliRunner(charset="ascii").invoke(command, ["doctor", "--hub", hub.url])
    assert "+ ok       hub" in result.output


def test_long_texts_are_wrapped_on_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "50")
    monkeypatch.setattr("fibws.cli.output.is_terminal", lambda: True)
    monkeypatch.setattr("fibws.cli.output.has_colours", lambda: False)
    doctor.print_finding(Finding("ends", "warning", "word " * 9, "advice"))
    assert capsys.readouterr().out == (
        "! warning  ends         word word word word word\n"
        "                        word word word word\n"
        "                        advice\n"
    )


def test_finding_is_one_line_in_a_pipe(capsys: pytest.CaptureFixture[str]) -> None:
    doctor.print_finding(Finding("version", "wrong", "two\nlines\x1b[2J" + " word" * 30, ""))
    out = capsys.readouterr().out
    assert out.count("\n") == 1
    assert "\x1b" not in out


def test_help_lists_all_checks(run: Run) -> None:
    text = run("doctor", "--help").output
    for line in run("doctor").output.splitlines()[:-2]:
        if line[0] != " ":
            assert f"  {line[11:22].rstrip()} " in text
    assert "  definitions " in text


def test_long_list_of_names_is_shortened() -> None:
    assert join_names(["/a", "/b"]) == "/a, /b"
    assert join_names(["/a", "/b", "/c"], 2) == "/a, /b and 1 more"
