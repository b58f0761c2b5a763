"""``fibws workspace``: what catkin_init_workspace and catkin_make are."""

from __future__ import annotations

import os
import re
from itertools import takewhile
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

import click

from fibws.cli.arguments import spread
from fibws.cli.common_options import SETTINGS, examples
from fibws.cli.output import counted, visible
from fibws.errors import WorkspaceError

if TYPE_CHECKING:
    from fibws.ros1.workspace.build import Plan, Workspace
    from fibws.ros1.workspace.source import Source

RULE = "~" * 50
KINDS = {"msg": "message", "srv": "service", "action": "action"}
_JOBS = re.compile(r"-[jl]\d*(\.\d+)?|--jobs(=\d+)?|--load-average(=[\d.]+)?|-k")
_MANY = {"--pkg", "--only-pkg-with-deps"}
_OTHERS = ("--cmake-args", "--make-args")
_WHITELIST = "-DCATKIN_WHITELIST_PACKAGES="
_SPACES = re.compile(r"--(source|build)(=.*)?|-DCATKIN_DEVEL_PREFIX=.*")


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
    """Begin and build workspaces of packages, as catkin does."""


@command.command("init")
@click.argument("folder", type=click.Path(path_type=Path), default=".")
def init(folder: Path) -> None:
    """Mark FOLDER, the src/ of a workspace, or else this one, as catkin_init_workspace does."""
    from fibws.ros1.workspace import place

    path = place.initialize(Path(os.path.normpath(place.here() / folder)))
    click.echo(f"Created file {visible(str(path))}")
    if path.parent.name != place.SOURCE:
        click.echo("Note: catkin_make looks for packages in src/, and this folder is not called so")


class _Make(click.Command):
    """Takes catkin_make's options, some of which take all words up to the next option."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ours = takewhile(lambda word: word not in _OTHERS, args)
        return super().parse_args(ctx, _plain(spread(ours, _MANY)))


@command.command("make", cls=_Make)
@click.option(
    "-C",
    "--directory",
    "folder",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    default=".",
    help="The workspace, if it is not this folder.",
)
@click.option(
    "--pkg",
    "packages",
    metavar="PACKAGE...",
    multiple=True,
    help="Build these packages alone.",
)
@click.option(
    "--only-pkg-with-deps",
    "with_depends",
    metavar="PACKAGE...",
    multiple=True,
    help="Build these packages alone, and those in the workspace that they depend on.",
)
@click.option("--force-cmake", is_flag=True, hidden=True)
@click.option("--no-color", is_flag=True, help="Print without colours.")
@click.argument("targets", metavar="[clean]", nargs=-1)
@click.pass_context
@examples(
    "{workspace make} && source devel/setup.bash",
    ("{workspace make} clean", "remove build products"),
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
    """Build the workspace that this folder is, as catkin_make does.

    It checks the packages in src/, compiles their messages, services and actions, and writes
    devel/, which has the files to be sourced. What is written in C++ is not built. Options for
    CMake and make (-D, -j, --cmake-args ...) are read past.
    """
    from fibws.ros1.workspace import place
    from fibws.ros1.workspace.build import Workspace
    from fibws.ros1.workspace.recipe import FILE as LISTS

    if no_color:
        context.color = False
    _check_targets(targets)
    base = Path(os.path.normpath(place.here() / folder))
    place.check(base)
    workspace = Workspace(base)
    if "clean" in targets:
        workspace.clean()
        click.echo(f"Took out of {visible(str(workspace.devel))} what was built")
        return
    _print_spaces(workspace)
    if not os.path.lexists(workspace.source / LISTS):
        click.echo(f"Created file {visible(str(place.initialize(workspace.source)))}")
    plan = workspace.plan([*packages, *with_depends], with_depends=bool(with_depends))
    _print_packages(plan)
    workspace.make(plan)
    # From here the files are best told by the paths that an editor can be given.
    prefix = f"{base}{os.sep}" if base == place.here() else "\0"
    for warning in plan.warnings:
        text = visible(warning.replace(prefix, ""))
        click.secho(f"Warning: {text}", fg="yellow", err=True)
    for fault in plan.faults:
        text = visible(str(fault).replace(prefix, ""))
        click.secho(f"Error: {text}", fg="red", err=True)
    if plan.faults:
        count = counted(len(plan.faults), "error")
        raise click.ClickException(f"nothing was built, because of {count}")
    for source in plan.built:
        click.echo(f"{source.name}: {_made(source)}")
    _print_next(workspace, plan)


def _plain(args: list[str]) -> list[str]:
    """The words without those for CMake and make."""
    plain: list[str] = []
    skip_number = False
    for word in args:
        if skip_number and re.fullmatch(r"[\d.]+", word):
            continue
        skip_number = word in ("-j", "-l", "--jobs", "--load-average")
        if _SPACES.fullmatch(word):
            raise WorkspaceError(f"{word}: the spaces of a workspace are src/ and devel/ here")
        if word.startswith(_WHITELIST):
            for name in word.removeprefix(_WHITELIST).split(";"):
                plain += ["--only-pkg-with-deps", name] if name else []
        elif not word.startswith(("-D", "-G", "--use-")) and not _JOBS.fullmatch(word):
            plain.append(word)
    return plain


def _check_targets(targets: tuple[str, ...]) -> None:
    for target in targets:
        if target in ("clean", "all") or target.startswith("VERBOSE="):
            continue
        if target == "install":
            text = "there is no install space here: devel/ has all of it. source devel/setup.bash"
            raise WorkspaceError(text)
        if target in ("test", "tests", "run_tests"):
            raise WorkspaceError(f"{target}: run the tests of packages by python3 -m pytest src")
        raise WorkspaceError(f"there is no target {target}; there is clean")


def _print_spaces(workspace: Workspace) -> None:
    for what, path in (
        ("Base path", workspace.folder),
        ("Source space", workspace.source),
        ("Build space", workspace.build),
        ("Devel space", workspace.devel),
    ):
        click.echo(f"{what}: {visible(str(path))}")


def _print_packages(plan: Plan) -> None:
    if not plan.sources:
        return
    count = counted(len(plan.built), "package")
    click.echo(RULE)
    click.echo(f"~~  traversing {count} in topological order:")
    for source in plan.built:
        click.echo(f"~~  - {source.name}")
    click.echo(RULE)


def _print_next(workspace: Workspace, plan: Plan) -> None:
    """Say what to type now."""
    from fibws.ros1.workspace import place
    from fibws.ros1.workspace.packages import PATH

    inside = workspace.folder == place.here()
    if not plan.sources and not plan.faults:
        where = "src" if inside else str(workspace.source)
        click.echo(
            f"There is no package yet; to begin one: cd {quote(where)} && "
            f"catkin_create_pkg NAME std_msgs rospy"
        )
    if str(workspace.source) in os.environ.get(PATH, "").split(os.pathsep):
        click.echo("Done; this shell has the workspace already.")
        return
    devel = Path(place.DEVEL) if inside else workspace.devel
    click.echo(f"Next: {place.sourcing(devel)}")


def _made(source: Source) -> str:
    recipe = source.recipe
    parts = [
        counted(len(files), KINDS[kind]) for kind, files in recipe.definitions.items() if files
    ]
    parts += [visible(each.path.name) for each in recipe.programs]
    parts += ["Python modules"] if recipe.python_setup is not None else []
    return ", ".join(parts) or "nothing to build"
