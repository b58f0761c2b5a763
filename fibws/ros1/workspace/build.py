"""catkin_make: reads a workspace's packages, checks them, and writes devel/."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fibws.errors import FibwsError, PackageFileError, WorkspaceError
from fibws.ros1.workspace import devel
from fibws.ros1.workspace.check import check
from fibws.ros1.workspace.crawl import find_folders
from fibws.ros1.workspace.definitions import compile_definitions
from fibws.ros1.workspace.manifest import FILE as MANIFEST
from fibws.ros1.workspace.manifest import read_manifest
from fibws.ros1.workspace.order import in_order, with_needed
from fibws.ros1.workspace.packages import PREFIXES, Packages
from fibws.ros1.workspace.place import BUILD, DEVEL, MARK, SOURCE, SPACES
from fibws.ros1.workspace.reader import read_recipe
from fibws.ros1.workspace.recipe import FILE as LISTS
from fibws.ros1.workspace.recipe import Recipe
from fibws.ros1.workspace.setup_files import setup_files
from fibws.ros1.workspace.source import Source
from fibws.ros1.workspace.tree import File, Tree, remove, write
from fibws.suggestions import suggestion

BUILT_BY, RECORD, TOOL = ".built_by", ".fibws", "fibws"
"""Files in devel/ that tell whose it is, and which files in it are ours; and our name for that."""


@dataclass
class Plan:
    """What is to be built.

    Attributes:
        sources: the packages, each behind those that it depends on.
        chosen: the names of those to be built, all of them unless some were asked for.
        trees: what each package is made into, by its name, be it built or not.
        faults: what is wrong; nothing is written then.
        warnings: what should be otherwise.
    """

    sources: list[Source] = field(default_factory=list)
    chosen: set[str] = field(default_factory=set)
    trees: dict[str, Tree] = field(default_factory=dict)
    faults: list[FibwsError] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def built(self) -> list[Source]:
        """The packages to be built, in their order."""
        return [source for source in self.sources if source.name in self.chosen]


class Workspace:
    """One workspace.

    Args:
        folder: it; see `fibws.ros1.workspace.place.check`.
        environment: where $CMAKE_PREFIX_PATH leads to other ones that it builds on; by default this
            process's own.
    """

    def __init__(self, folder: Path, environment: Mapping[str, str] | None = None) -> None:
        self.folder = folder
        self.source = folder / SOURCE
        self.devel = folder / DEVEL
        self.build = folder / BUILD
        environment = os.environ if environment is None else environment
        self._below = self._others(environment)

    def plan(self, names: Sequence[str] = (), *, with_depends: bool = False) -> Plan:
        """Read and check the packages.

        Args:
            names: those that are to be built; by default all.
            with_depends: whether those that they depend on are to be built, too.

        Raises:
            WorkspaceError: two packages have one name, they depend on each other in a circle, there
                is none of the names, or devel/ was made by another tool.
            OSError: a manifest, a recipe or a definition cannot be read.
        """
        self._check_devel()
        plan = Plan()
        sources = self._read(plan)
        depends = {name: source.depends for name, source in sources.items()}
        plan.sources = [sources[name] for name in in_order(depends)]
        plan.chosen = self._chosen(names, sources, plan)
        if with_depends:
            plan.chosen = with_needed(plan.chosen, depends)
        known = Packages([self.source, *(source for source, _ in self._below)]).names()
        compile_definitions(plan.sources, [each / "share" for _, each in self._below])
        for source in plan.sources:
            try:
                plan.trees[source.name] = devel.files(source)
            except OSError as error:
                line = source.recipe.python_setup or 1
                source.recipe.fault(line, f"{error.filename}: {error.strerror}")
                plan.trees[source.name] = {}
        for source in plan.built:
            check(source, known)
            plan.warnings += source.recipe.warnings
        plan.faults += devel.collisions(plan.sources, plan.trees)
        plan.faults += [fault for source in plan.built for fault in source.recipe.faults]
        # Without those that say the same, as of a definition that several others use.
        plan.faults = list({str(fault): fault for fault in plan.faults}.values())
        return plan

    def make(self, plan: Plan) -> None:
        """Write devel/, and take out what is no more; nothing is written if the plan has faults.

        Raises:
            OSError: something cannot be written.
        """
        if not plan.faults:
            built = {source.name: plan.trees[source.name] for source in plan.built}
            self._write(built, plan.trees.keys() - plan.chosen)

    def clean(self) -> None:
        """Take out of devel/ what was made of packages; the files to be sourced stay.

        Raises:
            WorkspaceError: devel/ was made by another tool.
            OSError: something cannot be removed.
        """
        self._check_devel()
        self._write({}, set())

    def _write(self, built: Mapping[str, Tree], others: set[str]) -> None:
        """Write devel/, in which what was made of packages that are called as ``others`` stays."""
        before = self._recorded()
        common = setup_files(self.folder, self._below)
        common[SPACES] = File(str(self.source).encode())
        record = {name: package for name, package in before.items() if package in others}
        for package, tree in {"": common, **built}.items():
            record |= dict.fromkeys(tree, package)
        # First of all whose the folder is, and what may be in it: somebody may break this off.
        write(self.devel, {BUILT_BY: File(TOOL.encode()), RECORD: _json({**before, **record})})
        for tree in (*built.values(), common):
            write(self.devel, tree)
        remove(self.devel, sorted(before.keys() - record.keys()))
        write(self.devel, {RECORD: _json(record)})
        # Others expect the folder to be there that FIBWS_INTERFACES names.
        (self.devel / "share").mkdir(exist_ok=True)
        if not self.build.exists():
            write(self.build, {BUILT_BY: File(TOOL.encode()), "CATKIN_IGNORE": File(b"")})
        mark = b"# This file marks the folder as the root of a catkin workspace.\n"
        write(self.folder, {MARK: File(mark)} if not (self.folder / MARK).exists() else {})

    def _recorded(self) -> dict[str, str]:
        """The files in devel/ that are ours, and which package each was made of."""
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

    def _others(self, environment: Mapping[str, str]) -> list[tuple[Path, Path]]:
        """The source and devel folders of other workspaces of fibws, the farthest one first."""
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

    def _read(self, plan: Plan) -> dict[str, Source]:
        """All packages by their names; what cannot be read becomes a fault of the plan."""
        sources: dict[str, Source] = {}
        for folder in find_folders(self.source):
            try:
                manifest = read_manifest(folder)
                if (folder / LISTS).is_file():
                    recipe = read_recipe(folder)
                elif manifest.is_metapackage:
                    recipe = Recipe(str(folder / LISTS))
                else:
                    missing = f"there is no {LISTS} beside it"
                    raise PackageFileError(str(folder / MANIFEST), 1, missing)
            except FibwsError as error:
                plan.faults.append(error)
                continue
            if manifest.name in sources:
                first = sources[manifest.name].folder
                raise WorkspaceError(
                    f"Multiple packages found with the same name {manifest.name!r}: "
                    f"{first} and {folder}. Rename one, or put a file CATKIN_IGNORE into it"
                )
            sources[manifest.name] = Source(folder, manifest, recipe)
        return sources

    def _chosen(self, names: Sequence[str], sources: Mapping[str, Source], plan: Plan) -> set[str]:
        if not names:
            return set(sources)
        unknown = [name for name in names if name not in sources]
        texts = [f"{name}{suggestion(name, sources)}" for name in unknown]
        if unknown and len(unknown) == len(names):
            raise WorkspaceError(f"Packages not found in the workspace: {', '.join(texts)}")
        if unknown:
            plan.warnings.append(f"Packages not found in the workspace: {', '.join(texts)}")
        return set(names) - set(unknown)


def _json(value: Mapping[str, str]) -> File:
    return File(json.dumps(value, indent=0, sort_keys=True).encode())
