"""Results of tests."""

from __future__ import annotations

import unittest
from xml.etree import ElementTree

import pytest
from rosunit import Report


class Some(unittest.TestCase):
    __test__ = False  # It is not pytest that runs it.

    def test_good(self) -> None:
        pass

    def test_bad(self) -> None:
        self.fail("bad <\x00>")

    def test_broken(self) -> None:
        raise ValueError("broken")

    def test_parts(self) -> None:
        for number in (1, 2):
            with self.subTest(number=number):
                self.assertEqual(number, 1)


class Unprepared(unittest.TestCase):
    __test__ = False  # It is not pytest that runs it.

    @classmethod
    def setUpClass(cls) -> None:
        raise ValueError("not prepared")

    def test_nothing(self) -> None:
        pass


def report_of(case: type[unittest.TestCase]) -> Report:
    report = Report()
    unittest.TestLoader().loadTestsFromTestCase(case)(report)
    return report


def test_each_test_has_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    report_of(Some).print()
    lines = [line for line in capsys.readouterr().out.splitlines() if not line.startswith("  ")]
    assert lines == [
        *("[Testcase: test_bad] ... FAILURE!", "FAILURE: bad <\x00>", "-" * 80),
        *("[Testcase: test_broken] ... ERROR!", "ERROR: broken", "-" * 80),
        "[Testcase: test_good] ... ok",
        *("[Testcase: test_parts] ... FAILURE!", "FAILURE: 2 != 1", "-" * 80),
    ]


def test_error_in_class_set_up_is_reported(capsys: pytest.CaptureFixture[str]) -> None:
    report = report_of(Unprepared)
    report.print()
    out = capsys.readouterr().out
    assert "ERROR!\nERROR: not prepared" in out
    assert not report.wasSuccessful()


def test_results_are_junit_xml() -> None:
    root = ElementTree.fromstring(report_of(Some).xml("package.name", "out\x07", "err").encode())
    assert root.attrib["name"] == "package.name"
    assert [root.attrib[name] for name in ("tests", "errors", "failures")] == ["4", "1", "2"]
    cases = {case.attrib["name"]: case for case in root.iter("testcase")}
    assert cases["test_good"].attrib["classname"].endswith("Some")
    assert len(cases["test_good"]) == 0
    (failure,) = cases["test_bad"]
    assert (failure.tag, failure.attrib["type"]) == ("failure", "AssertionError")
    assert str(failure.text).startswith("bad <&#x0000;>\n  File")
    assert cases["test_broken"][0].attrib["type"] == "ValueError"
    assert [root.findtext("system-out"), root.findtext("system-err")] == ["out&#x0007;", "err"]
