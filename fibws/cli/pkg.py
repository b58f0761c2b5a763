"""``fibws pkg``: what catkin_create_pkg and rospack are."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fibws.cli import output
from fibws.cli.arguments import spread
from fibws.cli.common_options import SETTINGS, examples
from fibws.errors import FibwsError, WorkspaceError
from fibws.suggestions import nearest, suggestion

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from fibws.ros1.workspace.packages import Package, Packages

_MANY = {"-s", "--sys-deps", "-b", "--boost-comps"}


@click.group(context_settings=SETTINGS)
def command() -> None:
    """Make packages, as catkin_create_pkg does, and find them, as rospack does.

    Packages are looked for in the folders of $ROS_PACKAGE_PATH, which `source devel/setup.bash`
    sets in a workspace.
    """


class _Create(click.Command):
    """Takes catkin_create_pkg's options, some of which take all words up to the next option."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        return super().parse_args(ctx, spread(args, _MANY))


@command.command("create", cls=_Create)
@click.argument("name")
@click.argument("depends", metavar="[PACKAGE]...", nargs=-1)
@click.option(
    "--with", "extras", metavar="LIST", help="Folders with an example: launch,msg,srv ..."
)
@click.option("--meta", is_flag=True, help="A metapackage, which only names others.")
@click.option(
    "-s",
    "--sys-deps",
    "system",
    metavar="NAME...",
    multiple=True,
    help="What of the system it needs.",
)
@click.option(
    "-b",
    "--boost-comps",
    "boost",
    metavar="NAME...",
    multiple=True,
    help="Parts of Boost it needs.",
)
@click.option(
    "-V", "--pkg_version", "version", default="0.0.0", show_default=True, help="Its version."
)
@click.option("-D", "--description", default="", help="What it is, in a sentence.")
@click.option("-l", "--license", "licenses", multiple=True, help="Its licence, as in BSD.")
@click.option("-a", "--author", "authors", multiple=True, help="'Jane Doe <jane@example.com>'")
@click.option("-m", "--maintainer", "maintainers", multiple=True, help="As an author is written.")
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
    """Begin a package, here, that depends on others, as catkin_create_pkg does."""
    from fibws.ros1.workspace import place
    from fibws.ros1.workspace.skeleton import Skeleton

    skeleton = Skeleton(
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
    here = place.here()
    for made in skeleton.create(here):
        click.echo(f"Created {made}")
    where = output.visible(str(here / name))
    click.echo(f"Successfully created files in {where}. Please adjust the values in package.xml.")
    _warn(name, depends, here)


def _extras(text: str | None) -> list[str]:
    from fibws.ros1.workspace.skeleton import EXTRAS

    found = [each.strip() for each in (text or "").split(",") if each.strip()]
    for each in found:
        if each not in EXTRAS:
            known = f"there are {', '.join(EXTRAS)}"
            raise click.BadParameter(f"{each!r} is none{suggestion(each, EXTRAS) or f'; {known}'}")
    return found


def _warn(name: str, depends: Iterable[str], here: Path) -> None:
    """Say what is most likely a mistake, though catkin_create_pkg would not."""
    from fibws.ros1.workspace import place
    from fibws.ros1.workspace.elsewhere import ELSEWHERE, PROVIDED
    from fibws.ros1.workspace.manifest import BY_CONVENTION
    from fibws.ros1.workspace.packages import Packages

    warnings = []
    if not BY_CONVENTION.fullmatch(name):
        warnings.append(f"by convention a package's name is in lower case: {name}")
    workspace = place.around(here)
    if workspace is not None and not here.resolve().is_relative_to(workspace / place.SOURCE):
        warnings.append(f"catkin_make looks in src/ alone: mv {name} {workspace / place.SOURCE}")
    known = {*Packages.from_environment(workspace).names(), *PROVIDED}
    for each in depends:
        if each not in known | ELSEWHERE and (near := nearest(each, known)):
            warnings.append(f"there is no package {each} here; did you mean {near}?")
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
@click.option("-n", "--names", is_flag=True, help="Only the names.")
def list_(names: bool) -> None:
    """Print the name and the folder of each package, as rospack list does."""
    for package in _packages():
        output.line(package.name if names else f"{package.name} {package.folder}")


@command.command("list-names", hidden=True)
def list_names() -> None:
    """Print the name of each package."""
    for package in _packages():
        output.line(package.name)


@command.command("find")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
def find(name: str | None) -> None:
    """Print the folder of PACKAGE, or of the one that this folder is in."""
    output.line(str(_package(name, _packages()).folder))


@command.command("depends1")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
def depends1(name: str | None) -> None:
    """Print the packages that PACKAGE's own manifest names."""
    for each in _package(name, _packages()).manifest.direct:
        output.line(each)


@command.command("depends")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
def depends(name: str | None) -> None:
    """Print the packages that PACKAGE depends on, be it by way of others."""
    packages = _packages()
    for each in _below(_package(name, packages), packages):
        output.line(each)


@command.command("depends-on1")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
def depends_on1(name: str | None) -> None:
    """Print the packages whose own manifest names PACKAGE."""
    packages = _packages()
    wanted = _package(name, packages).name
    for package in packages:
        if wanted in package.manifest.direct:
            output.line(package.name)


@command.command("depends-on")
@click.argument("name", metavar="[PACKAGE]", required=False, shell_complete=_complete)
def depends_on(name: str | None) -> None:
    """Print the packages that depend on PACKAGE, be it by way of others."""
    packages = _packages()
    wanted = _package(name, packages).name
    for package in packages:
        if wanted in _below(package, packages):
            output.line(package.name)


@command.command("profile", hidden=True)
def profile() -> None:
    """Do nothing: there is no cache that would have to be made anew."""


def _packages() -> Packages:
    from fibws.ros1.workspace.packages import Packages

    return Packages.from_environment()


def _package(name: str | None, packages: Packages) -> Package:
    """The package of that name, or the one that this folder is in."""
    if name is not None:
        return packages.find(name)
    from fibws.ros1.workspace.manifest import FILE, read_name

    here = Path.cwd()
    for folder in (here, *here.parents):
        if (folder / FILE).is_file():
            return packages.find(read_name(folder))
    raise WorkspaceError("write which package: this folder is in none")


def _below(package: Package, packages: Packages) -> list[str]:
    """The packages that one depends on, each behind those that it depends on itself."""
    found: dict[str, None] = {}
    begun = {package.name}

    def add(package: Package) -> None:
        for name in package.manifest.direct:
            if name not in begun:
                begun.add(name)
                # Another one is the system's, or not installed here.
                if packages.has(name):
                    add(packages.find(name))
                found[name] = None

    add(package)
    return list(found)
