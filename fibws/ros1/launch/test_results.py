"""Results of a launch file's tests: JUnit's XML, and the summary of rostest.

The names of files and the texts are those of rostest 1.16 and rosunit 1.15.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

from fibws.ros1.launch.node_command import ros_home

_NOT_IN_FILE_NAMES = re.compile(r"""[ "'&$!`/\\]""")
_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_WIDTH = 80


@dataclass(frozen=True)
class Case:
    """The result of one test case in the file that a test wrote.

    Attributes:
        name: ``package.file/test_case``.
        faults: ``failure`` or ``error``, and the text of each.
    """

    name: str
    faults: tuple[tuple[str, str], ...] = ()


@dataclass
class Results:
    """The content of the file that a test wrote."""

    tests: int = 0
    errors: int = 0
    failures: int = 0
    skipped: int = 0
    cases: list[Case] = field(default_factory=list)

    @property
    def are_good(self) -> bool:
        """Whether all tests passed."""
        return not self.errors and not self.failures

    def __str__(self) -> str:
        """The numbers, as catkin_test_results prints them."""
        return (
            f"{self.tests} tests, {self.errors} errors, {self.failures} failures, "
            f"{self.skipped} skipped"
        )


@dataclass
class Outcome:
    """The outcome of one <test>.

    Attributes:
        test: its ``test-name``.
        fault: ``failure`` or ``error`` if it did not run to its end; else empty.
        text: the reason.
        seconds: how long it took.
        output: the printed lines of the launch and the test.
        results: the results of its test cases.
    """

    test: str
    fault: str = ""
    text: str = ""
    seconds: float = 0.0
    output: list[str] = field(default_factory=list)
    results: Results = field(default_factory=Results)

    @property
    def name(self) -> str:
        """Its name in rostest's own results."""
        return f"test{self.test}"


def results_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder for results, $ROS_TEST_RESULTS_DIR or test_results in $ROS_HOME."""
    found = environment.get("ROS_TEST_RESULTS_DIR")
    return Path(found) if found else ros_home(environment) / "test_results"


def results_file(folder: Path, package: str, test: str, *, is_rostest: bool = False) -> Path:
    """Return the file for the results of a test, or for those of rostest itself."""
    prefix = "rostest" if is_rostest else "rosunit"
    return folder / package / f"{prefix}-{_NOT_IN_FILE_NAMES.sub('_', test)}.xml"


def file_results_name(package_folder: Path, file: Path) -> str:
    """Return the name of a launch file's results: ``test_talker`` for test/talker.test."""
    path, folder = file.absolute(), package_folder.absolute()
    inside = path.relative_to(folder) if path.is_relative_to(folder) else file
    return "_".join(part for part in inside.with_suffix("").parts if part != inside.anchor)


def read_results(file: Path) -> Results:
    """Read the file that a test wrote, of one or more suites.

    Raises:
        ValueError: it is not XML, or a number is invalid.
        OSError: it cannot be read.
    """
    try:
        root = ElementTree.fromstring(_printable(file.read_text("utf-8", errors="replace")))
    except ElementTree.ParseError as error:
        raise ValueError(f"invalid XML: {error}") from None
    if root.tag not in ("testsuite", "testsuites"):
        raise ValueError(f"expected <testsuite> or <testsuites>, got <{root.tag}>")
    results = Results()
    suites = [root] if root.tag == "testsuite" else root.findall("testsuite")
    for suite in suites:
        results.tests += int(suite.get("tests", 0))
        results.errors += int(suite.get("errors", 0))
        results.failures += int(suite.get("failures", 0))
        results.skipped += sum(int(suite.get(key, 0)) for key in ("skip", "skipped", "disabled"))
        for case in suite.iter("testcase"):
            name = f"{file.parent.name}.{file.stem}/{case.get('name', 'unknown')}"
            faults = tuple(
                (each.tag, (each.text or "").strip() or each.get("message", ""))
                for each in case
                if each.tag in ("failure", "error")
            )
            results.cases.append(Case(name, faults))
    return results


def read_all_results(folder: Path) -> dict[Path, Results]:
    """Return the results in all files below a folder, sorted by their paths.

    Other XML files are ignored.
    """
    found = {}
    for file in sorted(folder.rglob("*.xml")):
        with suppress(ValueError, OSError):
            found[file] = read_results(file)
    return found


def total(all_results: Iterable[Results]) -> Results:
    """Return the sums of results, without cases."""
    found = list(all_results)
    numbers = ("tests", "errors", "failures", "skipped")
    return Results(**{name: sum(getattr(each, name) for each in found) for name in numbers})


def xml(name: str, outcomes: Sequence[Outcome]) -> str:
    """Return the results of rostest itself: which tests ran to their end."""
    suite = ElementTree.Element(
        "testsuite",
        name=name,
        tests=str(len(outcomes)),
        errors=str(sum(each.fault == "error" for each in outcomes)),
        failures=str(sum(each.fault == "failure" for each in outcomes)),
        time=f"{sum(each.seconds for each in outcomes):.3f}",
    )
    for each in outcomes:
        time = f"{each.seconds:.4f}"
        case = ElementTree.SubElement(
            suite, "testcase", classname="rostest.runner.RosTest", name=each.name, time=time
        )
        if each.fault:
            ElementTree.SubElement(case, each.fault, type="").text = _printable(each.text)
    lines = [line for each in outcomes for line in each.output]
    ElementTree.SubElement(suite, "system-out").text = _printable("\n".join(lines))
    ElementTree.SubElement(suite, "system-err")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{ElementTree.tostring(suite, "unicode")}\n'


def summary(outcomes: Sequence[Outcome]) -> Iterator[tuple[str, str | None]]:
    """Yield the lines of rostest's summary, each with the name of its colour or None."""
    results = [each.results for each in outcomes]
    failed = [each.name for each in outcomes if each.fault == "failure"]
    errors = sum(each.errors for each in results)
    errors += sum(each.fault == "error" for each in outcomes)
    failures = sum(each.failures for each in results) + len(failed)
    lines = [f"[ROSTEST]{'-' * (_WIDTH - len('[ROSTEST]'))}", ""]
    lines += [line for each in results for case in each.cases for line in description(case)]
    lines += [f"[{name}][failed]" for name in failed]
    yield from ((line, None) for line in [*lines, "", "SUMMARY"])
    if errors or failures:
        yield " * RESULT: FAIL", "red"
    else:
        yield " * RESULT: SUCCESS", "green"
    yield f" * TESTS: {sum(each.tests for each in results)}", None
    yield f" * ERRORS: {errors}", "red" if errors else None
    yield f" * FAILURES: {failures}", "red" if failures else None
    if failed:
        yield "", None
        yield "ERROR: The following tests failed to run:", None
        yield from ((f" * {name}", None) for name in failed)
    yield "", None


def exit_code(outcomes: Iterable[Outcome]) -> int:
    """Return rostest's exit code: 1 if a test did not run, 2 if a test case failed, else 0."""
    outcomes = list(outcomes)
    if any(each.fault for each in outcomes):
        return 1
    return 0 if all(each.results.are_good for each in outcomes) else 2


def description(case: Case) -> Iterator[str]:
    """Yield the lines about one test case: that it passed, or its failures and errors."""
    if not case.faults:
        yield f"[{case.name}][passed]"
    for kind, text in case.faults:
        yield f"[{case.name}][{kind.upper()}]".ljust(_WIDTH, "-")
        yield from (text, "-" * _WIDTH, "")


def _printable(text: str) -> str:
    return _NOT_IN_XML.sub("?", text)
