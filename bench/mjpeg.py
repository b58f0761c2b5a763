"""web_video_server: CPU of a camera's images to browsers, and the frames that they get."""

from __future__ import annotations

import selectors
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from bench.environments import STOP_SECONDS, Environment, Script, on_hub
from bench.machine import cpu_seconds, free_port
from bench.measure import HUB, BenchError, Plan, Repeated
from bench.report import Report

TOPIC = "/bench_camera"
IMAGE_BYTES = 40_000
"""A JPEG of 640 x 480."""
HZ, VIEWERS = 30, 10
LIMIT_CPU_PERCENT = 15.0


def mjpeg(plan: Plan, report: Report) -> None:
    """Measure the server and the hub while ten viewers watch one camera."""
    arguments = (str(IMAGE_BYTES), str(HZ))
    with on_hub() as (_, environment), environment.script("camera.py", *arguments) as camera:
        camera.line()
        with _server(environment) as (pid, port), Viewers(port) as viewers:
            viewers.wait_for_frames()
            runs = [
                _watch(environment, camera, pid, viewers, plan)
                for _ in range(1 if plan.quick else 3)
            ]
    server, hub, shown = (Repeated.of(each) for each in zip(*runs, strict=True))
    for at, run in enumerate(runs):
        report.record("mjpeg", rep=at, server=run[0], hub=run[1], shown=run[2])
    what = f"MJPEG at {HZ} Hz to {VIEWERS} viewers"
    verdict = report.check(HUB, what, server.median, LIMIT_CPU_PERCENT, " %")
    report.table(
        f"Images of {IMAGE_BYTES // 1000} kB at {HZ} Hz through web_video_server to {VIEWERS} "
        "viewers: CPU, percent of a core, minimum (median)",
        ("web_video_server", "hub", "frames per viewer and second", "limit"),
        [(f"{server} %", f"{hub} %", f"{shown}", verdict)],
    )


def _watch(
    environment: Environment, camera: Script, pid: int, viewers: Viewers, plan: Plan
) -> tuple[float, float, float]:
    """Return the CPU of the server and of the hub in percent, and the frames per second."""
    assert environment.hub is not None
    _catch_up(camera)
    frames = max(10, round(HZ * plan.seconds))
    start = time.perf_counter()
    server, hub, received = cpu_seconds(pid), environment.hub.cpu_seconds, viewers.received
    for _ in range(frames):
        camera.line()
    seconds = time.perf_counter() - start
    shown = (viewers.received - received) / IMAGE_BYTES / VIEWERS / seconds
    if shown < HZ / 2:
        raise BenchError(f"the viewers received only {shown:.1f} of {HZ} images per second")
    return (
        (cpu_seconds(pid) - server) / seconds * 100,
        (environment.hub.cpu_seconds - hub) / seconds * 100,
        shown,
    )


def _catch_up(camera: Script) -> None:
    """Read the lines that have waited, until one takes as long as a new one does."""
    waited = 0.0
    while waited < 0.5 / HZ:
        start = time.perf_counter()
        camera.line()
        waited = time.perf_counter() - start


@contextmanager
def _server(environment: Environment) -> Iterator[tuple[int, int]]:
    """Run web_video_server; yield its process id and its port."""
    port = free_port()
    process = subprocess.Popen(
        [sys.executable, "-m", "fibws.programs.web_video_server", f"_port:={port}"],
        env=environment.variables,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
    )
    try:
        assert process.stdout is not None
        if not process.stdout.readline():
            raise BenchError("web_video_server did not start")
        yield process.pid, port
    finally:
        process.terminate()
        with suppress(subprocess.TimeoutExpired):
            process.wait(STOP_SECONDS)
        process.kill()
        process.communicate()


class Viewers:
    """Browsers that read a stream, in one thread.

    Attributes:
        received: the bytes that all of them have received.
    """

    def __init__(self, port: int) -> None:
        self.received = 0
        self._all_have_frames = threading.Event()
        self._selector = selectors.DefaultSelector()
        self._sockets = [socket.create_connection(("127.0.0.1", port)) for _ in range(VIEWERS)]
        self._counts = dict.fromkeys(self._sockets, 0)
        for each in self._sockets:
            request = f"GET /stream?topic={TOPIC} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
            each.sendall(request.encode())
            each.setblocking(False)
            self._selector.register(each, selectors.EVENT_READ)
        self._closed = False
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def wait_for_frames(self) -> None:
        """Wait until each viewer has an image."""
        if not self._all_have_frames.wait(30):
            raise BenchError("web_video_server sends no images")

    def __enter__(self) -> Viewers:
        """Do nothing; they read."""
        return self

    def __exit__(self, *failure: object) -> None:
        """Disconnect."""
        self._closed = True
        self._thread.join()
        for each in self._sockets:
            each.close()

    def _read(self) -> None:
        while not self._closed:
            for key, _ in self._selector.select(0.1):
                viewer = key.fileobj
                assert isinstance(viewer, socket.socket)
                data = viewer.recv(1 << 20)
                if not data:
                    self._selector.unregister(viewer)
                self.received += len(data)
                self._counts[viewer] += len(data)
            if min(self._counts.values()) >= IMAGE_BYTES:
                self._all_have_frames.set()
