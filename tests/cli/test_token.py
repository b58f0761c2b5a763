"""``fibws token``: the file of tokens."""

from __future__ import annotations

import json
import stat
import tomllib
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from fibws.access.rights import RIGHTS
from fibws.access.token_file import Tokens
from fibws.cli.commands import command
from fibws.cli.token import HELP_OF_RIGHTS, _complete_names
from fibws.cli.token import command as token_command


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "tokens.toml"


@pytest.fixture
def token(file: Path) -> Callable[..., Result]:
    """Run ``fibws token`` with a file."""

    def run(*words: str) -> Result:
        return CliRunner().invoke(command, ["token", *words, "--file", str(file)])

    return run


def test_added_token_is_printed_alone_and_found_in_the_file(
    token: Callable[..., Result], file: Path
) -> None:
    words = ["--publish", "/cmd_vel", "--publish", "/lights", "--subscribe", "/**"]
    result = token("add", "teleop", *words, "--deny-subscribe", "/private/**")
    assert result.exit_code == 0, result.output
    [printed] = result.stdout.splitlines()
    found = Tokens.load(file).find(printed)
    assert found is not None and found.name == "teleop" and found.expires is None
    assert found.rights.allows("publish", "/lights") and found.rights.allows("subscribe", "/a/b")
    assert not found.rights.allows("subscribe", "/private/a")
    assert not found.rights.allows("publish", "/other") and not found.rights.admin
    assert printed not in file.read_text() and printed not in result.stderr
    assert stat.S_IMODE(file.stat().st_mode) == 0o600


@pytest.mark.parametrize("right", RIGHTS)
def test_each_right_has_an_option_and_one_that_denies_it(
    token: Callable[..., Result], file: Path, right: Any
) -> None:
    option = right.replace("_", "-")
    result = token("add", "a", f"--{option}", "/**", f"--deny-{option}", "/x/*")
    found = Tokens.load(file).find(result.stdout.strip())
    assert found is not None
    assert found.rights.allow == {right: ("/**",)} and found.rights.deny == {right: ("/x/*",)}


def test_options_are_those_of_all_rights() -> None:
    assert set(HELP_OF_RIGHTS) == set(RIGHTS)


def test_admin_needs_no_other_rights(token: Callable[..., Result], file: Path) -> None:
    token("add", "operator", "--admin")
    [principal] = Tokens.load(file).tokens.values()
    assert principal.rights.admin


@pytest.mark.parametrize(
    ("expires", "least", "most"),
    [
        ("30d", timedelta(days=29), timedelta(days=30)),
        ("12h", timedelta(hours=11), timedelta(hours=12)),
        ("90m", timedelta(minutes=88), timedelta(minutes=90)),
        ("2w", timedelta(days=13), timedelta(days=14)),
    ],
)
def test_token_expires_after_a_time(
    token: Callable[..., Result], file: Path, expires: str, least: timedelta, most: timedelta
) -> None:
    assert token("add", "a", "--admin", "--expires", expires).exit_code == 0
    [principal] = Tokens.load(file).tokens.values()
    assert principal.expires is not None
    assert least <= datetime.fromtimestamp(principal.expires, UTC) - datetime.now(UTC) <= most


@pytest.mark.parametrize(
    ("expires", "time"),
    [
        ("2999-01-31", "2999-01-31T00:00:00+00:00"),
        ("2999-01-31T12:30", "2999-01-31T12:30:00+00:00"),
        ("2999-01-31T12:30:00+02:00", "2999-01-31T10:30:00+00:00"),
    ],
)
def test_token_expires_at_a_date(
    token: Callable[..., Result], file: Path, expires: str, time: str
) -> None:
    token("add", "a", "--admin", "--expires", expires)
    [line] = token("list", "--json").stdout.splitlines()
    assert json.loads(line)["expires"] == time


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        (["--publish", "cmd_vel"], "--publish"),
        (["--admin", "--expires", "soon"], "30d"),
        (["--admin", "--expires", "999999w"], "30d"),
        (["--admin", "--expires", "2001-01-01"], "past"),
        (["--deny-publish", "/a"], "allow nothing"),
        ([], "allow nothing"),
    ],
)
def test_invalid_options_are_usage_errors(
    token: Callable[..., Result], file: Path, words: list[str], fault: str
) -> None:
    result = token("add", "a", *words)
    assert result.exit_code == 2 and fault in result.output
    assert not file.exists()


