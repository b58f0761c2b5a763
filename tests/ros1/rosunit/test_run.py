"""Tests that a script ends with."""

from __future__ import annotations

import unittest
from pathlib import Path
from xml.etree import ElementTree

import pytest
import rosunit


class Good(unittest.TestCase):
    __test__ = False  # It is not pytest that runs it.

    def test_it(self) -> None:
        print("printed")


class Bad(unittest.TestCase):
    __test__ = False  # It is not pytest that runs it.

    def test_it(self) -> None:
        self.fail("bad")


def test_summary_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    rosunit.unitrun("package", "name", Good, sysargs=[])
    assert capsys.readouterr().out.splitlines() == [
        "[Testcase: test_it] ... ok",
        "-" * 61,
        "SUMMARY:",
        "\033[32m * RESULT: SUCCESS\033[0m",
        " * TESTS: 1",
        " * ERRORS: 0 []",
        " * FAILURES: 0 []",
        "",
    ]


def test_failure_exits_with_code_1(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        rosunit.unitrun("package", "name", Bad, sysargs=[])
    assert ended.value.code == 1
    out = capsys.readouterr().out
    assert " * RESULT: FAIL\n" in out
    assert " * FAILURES: 1 [test_it]\n" in out


def test_tests_are_found_by_name(capsys: pytest.CaptureFixture[str]) -> None:
    result = rosunit.run("package", "name", f"{__name__}.Good.test_it", sysargs=[])
    assert (result.testsRun, result.wasSuccessful()) == (1, True)


def test_test_instance_is_accepted(capsys: pytest.CaptureFixture[str]) -> None:
    assert rosunit.run("package", "name", Good("test_it"), sysargs=[]).testsRun == 1


def test_text_option_prints_the_output_of_tests(capsys: pytest.CaptureFixture[str]) -> None:
    rosunit.unitrun("package", "name", Good, sysargs=["script.py", "--text"])
    assert "printed\n" in capsys.readouterr().out


def test_results_are_written_to_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "results" / "good.xml"
    rosunit.unitrun("package", "name", Good, sysargs=[f"--gtest_output=xml:{path}"])
    out = capsys.readouterr().out
    assert out.startswith(f"[ROSUNIT] Outputting test results to {path}\n")
    assert "printed\n" not in out
    assert ElementTree.parse(path).getroot().findtext("system-out") == "printed\n"
