"""The results of tests: as text, and as JUnit's XML."""

from __future__ import annotations

import re
import traceback
import unittest
from time import monotonic
from types import TracebackType
from typing import Any, NamedTuple, TypeAlias
from xml.etree import ElementTree

Fault: TypeAlias = (
    tuple[type[BaseException], BaseException, TracebackType] | tuple[None, None, None]
)
"""The type of `sys.exc_info`."""

_UNPRINTABLE = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML does not allow."""


class Case(NamedTuple):
    """The result of one test."""

    test: unittest.TestCase
    seconds: float
    kind: str
    """``failure`` or ``error``; empty if the test passed."""
    type: str
    text: str
    """The error and its traceback."""

    @property
    def name(self) -> str:
        """The test's name."""
        return self.test.id().rpartition(".")[2]


class Report(unittest.TestResult):
    """Collects the results of tests."""

    def __init__(self) -> None:
        super().__init__()
        self.cases: list[Case] = []
        self._begun = monotonic()
        self._fault: tuple[str, Fault] | None = None

    def startTest(self, test: unittest.TestCase) -> None:
        """Note the start of a test."""
        super().startTest(test)
        self._begun = monotonic()
        self._fault = None

    def addError(self, test: Any, err: Fault) -> None:
        """Note an error in a test, or in the set-up of its class."""
        super().addError(test, err)
        self._fault = ("error", err)
        if not isinstance(test, unittest.TestCase):
            self._add(test)

    def addFailure(self, test: unittest.TestCase, err: Fault) -> None:
        """Note a failed assertion."""
        super().addFailure(test, err)
        self._fault = ("failure", err)

    def addSubTest(
        self, test: unittest.TestCase, subtest: unittest.TestCase, err: Fault | None
    ) -> None:
        """Note the result of a part of a test."""
        super().addSubTest(test, subtest, err)
        if err is not None and err[0] is not None:
            failed = issubclass(err[0], test.failureException)
            self._fault = ("failure" if failed else "error", err)

    def stopTest(self, test: unittest.TestCase) -> None:
        """Note the end of a test."""
        super().stopTest(test)
        self._add(test)

    def print(self) -> None:
        """Print a line for each test, and the errors of those that failed."""
        for case in self.cases:
            if not case.kind:
                print(f"[Testcase: {case.name}] ... ok")
                continue
            word = "FAILURE" if case.kind == "failure" else "ERROR"
            print(f"[Testcase: {case.name}] ... {word}!")
            print(f"{word}: {case.text}", end="")
            print("-" * 80)

    def xml(self, name: str, out: str, err: str) -> str:
        """Return the results as JUnit's XML.

        Args:
            name: the name of the suite.
            out: the tests' standard output.
            err: the tests' standard error.
        """
        suite = ElementTree.Element(
            "testsuite",
            name=name,
            tests=str(self.testsRun),
            errors=str(len(self.errors)),
            failures=str(len(self.failures)),
            time=f"{sum(case.seconds for case in self.cases):.3f}",
        )
        for case in self.cases:
            class_ = type(case.test)
            element = ElementTree.SubElement(
                suite,
                "testcase",
                classname=f"{class_.__module__}.{class_.__qualname__}",
                name=case.name,
                time=f"{case.seconds:.4f}",
            )
            if case.kind:
                fault = ElementTree.SubElement(element, case.kind, type=case.type)
                fault.text = _printable(case.text)
        for tag, text in (("system-out", out), ("system-err", err)):
            ElementTree.SubElement(suite, tag).text = _printable(text)
        body = ElementTree.tostring(suite, encoding="unicode")
        return f'<?xml version="1.0" encoding="utf-8"?>\n{body}\n'

    def _add(self, test: Any) -> None:
        kind, type_, text = "", "", ""
        if self._fault is not None:
            kind, (class_, error, where) = self._fault
            type_ = class_.__name__ if class_ is not None else ""
            text = f"{error}\n{''.join(traceback.format_tb(where))}"
        self.cases.append(Case(test, monotonic() - self._begun, kind, type_, text))


def _printable(text: str) -> str:
    return _UNPRINTABLE.sub(lambda found: f"&#x{ord(found[0]):04X};", text)
