"""The modules that a package's setup.py names; the file is read, and not run."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from fibws.errors import PackageFileError

FILE = "setup.py"
_CALLS = {"setup", "generate_distutils_setup"}
_WORDS = {"packages", "package_dir", "py_modules", "scripts"}


@dataclass(frozen=True)
class PythonSetup:
    """What Python is to find.

    Attributes:
        packages: folder of each package by its name; of ``a`` and ``a.b`` there is only ``a``.
        modules: file of each single module by its name.
        scripts: the names of scripts, which catkin_install_python() is for.
    """

    packages: dict[str, Path]
    modules: dict[str, Path]
    scripts: tuple[str, ...]


def read_setup(folder: Path) -> PythonSetup:
    """What the setup.py of the package in ``folder`` says.

    Raises:
        PackageFileError: it is not Python, a value is not written out, or a folder is missing.
        OSError: it cannot be read.
    """
    path = folder / FILE
    try:
        module = ast.parse(path.read_text("utf-8"), str(path))
    except (SyntaxError, ValueError) as error:
        line = getattr(error, "lineno", None) or 1
        raise PackageFileError(str(path), line, f"this is not Python: {error}") from None
    said: dict[str, Any] = {}
    line = 1
    for node in ast.walk(module):
        if isinstance(node, ast.Call) and _called(node) in _CALLS:
            for keyword in node.keywords:
                if keyword.arg in _WORDS:
                    line = keyword.value.lineno
                    said[keyword.arg] = _value(keyword, path, folder)
    return _resolved(said, folder, path, line)


def _called(node: ast.Call) -> str:
    function = node.func
    if isinstance(function, ast.Name):
        return function.id
    return function.attr if isinstance(function, ast.Attribute) else ""


def _value(keyword: ast.keyword, path: Path, folder: Path) -> Any:
    value = keyword.value
    if isinstance(value, ast.Call) and _called(value) == "find_packages":
        given = [*value.args, *(each.value for each in value.keywords if each.arg == "where")]
        where = next((each.value for each in given if isinstance(each, ast.Constant)), "")
        base = folder / str(where)
        return sorted(each.parent.name for each in base.glob("*/__init__.py"))
    try:
        found = ast.literal_eval(value)
    except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
        found = None
    wanted = dict if keyword.arg == "package_dir" else (list, tuple)
    texts = found.items() if isinstance(found, dict) else [(each, "") for each in found or ()]
    if not isinstance(found, wanted) or not all(
        isinstance(key, str) and isinstance(text, str) for key, text in texts
    ):
        example = "{'': 'src'}" if keyword.arg == "package_dir" else "['my_package']"
        fault = f"{keyword.arg} is to be written out here, as in {keyword.arg}={example}"
        raise PackageFileError(str(path), value.lineno, fault)
    return found


def _resolved(said: dict[str, Any], folder: Path, path: Path, line: int) -> PythonSetup:
    folders: dict[str, str] = said.get("package_dir", {})
    base = folder / folders.get("", "")
    packages = {}
    for name in (*said.get("packages", ()), *said.get("py_modules", ())):
        if not all(part.isidentifier() for part in name.split(".")):
            raise PackageFileError(str(path), line, f"{name!r} is not the name of a module")
    for name in said.get("packages", ()):
        first = name.partition(".")[0]
        where = folders.get(first, PurePosixPath(folders.get("", ""), first).as_posix())
        packages[first] = folder / where
        if not packages[first].is_dir():
            raise PackageFileError(str(path), line, f"there is no folder {where} for {first}")
    modules = {name: base / f"{name}.py" for name in said.get("py_modules", ())}
    for name, file in modules.items():
        if not file.is_file():
            raise PackageFileError(str(path), line, f"there is no {name}.py in {base}")
    return PythonSetup(packages, modules, tuple(said.get("scripts", ())))
