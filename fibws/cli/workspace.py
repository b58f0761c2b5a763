"""``fibws workspace``: catkin_init_workspace and catkin_make."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from itertools import takewhile
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

import click

from fibws.cli import output
from fibws.cli.arguments import spread
from fibws.cli.common_options import SETTINGS, examples
from fibws.cli.output import counted, visible
from fibws.command_names import command_name
from fibws.ros1.errors import WorkspaceError

if TYPE_CHECKING:
    from fibws.ros1.workspace.build import Plan, Workspace
    from fibws.ros1.workspace.source_tree import SourcePackage

RULE = "~" * 50
RESULTS = "build/test_results"
"""The folder in a workspace for the results of tests."""
RUN_TESTS = re.compile(r"(run_tests|test)(?P<package>(?<=run_tests)_.+)?")
"""The targets that run the tests of all packages, or of one: run_tests_PACKAGE."""
KINDS = {"msg": "message", "srv": "service", "action": "action"}
_JOBS = re.compile(r"-[jl]\d*(\.\d+)?|--jobs(=\d+)?|--load-average(=[\d.]+)?|-k")
_MANY = {"--pkg", "--only-pkg-with-deps"}
_OTHERS = ("--cmake-args", "--make-args")
_WHITELIST = "-DCATKIN_WHITELIST_PACKAGES="
_FOLDERS = re.compile(r"--(source|build)(=.*)?|-DCATKIN_DEVEL_PREFIX=.*")


@click.group(context_settings=SETTINGS)
@examples(
    "mkdir -p ros_workspace/src",
    "cd ros_workspace/src",
    "{workspace init}",
    "{pkg create} fibonacci std_msgs rospy",
    "cd ..",
    "{workspace make}",
    "source devel/setup.bash",
)
def command() -> None:
    """Create and build workspaces of packages, as catkin does."""


@command.command("init")
@click.argument("folder", type=click.Path(path_type=Path), default=".")
def init(folder: Path) -> None:
    """Mark FOLDER (default: this folder) as the src/ of a workspace."""
    from fibws.ros1.workspace import paths

    path = paths.initialize(Path(os.path.normpath(paths.current_folder() / folder)))
    click.echo(f"Created file {visible(str(path))}")
    if path.parent.name != paths.SOURCE:
        make = command_name("workspace make")
        click.echo(f"Note: {make} looks for packages in src/, and this is {path.parent.name}/")


class _Make(click.Command):
    """A command whose options may take several words, as those of catkin_make."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ours = list(takewhile(lambda word: word not in _OTHERS, args))
        tests = [word for word in args[len(ours) :] if RUN_TESTS.fullmatch(word)]
        return super().parse_args(ctx, [*_plain(spread(ours, _MANY)), *tests])


