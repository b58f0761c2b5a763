"""``fibws test``: run the tests of a launch file, as rostest does."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fibws import hub_address
from fibws.cli import output
from fibws.cli.common_options import SETTINGS, examples, hub_option
from fibws.cli.exit_handling import clean_exit, end_line
from fibws.cli.run import workspace_option
from fibws.credentials import Credentials
from fibws.errors import NoHub
from fibws.ros1.errors import WorkspaceError

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from fibws.ros1.launch.model import LaunchNode
    from fibws.ros1.launch.test_results import Outcome


def _complete(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Complete a package, then its test files; or else paths."""
    from click.shell_completion import CompletionItem

    from fibws.cli.launch import sources

    words = list(context.params.get("words") or ())
    found = sources.completions(words, incomplete, suffix=".test")
    return [CompletionItem(each) for each in found] or [CompletionItem(incomplete, type="file")]


@click.command(context_settings=SETTINGS)
@click.argument(
    "words", nargs=-1, metavar="[PACKAGE] FILE [ARG:=VALUE]...", shell_complete=_complete
)
@click.option("-t", "--text", is_flag=True, help="Show all output, and write no results of tests.")
@click.option("-r", "--reuse-master", is_flag=True, help="Use the running hub, not a new one.")
@click.option("-c", "--clear", is_flag=True, help="With --reuse-master, delete its parameters.")
@partial(
    hub_option,
    purpose="Address of the hub for --reuse-master",
)
@workspace_option
@click.option("--package", metavar="PACKAGE", help="Name of the package.  [default: FILE's]")
@click.option(
    "--pkgdir",
    "package_folder",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    help="Folder of the package.",
)
@click.option("--results-filename", metavar="NAME", help="Name of the file for the results.")
@click.option(
    "--results-base-dir",
    "results_folder",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    help="Folder for the results.  [default: $ROS_TEST_RESULTS_DIR, else ~/.ros/test_results]",
)
@examples(
    "{test} fibonacci fibonacci.test",
    ("{test} --text path/to/robot.test", "show the output of the tests"),
)
def command(
    words: tuple[str, ...],
    text: bool,
    reuse_master: bool,
    clear: bool,
    hub: str | None,
    workspace: Path | None,
    package: str | None,
    package_folder: Path | None,
    results_filename: str | None,
    results_folder: Path | None,
) -> None:
    """Run the tests of a launch file, as rostest does.

    For each <test> of FILE, a hub and the nodes of FILE are started on a free port, then the test's
    program. The results are written as JUnit's XML.

    The exit code is 0 if all tests passed, 1 if a test could not be run or took too long, 2 if a
    test case failed.
    """
    with clean_exit():
        if clear and not reuse_master:
            raise click.UsageError("--clear needs --reuse-master.")
        if hub is not None and not reuse_master:
            raise click.UsageError("--hub needs --reuse-master.")
        target = _Target(package, package_folder, results_filename, results_folder)
        sys.exit(_main(words, workspace, target, _hub(hub, reuse_master), text=text, clear=clear))


class _Target:
    """The package of the tests, and the files for their results.

    Args:
        package: the package's name; by default the one that has the test file.
        folder: its folder.
        name: the name of the file for rostest's own results.
        results_folder: the folder for results.
    """

    def __init__(
        self,
        package: str | None,
        folder: Path | None,
        name: str | None,
        results_folder: Path | None,
    ) -> None:
        from fibws.ros1.launch import test_results

        self.package = package or ""
        self._folder = folder
        self._name = name
        self._results_folder = results_folder or test_results.results_folder(os.environ)

    def find(self, file: Path) -> None:
        """Find the package of a test file, unless it is given."""
        from fibws.ros1.workspace.package_xml import FILE, read_name

        if self.package and self._folder is not None:
            return
        for folder in file.absolute().parents:
            if (folder / FILE).is_file():
                self.package, self._folder = self.package or read_name(folder), folder
                return
        if not self.package:
            raise WorkspaceError(f"{file} is not in a package; name one: --package PACKAGE")
        self._folder = file.absolute().parent

    def own_file(self, file: Path) -> Path:
        """Return the file for the results of rostest itself."""
        from fibws.ros1.launch.test_results import file_results_name, results_file

        name = Path(self._name).stem if self._name else None
        name = name or file_results_name(self._folder or Path.cwd(), file)
        return results_file(self._results_folder, self.package, name, is_rostest=True)

    def file_of(self, test: LaunchNode) -> Path:
        """Return the file for the results of one test."""
        from fibws.ros1.launch.test_results import results_file

        return results_file(self._results_folder, self.package, test.test_name)


