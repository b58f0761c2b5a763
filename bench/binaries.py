"""The two C programs, compiled when their source is newer."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from bench.errors import BenchError

HERE = Path(__file__).parent
BUILD = HERE / "build"


def binary(name: str) -> Path:
    """Return the program of that name, compiled from the C file of that name."""
    source, program = HERE / f"{name}.c", BUILD / name
    if program.exists() and program.stat().st_mtime >= source.stat().st_mtime:
        return program
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        raise BenchError("no C compiler: install gcc (or cc) to build the load generator")
    BUILD.mkdir(exist_ok=True)
    made = subprocess.run(
        [compiler, "-O2", "-o", program, source], capture_output=True, text=True, check=False
    )
    if made.returncode:
        last = (made.stderr.strip().splitlines() or ["no message"])[-1]
        raise BenchError(f"{compiler} does not compile {source.name}: {last}")
    return program
