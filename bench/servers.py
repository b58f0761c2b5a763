"""The servers that are measured: the hub, the relay in C, the naive hub."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import IO

from bench import plan
from bench.binaries import binary
from bench.errors import BenchError
from bench.handshake import handshake
from bench.machine import cpu_seconds, cpus

ROOT = Path(__file__).parents[1]
ADDRESS = re.compile(rb"ws://[\d.]+:(\d+)")
START_SECONDS = 20.0
STOP_SECONDS = 10.0


@dataclass(frozen=True)
class Server:
    """A server that runs, and the seconds it took from exec to its first handshake."""

    name: str
    pid: int
    port: int
    start_seconds: float

    @property
    def cpu_seconds(self) -> float:
        """Return the CPU time that it has taken."""
        return cpu_seconds(self.pid)


@contextmanager
def running(name: str) -> Iterator[Server]:
    """Start the server of that name on a free port of 127.0.0.1, and stop it in the end."""
    command = _command(name)
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with tempfile.TemporaryFile() as log:
        start = time.perf_counter()
        process = subprocess.Popen(
            command,
            cwd=ROOT,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        try:
            if chosen := cpus():
                os.sched_setaffinity(process.pid, {chosen.server})
            port = _port(name, process, log)
            handshake(port)
            yield Server(name, process.pid, port, time.perf_counter() - start)
            if process.poll() is not None:
                raise BenchError(f"{name} ended while it was measured: {_tail(log)}")
        finally:
            _stop(process)


@contextmanager
def all_running(names: Sequence[str]) -> Iterator[list[Server]]:
    """Start several servers, which idle until it is their turn."""
    with ExitStack() as stack:
        yield [stack.enter_context(running(name)) for name in names]


def _command(name: str) -> list[str]:
    match name:
        case plan.HUB:
            return [sys.executable, "-m", "bench.plain", "--port", "0"]
        case plan.HUB_UVLOOP:
            if find_spec("uvloop") is None:
                raise BenchError("--uvloop: uvloop is not installed")
            return [sys.executable, "-m", "fibws.hub", "--port", "0"]
        case plan.NAIVE:
            return [sys.executable, "-m", "bench.naive"]
        case plan.RELAY:
            # -c: what arrives in one read leaves in one write, the best that can be done.
            return [str(binary("relay")), "0", "-c"]
        case _:
            raise ValueError(name)


def _port(name: str, process: subprocess.Popen[bytes], log: IO[bytes]) -> int:
    deadline = time.monotonic() + START_SECONDS
    while time.monotonic() < deadline:
        if found := ADDRESS.search(_read(log)):
            return int(found[1])
        if process.poll() is not None:
            raise BenchError(f"{name} ended with {process.returncode}: {_tail(log)}")
        time.sleep(0.001)
    raise BenchError(f"{name} printed no address in {START_SECONDS:g} s: {_tail(log)}")


def _read(log: IO[bytes]) -> bytes:
    # pread leaves alone the position, which the server shares with us.
    return os.pread(log.fileno(), 1 << 20, 0)


def _tail(log: IO[bytes]) -> str:
    lines = _read(log).decode(errors="replace").strip().splitlines()
    return lines[-1] if lines else "no output"


def _stop(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(STOP_SECONDS)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
