"""``fibws pkg``: catkin_create_pkg and rospack."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fibws import __version__
from fibws.cli import output
from fibws.cli.arguments import spread
from fibws.cli.common_options import SETTINGS, examples
from fibws.command_names import command_name
from fibws.errors import FibwsError
from fibws.ros1.errors import WorkspaceError
from fibws.suggestions import nearest, suggestion_or_known

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from fibws.ros1.workspace.packages import Package, Packages

_MANY = {"-s", "--sys-deps", "-b", "--boost-comps"}


@click.group(context_settings=SETTINGS)
def command() -> None:
    """Create packages, as catkin_create_pkg does, and find them, as rospack does.

    Packages are found in the folders of $ROS_PACKAGE_PATH, which `source devel/setup.bash` sets in
    a workspace.
    """


class _Create(click.Command):
    """A command whose options may take several words, as those of catkin_create_pkg."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        return super().parse_args(ctx, spread(args, _MANY))


@command.command("create", cls=_Create)
@click.argument("name")
@click.argument("depends", metavar="[PACKAGE]...", nargs=-1)
@click.option(
    "--with", "extras", metavar="LIST", help="Create folders with examples: launch,msg,srv ..."
)
@click.option("--meta", is_flag=True, help="Create a metapackage, which only groups others.")
@click.option(
    "-s",
    "--sys-deps",
    "system",
    metavar="NAME...",
    multiple=True,
    help="System libraries that it depends on.",
)
@click.option(
    "-b",
    "--boost-comps",
    "boost",
    metavar="NAME...",
    multiple=True,
    help="Parts of Boost that it depends on.",
)
@click.option("-V", "--pkg_version", "version", default="0.0.0", show_default=True, help="Version.")
@click.option("-D", "--description", default="", help="Description, in one sentence.")
@click.option("-l", "--license", "licenses", multiple=True, help="License, as in BSD.")
@click.option("-a", "--author", "authors", multiple=True, help="'Jane Doe <jane@example.com>'")
@click.option("-m", "--maintainer", "maintainers", multiple=True, help="Maintainer, as --author.")
@click.option("--rosdistro", hidden=True)
@examples(
    "cd ros_workspace/src",
    "{pkg create} fibonacci std_msgs rospy",
    "{pkg create} fibonacci std_msgs rospy --with launch,msg",
)
def create(
    name: str,
    depends: tuple[str, ...],
    extras: str | None,
    meta: bool,
    system: tuple[str, ...],
    boost: tuple[str, ...],
    version: str,
    description: str,
    licenses: tuple[str, ...],
    authors: tuple[str, ...],
    maintainers: tuple[str, ...],
    rosdistro: str | None,
) -> None:
    """Create a package in this folder, as catkin_create_pkg does.

    The further arguments are the packages that it depends on.
    """
    from fibws.ros1.workspace.new_package import NewPackage
    from fibws.ros1.workspace.paths import current_folder

    package = NewPackage(
        name,
        list(dict.fromkeys(depends)),
        list(system),
        list(boost),
        version,
        description,
        list(licenses),
        list(authors),
        list(maintainers),
        _extras(extras),
        meta,
    )
    here = current_folder()
    for created in package.create(here):
        click.echo(f"Created {created}")
    where = output.visible(str(here / name))
    click.echo(f"Successfully created files in {where}. Please adjust the values in package.xml.")
    _warn(name, depends, here)


def _extras(text: str | None) -> list[str]:
    from fibws.ros1.workspace.new_package import EXTRAS

    found = [each.strip() for each in (text or "").split(",") if each.strip()]
    for each in found:
        if each not in EXTRAS:
            raise click.BadParameter(f"unknown folder {each!r}{suggestion_or_known(each, EXTRAS)}")
    return found


def _warn(name: str, depends: Iterable[str], here: Path) -> None:
    """Warn of likely mistakes that catkin_create_pkg lets pass."""
    from fibws.ros1.workspace import paths
    from fibws.ros1.workspace.package_xml import CONVENTIONAL_NAME
    from fibws.ros1.workspace.packages import Packages
    from fibws.ros1.workspace.packages_outside_fibws import NOT_NEEDED, REPOSITORIES

    warnings = []
    if not CONVENTIONAL_NAME.fullmatch(name):
        warnings.append(f"by convention, package names are in lower case: {name}")
    workspace = paths.workspace_around(here)
    if workspace is not None and not here.resolve().is_relative_to(workspace / paths.SOURCE):
        make = command_name("workspace make")
        warnings.append(f"{make} looks only in src/: mv {name} {workspace / paths.SOURCE}")
    known = {*Packages.from_environment(workspace).names(), *NOT_NEEDED}
    for each in depends:
        if each not in known | REPOSITORIES.keys() and (near := nearest(each, known)):
            warnings.append(f"package {each} not found; did you mean {near}?")
    for warning in warnings:
        click.secho(f"Warning: {output.visible(warning)}", fg="yellow", err=True)


