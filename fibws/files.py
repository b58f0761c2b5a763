"""Files that are kept: where they are, replacement in one step, and locks."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import FileIO
from pathlib import Path
from tempfile import TemporaryFile
from time import sleep

LOCK_LOOKS, LOCK_INTERVAL = 250, 0.02
"""Looks at a lock that is waited for, and seconds between two of them."""
_BINARY = getattr(os, "O_BINARY", 0)
"""Without it, Windows would change line ends."""


def replace_file(
    path: Path, content: bytes, mode: int = 0o666, *, keep: bool = False, sync: bool = False
) -> None:
    """Write a file in one step, so that a reader gets either the old content or the new one.

    Args:
        mode: the permissions of the file, from which the umask is removed.
        keep: whether a file that exists keeps its owner and its permissions, and whether a
            symbolic link is followed instead of replaced.
        sync: wait until the content is on the disk, so that the file is whole after a power cut.

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
            if sync:
                file.flush()
                os.fsync(file.fileno())
        if keep and path.exists():
            _copy_owner_and_mode(path, new)
        os.replace(new, path)
    except BaseException:
        with suppress(OSError):
            new.unlink(missing_ok=True)
        raise


def state_folder() -> Path:
    """Return the folder for files that a program keeps: systemd's $STATE_DIRECTORY, or the user's.

    The user's is ``fibws`` in $XDG_STATE_HOME or ``~/.local/state``.
    """
    if folder := os.environ.get("STATE_DIRECTORY", "").partition(":")[0]:
        return Path(folder)
    state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(state) / "fibws"


def make_private(folder: Path) -> None:
    """Create a folder, with those above it that are missing, for this user alone.

    The umask adds nothing: whoever may write to a folder can replace what is in it.

    Raises:
        OSError: it cannot be created.
    """
    if not folder.is_dir():
        make_private(folder.parent)
        folder.mkdir(mode=0o700, exist_ok=True)


