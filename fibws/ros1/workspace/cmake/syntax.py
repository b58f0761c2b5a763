"""Reads the syntax of CMake's language: commands and their arguments, not what they mean.

The grammar is that of the manual, https://cmake.org/cmake/help/latest/manual/cmake-language.7.html.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from fibws.errors import PackageFileError

_BLANK = re.compile(r"[ \t\r\n]+")
_COMMENT = re.compile(r"#(?!\[=*\[)[^\n]*")
_BRACKET = re.compile(r"#?\[(?P<marks>=*)\[\n?(?P<text>.*?)\](?P=marks)\]", re.DOTALL)
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_QUOTED = re.compile(r'"((?:[^"\\]|\\.)*)"', re.DOTALL)
_UNQUOTED = re.compile(r"""(?:[^\s()#"\\]|\\.|(?<=[^\s(])"[^"\s]*")+""", re.DOTALL)


@dataclass(frozen=True)
class Argument:
    """One argument as it is written, without its quotes.

    Attributes:
        text: with ``${}`` and backslashes as they stand there.
        line: the number of its line.
        quoted: whether it stands in quotes, so that it is one value even with ; in it.
        literal: whether it stands in brackets, so that nothing in it means anything.
    """

    text: str
    line: int
    quoted: bool = False
    literal: bool = False


@dataclass(frozen=True)
class Command:
    """One command, its name in lower case, since CMake does not tell the cases apart."""

    name: str
    arguments: tuple[Argument, ...]
    line: int


def read_commands(path: Path) -> list[Command]:
    """The commands of a CMakeLists.txt, in their order.

    Raises:
        PackageFileError: the text is none of CMake's language.
        OSError: it cannot be read.
    """
    return _Text(path.read_text("utf-8-sig", errors="replace"), str(path)).commands()


class _Text:
    """A text, and how far it has been read."""

    def __init__(self, text: str, source: str) -> None:
        self._text = text
        self._source = source
        self._at = 0
        self._counted = 0
        self._line = 1

    def commands(self) -> list[Command]:
        commands = []
        self._skip()
        while self._at < len(self._text):
            commands.append(self._command())
            self._skip()
        return commands

    def _command(self) -> Command:
        line = self.line
        name = _NAME.match(self._text, self._at)
        if name is None:
            if self._text[self._at] == ")":
                raise self._fault(
                    "this ) ends nothing: is there a # before the ( that it belongs to?"
                )
            shown = self._text[self._at : self._at + 20].split("\n")[0]
            raise self._fault(f"a command is expected, as in project(name), not {shown!r}")
        self._at = name.end()
        while self._text[self._at : self._at + 1] in (" ", "\t"):
            self._at += 1
        if self._text[self._at : self._at + 1] != "(":
            raise self._fault(f"( is missing behind {name[0]}")
        self._at += 1
        return Command(name[0].lower(), tuple(self._arguments(name[0], line)), line)

    def _arguments(self, name: str, line: int) -> list[Argument]:
        arguments: list[Argument] = []
        depth = 1
        while True:
            self._skip()
            if self._at >= len(self._text):
                raise PackageFileError(self._source, line, f"the ) that ends {name}( is missing")
            mark = self._text[self._at]
            if mark in "()":
                depth += 1 if mark == "(" else -1
                self._at += 1
                if not depth:
                    return arguments
                arguments.append(Argument(mark, self.line))
            else:
                arguments.append(self._argument())

    def _argument(self) -> Argument:
        line = self.line
        if found := _BRACKET.match(self._text, self._at):
            self._at = found.end()
            return Argument(found["text"], line, quoted=True, literal=True)
        if self._text[self._at] == '"':
            found = _QUOTED.match(self._text, self._at)
            if found is None:
                raise self._fault('the " that ends a text is missing')
            self._at = found.end()
            return Argument(found[1].replace("\\\n", ""), line, quoted=True)
        found = _UNQUOTED.match(self._text, self._at)
        if found is None:
            raise self._fault(f"{self._text[self._at]!r} cannot stand here")
        self._at = found.end()
        return Argument(found[0], line)

    def _skip(self) -> None:
        """Go on to what is neither a blank nor a comment."""
        while True:
            found = _BLANK.match(self._text, self._at) or _COMMENT.match(self._text, self._at)
            if found is None and self._text.startswith("#", self._at):
                found = _BRACKET.match(self._text, self._at)
                if found is None:
                    raise self._fault("the end of this comment is missing")
            if found is None:
                return
            self._at = found.end()

    @property
    def line(self) -> int:
        """The number of the line that was reached."""
        self._line += self._text.count("\n", self._counted, self._at)
        self._counted = self._at
        return self._line

    def _fault(self, fault: str) -> PackageFileError:
        return PackageFileError(self._source, self.line, fault)


def split(text: str) -> list[str]:
    """The elements of a list, which ; separates."""
    return [part.replace("\\;", ";") for part in re.split(r"(?<!\\);", text) if part]
