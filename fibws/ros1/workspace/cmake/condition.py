"""The conditions of CMake's ``if()``, as far as recipes of packages use them."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Mapping

from fibws.ros1.workspace.cmake.syntax import split

_FALSE = {"", "0", "OFF", "NO", "FALSE", "N", "IGNORE", "NOTFOUND"}
_TRUE = {"1", "ON", "YES", "TRUE", "Y"}
_DEEPEST = 20
_LONGEST = 256
"""Characters of a pattern, and of what it is tried on."""
_SLOW = re.compile(r"\)[*+{]|(?:[*+{].*){4}", re.DOTALL)
"""Patterns that Python may take for ever to try."""


def holds(
    words: list[str],
    variables: Mapping[str, str],
    targets: Collection[str] = (),
    commands: Collection[str] = (),
) -> bool:
    """Whether a condition is met; one that is not understood is not.

    Args:
        words: the arguments of ``if()``.
        variables: what they stand for.
        targets: the targets that there are.
        commands: the functions and macros that there are, in lower case.
    """
    if sum(word in ("(", "NOT") for word in words) > _DEEPEST:
        return False
    return _Condition([*words], variables, targets, commands).holds()


class _Condition:
    """The words of an ``if()``."""

    def __init__(
        self,
        words: list[str],
        variables: Mapping[str, str],
        targets: Collection[str],
        commands: Collection[str],
    ) -> None:
        self._words = words
        self._variables = variables
        self._targets = targets
        self._commands = commands

    def holds(self) -> bool:
        value = self._both()
        while self._take("OR"):
            value = self._both() or value
        return value and not self._words

    def _both(self) -> bool:
        value = self._one()
        while self._take("AND"):
            value = self._one() and value
        return value

    def _one(self) -> bool:
        if self._take("NOT"):
            return not self._one()
        if self._take("("):
            value = self._both()
            while self._take("OR"):
                value = self._both() or value
            self._take(")")
            return value
        if self._take("DEFINED"):
            return self._next() in self._variables
        if self._take("TARGET"):
            return self._next() in self._targets
        if self._take("EXISTS"):
            return os.path.exists(self._next())
        if self._take("IS_DIRECTORY"):
            return os.path.isdir(self._next())
        if self._take("COMMAND"):
            return self._next().lower() in self._commands
        left = self._next()
        for operator in ("STREQUAL", "EQUAL", "VERSION_EQUAL"):
            if self._take(operator):
                return self._text(left) == self._text(self._next())
        for operator, wanted in (("LESS", {-1}), ("GREATER", {1})):
            for suffix, others in (("", set[int]()), ("_EQUAL", {0})):
                for prefix in ("", "VERSION_"):
                    if self._take(f"{prefix}{operator}{suffix}"):
                        return self._compare(left, self._next()) in wanted | others
        if self._take("IN_LIST"):
            return self._text(left) in split(self._variables.get(self._next(), ""))
        if self._take("MATCHES"):
            return _matches(self._next(), self._text(left))
        return self._truth(left)

    def _compare(self, left: str, right: str) -> int:
        parts = [[_number(part) for part in self._text(each).split(".")] for each in (left, right)]
        return (parts[0] > parts[1]) - (parts[0] < parts[1])

    def _text(self, word: str) -> str:
        return self._variables.get(word, word)

    def _next(self) -> str:
        return self._words.pop(0) if self._words else ""

    def _take(self, word: str) -> bool:
        if self._words[:1] == [word]:
            self._words.pop(0)
            return True
        return False

    def _truth(self, text: str) -> bool:
        """What a word is worth as a condition: a constant, or a variable that is set to one."""
        upper = text.upper()
        if upper in _TRUE or re.fullmatch(r"-?[0-9.]*[1-9][0-9.]*", text):
            return True
        if upper in _FALSE or upper.endswith("-NOTFOUND"):
            return False
        value = self._variables.get(text, "").upper()
        return value not in _FALSE and not value.endswith("-NOTFOUND")


def _number(text: str) -> int:
    is_number = text.isascii() and text.isdecimal() and len(text) <= _LONGEST
    return int(text) if is_number else 0


def _matches(pattern: str, text: str) -> bool:
    if len(text) > _LONGEST or len(pattern) > _LONGEST or _SLOW.search(pattern):
        return False
    try:
        return re.search(pattern, text) is not None
    except re.error:
        return False
