"""The machine: its description, its CPUs and the CPU time of processes."""

from __future__ import annotations

import os
import platform
import random
import resource
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from bench.measure import BenchError


@dataclass(frozen=True)
class Cpus:
    """The CPUs of the server, of the load generator, and of a second generator that floods."""

    server: int
    load: int
    flood: int


def require_linux() -> None:
    """Raise unless this is Linux: the load generator needs epoll."""
    if not sys.platform.startswith("linux"):
        raise BenchError(f"the load generator needs Linux, this is {sys.platform}")


def cpus() -> Cpus | None:
    """Return three CPUs, on different cores if possible; None if there is only one CPU."""
    free = sorted(os.sched_getaffinity(0))
    if len(free) < 2:
        return None
    server = free.pop(0)
    # Hyper-threads of one core slow each other down, so siblings come last.
    free.sort(key=lambda cpu: cpu in _siblings(server))
    load = free.pop(0)
    free.sort(key=lambda cpu: cpu in _siblings(server) | _siblings(load))
    return Cpus(server, load, free[0] if free else load)


def _siblings(cpu: int) -> set[int]:
    path = Path(f"/sys/devices/system/cpu/cpu{cpu}/topology/thread_siblings_list")
    try:
        ranges = path.read_text().strip().split(",")
    except OSError:
        return {cpu}
    found: set[int] = set()
    for each in ranges:
        first, _, last = each.partition("-")
        found.update(range(int(first), int(last or first) + 1))
    return found


def free_port() -> int:
    """Return a port of 127.0.0.1 for a program that cannot choose one itself.

    It lies below those that systems give to outgoing connections, so that none takes it before the
    program does, or while the program restarts.
    """
    while True:
        port = random.randrange(10_000, 30_000)
        with suppress(OSError), socket.create_server(("127.0.0.1", port)):
            return port


@contextmanager
def pinned(cpu: int) -> Iterator[None]:
    """Keep this process on one CPU during the block."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {cpu})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def on_load_cpu() -> AbstractContextManager[None]:
    """Keep this process off the server's CPU during the block."""
    chosen = cpus()
    return pinned(chosen.load) if chosen else nullcontext()


def cpu_seconds(pid: int) -> float:
    """Return the CPU time of a process, user and system, with a resolution of nanoseconds."""
    # The clock of clock_getcpuclockid(3), which Python only offers for threads.
    return time.clock_gettime(~pid << 3 | 2)


def memory(pid: int) -> dict[str, int]:
    """Return a process's memory in bytes, by the names of proc(5): VmRSS now, VmHWM at most."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    fields = (line.split() for line in lines if line.startswith("Vm"))
    return {name.rstrip(":"): int(kibibytes) * 1024 for name, kibibytes, _ in fields}


class Disturbance:
    """The CPU time of other processes, from now on."""

    def __init__(self) -> None:
        """Start to count."""
        self._wall = time.monotonic()
        self._others = _busy_seconds() - _own_seconds()

    def percent(self) -> float:
        """Return the share of all CPUs that others used; only right after our children ended."""
        others = _busy_seconds() - _own_seconds() - self._others
        available = (time.monotonic() - self._wall) * (os.cpu_count() or 1)
        return max(0.0, 100 * others / available)


def _busy_seconds() -> float:
    fields = Path("/proc/stat").read_text().splitlines()[0].split()[1:]
    user, nice, system, _idle, _iowait, irq, softirq, steal = map(int, fields[:8])
    ticks = user + nice + system + irq + softirq + steal
    return ticks / os.sysconf("SC_CLK_TCK")


def _own_seconds() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def describe() -> str:
    """Return one line: CPU, system, Python and the versions of relevant packages."""
    packages = ("websockets", "pydantic", "pydantic-core", "uvloop")
    versions = [f"{name} {found}" for name in packages if (found := _version(name))]
    return ", ".join(
        [
            f"{_cpu_model()}, {os.cpu_count()} CPUs",
            f"{platform.system()} {platform.release()}",
            f"{platform.python_implementation()} {platform.python_version()}",
            *versions,
        ]
    )


def _cpu_model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    for line in lines:
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.machine()


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
