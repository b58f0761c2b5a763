"""Build a workspace, as catkin_make does: read and check its packages, and write devel/."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fibws.errors import FibwsError
from fibws.ros1.errors import PackageFileError, WorkspaceError
from fibws.ros1.shell.environment import shadows_ros
from fibws.ros1.workspace.definitions import compile_definitions
from fibws.ros1.workspace.devel_space import check_collisions, generated_files, modules_of
from fibws.ros1.workspace.file_writer import File, Tree, remove, write
from fibws.ros1.workspace.package_checks import (
    check_package,
    missing_dependencies,
    note_cpp,
)
from fibws.ros1.workspace.packages import PREFIXES, Packages
from fibws.ros1.workspace.paths import BUILD, DEVEL, MARK, SOURCE, SPACES
from fibws.ros1.workspace.setup_files import setup_files
from fibws.ros1.workspace.source_tree import (
    SourcePackage,
    read_source_tree,
    with_dependencies,
)
from fibws.suggestions import suggestion

BUILT_BY, RECORD, TOOL = ".built_by", ".fibws", "fibws"
"""Files in devel/ that say which tool built it, and which files fibws wrote; and fibws's name."""


@dataclass
class Plan:
    """The packages to build, and what is wrong in them.

    Attributes:
        packages: all packages of the workspace, each after those that it depends on.
        chosen: the names of those that were asked for, by default all.
        failed: the names of packages that cannot be built, each with the failed packages that it
            depends on; without any, it has errors of its own.
        trees: the generated files of each package, by its name.
        errors: what is wrong in the chosen packages and their dependencies.
        warnings: likely mistakes in the chosen packages.
    """

    packages: list[SourcePackage] = field(default_factory=list)
    chosen: set[str] = field(default_factory=set)
    failed: dict[str, list[str]] = field(default_factory=dict)
    trees: dict[str, Tree] = field(default_factory=dict)
    errors: list[FibwsError] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def built(self) -> list[SourcePackage]:
        """The packages to build, in order."""
        return [
            package
            for package in self.packages
            if package.name in self.chosen and package.name not in self.failed
        ]


