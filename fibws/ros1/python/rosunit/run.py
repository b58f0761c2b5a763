"""Runs tests with the options of the command line, and prints their results."""

from __future__ import annotations

import io
import sys
import unittest
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

from rosunit.report import Report

XML_OUTPUT_FLAG = "--gtest_output=xml:"
"""The option for the file of the results, which follows it."""


class XMLTestRunner:
    """Runs tests, and captures their output.

    Args:
        name: the name of the suite.
        file: for the results and the captured output, as JUnit's XML.
    """

    def __init__(self, name: str, file: Path | None = None) -> None:
        self._name = name
        self._file = file

    def run(self, test: unittest.TestSuite | unittest.TestCase) -> Report:
        """Run tests, and print their results."""
        if self._file is not None:
            self._file.parent.mkdir(parents=True, exist_ok=True)
            print(f"[ROSUNIT] Outputting test results to {self._file}")
        report, out, err = Report(), io.StringIO(), io.StringIO()
        with redirect_stdout(out), redirect_stderr(err):
            test(report)
        if self._file is not None:
            xml = report.xml(self._name, out.getvalue(), err.getvalue())
            self._file.write_text(xml, encoding="utf-8")
        report.print()
        return report


def create_xml_runner(
    test_pkg: str, test_name: str, results_file: str | None = None, is_rostest: bool = False
) -> XMLTestRunner:
    """Return a runner for a script's tests; without a file it only prints the results."""
    return XMLTestRunner(f"{test_pkg}.{test_name}", Path(results_file) if results_file else None)


def run(
    package: str, test_name: str, test: Any, sysargs: Sequence[str] | None = None
) -> unittest.TestResult:
    """Run a script's tests, and print a summary.

    Args:
        package: the script's package.
        test_name: the name of the tests.
        test: a class of tests, or the name of one.
        sysargs: the command line: ``--text`` prints the tests' own output,
            ``--gtest_output=xml:FILE`` writes the results to a file.
    """
    arguments = sys.argv if sysargs is None else sysargs
    file = None
    for argument in arguments:
        if argument.startswith(XML_OUTPUT_FLAG):
            file = argument.removeprefix(XML_OUTPUT_FLAG)
    loader = unittest.TestLoader()
    suite = (
        loader.loadTestsFromName(test)
        if isinstance(test, str)
        else loader.loadTestsFromTestCase(test if isinstance(test, type) else type(test))
    )
    result: unittest.TestResult
    if "--text" in arguments:
        result = unittest.TextTestRunner(verbosity=2).run(suite)
    else:
        result = create_xml_runner(package, test_name, file).run(suite)
    print_unittest_summary(result)
    return result


def unitrun(
    package: str,
    test_name: str,
    test: Any,
    sysargs: Sequence[str] | None = None,
    coverage_packages: object = None,
) -> None:
    """Run a script's tests as `run` does, and exit with code 1 if a test failed.

    Args:
        coverage_packages: has no effect.
    """
    if not run(package, test_name, test, sysargs).wasSuccessful():
        sys.exit(1)


def print_unittest_summary(result: unittest.TestResult) -> None:
    """Print the number of tests, and which failed."""
    word = "\033[32m * RESULT: SUCCESS\033[0m" if result.wasSuccessful() else " * RESULT: FAIL"
    print("-" * 61, "SUMMARY:", word, f" * TESTS: {result.testsRun}", sep="\n")
    print(f" * ERRORS: {len(result.errors)} [{_names(result.errors)}]")
    print(f" * FAILURES: {len(result.failures)} [{_names(result.failures)}]\n", flush=True)


def _names(faults: list[tuple[unittest.TestCase, str]]) -> str:
    return ", ".join(test.id().rpartition(".")[2] for test, _ in faults)
