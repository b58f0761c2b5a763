"""TLS of the hub, compared with nginx's TLS in front of a hub without it, and with no TLS."""

from __future__ import annotations

import os
import shutil
import socket
import ssl
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

from bench.client import frame, operation
from bench.handshake import connected, handshake
from bench.machine import cpu_seconds, cpus, free_port, on_load_cpu
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import START_SECONDS, running
from fibws.hub.tls.self_signed import Files, ensure_certificate

PLAIN, TLS, NGINX = "{} without TLS", "{} with TLS", "nginx with TLS, {}"
TOPIC, TYPE = "/text", "std_msgs/String"
SUBSCRIBERS = 4
HANDSHAKES = 100
QUICK_HANDSHAKES = 20
SAME_AS_NGINX = 1.0
"""Most CPU time of a delivery by the hub's TLS, as a ratio to nginx and the hub behind it."""


@dataclass(frozen=True)
class Cell:
    """Messages of one size; the publisher sends as many at once, and waits for all deliveries."""

    payload: int
    window: int

    @property
    def name(self) -> str:
        """Return the name in the table."""
        return f"1 → {SUBSCRIBERS}, {self.payload >> 10} KiB, window {self.window}"


CELLS = (Cell(1 << 10, 64), Cell(1 << 18, 4))


@dataclass(frozen=True)
class Way:
    """A way to a hub: its port, its TLS if any, and the processes that work for it."""

    name: str
    port: int
    context: ssl.SSLContext | None
    pids: Sequence[int]

    @property
    def cpu_seconds(self) -> float:
        """Return the CPU time that the processes have used."""
        return sum(map(cpu_seconds, self.pids))


@dataclass(frozen=True)
class Throughput:
    """CPU time of the servers for one delivery, and deliveries in a second."""

    cpu_us: float
    per_s: float


def tls(plan: Plan, report: Report) -> None:
    """Measure deliveries and handshakes by each way in turn."""
    for hub in plan.hubs:
        with tempfile.TemporaryDirectory() as folder, _ways(hub, Path(folder)) as ways:
            with on_load_cpu():
                _deliveries(hub, ways, plan, report)
                _handshakes(hub, ways, plan, report)


def _deliveries(hub: str, ways: Sequence[Way], plan: Plan, report: Report) -> None:
    rows = []
    for cell in CELLS[:1] if plan.quick else CELLS:
        found: dict[str, list[Throughput]] = {way.name: [] for way in ways}
        for rep in range(plan.reps):
            for way in ways:
                seen = _measure(way, cell, plan)
                found[way.name].append(seen)
                report.record("tls", server=way.name, cell=cell.name, rep=rep, **vars(seen))
        for name, each in found.items():
            cost = [one.cpu_us for one in each]
            to_plain = Repeated.ratio(cost, [one.cpu_us for one in found[PLAIN.format(hub)]])
            proxied = found.get(NGINX.format(hub), [])
            to_nginx = Repeated.ratio(cost, [one.cpu_us for one in proxied]) if proxied else None
            verdict = ""
            if to_nginx is not None and name == TLS.format(hub):
                what = f"TLS, {cell.name}, against nginx"
                verdict = report.check(hub, what, to_nginx.median, SAME_AS_NGINX)
            rows.append(
                (
                    cell.name,
                    name,
                    f"{Repeated.of(cost)}",
                    f"{to_plain}",
                    f"{to_nginx}" if to_nginx is not None else "",
                    verdict,
                    f"{max(one.per_s for one in each):,.0f}",
                )
            )
    report.table(
        f"TLS: CPU, µs per delivery, minimum (median) of {plan.reps}",
        ("messages", "server", "CPU", ": no TLS", ": nginx", "limit", "deliveries/s"),
        rows,
    )


def _measure(way: Way, cell: Cell, plan: Plan) -> Throughput:
    with ExitStack() as stack:
        publisher, *subscribers = [
            stack.enter_context(connected(way.port, context=way.context))
            for _ in range(1 + SUBSCRIBERS)
        ]
        for subscriber in subscribers:
            subscriber.sendall(operation("subscribe", topic=TOPIC, type=TYPE))
            _ping(subscriber)
        publisher.sendall(operation("advertise", topic=TOPIC, type=TYPE))
        _ping(publisher)
        message = operation("publish", topic=TOPIC, msg={"data": "x" * cell.payload})
        publisher.sendall(message)
        sizes = {_frame_size(subscriber) for subscriber in subscribers}
        if len(sizes) != 1:
            raise BenchError(f"{way.name}: subscribers received frames of {sizes} bytes")
        batch, expected = message * cell.window, sizes.pop() * cell.window

        def repeat(seconds: float) -> int:
            rounds, end = 0, time.perf_counter() + seconds
            while time.perf_counter() < end:
                publisher.sendall(batch)
                for subscriber in subscribers:
                    _read(subscriber, expected)
                rounds += 1
            return rounds * cell.window * SUBSCRIBERS

        repeat(plan.warm_seconds)
        start, used = time.perf_counter(), way.cpu_seconds
        deliveries = repeat(plan.seconds)
        used, seconds = way.cpu_seconds - used, time.perf_counter() - start
        return Throughput(used / deliveries * 1e6, deliveries / seconds)


