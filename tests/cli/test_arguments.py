"""Reading a command line."""

from __future__ import annotations

import io
import sys
from typing import Any

import click
import pytest
from click.testing import CliRunner

from fibws.cli import arguments


@click.command(context_settings=arguments.VALUES)
@click.argument("values", nargs=-1, callback=arguments.check)
@click.option("-v", is_flag=True)
def command(values: tuple[str, ...], v: bool) -> None:
    click.echo(f"{list(values)} {v}")


def run(*arguments: str) -> Any:
    return CliRunner().invoke(command, arguments)


@pytest.mark.parametrize("word", ["-5", "-.5", "-1e5", "-1.5", "-.inf", "- 1", "-", "{a: -1}"])
def test_value_may_begin_with_a_minus(word: str) -> None:
    assert run(word).output == f"{[word]} False\n"


def test_options_stay_options() -> None:
    assert run("-5", "-v", "-6").output == "['-5', '-6'] True\n"


@pytest.mark.parametrize("word", ["-x", "--jsn", "-inf"])
def test_unknown_option_is_an_error(word: str) -> None:
    result = run("1", word)
    assert result.exit_code == 2
    assert "No such option" in result.output
    assert word in result.output


@pytest.mark.parametrize(
    ("typed", "plain"),
    [
        ("x -s a b -v y", "x -s a -s b -v y"),
        ("-s a __name:=n b", "-s a __name:=n -s b"),
        ("-s a -b c d", "-s a -b c -b d"),
        ("-s a -s b", "-s a -s b"),
        ("-s -v", "-v -s"),
        ("-s -v -s a", "-v -s a"),
        ("-s=a b", "-s=a b"),
        ("-s a -- -s b", "-s a -- -s b"),
        ("x -s --", "x -s"),
        ("-s -b -- x", "-s -b"),
    ],
)
def test_option_is_repeated_before_each_of_its_values(typed: str, plain: str) -> None:
    assert arguments.spread(typed.split(), {"-s", "-b"}) == plain.split()


@click.command(cls=arguments.DigitOptions)
@click.argument("values", nargs=-1)
@click.option("-1", "--once", "once", is_flag=True)
def once(values: tuple[str, ...], once: bool) -> None:
    click.echo(f"{list(values)} {once}")


@pytest.mark.parametrize("word", ["-5", "-15", "-1.5", "-.5", "-1e5"])
def test_negative_number_follows_two_dashes_if_options_are_digits(word: str) -> None:
    result = CliRunner().invoke(once, ["-1", word])
    assert result.exit_code == 2
    assert f"-- {word}" in result.output
    assert CliRunner().invoke(once, ["-1", "--", word]).output == f"{[word]} True\n"


@pytest.mark.parametrize("arguments", [["-1", "-z"], ["-z", "--", "-5"], ["-z5"]])
def test_unknown_option_is_an_error_if_options_are_digits(arguments: list[str]) -> None:
    result = CliRunner().invoke(once, arguments)
    assert result.exit_code == 2
    assert "No such option" in result.output


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_pipe_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    pipe = io.StringIO("5")
    monkeypatch.setattr(sys, "stdin", pipe)
    assert arguments.piped_input() is pipe
    assert not arguments.is_stdin_terminal()


def test_terminal_is_not_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", Terminal())
    assert arguments.piped_input() is None
    assert arguments.is_stdin_terminal()


def test_closed_input_is_not_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    assert arguments.piped_input() is None
    assert not arguments.is_stdin_terminal()
