"""Write and remove the files of a folder, each as a whole."""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from errno import EISDIR
from pathlib import Path, PurePosixPath
from typing import TypeAlias

from fibws.files import replace_file


@dataclass(frozen=True)
class File:
    """The content of a file, and whether it is executable."""

    content: bytes
    executable: bool = False


Tree: TypeAlias = dict[str, File]
"""Files by their paths in a folder, with / between the parts."""


def write(folder: Path, tree: Tree) -> None:
    """Write files into ``folder``, which is created if it does not exist.

    Each file is replaced atomically; a file that has this content already is not touched.

    Raises:
        OSError: a file cannot be written.
    """
    for name, file in tree.items():
        _write(folder / name, file)


def remove(folder: Path, names: Iterable[str]) -> None:
    """Remove files from ``folder``, and its folders that are empty then.

    Raises:
        OSError: a file cannot be removed.
    """
    for name in names:
        inside = PurePosixPath(name)
        if inside.is_absolute() or ".." in inside.parts:
            continue  # The list of files was edited.
        path = folder / inside
        if path.parent.resolve() != folder.resolve() / inside.parent:
            continue  # A link leads out of the folder.
        path.unlink(missing_ok=True)
        for parent in path.parents:
            if parent == folder:
                break
            with suppress(OSError):  # It is not empty.
                parent.rmdir()


def _write(path: Path, file: File) -> None:
    if path.is_file() and not path.is_symlink() and path.read_bytes() == file.content:
        if (path.stat().st_mode & 0o111 != 0) != file.executable:
            path.chmod(0o755 if file.executable else 0o644)
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        raise IsADirectoryError(EISDIR, os.strerror(EISDIR), str(path))
    replace_file(path, file.content, 0o777 if file.executable else 0o666)
