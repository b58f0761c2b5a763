"""The command line."""

from __future__ import annotations

import re

import pytest
from click.testing import CliRunner
from running_programs import Start

import fibws
from fibws import __main__
from fibws.cli.commands import COMMANDS, command
from fibws.cli.exit_handling import INTERRUPTED


def test_help_lists_all_commands() -> None:
    result = CliRunner().invoke(command, ["--help"])
    assert result.exit_code == 0
    for name, each in COMMANDS.items():
        assert re.search(rf"{name} +{each.help}", result.stdout)


def test_each_command_has_help() -> None:
    for name in COMMANDS:
        result = CliRunner().invoke(command, [name, "--help"])
        assert result.exit_code == 0, result.output


def test_help_of_a_command_is_shown_by_either_way() -> None:
    by_option = CliRunner().invoke(command, ["topic", "list", "--help"], prog_name="fibws")
    by_command = CliRunner().invoke(command, ["help", "topic", "list"], prog_name="fibws")
    assert (by_command.exit_code, by_command.stdout) == (0, by_option.stdout)
    assert CliRunner().invoke(command, ["help"]).stdout == CliRunner().invoke(command).output


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["topic", "lst"], "No such command 'lst'; did you mean list?"),
        (["topic", "list", "x"], "'fibws topic list' has no commands, such as 'x'"),
    ],
)
def test_help_of_an_unknown_command_is_an_error(words: list[str], text: str) -> None:
    result = CliRunner().invoke(command, ["help", *words], prog_name="fibws")
    assert result.exit_code == 2
    assert text in result.stderr


def test_options_of_the_connection_are_explained_once() -> None:
    options = ["--hub", "--ca", "--client-cert", "--client-key", "--token-file"]
    text = CliRunner().invoke(command, ["help", "connection"]).stdout
    assert [each for each in options if f"  {each} " in text] == options
    shown = CliRunner().invoke(command, ["topic", "list", "--help"]).stdout
    assert [each for each in options if each in shown] == ["--hub"]
    assert "fibws help connection" in shown


def test_unknown_command_is_an_error() -> None:
    result = CliRunner().invoke(command, ["demp"])
    assert result.exit_code == 2
    assert "No such command 'demp'" in result.stderr


def test_version() -> None:
    assert CliRunner().invoke(command, ["--version"]).stdout == f"fibws {fibws.__version__}\n"


async def test_package_is_a_program(start: Start) -> None:
    program = await start("fibws", "--help")
    code, out, err = await program.end()
    assert (code, err) == (0, "")
    assert "demo" in out


def test_ctrl_c_during_imports_ends_quietly(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(name: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(__main__, "import_module", interrupted)
    with pytest.raises(SystemExit) as ended:
        __main__.main()
    assert ended.value.code == INTERRUPTED