def _complete(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    from click.shell_completion import CompletionItem

    try:
        names = _packages().names()
    except (FibwsError, OSError):
        return []
    return [CompletionItem(name) for name in names if name.startswith(incomplete)]


@command.command("list")
@click.option("-n", "--names", is_flag=True, help="Print only the names.")
def list_(names: bool) -> None:
    """Print the name and the folder of each package, as rospack list does."""
    for package in _packages():
        output.line(package.name if names else f"{package.name} {package.folder}")


@command.command("list-names", hidden=True)
def list_names() -> None:
    """Print the name of each package."""
    for package in _packages():
        output.line(package.name)


@command.command("list-provided", hidden=True)
def list_provided() -> None:
    """Print the packages that need not be installed, in one line, for bin/rosdep."""
    from fibws.ros1.workspace.packages_outside_fibws import NOT_NEEDED

    standard = (package.name for package in _packages() if package.is_standard)
    output.line(" ".join(sorted(NOT_NEEDED.union(standard))))


@command.command("find")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
def find(name: str | None) -> None:
    """Print the folder of PACKAGE (default: the package of this folder)."""
    output.line(str(_package(name, _packages()).folder))


@command.command("depends1")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
def depends1(name: str | None) -> None:
    """Print the packages that PACKAGE depends on directly."""
    for each in _package(name, _packages()).manifest.direct:
        output.line(each)


@command.command("depends")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
def depends(name: str | None) -> None:
    """Print the packages that PACKAGE depends on, directly or indirectly."""
    packages = _packages()
    for each in _below(_package(name, packages), packages):
        output.line(each)


@command.command("depends-on1")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
def depends_on1(name: str | None) -> None:
    """Print the packages that depend on PACKAGE directly."""
    packages = _packages()
    wanted = _package(name, packages).name
    for package in packages:
        if wanted in package.manifest.direct:
            output.line(package.name)


@command.command("depends-on")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
def depends_on(name: str | None) -> None:
    """Print the packages that depend on PACKAGE, directly or indirectly."""
    packages = _packages()
    wanted = _package(name, packages).name
    for package in packages:
        if wanted in _below(package, packages):
            output.line(package.name)


@command.command("version")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
@click.option("-d", "--distro", is_flag=True, help="Print the name of the ROS distribution.")
@click.option("-a", "--all", "all_", is_flag=True, help="Print the versions of all packages.")
@click.option("-s", "--skip-newline", is_flag=True, help="End the output without a newline.")
def version(name: str | None, distro: bool, all_: bool, skip_newline: bool) -> None:
    """Print the version of PACKAGE, as rosversion does.

    Packages that are part of fibws have the version of fibws.
    """
    if (name is not None) + distro + all_ != 1:
        raise click.UsageError("Expected one of PACKAGE, --distro and --all.")
    if distro:
        from fibws.ros1.shell.environment import DISTRO

        lines = [os.environ.get("ROS_DISTRO") or DISTRO]
    elif name is not None:
        lines = [_version(_packages().find(name))]
    else:
        lines = [f"{package.name}: {_version_or_reason(package)}" for package in _packages()]
    click.echo(output.visible("\n".join(lines)), nl=not skip_newline)


@command.command("profile", hidden=True)
def profile() -> None:
    """Do nothing, as there is no cache to update; accepted for compatibility with rospack."""


def _packages() -> Packages:
    from fibws.ros1.workspace.packages import Packages

    return Packages.from_environment()


def _package(name: str | None, packages: Packages) -> Package:
    """Return the package of that name, or the one that this folder is in."""
    if name is not None:
        return packages.find(name)
    from fibws.ros1.workspace.package_xml import FILE, read_name

    here = Path.cwd()
    for folder in (here, *here.parents):
        if (folder / FILE).is_file():
            return packages.find(read_name(folder))
    raise WorkspaceError("missing package name, as this folder is not in a package")


def _version(package: Package) -> str:
    return __version__ if package.is_standard else package.manifest.version


def _version_or_reason(package: Package) -> str:
    try:
        return _version(package)
    except (FibwsError, OSError):
        return "<invalid package.xml>"


def _below(package: Package, packages: Packages) -> list[str]:
    """Return the packages that one depends on, each after its own dependencies."""
    found: dict[str, None] = {}
    begun = {package.name}

    def add(package: Package) -> None:
        for name in package.manifest.direct:
            if name not in begun:
                begun.add(name)
                # Others are libraries of the system, or not installed.
                if packages.has(name):
                    add(packages.find(name))
                found[name] = None

    add(package)
    return list(found)
