"""Read which modules a package's setup.py names; the file is parsed, not run."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from fibws.ros1.errors import PackageFileError

FILE = "setup.py"
_CALLS = {"setup", "generate_distutils_setup"}
_NAMES = {"packages", "package_dir", "py_modules"}


@dataclass(frozen=True)
class PythonSetup:
    """The Python modules of a package.

    Attributes:
        packages: the folder of each package by its name; of ``a`` and ``a.b`` only ``a``.
        modules: the file of each single module by its name.
        warnings: likely mistakes, each with file and line.
    """

    packages: dict[str, Path]
    modules: dict[str, Path]
    warnings: list[str] = field(default_factory=list)


def read_setup(folder: Path) -> PythonSetup:
    """Read the setup.py of the package in ``folder``.

    Raises:
        PackageFileError: it is not Python, a value is not a literal, or a module's file is missing.
        OSError: it cannot be read.
    """
    path = folder / FILE
    try:
        module = ast.parse(path.read_text("utf-8"), str(path))
    except (SyntaxError, ValueError) as error:
        line = getattr(error, "lineno", None) or 1
        raise PackageFileError(str(path), line, f"invalid Python: {error}") from None
    values: dict[str, Any] = {}
    line = 1
    for name, value in _settings(module):
        line = value.lineno
        values[name] = _literal(name, value, path, folder)
    return _resolve(values, folder, path, line)


def _settings(module: ast.Module) -> Iterator[tuple[str, ast.expr]]:
    """Yield the values that the file gives as ``setup(name=value)`` or ``d["name"] = value``."""
    for node in ast.walk(module):
        if isinstance(node, ast.Call) and _called(node) in _CALLS:
            yield from ((each.arg, each.value) for each in node.keywords if each.arg in _NAMES)
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Subscript):
            key = node.targets[0].slice
            if isinstance(key, ast.Constant) and key.value in _NAMES:
                yield str(key.value), node.value


def _called(node: ast.Call) -> str:
    function = node.func
    if isinstance(function, ast.Name):
        return function.id
    return function.attr if isinstance(function, ast.Attribute) else ""


def _literal(name: str, value: ast.expr, path: Path, folder: Path) -> Any:
    if isinstance(value, ast.Call) and _called(value) == "find_packages":
        given = [*value.args, *(each.value for each in value.keywords if each.arg == "where")]
        where = next((each.value for each in given if isinstance(each, ast.Constant)), "")
        base = folder / str(where)
        return sorted(each.parent.name for each in base.glob("*/__init__.py"))
    try:
        found = ast.literal_eval(value)
    except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
        found = None
    wanted = dict if name == "package_dir" else (list, tuple)
    texts = found.items() if isinstance(found, dict) else [(each, "") for each in found or ()]
    if not isinstance(found, wanted) or not all(
        isinstance(key, str) and isinstance(text, str) for key, text in texts
    ):
        example = "{'': 'src'}" if name == "package_dir" else "['my_package']"
        text = f"{name} must be a literal, as in {name}={example}"
        raise PackageFileError(str(path), value.lineno, text)
    return found


def _resolve(values: dict[str, Any], folder: Path, path: Path, line: int) -> PythonSetup:
    folders: dict[str, str] = values.get("package_dir", {})
    base = folder / folders.get("", "")
    for name in (*values.get("packages", ()), *values.get("py_modules", ())):
        if not all(part.isidentifier() for part in name.split(".")):
            raise PackageFileError(str(path), line, f"invalid module name {name!r}")
    packages, warnings = {}, []
    for name in values.get("packages", ()):
        first = name.partition(".")[0]
        where = folders.get(first, PurePosixPath(folders.get("", ""), first).as_posix())
        if (folder / where).is_dir():
            packages[first] = folder / where
        else:  # catkin builds the package without it.
            text = f"folder {where} of module {first} not found"
            warnings.append(str(PackageFileError(str(path), line, text)))
    modules = {name: base / f"{name}.py" for name in values.get("py_modules", ())}
    for name, file in modules.items():
        if not file.is_file():
            raise PackageFileError(str(path), line, f"{name}.py not found in {base}")
    return PythonSetup(packages, modules, list(dict.fromkeys(warnings)))