@command.command("make", cls=_Make)
@click.option(
    "-C",
    "--directory",
    "folder",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    default=".",
    help="The workspace (default: this folder).",
)
@click.option(
    "--pkg",
    "packages",
    metavar="PACKAGE...",
    multiple=True,
    help="Build only these packages.",
)
@click.option(
    "--only-pkg-with-deps",
    "with_depends",
    metavar="PACKAGE...",
    multiple=True,
    help="Build only these packages and their dependencies in the workspace.",
)
@click.option("--force-cmake", is_flag=True, hidden=True)
@click.option("--no-color", is_flag=True, help="Print without colours.")
@click.argument("targets", metavar="[clean|run_tests]", nargs=-1)
@click.pass_context
@examples(
    "{workspace make} && source devel/setup.bash",
    ("{workspace make} clean", "remove build products"),
    ("{workspace make} run_tests", "build, and run the tests"),
)
def make(
    context: click.Context,
    folder: Path,
    packages: tuple[str, ...],
    with_depends: tuple[str, ...],
    force_cmake: bool,
    no_color: bool,
    targets: tuple[str, ...],
) -> None:
    """Build the workspace in this folder, as catkin_make does.

    This checks the packages in src/, compiles their messages, services and actions, and writes
    devel/ with the files to source. A package with an error is left out, together with the packages
    that depend on it; the others are built. C++ is not built. The target run_tests also runs the
    tests of the packages, or of one: run_tests_PACKAGE. Options for CMake and make (-D, -j,
    --cmake-args ...) are ignored.
    """
    from fibws.ros1.workspace import paths
    from fibws.ros1.workspace.build import Workspace
    from fibws.ros1.workspace.cmake_lists import FILE as LISTS

    if no_color:
        context.color = False
    _check_targets(targets)
    base = Path(os.path.normpath(paths.current_folder() / folder))
    paths.check_workspace(base)
    workspace = Workspace(base)
    if "clean" in targets:
        workspace.clean()
        click.echo(f"Removed build products from {visible(str(workspace.devel))}")
        return
    _print_spaces(workspace)
    if not os.path.lexists(workspace.source / LISTS):
        click.echo(f"Created file {visible(str(paths.initialize(workspace.source)))}")
    plan = workspace.plan([*packages, *with_depends], with_depends=bool(with_depends))
    _print_packages(plan)
    workspace.make(plan)
    # Show paths relative to this folder, as editors take them.
    prefix = f"{base}{os.sep}" if base == paths.current_folder() else "\0"
    for warning in plan.warnings:
        text = visible(warning.replace(prefix, ""))
        click.secho(f"Warning: {text}", fg="yellow", err=True)
    for error in plan.errors:
        text = visible(str(error).replace(prefix, ""))
        click.secho(f"Error: {text}", fg="red", err=True)
    for package in plan.built:
        click.echo(f"{package.name}: {_summary(package)}")
    if plan.built or not plan.errors:
        _print_next(workspace, plan)
    if tests := [found for target in targets if (found := RUN_TESTS.fullmatch(target))]:
        _run_tests(workspace, plan, {found["package"][1:] for found in tests if found["package"]})
    if failed := [_failure(name, plan) for name in plan.failed if name in plan.chosen]:
        raise click.ClickException(f"not built: {', '.join(failed)}")


@command.command("test-results")
@click.argument("folder", type=click.Path(path_type=Path, exists=True), required=False)
@click.option("--all", "all_", is_flag=True, help="Print the files without failures, too.")
@click.option("--verbose", is_flag=True, help="Print the failures.")
def results(folder: Path | None, all_: bool, verbose: bool) -> None:
    """Print the results of tests in FOLDER, as catkin_test_results does.

    FOLDER is build/test_results if it exists, else this folder. The exit code is 1 if a test
    failed.
    """
    default = Path(RESULTS)
    sys.exit(_print_results(folder or (default if default.is_dir() else Path()), all_, verbose))


def _run_tests(workspace: Workspace, plan: Plan, names: set[str]) -> None:
    """Run the tests of the named packages, or of all that were built; exit with 1 if one failed."""
    from fibws.ros1.launch.test_results import Outcome, read_all_results, xml
    from fibws.ros1.workspace.package_tests import package_tests, test_variables

    chosen = [package for package in plan.built if not names or package.name in names]
    if unknown := names - {package.name for package in chosen}:
        raise WorkspaceError(f"run_tests: packages not built: {', '.join(sorted(unknown))}")
    folder = workspace.folder / RESULTS
    for package in chosen:
        for file in read_all_results(folder / package.name):
            file.unlink()
    variables = test_variables(workspace.source, workspace.devel, os.environ)
    failed = []
    for test in package_tests(chosen, folder):
        click.secho(f"~~  {test.package}: {test.title}", bold=True)
        test.results.parent.mkdir(parents=True, exist_ok=True)
        code = subprocess.run(test.command, env=variables, cwd=test.folder).returncode
        if code != 0:
            failed.append(f"{test.package}: {test.title}")
        if not test.results.exists():
            fault = "failure" if code else ""
            text = xml(test.results.stem, [Outcome("_ran", fault, f"exit code {code}")])
            test.results.write_text(text, "utf-8")
    skipped = [name for package in chosen for name in package.lists.cpp_tests]
    if skipped:
        text = f"fibws does not build C++: {counted(len(skipped), 'test')} left out: "
        click.secho(f"Warning: {text}{visible(', '.join(skipped))}", fg="yellow", err=True)
    _print_results(folder, False, False)
    if failed:
        raise click.ClickException(f"tests failed: {'; '.join(failed)}")