def check_writable(folder: Path) -> None:
    """Create a folder if it is missing, and a file in it, which is removed again.

    Raises:
        OSError: it cannot be created, or no file in it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryFile(dir=folder):
        pass


@contextmanager
def replacing(path: Path, *, backup: Path | None = None) -> Iterator[Path]:
    """Write a file that may be large in one step: the block writes a new file beside it.

    After the block, the new file takes the old one's place, and its owner and permissions. If the
    block raises, it is removed, and the old one remains. A symbolic link is followed.

    Args:
        backup: another name to keep the old file by; a file of this name is replaced.

    Yields:
        The path of the new file, which has the same suffix and does not exist so far.

    Raises:
        BlockingIOError: a program writes the old file; see `open_to_write`.
        OSError: it cannot be written, or its owner cannot be kept.
    """
    given, path = path, Path(os.path.realpath(path))
    check_not_written(path)
    new = path.with_name(f".{path.stem}.{os.getpid()}.{os.urandom(4).hex()}{path.suffix}")
    try:
        yield new
        check_not_written(path)
        if path.exists():
            _copy_owner_and_mode(path, new)
            if backup is not None:
                _keep_as(path, backup)
        os.replace(new, path)
    except BaseException as error:
        if isinstance(error, OSError) and error.filename == os.fspath(new):
            error.filename = os.fspath(given)  # The new file's name means nothing to anybody.
        with suppress(OSError):
            new.unlink(missing_ok=True)
        raise


def _keep_as(path: Path, backup: Path) -> None:
    """Give a file a second name; rename it where files cannot have two."""
    link = backup.with_name(f".{backup.name}.{os.getpid()}.{os.urandom(4).hex()}")
    try:
        os.link(path, link)
    except OSError:
        os.replace(path, backup)
    else:
        os.replace(link, backup)


def _copy_owner_and_mode(old: Path, new: Path) -> None:
    wanted, found = old.stat(), new.stat()
    if sys.platform != "win32" and (found.st_uid, found.st_gid) != (wanted.st_uid, wanted.st_gid):
        try:
            os.chown(new, wanted.st_uid, wanted.st_gid)
        except PermissionError:
            fault = "it belongs to another user or group"
            raise PermissionError(errno.EPERM, fault, str(old)) from None
    new.chmod(wanted.st_mode & 0o7777)


def open_to_write(path: str | os.PathLike[str], *, truncate: bool = True) -> FileIO:
    """Open a file for reading and writing, without a buffer, and lock it until it is closed.

    The lock counts among programs that use this function or `check_not_written`. It stays with the
    file when that gets another name, and is free when the program is killed.

    Args:
        truncate: begin with an empty file, which need not exist; else the file must exist.

    Raises:
        BlockingIOError: another program writes it.
        OSError: it cannot be opened.
    """
    flags = os.O_RDWR | _BINARY | (os.O_CREAT if truncate else 0)
    file = open(path, "r+b", buffering=0, opener=lambda name, _: os.open(name, flags, 0o666))
    try:
        if not _try_lock_end(file.fileno()):
            raise _being_written(path)
        if truncate:
            file.truncate()
    except BaseException:
        file.close()
        raise
    return file


def check_not_written(path: str | os.PathLike[str]) -> None:
    """Check that no program writes a file that `open_to_write` has opened, if there is one.

    Raises:
        BlockingIOError: a program does; the text says which, where the system tells.
    """
    try:
        file = open(path, "rb")
    except OSError:
        return
    with file:
        if not _try_lock_end(file.fileno()):
            raise _being_written(path)


def _being_written(path: str | os.PathLike[str]) -> BlockingIOError:
    text = f"being written by {lock_holder(path) or 'another program'}"
    return BlockingIOError(errno.EAGAIN, text, os.fspath(path))


def lock_holder(path: str | os.PathLike[str], kind: str = "FLOCK") -> str:
    """Return which process has locked a file; empty if none has, or the system does not tell.

    Args:
        kind: of the lock, as in /proc/locks: ``FLOCK`` or ``POSIX``.
    """
    for words in _locks(path):
        if words[1] == kind:
            with suppress(OSError, ValueError):
                command = Path(f"/proc/{int(words[4])}/cmdline").read_bytes().split(b"\0")
                words_of = b" ".join(command).decode("utf-8", "replace").strip()
                return f"process {words[4]} ({words_of})"
    return ""


def has_write_lock(path: str | os.PathLike[str], byte: int) -> bool:
    """Return whether a program has a POSIX lock to write a byte; False if nobody tells."""
    return any(
        words[1] == "POSIX"
        and words[3] == "WRITE"
        and int(words[6]) <= byte
        and (words[7] == "EOF" or byte <= int(words[7]))
        for words in _locks(path)
    )


def wait_for_write_lock(path: str | os.PathLike[str], byte: int) -> bool:
    """Wait until no program has a POSIX lock to write a byte.

    Returns:
        False if one still has after some seconds.
    """
    for _ in range(LOCK_LOOKS):
        if not has_write_lock(path, byte):
            return True
        sleep(LOCK_INTERVAL)
    return False


def _locks(path: str | os.PathLike[str]) -> Iterator[list[str]]:
    """Yield the words of each line of /proc/locks about a file; nothing without /proc."""
    try:
        inode = str(os.stat(path).st_ino)
        lines = Path("/proc/locks").read_text(encoding="ascii").splitlines()
    except (OSError, ValueError):
        return
    for words in map(str.split, lines):
        if len(words) == 8 and words[5].rpartition(":")[2] == inode:
            yield words


@contextmanager
def reserved(path: Path) -> Iterator[None]:
    """Reserve a file, which need not exist, for this program; a killed program frees it.

    It counts among programs that use this function. What is locked is an empty file beside it,
    which stays: a program that waited for a lock on a removed one would not exclude others.

    Raises:
        BlockingIOError: another program has reserved it.
        OSError: there can be no file beside it.
    """
    with path.with_name(f".{path.name}.lock").open("wb") as file:
        if not _try_lock(file.fileno()):
            raise BlockingIOError(errno.EAGAIN, "another program uses it", str(path))
        yield


if sys.platform == "win32":

    def _try_lock(descriptor: int) -> bool:
        import msvcrt

        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

    def _try_lock_end(descriptor: int) -> bool:
        """Lock a byte far beyond the file's end: nobody can read one that is locked."""
        os.lseek(descriptor, 2**62, os.SEEK_SET)
        try:
            return _try_lock(descriptor)
        finally:
            os.lseek(descriptor, 0, os.SEEK_SET)

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

    def _try_lock(descriptor: int) -> bool:
        import fcntl

        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        except OSError:
            pass  # Some network file systems have no locks.
        return True

    _try_lock_end = _try_lock

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
