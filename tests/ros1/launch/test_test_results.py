"""Results of tests: names of files, JUnit's XML, and the summary."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

from fibws.ros1.launch import test_results
from fibws.ros1.launch.test_results import Case, Outcome, Results

TWO_SUITES = """<testsuites>
  <testsuite tests="2" errors="1" failures="0" time="0.1">
    <testcase classname="A" name="test_a"/>
    <testcase name="test_b"><error message="lost"/></testcase>
    <testsuite><testcase name="inner"/></testsuite>
  </testsuite>
  <testsuite tests="1" failures="1">
    <testcase name="test_c"><failure>
1 != 2
</failure></testcase>
  </testsuite>
</testsuites>"""


def test_results_are_in_the_folder_of_the_environment() -> None:
    assert test_results.results_folder({"ROS_TEST_RESULTS_DIR": "/r"}) == Path("/r")
    assert test_results.results_folder({"ROS_HOME": "/h"}) == Path("/h/test_results")


def test_files_are_named_as_by_rostest() -> None:
    folder = Path("results")
    assert test_results.results_file(folder, "robot", "a b/c") == folder / "robot/rosunit-a_b_c.xml"
    own = test_results.results_file(folder, "robot", "test_talk", is_rostest=True)
    assert own == folder / "robot/rostest-test_talk.xml"


def test_name_of_a_file_is_its_path_in_the_package(tmp_path: Path) -> None:
    assert test_results.file_results_name(tmp_path, tmp_path / "test/talk.er.test") == (
        "test_talk.er"
    )
    assert test_results.file_results_name(tmp_path, Path("other/talk.test")) == "other_talk"


def test_all_suites_of_a_file_are_read(tmp_path: Path) -> None:
    file = tmp_path / "robot" / "rosunit-moves.xml"
    file.parent.mkdir()
    file.write_text(TWO_SUITES)
    results = test_results.read_results(file)
    assert (results.tests, results.errors, results.failures) == (3, 1, 1)
    assert not results.are_good
    assert results.cases == [
        Case("robot.rosunit-moves/test_a"),
        Case("robot.rosunit-moves/test_b", (("error", "lost"),)),
        Case("robot.rosunit-moves/inner"),
        Case("robot.rosunit-moves/test_c", (("failure", "1 != 2"),)),
    ]


@pytest.mark.parametrize("text", ["", "no XML", "<testsuite tests='many'/>"])
def test_invalid_file_is_an_error(tmp_path: Path, text: str) -> None:
    file = tmp_path / "x.xml"
    file.write_text(text)
    with pytest.raises(ValueError):
        test_results.read_results(file)


def test_characters_that_xml_does_not_allow_are_replaced(tmp_path: Path) -> None:
    file = tmp_path / "x.xml"
    file.write_bytes(b"<testsuite tests='1'><testcase name='a\x1bb'/></testsuite>")
    [case] = test_results.read_results(file).cases
    assert case.name.endswith("/a?b")
    outcome = Outcome("moves", "error", "bad \x1b", 1.5, ["line \x00"])
    suite = ElementTree.fromstring(test_results.xml("robot", [outcome]))
    assert suite.findtext("testcase/error") == "bad ?"
    assert suite.findtext("system-out") == "line ?"
    assert (suite.get("errors"), suite.get("time")) == ("1", "1.500")


def test_results_in_the_summary_have_colours() -> None:
    good = Outcome("a", results=Results(1, cases=[Case("a/x")]))
    assert (" * RESULT: SUCCESS", "green") in test_results.summary([good])
    bad = Outcome("b", "failure", "why")
    lines = list(test_results.summary([good, bad]))
    for line in ((" * RESULT: FAIL", "red"), (" * FAILURES: 1", "red"), (" * ERRORS: 0", None)):
        assert line in lines


@pytest.mark.parametrize(
    ("outcomes", "code"),
    [
        ([], 0),
        ([Outcome("a")], 0),
        ([Outcome("a"), Outcome("b", results=Results(1, 0, 1))], 2),
        ([Outcome("a", "error"), Outcome("b", results=Results(1, 1, 0))], 1),
    ],
)
def test_exit_code_says_whether_tests_ran_and_passed(outcomes: list[Outcome], code: int) -> None:
    assert test_results.exit_code(outcomes) == code
