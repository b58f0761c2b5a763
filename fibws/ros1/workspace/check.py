"""Whether a package's manifest, its recipe and its files say the same.

What catkin refuses is a fault; what it only warns of, or what a learner runs into later, a warning.
"""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path

from fibws.errors import PackageFileError
from fibws.ros1.workspace.elsewhere import ELSEWHERE, MODULES, PROVIDED
from fibws.ros1.workspace.missing import quoted
from fibws.ros1.workspace.programs import (
    find_files,
    has_shebang,
    has_windows_shebang,
    is_executable,
)
from fibws.ros1.workspace.source import Source
from fibws.suggestions import nearest, suggestion


def check(source: Source, packages: Collection[str]) -> None:
    """Note in the package's recipe what is wrong in it.

    Args:
        source: the package.
        packages: the names of all packages that there are, the standard ones too.
    """
    source.recipe.warnings[:0] = source.manifest.warnings
    _check_names(source)
    _check_components(source, packages)
    _check_catkin_package(source)
    _check_messages(source)
    _check_dependencies(source, packages)
    _check_programs(source)
    _check_compiled(source)


def _check_names(source: Source) -> None:
    manifest, recipe = source.manifest, source.recipe
    if recipe.project.text and recipe.project.text != manifest.name:
        same = f"package.xml calls it {manifest.name!r}, and both have to be the same"
        recipe.fault(recipe.project.line, f"the project is called {recipe.project.text!r}, {same}")
    build_type = manifest.exports.get("build_type", "catkin")
    if build_type not in ("catkin", "cmake"):
        text = f"this is a package of ROS 2 ({build_type}); here are those of ROS 1, of catkin"
        recipe.faults.append(PackageFileError(manifest.source, manifest.line, text))


def _check_components(source: Source, packages: Collection[str]) -> None:
    manifest, recipe = source.manifest, source.recipe
    for name, line in recipe.components.items():
        if name == "catkin" or name in recipe.modules:
            continue
        if name not in packages and name not in PROVIDED | ELSEWHERE:
            near = suggestion(name, {*packages, *PROVIDED})
            recipe.fault(line, f"find_package(): there is no package {name} here{near}")
        elif name not in manifest.build:
            recipe.warn(line, f"package.xml lacks <build_depend>{name}</build_depend>")


def _check_catkin_package(source: Source) -> None:
    manifest, recipe = source.manifest, source.recipe
    if recipe.declares is None:
        if not recipe.faults and not manifest.is_metapackage:
            recipe.warn(recipe.project.line, "catkin_package() is missing")
        return
    if "catkin" not in manifest.build:
        text = "<buildtool_depend>catkin</buildtool_depend> is missing"
        recipe.faults.append(PackageFileError(manifest.source, manifest.line, text))
    runs = "run_depend" if manifest.format == 1 else "exec_depend"
    for name, line in recipe.catkin_depends.items():
        lacks = f"catkin_package() depends on {name}, and package.xml lacks"
        if name in recipe.components and name not in manifest.build:
            recipe.fault(line, f"{lacks} <build_depend>{name}</build_depend>")
        if name not in manifest.exec and name not in manifest.exported:
            recipe.fault(line, f"{lacks} <{runs}>{name}</{runs}>")


def _check_messages(source: Source) -> None:
    manifest, recipe = source.manifest, source.recipe
    line = recipe.generates
    if line is None:
        return
    runs = "run_depend" if manifest.format == 1 else "exec_depend"
    tools = {"message_generation", "genmsg"}
    # What find_package() finds and is not in package.xml was warned of there.
    if not tools & {*manifest.build, *recipe.components}:
        recipe.warn(line, "package.xml lacks <build_depend>message_generation</build_depend>")
    if "message_runtime" not in manifest.exec and "message_runtime" not in manifest.exported:
        recipe.warn(line, f"package.xml lacks <{runs}>message_runtime</{runs}>")
    for name, at in recipe.message_packages.items():
        if name not in recipe.components:
            where = f"find_package(catkin REQUIRED COMPONENTS ... {name})"
            recipe.fault(at, f"generate_messages() depends on {name}, and {where} lacks it")
        elif name not in manifest.exec:
            recipe.warn(at, f"package.xml lacks <{runs}>{name}</{runs}>")
    if not any(recipe.definitions.values()):
        recipe.warn(
            line, "there is nothing to generate: add_message_files() or the like is missing"
        )


def _check_dependencies(source: Source, packages: Collection[str]) -> None:
    manifest, recipe = source.manifest, source.recipe
    known = {*packages, *PROVIDED}
    said: set[str] = set()
    for each in manifest.depends:
        name = each.name
        if name in known | ELSEWHERE | said or name.lower() in MODULES or each.tag == "test_depend":
            continue
        said.add(name)
        if near := nearest(name, known):
            where = f"{manifest.source}, line {each.line}"
            recipe.warnings.append(
                f"{where}: there is no package {name} here; did you mean {near}?"
            )


def _check_programs(source: Source) -> None:
    recipe = source.recipe
    installed = {each.path.resolve() for each in recipe.programs}
    made: dict[str, Path] = {}
    for each in recipe.programs:
        other = made.get(each.target, each.path)
        made[each.target] = each.path
        if other.resolve() != each.path.resolve():
            text = f"{quoted(each.path)} replaces {quoted(other)}: both become {each.target}"
            recipe.warn(each.line, text)
        if not has_shebang(each.path):
            text = "its first line should be #!/usr/bin/env python3"
            recipe.warn(each.line, f"{each.path.name} is not marked as a Python program: {text}")
        if not is_executable(each.path):
            recipe.warn(
                each.line, f"{each.path.name} is not executable: chmod +x {quoted(each.path)}"
            )
    for path in find_files(source.folder):
        is_script = path.suffix == ".py" and has_shebang(path)
        if is_script and not is_executable(path) and path.resolve() not in installed:
            text = "is not executable, so rosrun will not find it"
            recipe.warnings.append(f"{path} {text}: chmod +x {quoted(path)}")
        if os.name != "nt" and is_executable(path) and has_windows_shebang(path):
            text = "its lines end as on Windows, so it does not run by itself: save it with LF"
            recipe.warnings.append(f"{path}, line 1: {text}, not CRLF")


def _check_compiled(source: Source) -> None:
    for name, line in source.recipe.compiled.items():
        source.recipe.warn(line, f"C++ is not built here: {name} was passed over")
