"""``fibws doctor`` at a real hub."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner
from hub_in_thread import HubThread, Publish, Run

from fibws.cli import doctor
from fibws.cli.commands import command
from fibws.cli.doctor.finding import Finding, listed


@pytest.fixture(autouse=True)
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "MOMENT", 0.0)
    for name in ("ROS_MASTER_URI", "ROS_NAMESPACE", "FIBWS_INTERFACES"):
        monkeypatch.delenv(name, raising=False)


def test_a_setup_in_which_nothing_is_wrong(run: Run) -> None:
    result = run("doctor")
    assert result.exit_code == 0, result.output
    checks = [line[11:22].rstrip() for line in result.output.splitlines() if line[0] != " "]
    assert checks == [
        *("python", "packages", "terminal", "environment"),
        *("hub", "version", "round trip", "clock"),
        *("graph", "types", "ends", "names", "clients"),
    ]


def test_what_looks_odd_is_no_failure(run: Run, publish: Publish) -> None:
    publish("/chatter", "std_msgs/String", {"data": "hello"})
    result = run("doctor")
    assert result.exit_code == 0
    assert "! warning  ends         Nobody hears /chatter\n" in result.output


def test_without_a_hub_it_says_what_to_do_and_fails(hub: HubThread, run: Run) -> None:
    hub.stop()
    result = run("doctor")
    assert result.exit_code == 1
    first, second = result.output.splitlines()[-2:]
    assert first.startswith(f"✗ wrong    hub          Nothing answers at {hub.url}")
    assert second.startswith("                        Start one: fibws hub.")


def test_json_is_a_finding_a_line(run: Run) -> None:
    found = [json.loads(line) for line in run("doctor", "--json").output.splitlines()]
    assert found[0].keys() == {"check", "verdict", "text", "advice"}
    assert {finding["verdict"] for finding in found} <= {"ok", "warning", "wrong"}
    assert found[-1]["check"] == "clients"


def test_a_hub_that_goes_meanwhile_is_a_finding(
    hub: HubThread, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def version(url: str) -> Finding:
        hub.stop()
        return Finding("version", "ok", "the last that was heard")

    monkeypatch.setattr("fibws.cli.doctor.hub.version", version)
    result = run("doctor")
    assert result.exit_code == 1
    assert "✗ wrong    hub          The hub at" in result.output


def test_signs_are_ascii_where_others_cannot_be_shown(hub: HubThread) -> None:
    result = CliRunner(charset="ascii").invoke(command, ["doctor", "--hub", hub.url])
    assert "+ ok       hub" in result.output


def test_long_texts_stand_beside_each_other_on_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "50")
    monkeypatch.setattr("fibws.cli.output.is_terminal", lambda: True)
    monkeypatch.setattr("fibws.cli.output.has_colours", lambda: False)
    doctor.tell(Finding("ends", "warning", "word " * 9, "advice"))
    assert capsys.readouterr().out == (
        "! warning  ends         word word word word word\n"
        "                        word word word word\n"
        "                        advice\n"
    )


def test_a_finding_is_one_line_in_a_pipe(capsys: pytest.CaptureFixture[str]) -> None:
    doctor.tell(Finding("version", "wrong", "two\nlines\x1b[2J" + " word" * 30, ""))
    out = capsys.readouterr().out
    assert out.count("\n") == 1
    assert "\x1b" not in out


def test_its_help_names_every_check(run: Run) -> None:
    text = run("doctor", "--help").output
    for line in run("doctor").output.splitlines():
        if line[0] != " ":
            assert f"  {line[11:22].rstrip()} " in text
    assert "  definitions " in text


def test_a_list_is_cut() -> None:
    assert listed(["/a", "/b"]) == "/a, /b"
    assert listed(["/a", "/b", "/c"], 2) == "/a, /b and 1 more"
