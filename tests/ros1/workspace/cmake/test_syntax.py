"""The syntax of CMake's language."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fibws.errors import PackageFileError
from fibws.ros1.workspace.cmake.syntax import Command, read_commands


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "CMakeLists.txt"


def shapes(commands: list[Command]) -> list[tuple[str, ...]]:
    return [(each.name, *(argument.text for argument in each.arguments)) for each in commands]


@pytest.mark.parametrize(
    ("text", "commands"),
    [
        ("project(a)", [("project", "a")]),
        ("PROJECT (a b)\n", [("project", "a", "b")]),
        ("a() b()", [("a",), ("b",)]),
        ("a( # comment ) \n b\n)", [("a", "b")]),
        ("# a()\n", []),
        ("#[[ a()\n]] b()", [("b",)]),
        ("#[==[ ]] ]==] b()", [("b",)]),
        ('a("b c" "d#e" "")', [("a", "b c", "d#e", "")]),
        ('a("b \\" c")', [("a", 'b \\" c')]),
        ('a("b\\\nc")', [("a", "bc")]),
        ('a("b\nc")', [("a", "b\nc")]),
        ("a([[b ${c} ]] [=[]]]=])", [("a", "b ${c} ", "]]")]),
        ("if(NOT (a AND b))", [("if", "NOT", "(", "a", "AND", "b", ")")]),
        ("a(b\\ c d\\;e)", [("a", "b\\ c", "d\\;e")]),
        ("a(-DX=${Y}/z.py)", [("a", "-DX=${Y}/z.py")]),
        ("\ufeffa()", [("a",)]),
        ("a(\r\n  b\r\n)\r\n", [("a", "b")]),
    ],
)
def test_commands_are_read(file: Path, text: str, commands: list[tuple[str, ...]]) -> None:
    file.write_text(text, encoding="utf-8", newline="")
    assert shapes(read_commands(file)) == commands


def test_commands_and_arguments_know_their_lines(file: Path) -> None:
    file.write_text("# one\na(\n  b\n  # c\n  d)\n\ne()")
    first, second = read_commands(file)
    assert (first.line, [each.line for each in first.arguments], second.line) == (2, [3, 5], 7)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("a()\nb(\nc\n", r"line 2: the \) that ends b\( is missing"),
        ("a()\n)", r"line 2: this \) ends nothing: is there a # before the \( that it belongs to"),
        ("a()\n1", r"line 2: a command is expected, as in project\(name\), not '1'"),
        ("a\nb()", r"line 1: \( is missing behind a"),
        ('a(\n"b\n)', 'line 2: the " that ends a text is missing'),
        ("#[[ a", "line 1: the end of this comment is missing"),
        ("a(\\", r"line 1: '\\\\' cannot stand here"),
    ],
)
def test_what_is_no_cmake_is_told_with_its_line(file: Path, text: str, fault: str) -> None:
    file.write_text(text)
    with pytest.raises(PackageFileError, match=fault):
        read_commands(file)


@given(st.text('ab(){}$"\\#[]=; \n', max_size=60))
@example('a("b"c)')
def test_any_text_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    file = tmp_path_factory.getbasetemp() / "any.txt"
    file.write_text(text)
    try:
        read_commands(file)
    except PackageFileError as error:
        assert 1 <= error.line <= text.count("\n") + 1