def _hub(hub: str | None, reuse_master: bool) -> str | None:
    """Return the URL of the running hub to use, or None for a new one."""
    if not reuse_master:
        return None
    from fibws.client.hub_client import is_hub_running

    url = hub_address.hub_url(hub)
    Credentials.find(hub).set_in(os.environ)
    if not is_hub_running(url, "rostest"):
        raise NoHub(url, "nothing answers")
    return url


def _main(
    words: Sequence[str],
    workspace: Path | None,
    target: _Target,
    hub: str | None,
    *,
    text: bool,
    clear: bool,
) -> int:
    from fibws.cli.launch.sources import Sources
    from fibws.ros1.launch import test_results
    from fibws.ros1.launch.rostest_session import NEW_HUB, run_test
    from fibws.ros1.launch.session import LaunchConsole

    try:
        sources = Sources(words, workspace)
    except WorkspaceError as error:
        _report_missing_file(words, target, str(error))
        raise
    if len(sources.files) != 1:
        raise click.UsageError(f"Expected one test file, got {len(sources.files)}.")
    file = Path(sources.files[0])
    target.find(file)
    reader = sources.read()
    launch = reader.launch
    for warning in [*launch.warnings, *reader.unknown_values()]:
        click.echo(output.visible(f"WARNING: {warning}"), err=True)
    own_file = target.own_file(file)
    if not text:
        output.line(f"[ROSUNIT] Outputting test results to {own_file}")
    tests = [node for node in launch.nodes.values() if node.is_test]
    if not tests:
        click.echo(output.visible(f"WARNING: {file} has no <test>"), err=True)
    outcomes: list[Outcome] = []
    for test in tests:
        if any(each.test == test.test_name for each in outcomes):
            fault = f"Duplicate tests named [{test.test_name}] in rostest suite"
            outcome = test_results.Outcome(test.test_name, "failure", fault)
        else:
            outcome = run_test(
                test,
                launch,
                sources.packages,
                url=hub or NEW_HUB,
                file=target.file_of(test),
                text=text,
                clear=clear,
                console=LaunchConsole(output.line_as_is, output.has_colours(), end_line),
                report=output.line,
            )
        outcomes.append(outcome)
        _print_outcome(outcome)
    if not text:
        _write(own_file, test_results.xml(f"{target.package}.{own_file.stem}", outcomes))
    output.line()
    for line, colour in test_results.summary(outcomes):
        output.line(line, colour=colour)
    return test_results.exit_code(outcomes)


def _print_outcome(outcome: Outcome) -> None:
    if not outcome.fault:
        output.line(f"[Testcase: {outcome.name}] ... ok")
        return
    word = outcome.fault.upper()
    output.line(f"[Testcase: {outcome.name}] ... {word}!")
    output.line(f"{word}: {outcome.text}")
    output.line("-" * 80)


def _report_missing_file(words: Sequence[str], target: _Target, fault: str) -> None:
    """Write a failed test to the results if the package is given, as catkin's targets do."""
    from fibws.ros1.launch import test_results

    files = [word for word in words if ":=" not in word]
    if target.package and files:
        own_file = target.own_file(Path(files[-1]))
        outcome = test_results.Outcome("_ran", "failure", fault)
        _write(own_file, test_results.xml(own_file.stem, [outcome]))


def _write(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, "utf-8")
