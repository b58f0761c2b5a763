"""What tools print: for a person's terminal, and for programs."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Callable
from math import inf, nan
from typing import TypeAlias

import click
import pytest

from fibws.cli import output

HOSTILE = "\x1b]0;owned\x07\x9b31m red\r\x08\x7f \u202ereversed"


def test_plural_of_a_noun() -> None:
    assert [output.counted(number, "node") for number in range(3)] == [
        "0 nodes",
        "1 node",
        "2 nodes",
    ]


class Stream(io.TextIOWrapper):
    """Standard output as a terminal or a pipe of some encoding."""

    def __init__(self, encoding: str, *, is_terminal: bool) -> None:
        self.bytes = io.BytesIO()
        super().__init__(self.bytes, encoding=encoding, newline="\n")
        self._is_terminal = is_terminal

    def isatty(self) -> bool:
        return self._is_terminal

    def text(self) -> str:
        self.flush()
        return self.bytes.getvalue().decode(self.encoding)


Stdout: TypeAlias = Callable[..., Stream]


@pytest.fixture
def stdout(monkeypatch: pytest.MonkeyPatch) -> Stdout:
    """Takes the place of standard output, which pytest replaces for the test itself."""

    def stdout(encoding: str = "utf-8", *, is_terminal: bool = False) -> Stream:
        stream = Stream(encoding, is_terminal=is_terminal)
        monkeypatch.setattr(sys, "stdout", stream)
        monkeypatch.setenv("TERM", "xterm")
        return stream

    return stdout


def test_infinity_in_json_is_a_number_and_nan_is_null(stdout: Stdout) -> None:
    pipe = stdout()
    output.as_json({"NaN": [inf, -inf, nan, -0.0, 2**63], "x": 'say "Infinity", \\" NaN'})
    line = pipe.text()
    text = r'"say \"Infinity\", \\\" NaN"'
    assert line == f'{{"NaN":[1e999,-1e999,null,-0.0,9223372036854775808],"x":{text}}}\n'
    assert json.loads(line)["NaN"] == [inf, -inf, None, 0, 2**63]


@pytest.mark.parametrize("is_terminal", [True, False])
def test_control_characters_are_escaped(stdout: Stdout, is_terminal: bool) -> None:
    stream = stdout(is_terminal=is_terminal)
    output.line(HOSTILE)
    shown = r"\x1b]0;owned\x07\x9b31m red\r\x08\x7f \u202ereversed"
    assert stream.text() == f"{shown}\n"


def test_lines_and_tabs_are_kept_on_a_terminal(stdout: Stdout) -> None:
    terminal = stdout(is_terminal=True)
    output.line("average rate: 1.000\n\tmin: 1.000s é 中")
    assert terminal.text() == "average rate: 1.000\n\tmin: 1.000s é 中\n"


@pytest.mark.parametrize("text", ["a \ud800 b", "\U0001f600"])
def test_characters_missing_in_the_encoding_are_escaped(text: str, stdout: Stdout) -> None:
    ascii_pipe = stdout("ascii")
    output.line(text)
    assert ascii_pipe.text() == text.encode("ascii", "backslashreplace").decode() + "\n"


def test_lone_surrogate_is_printed_escaped(stdout: Stdout) -> None:
    pipe = stdout()
    output.line("a \ud800 b")
    assert pipe.text() == "a \\ud800 b\n"


def test_colours_on_a_terminal(stdout: Stdout) -> None:
    terminal = stdout(is_terminal=True)
    output.line("a", colour="red", bold=True)
    output.line("b", colour="green")
    assert terminal.text() == "\x1b[31m\x1b[1ma\x1b[0m\n\x1b[32mb\x1b[0m\n"


def test_no_colours_in_a_pipe(stdout: Stdout) -> None:
    pipe = stdout()
    output.line("a", colour="red", bold=True)
    assert pipe.text() == "a\n"


def test_no_colour_disables_colours(stdout: Stdout) -> None:
    terminal = stdout(is_terminal=True)
    context = click.Context(click.Command("fibws"))
    context.color = False
    with context, click.Context(click.Command("log"), parent=context):
        output.line("a", colour="red")
    assert terminal.text() == "a\n"


def test_no_control_sequences_on_a_dumb_terminal(
    stdout: Stdout, monkeypatch: pytest.MonkeyPatch
) -> None:
    terminal = stdout(is_terminal=True)
    assert output.has_control_sequences()
    monkeypatch.setenv("TERM", "dumb")
    assert not output.has_control_sequences()
    output.line("a", colour="red", bold=True)
    assert terminal.text() == "a\n"


def test_json_is_one_line_of_equal_meaning(stdout: Stdout) -> None:
    terminal = stdout(is_terminal=True)
    output.as_json({"data": f"{HOSTILE}\n"})
    text = terminal.text()
    assert text.count("\n") == 1
    assert text[:-1].isprintable()
    assert json.loads(text) == {"data": f"{HOSTILE}\n"}


def test_json_keeps_letters_of_the_encoding(stdout: Stdout) -> None:
    pipe = stdout()
    output.as_json(["é", 1])
    assert pipe.text() == '["é",1]\n'


@pytest.mark.parametrize("text", ["\U0001f600", "\ud800"])
def test_json_is_valid_in_every_encoding(text: str, stdout: Stdout) -> None:
    ascii_pipe = stdout("ascii")
    output.as_json([text])
    assert json.loads(ascii_pipe.text()) == [text]


def test_names_are_sorted(stdout: Stdout) -> None:
    pipe = stdout()
    output.names(["/b", "/a"])
    output.names(["/b", "/a"], json_=True)
    assert pipe.text() == '/a\n/b\n"/a"\n"/b"\n'


@pytest.mark.parametrize(
    ("columns", "is_terminal", "lines"),
    [
        (12, True, ["NAME    N", "/robot  1"]),
        (8, True, ["NAME  /robot", "N     1", "", "NAME  /b", "N     22"]),
        (8, False, ["NAME    N", "/robot  1"]),
    ],
)
def test_narrow_terminal_gets_a_block_per_row(
    columns: int,
    is_terminal: bool,
    lines: list[str],
    stdout: Stdout,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stream = stdout(is_terminal=is_terminal)
    monkeypatch.setenv("COLUMNS", str(columns))
    output.table(("NAME", "N"), [("/robot", "1"), ("/b", "22")])
    assert stream.text().splitlines()[: len(lines)] == lines


def test_table_has_one_line_per_row(stdout: Stdout) -> None:
    pipe = stdout()
    output.table(("NAME", "N"), [("/a\n/forged", "1"), ("/b", "22")])
    assert pipe.text() == "NAME         N\n/a\\n/forged  1\n/b           22\n"


def test_can_show_depends_on_the_encoding(stdout: Stdout) -> None:
    stdout("ascii")
    assert output.can_show("a")
    assert not output.can_show("─")


def test_closed_output_is_ignored(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    output.line("lost", colour="red")
    output.as_json({"é": 1})
    assert not output.is_terminal()