class Workspace:
    """One workspace.

    Args:
        folder: its folder; see `fibws.ros1.workspace.paths.check_workspace`.
        environment: variables of which $CMAKE_PREFIX_PATH names workspaces that it builds on; by
            default those of this process. If they hide an installed ROS, so do the setup files.
    """

    def __init__(self, folder: Path, environment: Mapping[str, str] | None = None) -> None:
        self.folder = folder
        self.source = folder / SOURCE
        self.devel = folder / DEVEL
        self.build = folder / BUILD
        environment = os.environ if environment is None else environment
        self._below = self._other_workspaces(environment)
        self._shadows = shadows_ros(environment)

    def plan(self, names: Sequence[str] = (), *, with_depends: bool = False) -> Plan:
        """Read and check the packages.

        An error in one package stops that package and those that depend on it, but no others.

        Args:
            names: the packages to build; by default all.
            with_depends: whether to build those that they depend on, too.

        Raises:
            WorkspaceError: the names are unknown, or devel/ was built by another tool.
        """
        self._check_devel()
        plan = Plan()
        plan.packages, plan.warnings = read_source_tree(self.source)
        depends = {package.name: package.depends for package in plan.packages}
        plan.chosen = self._choose(names, plan)
        needed = with_dependencies(plan.chosen, depends)
        if with_depends:
            plan.chosen = needed
        compile_definitions(plan.packages, [devel / "share" for _, devel in self._below])
        modules: Tree = {}
        for package in plan.packages:
            check_package(package)
            plan.trees[package.name] = _tree(package, modules)
            modules |= modules_of(plan.trees[package.name])
        check_collisions(plan.packages, plan.trees)
        for package in plan.packages:
            failed = sorted(package.depends & plan.failed.keys())
            if package.errors or failed:
                plan.failed[package.name] = [] if package.errors else failed
        # One error may stop several packages, as one in a definition that others use.
        errors = [error for each in plan.packages if each.name in needed for error in each.errors]
        plan.errors = list({str(error): error for error in errors}.values())
        plan.warnings += self._warnings(plan)
        return plan

    def make(self, plan: Plan) -> None:
        """Write devel/ for the packages that can be built; what failed ones had there stays.

        Raises:
            OSError: a file cannot be written.
        """
        built = {package.name: plan.trees[package.name] for package in plan.built}
        self._write(built, plan.trees.keys() - built.keys())

    def clean(self) -> None:
        """Remove from devel/ what was generated from packages; the files to source stay.

        Raises:
            WorkspaceError: devel/ was built by another tool.
            OSError: a file cannot be removed.
        """
        self._check_devel()
        self._write({}, set())

    def _warnings(self, plan: Plan) -> list[str]:
        chosen = [package for package in plan.packages if package.name in plan.chosen]
        known = Packages([self.source, *(source for source, _ in self._below)]).names()
        return [
            *(warning for package in chosen for warning in package.warnings),
            *missing_dependencies(chosen, known),
            *note_cpp(chosen),
        ]

    def _write(self, built: Mapping[str, Tree], others: set[str]) -> None:
        """Write devel/, in which the files of the packages named ``others`` stay."""
        before = self._recorded()
        common = setup_files(self.folder, self._below, shadows=self._shadows)
        common[SPACES] = File(str(self.source).encode())
        record = {name: package for name, package in before.items() if package in others}
        for package, tree in {"": common, **built}.items():
            record |= dict.fromkeys(tree, package)
        # The record comes first, with all that may be written, as this may be interrupted.
        write(self.devel, {BUILT_BY: File(TOOL.encode()), RECORD: _json({**before, **record})})
        for tree in (*built.values(), common):
            write(self.devel, tree)
        remove(self.devel, sorted(before.keys() - record.keys()))
        write(self.devel, {RECORD: _json(record)})
        # $FIBWS_INTERFACES names this folder.
        (self.devel / "share").mkdir(exist_ok=True)
        if not self.build.exists():
            write(self.build, {BUILT_BY: File(TOOL.encode()), "CATKIN_IGNORE": File(b"")})
        mark = b"# This file marks the folder as the root of a catkin workspace.\n"
        write(self.folder, {MARK: File(mark)} if not (self.folder / MARK).exists() else {})

    def _recorded(self) -> dict[str, str]:
        """Return the files in devel/ that fibws wrote, each with its package."""
        try:
            found = json.loads((self.devel / RECORD).read_text("utf-8"))
        except (OSError, ValueError):
            return {}
        return {str(key): str(value) for key, value in found.items()} if type(found) is dict else {}

    def _check_devel(self) -> None:
        try:
            tool = (self.devel / BUILT_BY).read_text("utf-8", errors="replace").strip()
        except OSError:
            tool = "another tool" if self.devel.is_dir() and any(self.devel.iterdir()) else TOOL
        if tool != TOOL:
            raise WorkspaceError(
                f"The devel space at {self.devel} was previously built by {tool}. "
                f"Remove it, or build another workspace"
            )

    def _other_workspaces(self, environment: Mapping[str, str]) -> list[tuple[Path, Path]]:
        """Return the source and devel folders of other workspaces of fibws, the farthest first."""
        found = []
        for name in environment.get(PREFIXES, "").split(os.pathsep):
            prefix = Path(name)
            if not name or prefix == self.devel or prefix.resolve() == self.devel.resolve():
                continue
            try:
                is_ours = (prefix / BUILT_BY).read_text("utf-8").strip() == TOOL
                source = Path((prefix / SPACES).read_text("utf-8").strip())
            except (OSError, ValueError):
                continue
            if is_ours:
                found.append((source, prefix))
        return found[::-1]

    def _choose(self, names: Sequence[str], plan: Plan) -> set[str]:
        known = {package.name for package in plan.packages}
        if not names:
            return known
        unknown = [name for name in names if name not in known]
        texts = ", ".join(f"{name}{suggestion(name, known)}" for name in unknown)
        text = f"Packages not found in the workspace: {texts}"
        if unknown and len(unknown) == len(names):
            raise WorkspaceError(text)
        if unknown:
            plan.warnings.append(text)
        return set(names) & known


def _tree(package: SourcePackage, modules: Tree) -> Tree:
    """Return the package's generated files; unreadable files become errors of the package.

    Args:
        package: the package.
        modules: the modules of packages before it.
    """
    try:
        return generated_files(package, modules)
    except OSError as error:
        line = package.lists.python_setup or 1
        text = f"{error.filename}: {error.strerror}"
        package.errors.append(PackageFileError(package.lists.source, line, text))
        return {}


def _json(value: Mapping[str, str]) -> File:
    return File(json.dumps(value, indent=0, sort_keys=True).encode())
