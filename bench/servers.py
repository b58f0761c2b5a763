"""The servers to measure: the hub, a hub of another checkout, the relay in C, the naive hub."""

from __future__ import annotations

import os
import re
import shutil
import ssl
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

from bench import measure
from bench.handshake import handshake
from bench.machine import cpu_seconds, cpus
from bench.measure import BenchError

HERE = Path(__file__).parent
ROOT = HERE.parent
BUILD = HERE / "build"
ADDRESS = re.compile(rb"wss?://[\d.]+:(\d+)")
START_SECONDS = 20.0
STOP_SECONDS = 10.0
# None in sys.modules makes `import uvloop` fail, as if it were not installed.
HUB_WITHOUT_UVLOOP = (
    "import runpy, sys; sys.modules['uvloop'] = None; "
    "runpy.run_module('fibws.hub', run_name='__main__', alter_sys=True)"
)


@dataclass(frozen=True)
class Server:
    """A running server, and the seconds it took from exec to its first handshake."""

    name: str
    pid: int
    port: int
    start_seconds: float

    @property
    def cpu_seconds(self) -> float:
        """Return the CPU time that the server has used."""
        return cpu_seconds(self.pid)


@contextmanager
def running(
    name: str,
    *,
    checkout: Path = ROOT,
    pinned: bool = True,
    options: Sequence[str] = (),
    context: ssl.SSLContext | None = None,
) -> Iterator[Server]:
    """Start a server on a free port of 127.0.0.1 and stop it on leaving.

    Args:
        name: which server: a hub, the relay or the naive hub.
        checkout: the folder that has the hub's source.
        pinned: whether to keep the server on one CPU.
        options: further options of the hub's command line.
        context: for a server with TLS.
    """
    environment = {**os.environ, "PYTHONUNBUFFERED": "1", "PYTHONPATH": str(checkout)}
    with tempfile.TemporaryFile() as log:
        start = time.perf_counter()
        process = subprocess.Popen(
            [*_command(name), *options],
            cwd=checkout,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        try:
            if pinned and (chosen := cpus()):
                os.sched_setaffinity(process.pid, {chosen.server})
            port = _port(name, process, log)
            handshake(port, context=context)
            yield Server(name, process.pid, port, time.perf_counter() - start)
            if process.poll() is not None:
                raise BenchError(f"{name} exited during the measurement: {_tail(log)}")
        finally:
            _stop(process)


@contextmanager
def all_running(names: Sequence[str], *, against: Path | None = None) -> Iterator[list[Server]]:
    """Start several servers; each is idle until it is measured.

    Args:
        names: which servers.
        against: the checkout of the server called "base".
    """
    with ExitStack() as stack:
        yield [
            stack.enter_context(
                running(name, checkout=against if against and name == measure.BASE else ROOT)
            )
            for name in names
        ]


def binary(name: str) -> Path:
    """Return the path of a C program, compiled first if its source file is newer."""
    source, program = HERE / f"{name}.c", BUILD / name
    if program.exists() and program.stat().st_mtime >= source.stat().st_mtime:
        return program
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        raise BenchError("C compiler not found; install gcc (or cc) to build the load generator")
    BUILD.mkdir(exist_ok=True)
    made = subprocess.run(
        [compiler, "-O2", "-o", program, source], capture_output=True, text=True, check=False
    )
    if made.returncode:
        last = (made.stderr.strip().splitlines() or ["no message"])[-1]
        raise BenchError(f"{compiler} failed on {source.name}: {last}")
    return program


def _command(name: str) -> list[str]:
    match name:
        case measure.HUB | measure.BASE:
            return [sys.executable, "-c", HUB_WITHOUT_UVLOOP, "--port", "0"]
        case measure.HUB_UVLOOP:
            if find_spec("uvloop") is None:
                raise BenchError("--uvloop: uvloop is not installed")
            return [sys.executable, "-m", "fibws.hub", "--port", "0"]
        case measure.NAIVE:
            return [sys.executable, "-m", "bench.naive"]
        case measure.RELAY:
            # -c: frames that arrive in one read leave in one write, the best that can be done.
            return [str(binary("relay")), "0", "-c"]
        case _:
            raise ValueError(name)


def _port(name: str, process: subprocess.Popen[bytes], log: IO[bytes]) -> int:
    deadline = time.monotonic() + START_SECONDS
    while time.monotonic() < deadline:
        if found := ADDRESS.search(_read(log)):
            return int(found[1])
        if process.poll() is not None:
            raise BenchError(f"{name} exited with status {process.returncode}: {_tail(log)}")
        time.sleep(0.001)
    raise BenchError(f"{name} printed no address within {START_SECONDS:g} s: {_tail(log)}")


def _read(log: IO[bytes]) -> bytes:
    # pread leaves the file position alone, which is shared with the server.
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