def _handshakes(hub: str, ways: Sequence[Way], plan: Plan, report: Report) -> None:
    count = QUICK_HANDSHAKES if plan.quick else HANDSHAKES
    rows = []
    for way in ways:
        costs, times = [], []
        for _ in range(plan.reps):
            used = way.cpu_seconds
            times += [handshake(way.port, context=way.context) * 1000 for _ in range(count)]
            costs.append((way.cpu_seconds - used) / count * 1000)
        report.record("tls handshake", server=way.name, cpu_ms=costs)
        rows.append((way.name, f"{Repeated.of(costs)}", f"{Repeated.of(times)}"))
    report.table(
        f"TLS: {count} handshakes one after the other, minimum (median)",
        ("server", "CPU of one, ms", "time, ms"),
        rows,
    )


@contextmanager
def _ways(hub: str, folder: Path) -> Iterator[list[Way]]:
    """Start the servers; nginx only if it is installed."""
    with patch.dict(os.environ, XDG_STATE_HOME=str(folder)), ExitStack() as stack:
        files = ensure_certificate([])
        context = ssl.create_default_context(cafile=files.authority)
        plain = stack.enter_context(running(hub))
        secure = stack.enter_context(running(hub, options=("--self-signed",), context=context))
        ways = [
            Way(PLAIN.format(hub), plain.port, None, [plain.pid]),
            Way(TLS.format(hub), secure.port, context, [secure.pid]),
        ]
        program = shutil.which("nginx", path="/usr/sbin:/usr/bin:/usr/local/bin")
        if program is None:
            print("note: nginx is not installed, so that nothing is compared with it")
        else:
            port, pid = stack.enter_context(_nginx(program, folder, files, plain.port, context))
            ways.append(Way(NGINX.format(hub), port, context, [pid, plain.pid]))
        yield ways


@contextmanager
def _nginx(
    program: str, folder: Path, files: Files, hub: int, context: ssl.SSLContext
) -> Iterator[tuple[int, int]]:
    """Run nginx in front of a hub; yield its port and its process."""
    port = free_port()
    temporary = "".join(
        f"{name}_temp_path {folder / name}; "
        for name in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    config = folder / "nginx.conf"
    config.write_text(
        f"daemon off; master_process off; pid {folder}/pid; error_log {folder}/log;\n"
        f"events {{}} http {{ access_log off; {temporary}\n"
        f"server {{ listen 127.0.0.1:{port} ssl;\n"
        f"ssl_certificate {files.certificate}; ssl_certificate_key {files.certificate};\n"
        f"location / {{ proxy_pass http://127.0.0.1:{hub}; proxy_http_version 1.1;\n"
        "proxy_set_header Upgrade $http_upgrade; proxy_set_header Connection upgrade; } } }\n"
    )
    process = subprocess.Popen(
        [program, "-c", config, "-e", folder / "log"],
        stdin=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        if chosen := cpus():
            os.sched_setaffinity(process.pid, {chosen.server})
        deadline = time.monotonic() + START_SECONDS
        while True:
            try:
                handshake(port, context=context)
                break
            except BenchError:
                if process.poll() is not None or time.monotonic() > deadline:
                    raise BenchError(f"nginx: {(folder / 'log').read_text().strip()}") from None
                time.sleep(0.01)
        yield port, process.pid
    finally:
        process.terminate()
        process.wait()


_BUFFER = memoryview(bytearray(1 << 18))


def _ping(client: socket.socket) -> None:
    """Wait until the hub has read everything that was sent."""
    client.sendall(frame(b"", 0x89))
    _read(client, 2)


def _frame_size(client: socket.socket) -> int:
    """Read a frame and return its size."""
    _read(client, 2)
    length = _BUFFER[1]
    extra = {126: 2, 127: 8}.get(length, 0)
    if extra:
        _read(client, extra)
        length = int.from_bytes(_BUFFER[:extra])
    _read(client, length)
    return 2 + extra + length


def _read(client: socket.socket, size: int) -> None:
    """Read as many bytes; the last ones are in the buffer."""
    while size:
        read = client.recv_into(_BUFFER, min(size, len(_BUFFER)))
        if not read:
            raise BenchError("the hub has closed a connection")
        size -= read
