"""Files that several programs use at once: replacement in one step, and locks."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_BINARY = getattr(os, "O_BINARY", 0)
"""Without it, Windows would change line ends."""


def replace_file(path: Path, content: bytes, mode: int = 0o666, *, keep: bool = False) -> None:
    """Write a file in one step, so that a reader gets either the old content or the new one.

    Args:
        mode: the permissions of the file, from which the umask is removed.
        keep: whether a file that exists keeps its owner and its permissions, and whether a
            symbolic link is followed instead of replaced.

    Raises:
        OSError: it cannot be written, or its owner cannot be kept.
    """
    if keep:
        path = Path(os.path.realpath(path))
    new = path.with_name(f".{path.name}.{os.getpid()}.{os.urandom(4).hex()}")
    try:
        descriptor = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _BINARY, mode)
        with open(descriptor, "wb") as file:
            file.write(content)
        if keep and path.exists():
            _copy_owner_and_mode(path, new)
        os.replace(new, path)
    except BaseException:
        with suppress(OSError):
            new.unlink(missing_ok=True)
        raise


def _copy_owner_and_mode(old: Path, new: Path) -> None:
    wanted, found = old.stat(), new.stat()
    if sys.platform != "win32" and (found.st_uid, found.st_gid) != (wanted.st_uid, wanted.st_gid):
        try:
            os.chown(new, wanted.st_uid, wanted.st_gid)
        except PermissionError:
            fault = "it belongs to another user or group"
            raise PermissionError(errno.EPERM, fault, str(old)) from None
    new.chmod(wanted.st_mode & 0o7777)


if sys.platform == "win32":

    @contextmanager
    def locked(path: Path) -> Iterator[None]:
        """Wait until no other program edits a file, and keep others waiting meanwhile.

        It counts among programs that use this function; for at most ten seconds.

        Raises:
            OSError: there can be no lock beside the file, or it was taken for too long.
        """
        import msvcrt

        lock = path.with_name(f".{path.name}.lock")
        with lock.open("wb") as file:
            msvcrt.locking(file.fileno(), msvcrt.LK_LOCK, 1)
            try:
                yield
            finally:
                file.seek(0)
                msvcrt.locking(file.fileno(), msvcrt.LK_UNLCK, 1)
        with suppress(OSError):  # Another program waits for it.
            lock.unlink()

else:

    @contextmanager
    def locked(path: Path) -> Iterator[None]:
        """Wait until no other program edits a file, and keep others waiting meanwhile.

        It counts among programs that use this function. What is locked is the folder, which is
        there before the file is, and which no replacement of the file changes.

        Raises:
            OSError: the folder cannot be read.
        """
        import fcntl

        folder = os.open(Path(os.path.realpath(path)).parent, os.O_RDONLY)
        try:
            with suppress(OSError):  # Some network file systems have no locks.
                fcntl.flock(folder, fcntl.LOCK_EX)
            yield
        finally:
            os.close(folder)
