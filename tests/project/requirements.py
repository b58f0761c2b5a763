"""The requirements in pyproject.toml, constraints.txt, and what the code imports."""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement
from packaging.utils import NormalizedName, canonicalize_name

ROOT = Path(__file__).parents[2]
PYPROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
EXTRAS: dict[str, list[str]] = PYPROJECT["project"]["optional-dependencies"]


def requirements_of(extra: str) -> Iterator[Requirement]:
    """Yield the requirements of an extra, those of the extras that it names, and fibws's own."""
    yield from map(Requirement, PYPROJECT["project"]["dependencies"])
    for requirement in map(Requirement, EXTRAS[extra]):
        if requirement.name == "fibws":
            for other in requirement.extras:
                yield from requirements_of(other)
        else:
            yield requirement


def names_of(extra: str) -> set[NormalizedName]:
    """Return the names of the packages that an extra requires."""
    return {canonicalize_name(each.name) for each in requirements_of(extra)}


def checked_files() -> Iterator[Path]:
    """Yield the files that mypy checks."""
    mypy = PYPROJECT["tool"]["mypy"]
    for name in mypy["files"]:
        path = ROOT / name
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            relative = file.relative_to(ROOT).as_posix()
            if not any(re.search(pattern, relative) for pattern in mypy["exclude"]):
                yield file


def imported_modules(file: Path) -> set[str]:
    """Return the top-level modules that a file imports, anywhere in it."""
    modules = set()
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            modules.add(node.module)
    return {module.partition(".")[0] for module in modules}


def modules_without_types() -> set[str]:
    """Return the top-level modules that mypy need not find."""
    return {
        pattern.partition(".")[0]
        for override in PYPROJECT["tool"]["mypy"]["overrides"]
        if override.get("ignore_missing_imports")
        for pattern in override["module"]
    }
