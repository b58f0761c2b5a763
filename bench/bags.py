"""Bags: CPU of writing and reading messages, and the memory of reading a large one."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from bench.measure import HUB, Plan, Repeated
from bench.report import Report
from fibws.bags import open_reader, open_writer

FILES = ("none.bag", "bz2.bag", "lz4.bag", "none.mcap", "zstd.mcap")
IMAGE_BYTES = 900_000
LIMIT_SMALL_US = 10.0
"""100,000 messages a second."""
LIMIT_LARGE_MS = 9.0
"""100 MB a second."""
LIMIT_MEMORY_MB = 100.0
_READER = """
import sys
from fibws.bags import open_reader

with open_reader(sys.argv[1]) as reader:
    for _ in reader.messages():
        pass
[peak] = [line for line in open("/proc/self/status") if line.startswith("VmHWM:")]
print(peak.split()[1])
"""
"""It prints its peak memory in KiB, which the kernel does not count from before it was started."""
COMPRESSED_IN_THREADS = ("bz2.bag",)
"""Compression methods that are slower than disks; recorders write in a thread."""


def bags(plan: Plan, report: Report) -> None:
    """Measure messages of 4 bytes and of 900 kB, and reading a bag of 2 GB."""
    small, large = (20_000, 20) if plan.quick else (300_000, 100)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in FILES:
            path = Path(folder) / name
            runs = [
                (*_write_and_read(path, small, bytes(4)), *_write_and_read(path, large, _image()))
                for _ in range(1 if plan.quick else plan.reps)
            ]
            writing, reading, writing_large, reading_large = (
                Repeated.of(each) for each in zip(*runs, strict=True)
            )
            report.record("bags", file=name, runs=runs)
            is_slow = name in COMPRESSED_IN_THREADS
            limits = (LIMIT_SMALL_US, None if is_slow else LIMIT_LARGE_MS * 1000)
            verdicts = (
                report.check(HUB, f"{name}, 4 bytes", writing.median, limits[0], " µs"),
                report.check(HUB, f"{name}, 900 kB", writing_large.median, limits[1], " µs"),
            )
            cells = (f"{writing}", f"{reading}", f"{writing_large}", f"{reading_large}")
            rows.append((name, *cells, ", ".join(filter(None, verdicts))))
        memory = _memory(Path(folder) / "large.bag", 200 if plan.quick else 2200)
    report.table(
        "Bags: CPU µs per message, minimum (median)",
        ("file", "write 4 B", "read 4 B", "write 900 kB", "read 900 kB", "limits"),
        rows,
    )
    verdict = report.check(HUB, "memory of reading a bag", memory, LIMIT_MEMORY_MB, " MB")
    report.table("Reading a large bag", ("memory", "limit"), [(f"{memory:.0f} MB", verdict)])


def _image() -> bytes:
    """Return an image that compresses to about half."""
    return b"".join(os.urandom(500) + bytes(500) for _ in range(IMAGE_BYTES // 1000))


def _write_and_read(path: Path, count: int, data: bytes) -> tuple[float, float]:
    """Return the CPU microseconds of writing a message, and of reading one."""
    start = time.process_time()
    with open_writer(path, path.stem) as writer:
        publisher = writer.connection("/a", "std_msgs/Int32", "*", "int32 data")
        for number in range(count):
            writer.write(publisher, number, data)
    middle = time.process_time()
    with open_reader(path) as reader:
        found = sum(1 for _ in reader.messages())
    end = time.process_time()
    assert found == count
    return (middle - start) * 1e6 / count, (end - middle) * 1e6 / count


def _memory(path: Path, images: int) -> float:
    """Return the memory in MB of a program that reads a bag."""
    with open_writer(path) as writer:
        publishers = [
            writer.connection(topic, "std_msgs/Int32", "*", "int32 data")
            for topic in ("/image", "/number")
        ]
        image = _image()
        for number in range(images):
            writer.write(publishers[0], number * 1000, image)
            for other in range(100):
                writer.write(publishers[1], number * 1000 + other, b"1234")
    words = [sys.executable, "-c", _READER, str(path)]
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    return int(done.stdout) * 1024 / 1e6
