"""Packages of definitions in ROS's layout: ``<package>/msg/Type.msg``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Literal, TypeAlias

Kind: TypeAlias = Literal["msg", "srv", "action"]
KINDS: tuple[Kind, ...] = ("msg", "srv", "action")


class Package:
    """The definition files of one package, listed on first use."""

    __slots__ = ("_files", "folder", "name")

    def __init__(self, name: str, folder: Path) -> None:
        self.name = name
        self.folder = folder
        self._files: dict[Kind, dict[str, Path]] = {}

    def files(self, kind: Kind) -> dict[str, Path]:
        """The files of one kind by the name of what they define."""
        if kind not in self._files:
            paths = sorted((self.folder / kind).glob(f"*.{kind}"))
            self._files[kind] = {path.stem: path for path in paths if _is_name(path.stem)}
        return self._files[kind]


def find_packages(folder: Path) -> Iterator[Package]:
    """The packages in ``folder``, which holds them side by side or is one itself."""
    if _is_package(folder):
        yield Package(folder.resolve().name, folder)
        return
    for entry in sorted(folder.iterdir()):
        if _is_package(entry):
            yield Package(entry.name, entry)


def _is_package(folder: Path) -> bool:
    named = _is_name(folder.resolve().name)
    return named and any((folder / kind).is_dir() for kind in KINDS)


def _is_name(text: str) -> bool:
    return text.isascii() and text.isidentifier()
