"""What is built of packages: the files of devel/."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from fibws.errors import FibwsError, PackageFileError
from fibws.ros1.workspace.manifest import FILE as MANIFEST
from fibws.ros1.workspace.python_setup import FILE as SETUP
from fibws.ros1.workspace.python_setup import read_setup
from fibws.ros1.workspace.setup_files import MODULES
from fibws.ros1.workspace.source import Source
from fibws.ros1.workspace.tree import File, Tree

_LONGEST_SHEBANG = 120
"""What Linux is sure to read of the first line, in bytes."""

_RELAY = """\
{shebang}# Made by catkin_make. It stands in for the file that it names, and runs that.
import os
import sys

__file__ = {path!r}
sys.path.insert(0, os.path.dirname(__file__))
with open(__file__, "rb") as file:
    code = compile(file.read(), __file__, "exec")
del os, sys, file
exec(code)
"""

_MODULE = """\
# Made by catkin_make. It stands in for the file that it names.
__file__ = {path!r}
with open(__file__, "rb") as file:
    code = compile(file.read(), __file__, "exec")
del file
exec(code)
"""

_PACKAGE = """\
# Made by catkin_make. It stands in for the package in the folder that it names.
import os

__path__.insert(0, {path!r})
__file__ = os.path.join({path!r}, "__init__.py")
if os.path.exists(__file__):
    with open(__file__, "rb") as file:
        code = compile(file.read(), __file__, "exec")
    exec(code)
"""


def files(source: Source) -> Tree:
    """The files that are made of one package; what cannot be made becomes a fault of the recipe."""
    name, recipe = source.name, source.recipe
    tree: Tree = {f"share/{name}/{MANIFEST}": File((source.folder / MANIFEST).read_bytes())}
    for kind, listed in recipe.definitions.items():
        for each in listed:
            tree[f"share/{name}/{kind}/{each.path.name}"] = File(each.path.read_bytes())
    for each in recipe.programs:
        if not Path(each.destination).is_absolute():
            text = _RELAY.format(shebang=_shebang(), path=str(each.path))
            tree[each.target] = File(text.encode(), True)
    if recipe.python_setup is not None:
        try:
            tree |= _modules(source)
        except FibwsError as error:
            recipe.faults.append(error)
    return tree


def collisions(sources: Sequence[Source], trees: Mapping[str, Tree]) -> list[PackageFileError]:
    """What is wrong because two packages would make the same file, of ``trees`` by their names."""
    made: dict[str, Source] = {}
    faults = []
    for source in sources:
        recipe = source.recipe
        lines = {each.target: each.line for each in recipe.programs}
        for path in trees[source.name]:
            first = made.setdefault(path, source)
            if first is not source:
                line = lines.get(path, recipe.python_setup or 1)
                text = f"{first.name} makes {path}, too"
                faults.append(PackageFileError(recipe.source, line, text))
    return faults


def _modules(source: Source) -> Tree:
    setup = read_setup(source.folder)
    tree: Tree = {}
    for name, folder in setup.packages.items():
        text = _PACKAGE.format(path=str(folder))
        tree[f"{MODULES}/{name}/__init__.py"] = File(text.encode())
    for name, file in setup.modules.items():
        tree[f"{MODULES}/{name}.py"] = File(_MODULE.format(path=str(file)).encode())
    if setup.scripts:
        text = f"{source.folder / SETUP}: scripts are left where they are: {list(setup.scripts)}"
        source.recipe.warnings.append(f"{text}; catkin_install_python() is for them")
    return tree


def _shebang() -> str:
    """The line that has this Python run a file, if the system can read such a line."""
    line = f"#!{sys.executable}"
    if any(blank in line for blank in " \t") or len(line.encode()) > _LONGEST_SHEBANG:
        line = "#!/usr/bin/env python3"
    return f"{line}\n"