def _print_results(folder: Path, all_: bool, verbose: bool) -> int:
    """Print results, and return 1 if a test failed."""
    from fibws.ros1.launch.test_results import description, read_all_results, total

    found = read_all_results(folder)
    for file, each in found.items():
        if all_ or not each.are_good:
            output.line(f"{file.relative_to(folder)}: {each}")
        for case in each.cases if verbose else ():
            if case.faults:
                for line in description(case):
                    output.line(line)
    summary = total(found.values())
    output.line(f"Summary: {summary}")
    return 0 if summary.are_good else 1


def _plain(args: list[str]) -> list[str]:
    """Return the words without those for CMake and make."""
    plain: list[str] = []
    skip_number = False
    for word in args:
        if skip_number and re.fullmatch(r"[\d.]+", word):
            continue
        skip_number = word in ("-j", "-l", "--jobs", "--load-average")
        if _FOLDERS.fullmatch(word):
            raise WorkspaceError(f"{word}: the folders of a workspace must be src/ and devel/")
        if word.startswith(_WHITELIST):
            for name in word.removeprefix(_WHITELIST).split(";"):
                plain += ["--only-pkg-with-deps", name] if name else []
        elif not word.startswith(("-D", "-G", "--use-")) and not _JOBS.fullmatch(word):
            plain.append(word)
    return plain


def _check_targets(targets: tuple[str, ...]) -> None:
    for target in targets:
        if target in ("clean", "all", "tests") or target.startswith("VERBOSE="):
            continue
        if RUN_TESTS.fullmatch(target):
            continue
        if target == "install":
            text = "install: fibws has no install space; use devel/: source devel/setup.bash"
            raise WorkspaceError(text)
        raise WorkspaceError(f"unknown target {target}; the targets are clean and run_tests")


def _print_spaces(workspace: Workspace) -> None:
    for name, path in (
        ("Base path", workspace.folder),
        ("Source space", workspace.source),
        ("Build space", workspace.build),
        ("Devel space", workspace.devel),
    ):
        click.echo(f"{name}: {visible(str(path))}")


def _print_packages(plan: Plan) -> None:
    if not plan.packages:
        return
    count = counted(len(plan.built), "package")
    click.echo(RULE)
    click.echo(f"~~  traversing {count} in topological order:")
    for package in plan.built:
        click.echo(f"~~  - {package.name}")
    click.echo(RULE)


def _print_next(workspace: Workspace, plan: Plan) -> None:
    """Print what to type next."""
    from fibws.ros1.workspace import paths
    from fibws.ros1.workspace.packages import PATH

    inside = workspace.folder == paths.current_folder()
    if not plan.packages:
        where = "src" if inside else str(workspace.source)
        for manifest in sorted(workspace.folder.glob("*/package.xml")):
            beside = manifest.parent.name if inside else str(manifest.parent)
            click.echo(f"{beside} is not in src, so it is not built: mv {quote(beside)} {where}")
        create = f"{command_name('pkg create')} NAME std_msgs rospy"
        click.echo(f"There is no package yet; to create one: cd {quote(where)} && {create}")
    if str(workspace.source) in os.environ.get(PATH, "").split(os.pathsep):
        click.echo("Done; this shell has sourced the workspace already.")
        return
    devel = Path(paths.DEVEL) if inside else workspace.devel
    click.echo(f"Next: {paths.source_command(devel)}")


def _failure(name: str, plan: Plan) -> str:
    needed = plan.failed[name]
    return f"{name} (needs {', '.join(needed)})" if needed else name


def _summary(package: SourcePackage) -> str:
    lists = package.lists
    parts = [counted(len(files), KINDS[kind]) for kind, files in lists.definitions.items() if files]
    parts += [visible(each.path.name) for each in lists.programs]
    parts += [visible(each.path.name) for each in lists.reconfigure]
    parts += ["Python modules"] if lists.python_setup is not None else []
    return ", ".join(parts) or "nothing to build"