def test_name_can_be_taken_once(token: Callable[..., Result], file: Path) -> None:
    token("add", "a", "--admin")
    before = file.read_text()
    result = token("add", "a", "--admin")
    assert result.exit_code == 1 and "a already" in result.output and not result.stdout
    assert file.read_text() == before


def test_list_shows_names_and_rights_but_no_digests(
    token: Callable[..., Result], file: Path
) -> None:
    file.write_text(
        "[certificates.robot1]\nallow = {node = ['/robot1/**']}\n"
        "[anonymous]\nallow = {subscribe = ['/map']}\n"
    )
    token("add", "teleop", "--publish", "/cmd_vel", "--deny-publish", "/x", "--expires", "30d")
    token("add", "operator", "--admin")
    result = token("list")
    heads, *lines = result.stdout.splitlines()
    assert heads.split() == ["NAME", "KIND", "EXPIRES", "RIGHTS"]
    assert [line.split()[:2] for line in lines] == [
        ["teleop", "token"],
        ["operator", "token"],
        ["robot1", "certificate"],
        ["anonymous", "anonymous"],
    ]
    assert lines[0].endswith("publish /cmd_vel, not publish /x")
    assert lines[1].split()[2:] == ["never", "admin"]
    assert lines[3].endswith("subscribe /map")
    values = [json.loads(line) for line in token("list", "--json").stdout.splitlines()]
    assert values[1] == {"name": "operator", "kind": "token", "expires": None, "admin": True}
    assert values[2]["allow"] == {"node": ["/robot1/**"]}
    for each in tomllib.loads(file.read_text())["tokens"].values():
        assert each["sha256"] not in result.stdout


def test_expired_token_is_listed_as_expired(token: Callable[..., Result], file: Path) -> None:
    digest = "0" * 64
    file.write_text(f'[tokens.old]\nsha256 = "{digest}"\nexpires = 2001-01-01\nadmin = true\n')
    assert "2001-01-01 00:00 (expired)" in token("list").stdout


def test_revoked_token_is_gone_and_comments_stay(token: Callable[..., Result], file: Path) -> None:
    file.write_text("# The robots of the lab.\n")
    first = token("add", "first", "--admin").stdout.strip()
    second = token("add", "second", "--admin").stdout.strip()
    result = token("revoke", "first")
    assert result.exit_code == 0 and "SIGHUP" in result.stdout
    tokens = Tokens.load(file)
    assert tokens.find(first) is None and tokens.find(second) is not None
    assert "# The robots of the lab." in file.read_text()


def test_unknown_name_cannot_be_revoked(token: Callable[..., Result]) -> None:
    token("add", "teleop", "--admin")
    result = token("revoke", "telop")
    assert result.exit_code == 1 and "teleop" in result.output


def test_missing_file_cannot_be_listed(token: Callable[..., Result]) -> None:
    assert token("list").exit_code == 2


def test_invalid_file_is_reported(token: Callable[..., Result], file: Path) -> None:
    file.write_text("[tokens.a]\nsha256 = 'short'\n")
    for words in (["list"], ["add", "b", "--admin"], ["revoke", "a"]):
        result = token(*words)
        assert result.exit_code == 1 and str(file) in result.output


def test_environment_names_the_file(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_TOKENS", str(file))
    assert CliRunner().invoke(command, ["token", "add", "a", "--admin"]).exit_code == 0
    assert "a" in CliRunner().invoke(command, ["token", "list"]).stdout


def test_names_are_completed(token: Callable[..., Result], file: Path) -> None:
    token("add", "teleop", "--admin")
    token("add", "robot1", "--admin")
    revoke = token_command.commands["revoke"]
    context = revoke.make_context("revoke", ["x", "--file", str(file)])
    found = _complete_names(context, revoke.params[0], "te")
    assert [each.value for each in found] == ["teleop"]
