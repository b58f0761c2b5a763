"""The real genpy, to compare with."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import cast

import pytest
from genpy.classes import message_class
from recorded_answers import Answers, shortened

from fibws.msg import default_interfaces

from .world import World

HERE = Path(__file__).parent
PYTHON = "/usr/bin/python3"
OURS = World(message_class)
ADDED = re.compile(
    r" by zero$| and no __dict__ for setting new attributes$|(?<=')[\w.]+\.(?=\w+' object)"
)
"""What Python's own errors say since 3.13; Debian's Python may be an older one, or ours."""

PART = re.compile(r"^MSG: (\S+)$", re.MULTILINE)


class RealGenpy:
    """Debian's genpy, which evaluates expressions in a process of its own."""

    def __init__(self, folder: str) -> None:
        self._defined: set[str] = set()
        self._process = subprocess.Popen(
            [PYTHON, "-I", HERE / "world.py"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={"PATH": "/usr/bin:/bin", "HOME": folder, "TMPDIR": folder, "LANG": "C.UTF-8"},
        )
        assert self._process.stdin is not None and self._process.stdout is not None
        self._stdin, self._stdout = self._process.stdin, self._process.stdout

    def define(self, type_: str) -> None:
        """Let expressions use a type."""
        if type_ not in self._defined:
            text = default_interfaces().full_text(type_)
            self._stdin.write(f"{json.dumps(['define', type_, text])}\n")
            self._defined.update([type_, *PART.findall(text)])

    def say(self, expression: str) -> str:
        """Return what an expression is, as `World.say` does."""
        self._stdin.write(f"{json.dumps(['say', expression])}\n")
        self._stdin.flush()
        line = self._stdout.readline()
        assert line, "the real genpy has ended"
        return str(json.loads(line))

    def close(self) -> None:
        """End the process."""
        self._stdin.close()
        self._process.wait(60)
        self._stdout.close()


@pytest.fixture(scope="session")
def real_genpy() -> Iterator[RealGenpy]:
    """Debian's genpy, needed for recording only."""
    with tempfile.TemporaryDirectory() as home:
        genpy = RealGenpy(home)
        yield genpy
        genpy.close()


class Agree:
    """The answers of the real genpy beside ours.

    Types that expressions name besides ``std_msgs/Int32`` are to be given:
    ``agree("M('a/B')", "a/B")``.
    """

    def __init__(self, answers: Answers, genpy: Callable[[], RealGenpy]) -> None:
        self._answers = answers
        self._genpy = genpy

    def __call__(self, expression: str, *types: str) -> str:
        """Return what an expression is, after asserting that the real genpy says the same."""
        theirs = self._answers.of(expression, lambda: shortened(self._ask(expression, types)))
        ours = say(expression)
        assert shortened(ours) == theirs, expression
        return ours

    def on_all(self, about: str, expressions: list[str], *types: str) -> None:
        """Assert that the real genpy says the same of many expressions.

        Args:
            about: what they are about. Only a digest of each answer is recorded.
        """

        def ask() -> str:
            return " ".join(digest(self._ask(each, types)) for each in expressions)

        theirs = self._answers.of(about, ask).split()
        for expression, expected in zip(expressions, theirs, strict=True):
            assert digest(say(expression)) == expected, expression

    def _ask(self, expression: str, types: tuple[str, ...]) -> str:
        genpy = self._genpy()
        for type_ in types:
            genpy.define(type_)
        return ADDED.sub("", genpy.say(expression))


def say(expression: str) -> str:
    """Return what an expression is under fibws."""
    return ADDED.sub("", OURS.say(expression))


def digest(text: str) -> str:
    """Return a short digest of an answer."""
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:8]


@pytest.fixture
def agree(answers: Answers, request: pytest.FixtureRequest) -> Agree:
    """Asserts that ours and the real genpy agree."""
    return Agree(answers, lambda: cast(RealGenpy, request.getfixturevalue("real_genpy")))
