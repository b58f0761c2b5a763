"""The files that a folder is to hold, and how it is brought to that."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from errno import EISDIR
from pathlib import Path, PurePosixPath
from typing import TypeAlias


@dataclass(frozen=True)
class File:
    """What a file is to hold, and whether it is a program."""

    content: bytes
    executable: bool = False


Tree: TypeAlias = dict[str, File]
"""Files by their paths in a folder, with / between the parts."""


def write(folder: Path, tree: Tree) -> None:
    """Write the files of ``tree`` into ``folder``, which is made if it is not there.

    Each is replaced as a whole, so that nobody ever reads half of it; one that is right already
    stays as it is.

    Raises:
        OSError: one cannot be written.
    """
    for name, file in tree.items():
        _write(folder / name, file)


def remove(folder: Path, names: Iterable[str]) -> None:
    """Take files out of ``folder``, and those of its folders that are empty then.

    Raises:
        OSError: one cannot be removed.
    """
    for name in names:
        inside = PurePosixPath(name)
        if inside.is_absolute() or ".." in inside.parts:
            continue  # Somebody has edited the list of files.
        path = folder / inside
        if path.parent.resolve() != folder.resolve() / inside.parent:
            continue  # A link leads out of the folder: what is there is not ours.
        path.unlink(missing_ok=True)
        for parent in path.parents:
            if parent == folder:
                break
            with suppress(OSError):  # It holds something else.
                parent.rmdir()


def _write(path: Path, file: File) -> None:
    mode = 0o755 if file.executable else 0o644
    if path.is_file() and not path.is_symlink() and path.read_bytes() == file.content:
        if (path.stat().st_mode & 0o111 != 0) != file.executable:
            path.chmod(mode)
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        raise IsADirectoryError(EISDIR, os.strerror(EISDIR), str(path))
    handle, name = tempfile.mkstemp(prefix=".fibws-", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as target:
            target.write(file.content)
        os.chmod(name, mode)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
