"""How much memory this process may use: that of its container or service, or of the machine."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

UNKNOWN = 4 * 2**30
"""Bytes that count where the system does not tell."""


def available_memory(root: Path = Path("/")) -> int:
    """Return the bytes that this process may use at most.

    That is the least limit of its control groups, of version 1 or 2, and not more than the machine
    has.

    Args:
        root: the folder in which ``proc`` and ``sys`` are.
    """
    return min(_machine_memory(), *_group_limits(root), sys.maxsize)


def _machine_memory() -> int:
    if sys.platform == "win32":
        return _windows_memory()
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError):
        return UNKNOWN


def _windows_memory() -> int:
    import ctypes

    libraries = getattr(ctypes, "windll", None)
    size = ctypes.c_ulonglong()
    if libraries is None:
        return UNKNOWN
    # It gives kilobytes, and fails where the firmware does not tell.
    found = libraries.kernel32.GetPhysicallyInstalledSystemMemory(ctypes.byref(size))
    return size.value * 1024 if found else UNKNOWN


def _group_limits(root: Path) -> Iterator[int]:
    """Yield the limits of the process's control groups, and of those above them."""
    with suppress(OSError):
        text = (root / "proc/self/cgroup").read_text("utf-8", "replace")
        for line in text.splitlines():
            _, _, rest = line.partition(":")
            controllers, _, path = rest.partition(":")
            if not controllers:
                yield from _limits(root / "sys/fs/cgroup", path, "memory.max")
            elif "memory" in controllers.split(","):
                yield from _limits(root / "sys/fs/cgroup/memory", path, "memory.limit_in_bytes")


def _limits(top: Path, path: str, name: str) -> Iterator[int]:
    """Yield the limits in a group's folder and in those above it.

    In a container some of them may be missing: then the top is the container's own group.
    """
    group = top / path.lstrip("/")
    for folder in (group, *group.parents):
        if folder.is_relative_to(top):
            with suppress(OSError, ValueError):  # Version 2 says "max" for no limit.
                yield int((folder / name).read_text("ascii"))
