"""Values as the words of a command line."""

from __future__ import annotations

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
def test_a_value_may_begin_with_a_minus(word: str) -> None:
    assert run(word).output == f"{[word]} False\n"


def test_options_stay_options() -> None:
    assert run("-5", "-v", "-6").output == "['-5', '-6'] True\n"


@pytest.mark.parametrize("word", ["-x", "--jsn", "-inf"])
def test_what_is_neither_is_said_to_be_no_option(word: str) -> None:
    result = run("1", word)
    assert result.exit_code == 2
    assert "No such option" in result.output
    assert word in result.output


@pytest.mark.parametrize(
    ("typed", "plain"),
    [
        ("x -s a b -v y", "x -s a -s b -v y"),
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
def test_an_option_of_many_words_stands_before_each(typed: str, plain: str) -> None:
    assert arguments.spread(typed.split(), {"-s", "-b"}) == plain.split()


@click.command(cls=arguments.DigitOptions)
@click.argument("values", nargs=-1)
@click.option("-1", "--once", "once", is_flag=True)
def once(values: tuple[str, ...], once: bool) -> None:
    click.echo(f"{list(values)} {once}")


@pytest.mark.parametrize("word", ["-5", "-15", "-1.5", "-.5", "-1e5"])
def test_where_options_are_digits_a_number_is_to_stand_behind_two_dashes(word: str) -> None:
    result = CliRunner().invoke(once, ["-1", word])
    assert result.exit_code == 2
    assert f"Error: {word} is taken for options: write -- before the values" in result.output
    assert CliRunner().invoke(once, ["-1", "--", word]).output == f"{[word]} True\n"


@pytest.mark.parametrize("arguments", [["-1", "-z"], ["-z", "--", "-5"], ["-z5"]])
def test_what_is_no_number_is_no_option_there_either(arguments: list[str]) -> None:
    result = CliRunner().invoke(once, arguments)
    assert result.exit_code == 2
    assert "No such option" in result.output
