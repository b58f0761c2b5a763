"""The cost of authentication: per message, per handshake, and when everybody comes back at once."""

from __future__ import annotations

import asyncio
import multiprocessing
import socket
import struct
import tempfile
import time
from contextlib import suppress
from multiprocessing.queues import Queue
from multiprocessing.synchronize import Event
from pathlib import Path

import jwt

from bench.handshake import connected
from bench.load import load
from bench.measure import HUB, BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, running
from fibws.access.rights import Rights
from fibws.access.token_file import TokenFile

LIMIT_RATIO = 1.01
"""Of the CPU per delivery, against a hub without authentication."""
LIMIT_JWT_MS = 0.3
LIMIT_BACK_SECONDS = 10.0
LIMIT_LAG_MS = 250.0
CLIENTS = 1000
HANDSHAKES = 300
QUICK_HANDSHAKES = 100
EVERYTHING = Rights({"publish": ["/**"], "subscribe": ["/**"], "node": ["/**"]})
LOAD = ("--subs", "10", "--size", "32", "--window", "64")
SECRET = b"0123456789abcdef" * 4
PING = bytes((0x89, 0x84)) + bytes(4)
"""The header of a masked ping with four bytes; the mask changes nothing."""


def access(plan: Plan, report: Report) -> None:
    """Compare a hub with tokens to one without."""
    with tempfile.TemporaryDirectory() as folder:
        tokens, key = Path(folder, "tokens.toml"), Path(folder, "key")
        token = TokenFile(tokens).add("robot", EVERYTHING)
        with tokens.open("a") as text:
            text.write('\n[anonymous.allow]\npublish = ["/**"]\nsubscribe = ["/**"]\n')
        key.write_bytes(SECRET)
        options = ("--tokens", str(tokens), "--jwt-key", str(key))
        web_token = jwt.encode(
            {"sub": "robot", "exp": time.time() + 3600, "fibws": EVERYTHING.table()}, SECRET
        )
        _compare_deliveries(plan, report, options)
        _compare_handshakes(plan, report, options, token, web_token)
        _measure_return(report, options, token)


def _compare_deliveries(plan: Plan, report: Report, options: tuple[str, ...]) -> None:
    names = {"open": (), "with tokens": options}
    costs: dict[str, list[float]] = {name: [] for name in names}
    for rep in range(plan.reps):
        for name in list(names)[:: -1 if rep % 2 else 1]:
            with running(HUB, options=names[name]) as server:
                seen = load(server, plan, *LOAD)
            report.fault(HUB, name, seen.fault)
            costs[name].append(seen.cpu_us_per_delivery)
    open_, guarded = costs["open"], costs["with tokens"]
    ratio = Repeated.ratio(guarded, open_)
    limit = report.check(HUB, "with tokens, against open", ratio.median, LIMIT_RATIO)
    report.table(
        f"Rights: CPU of the hub, µs per delivery to 10, minimum (median) of {plan.reps}",
        ("open", "with tokens", "with tokens : open", "limit"),
        [(f"{Repeated.of(open_)}", f"{Repeated.of(guarded)}", f"{ratio}", limit)],
    )


def _compare_handshakes(
    plan: Plan, report: Report, options: tuple[str, ...], token: str, web_token: str
) -> None:
    count = QUICK_HANDSHAKES if plan.quick else HANDSHAKES
    paths = {"no token": "/", "token": f"/?token={token}", "web token": f"/?token={web_token}"}
    costs: dict[str, list[float]] = {name: [] for name in paths}
    with running(HUB, options=options) as server:
        for _ in range(plan.reps):
            for name, path in paths.items():
                costs[name].append(_handshake_ms(server, path, count))
    nothing = Repeated.of(costs["no token"])
    rows = []
    for name, found in costs.items():
        cost = Repeated.of(found)
        more = cost.median - nothing.median
        limit = report.check(HUB, f"handshake with {name}", more, LIMIT_JWT_MS, " ms")
        rows.append((name, f"{cost}", f"{more:.3f}", limit if name == "web token" else ""))
    report.table(
        f"Handshake: CPU of the hub, ms, minimum (median) of {plan.reps} times {count}",
        ("client", "ms", "more than without", "limit"),
        rows,
    )


def _handshake_ms(server: Server, path: str, count: int) -> float:
    before = server.cpu_seconds
    for _ in range(count):
        connected(server.port, path).close()
    return (server.cpu_seconds - before) / count * 1000


def _measure_return(report: Report, options: tuple[str, ...], token: str) -> None:
    """Let a thousand clients come at once, and measure meanwhile how late the hub answers."""
    context = multiprocessing.get_context("spawn")
    with running(HUB, options=options) as server, connected(server.port, "/") as probe:
        queue: Queue[float] = context.Queue()
        measured = context.Event()
        clients = context.Process(target=_return, args=(server.port, token, queue, measured))
        clients.start()
        try:
            lags: list[float] = []
            while queue.empty():
                if not clients.is_alive() and queue.empty():
                    raise BenchError("the clients that return have failed")
                began = time.perf_counter()
                probe.sendall(PING + struct.pack("!I", len(lags)))
                _read_pong(probe)
                lags.append((time.perf_counter() - began) * 1000)
                time.sleep(0.002)
            seconds = queue.get()
        finally:
            measured.set()
            clients.join()
    slowest = max(lags)
    report.record("return", seconds=seconds, slowest_ms=slowest)
    report.table(
        f"{CLIENTS} clients with tokens come back at once, each subscribes",
        ("all are back, s", "limit", "slowest answer to another client, ms", "limit"),
        [
            (
                f"{seconds:.2f}",
                report.check(HUB, "all clients are back", seconds, LIMIT_BACK_SECONDS, " s"),
                f"{slowest:.0f}",
                report.check(HUB, "answer meanwhile", slowest, LIMIT_LAG_MS, " ms"),
            )
        ],
    )


def _read_pong(probe: socket.socket) -> None:
    """Read one pong of four bytes."""
    data = b""
    while len(data) < 6:
        chunk = probe.recv(6 - len(data))
        if not chunk:
            raise BenchError("the hub has closed the probe's connection")
        data += chunk


def _return(port: int, token: str, queue: Queue[float], measured: Event) -> None:
    asyncio.run(_all_return(port, token, queue, measured))


async def _all_return(port: int, token: str, queue: Queue[float], measured: Event) -> None:
    """Report the seconds in which all clients have connected and subscribed."""
    began = time.perf_counter()
    writers = await asyncio.gather(*(_one_returns(port, token, n) for n in range(CLIENTS)))
    queue.put(time.perf_counter() - began)
    await asyncio.to_thread(measured.wait)
    for writer in writers:
        with suppress(OSError):
            writer.close()


async def _one_returns(port: int, token: str, number: int) -> asyncio.StreamWriter:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    subscribe = b'{"op":"subscribe","topic":"/chatter","type":"std_msgs/String"}'
    frame = bytes((0x81, 0x80 | len(subscribe))) + bytes(4) + subscribe
    writer.write(
        f"GET /?node=/robot_{number} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
        f"Sec-WebSocket-Version: 13\r\nAuthorization: Bearer {token}\r\n\r\n".encode()
    )
    head = await reader.readuntil(b"\r\n\r\n")
    if b" 101 " not in head:
        raise BenchError(f"handshake refused: {head[:60]!r}")
    writer.write(frame + PING + struct.pack("!I", number))
    await reader.readexactly(6)
    return writer
