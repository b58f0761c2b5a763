"""The effect of one client on the others: large texts, stuck and slow readers, churn."""

from __future__ import annotations

import base64
import json
import multiprocessing
import os
import selectors
import socket
import statistics
import struct
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import cbor2

from bench.client import PING, TEXT, Client, connect_all, frame, operation
from bench.handshake import connected
from bench.machine import memory, on_load_cpu
from bench.measure import HUB, BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, running

MIB = 2**20
BINARY = 0x82
SIZES = {64: (500.0, 3.0), 1: (50.0, None)}
"""MiB of a text; most milliseconds that another client's call may take meanwhile; most bytes of
memory that it may take for each of its own, beside them."""
SETTLE_SECONDS = 1.0
LIMIT_KEPT = 0.5
"""The share of a text's bytes by which memory may be larger a second after it."""
CALL = operation("call_service", service="/rosapi/get_time", args={})
CALL_INTERVAL = 0.001

PAIR_HZ = 200
LIMIT_PAIR_MS = 10.0
FLOOD_LIMIT = 5000
"""Messages per second that a client may send in the measurement of limits."""
LIMIT_FLOOD_RATIO = 2.0
CHURNERS, PUBLISHERS, STUCK = 30, 4, 100

SLOW_BYTES, SLOW_READ, SLOW_OFFERED = 10_000, 1_000_000, 10_000_000
"""Bytes of a message; bytes that are read, and that are offered, per second."""
SLOW_SECONDS, QUICK_SLOW_SECONDS = 12.0, 3.0
QUICK_STEP = 4
"""A quick run measures every fourth text."""
LIMIT_AGE_SECONDS = 2.0

processes = multiprocessing.get_context("fork")


def isolation(plan: Plan, report: Report) -> None:
    """Measure each of them beside a client that behaves."""
    _limits(plan, report)
    _texts(plan, report)
    _neighbours(plan, report)
    _slow_reader(plan, report)


# Large texts.


def _publish(before: str, item: str, after: str) -> Callable[[int], bytes]:
    """Return a function that builds a publish operation of a given size by repeating an item."""

    def make(size: int) -> bytes:
        head = b'{"op":"publish","topic":"/bench","msg":%b' % before.encode()
        tail = after.encode() + b"}"
        count = (size - len(head) - len(tail)) // (len(item) + 1)
        return head + b",".join([item.encode()] * count) + tail

    return make


def _cbor(tag: bytes, item: bytes, unit: int = 1) -> Callable[[int], bytes]:
    """Return a function that builds a publish operation in CBOR with an array of one item.

    Args:
        tag: what precedes the array's length, the initial byte for a length of 64 bits included.
        unit: how many of the length one item counts for.
    """
    head = b"\xa3" + b"".join(map(cbor2.dumps, ("op", "publish", "topic", "/bench", "msg")))
    head += b"\xa1" + cbor2.dumps("data") + tag

    def make(size: int) -> bytes:
        count = (size - len(head) - 8) // len(item)
        return head + struct.pack("!Q", count * unit) + item * count

    return make


def _image(size: int) -> bytes:
    data = base64.b64encode(bytes(size * 3 // 4 - 100)).decode()
    return json.dumps({"op": "publish", "topic": "/bench", "msg": {"data": data}}).encode()


def _members(size: int) -> bytes:
    members = ",".join(f'"{number:08x}":0' for number in range(size // 13))
    return b'{"op":"publish","topic":"/bench","msg":{%b}}' % members.encode()


TEXTS: dict[str, tuple[str, int, Callable[[int], bytes]]] = {
    "an image": ("sensor_msgs/Image", TEXT, _image),
    "a long string": ("std_msgs/String", TEXT, _publish('{"data":"', "a" * 99, '"}')),
    "escapes": ("std_msgs/String", TEXT, _publish('{"data":"', "\\u0000" * 10, '"}')),
    "numbers": ("sensor_msgs/LaserScan", TEXT, _publish('{"ranges":[', "0.1234567", "]}")),
    "points": (
        "geometry_msgs/Polygon",
        TEXT,
        _publish('{"points":[', '{"x":0.5,"y":1,"z":2}', "]}"),
    ),
    "empty transforms": ("tf2_msgs/TFMessage", TEXT, _publish('{"transforms":[', "{}", "]}")),
    "empty lists": ("std_msgs/String", TEXT, _publish('{"data":[', "[]", "]}")),
    "empty lists behind {}": (
        "std_msgs/String",
        TEXT,
        lambda size: b"{}" + _publish('{"data":[', "[]", "]}")(size - 2),
    ),
    "many operations": ("std_msgs/String", TEXT, lambda size: b"{}" * (size // 2)),
    "many members": ("std_msgs/String", TEXT, _members),
    "brackets": ("std_msgs/String", TEXT, lambda size: b"[" * size),
    "no JSON at its end": (
        "std_msgs/String",
        TEXT,
        lambda size: _publish('{"data":[', "0.5", "]}")(size)[:-2],
    ),
    "CBOR, empty lists": ("std_msgs/String", BINARY, _cbor(b"\x9b", b"\x80")),
    "CBOR, a typed array": ("std_msgs/UInt8MultiArray", BINARY, _cbor(b"\xd8\x40\x5b", b"\1")),
    "CBOR, 64-bit numbers": (
        "std_msgs/Float64MultiArray",
        BINARY,
        _cbor(b"\xd8\x56\x5b", b"\1" * 8, unit=8),
    ),
}
"""The type of the topic, the frame's first byte, and what makes a message of a size in bytes."""


@dataclass(frozen=True)
class Effect:
    """The effect of one text on the hub and on another client."""

    cpu_ms: float
    slowest_ms: float
    """The slowest call of the other client."""
    memory: float
    """The most bytes of memory for each of the text's, beside them."""
    kept: float
    """The bytes of memory for each of the text's that are left a second later."""


def _texts(plan: Plan, report: Report) -> None:
    rows = []
    for mebibytes, (limit_ms, limit_memory) in SIZES.items():
        if plan.quick and mebibytes > 1:
            continue
        for name, (type_, first, make) in list(TEXTS.items())[:: QUICK_STEP if plan.quick else 1]:
            text = frame(make(mebibytes * MIB - 64), first)
            with running(HUB) as server:
                effect = _effect(server, type_, text)
            report.record("isolation", what=name, mebibytes=mebibytes, **vars(effect))
            what = f"{name}, {mebibytes} MiB"
            limit_kept = None if limit_memory is None else LIMIT_KEPT
            rows.append(
                (
                    what,
                    f"{effect.cpu_ms:.0f}",
                    f"{effect.slowest_ms:.1f}",
                    report.check(HUB, f"{what}, slowest call", effect.slowest_ms, limit_ms, " ms"),
                    f"{effect.memory:.1f}",
                    report.check(HUB, f"{what}, memory", effect.memory, limit_memory),
                    f"{effect.kept:.2f}",
                    report.check(HUB, f"{what}, memory kept", effect.kept, limit_kept),
                )
            )
    report.table(
        "One text, and the calls of another client meanwhile; memory in bytes for each of the text",
        (
            "text",
            "CPU, ms",
            "slowest call, ms",
            "limit",
            "memory at most",
            "limit",
            "1 s later",
            "limit",
        ),
        rows,
    )


def _effect(server: Server, type_: str, text: bytes) -> Effect:
    with Client(server.port, "/caller") as caller:
        _slowest_call(caller, 20)
        before = memory(server.pid)["VmRSS"]
        Path(f"/proc/{server.pid}/clear_refs").write_text("5")  # Peak memory counts from here.
        cpu = server.cpu_seconds
        sender = processes.Process(target=_send, args=(server.port, type_, text), daemon=True)
        with on_load_cpu():
            sender.start()
            slowest = 0.0
            while sender.is_alive():
                slowest = max(slowest, _slowest_call(caller, 1))
        cpu = server.cpu_seconds - cpu
        if sender.exitcode:
            raise BenchError(f"the sender of a text exited with {sender.exitcode}")
        time.sleep(SETTLE_SECONDS)
        _slowest_call(caller, 20)
        after = memory(server.pid)
    size = len(text)
    return Effect(
        cpu_ms=cpu * 1000,
        slowest_ms=slowest * 1000,
        memory=max(0.0, (after["VmHWM"] - before - size) / size),
        kept=max(0.0, (after["VmRSS"] - before) / size),
    )


def _send(port: int, type_: str, text: bytes) -> None:
    """Send a text and wait until the hub has taken it; whatever it answers does not matter."""
    connection = connected(port, "/?node=/sender", 60)
    connection.sendall(operation("advertise", topic="/bench", type=type_) + text + frame(b"", PING))
    received = b""
    while not received.endswith(b"\x8a\x00"):
        if not (chunk := connection.recv(MIB)):
            raise BenchError("the hub closed the sender's connection")
        received = (received + chunk)[-2:]


def _slowest_call(caller: Client, count: int) -> float:
    """Return the seconds of the slowest of several calls."""
    slowest = 0.0
    for _ in range(count):
        start = time.perf_counter()
        caller.send(CALL)
        caller.receive()
        slowest = max(slowest, time.perf_counter() - start)
        time.sleep(CALL_INTERVAL)
    return slowest


# Busy neighbours.


def _neighbours(plan: Plan, report: Report) -> None:
    rows = []
    for name, load in (
        ("nobody", None),
        (f"{CHURNERS} clients that subscribe and unsubscribe", _churn),
        (f"{PUBLISHERS} publishers at full speed, {STUCK} readers that stand still", _flood),
    ):
        with running(HUB) as server, ExitStack() as stack:
            if name.endswith("still"):
                for reader in stack.enter_context(connect_all(server.port, STUCK, "stuck")):
                    reader.send(operation("subscribe", topic="/flood", type="std_msgs/String"))
                    reader.settle()
            if load is not None:
                stack.enter_context(_in_background(load, server.port))
                time.sleep(plan.warm_seconds)
            with on_load_cpu():
                took = _pair(server.port, int(PAIR_HZ * plan.seconds))
        p50, p99 = statistics.median(took), statistics.quantiles(took, n=100)[98]
        report.record("isolation", what=name, p50_ms=p50, p99_ms=p99, slowest_ms=max(took))
        verdict = report.check(HUB, f"beside {name}, p99", p99, LIMIT_PAIR_MS, " ms")
        rows.append((name, f"{p50:.2f}", f"{p99:.2f}", verdict, f"{max(took):.2f}"))
    report.table(
        f"Milliseconds from one client to another at {PAIR_HZ} Hz, beside busy neighbours",
        ("neighbours", "p50", "p99", "limit", "slowest"),
        rows,
    )


def _pair(port: int, count: int) -> list[float]:
    """Return the milliseconds that each of several messages took from client to client."""
    took = []
    with Client(port, "/from") as publisher, Client(port, "/to") as subscriber:
        publisher.send(operation("advertise", topic="/pair", type="std_msgs/Int32"))
        publisher.settle()
        subscriber.send(operation("subscribe", topic="/pair", type="std_msgs/Int32"))
        subscriber.settle()
        for number in range(count):
            start = time.perf_counter()
            publisher.send(operation("publish", topic="/pair", msg={"data": number}))
            subscriber.receive()
            took.append((time.perf_counter() - start) * 1000)
            time.sleep(1 / PAIR_HZ)
    return took


@contextmanager
def _in_background(load: Callable[[int], None], port: int) -> Iterator[None]:
    process = processes.Process(target=load, args=(port,), daemon=True)
    with on_load_cpu():
        process.start()
    try:
        yield
        if not process.is_alive():
            raise BenchError(f"the load ended with {process.exitcode}")
    finally:
        process.kill()
        process.join()


def _churn(port: int) -> None:
    """Have clients subscribe and unsubscribe without pause."""
    pair = operation("subscribe", topic="/churn", type="std_msgs/String")
    pair += operation("unsubscribe", topic="/churn")
    _pour([connected(port, f"/?node=/churner_{n}") for n in range(CHURNERS)], pair * 500)


def _flood(port: int) -> None:
    """Have publishers send at full speed."""
    publishers = [connected(port, f"/?node=/publisher_{n}") for n in range(PUBLISHERS)]
    for each in publishers:
        each.sendall(operation("advertise", topic="/flood", type="std_msgs/String"))
    _pour(publishers, operation("publish", topic="/flood", msg={"data": "x" * 32}) * 500)


def _pour(sockets: list[socket.socket], data: bytes) -> None:
    """Write the same bytes to sockets again and again, for ever; ignore what they receive."""
    rest = dict.fromkeys(sockets, b"")
    with selectors.DefaultSelector() as selector:
        for each in sockets:
            each.setblocking(False)
            selector.register(each, selectors.EVENT_READ | selectors.EVENT_WRITE, each)
        while True:
            for key, ready in selector.select():
                if ready & selectors.EVENT_READ:
                    key.data.recv(MIB)
                if ready & selectors.EVENT_WRITE:
                    sent = key.data.send(rest[key.data] or data)
                    rest[key.data] = (rest[key.data] or data)[sent:]


# Floods and limits.


def _limits(plan: Plan, report: Report) -> None:
    """Measure the effect of a client that floods within its limit, and of one that goes beyond."""
    within = f"one client that floods within its limit, {FLOOD_LIMIT} msg/s"
    beyond = "one client that floods beyond its limit, 100,000 msg/s offered"
    loads: list[tuple[str, Callable[[int], None] | None]] = [
        ("nobody", None),
        (within, _flood_within),
        (beyond, _flood_beyond),
    ]
    found: dict[str, list[tuple[float, float, float]]] = {name: [] for name, _ in loads}
    options = ("--max-messages-per-second", str(FLOOD_LIMIT))
    for _ in range(plan.reps):
        for name, load in loads:
            with running(HUB, options=options) as server, ExitStack() as stack:
                if load is not None:
                    stack.enter_context(_in_background(load, server.port))
                    time.sleep(plan.warm_seconds)
                with on_load_cpu():
                    took = _pair(server.port, int(PAIR_HZ * plan.seconds))
            percentile = statistics.quantiles(took, n=100)[98]
            found[name].append((statistics.median(took), percentile, max(took)))
    quiet = Repeated.of(each[1] for each in found["nobody"])
    rows = []
    for name, results in found.items():
        p50, p99, slowest = (Repeated.of(values) for values in zip(*results, strict=True))
        ratio = p99 / quiet
        report.record(
            "isolation", what=name, p50_ms=p50.median, p99_ms=p99.median, ratio=ratio.median
        )
        limit = None if name == "nobody" else LIMIT_FLOOD_RATIO
        verdict = report.check(HUB, f"beside {name}, p99", ratio.median, limit)
        rows.append((name, f"{p50}", f"{p99}", f"{ratio}", verdict, f"{slowest}"))
    report.table(
        f"Milliseconds from one client to another at {PAIR_HZ} Hz, minimum (median) of {plan.reps}",
        ("neighbours", "p50", "p99", "ratio of p99", "limit", "slowest"),
        rows,
    )


def _flood_within(port: int) -> None:
    """Publish at the rate of the limit, in a burst each hundredth of a second."""
    message = operation("publish", topic="/flood", msg={"data": "x" * 32})
    count = FLOOD_LIMIT // 100
    os.nice(19)  # It shares a CPU with the clients that are measured.
    publisher = connected(port, "/?node=/flooder")
    publisher.sendall(operation("advertise", topic="/flood", type="std_msgs/String"))
    due = time.monotonic()
    while True:
        publisher.sendall(message * count)
        due += 0.01
        time.sleep(max(0.0, due - time.monotonic()))


def _flood_beyond(port: int) -> None:
    """Publish 100,000 messages per second, and connect again whenever the hub closes."""
    os.nice(19)
    message = operation("publish", topic="/flood", msg={"data": "x" * 32})
    while True:
        publisher = connected(port, "/?node=/flooder")
        due = time.monotonic()
        with suppress(OSError):
            publisher.sendall(operation("advertise", topic="/flood", type="std_msgs/String"))
            while True:
                publisher.sendall(message * 1000)
                due += 0.01
                time.sleep(max(0.0, due - time.monotonic()))


# A slow reader.


def _slow_reader(plan: Plan, report: Report) -> None:
    """Measure the age of the messages that a slow reader gets of a fast publisher."""
    seconds = QUICK_SLOW_SECONDS if plan.quick else SLOW_SECONDS
    with running(HUB) as server, _in_background(_publish_stamped, server.port), on_load_cpu():
        ages = _ages_read(server.port, seconds)
    settled = ages[len(ages) // 2 :]
    oldest = max(settled)
    report.record("isolation", what="a slow reader", oldest=oldest, median=statistics.median(ages))
    verdict = report.check(HUB, "age of what a slow reader gets", oldest, LIMIT_AGE_SECONDS, " s")
    report.table(
        f"A reader of {SLOW_READ / 1e6:g} MB/s of a topic with {SLOW_OFFERED / 1e6:g} MB/s",
        ("messages read", "age, median, s", "oldest, s", "limit"),
        [(f"{len(ages)}", f"{statistics.median(settled):.2f}", f"{oldest:.2f}", verdict)],
    )


def _publish_stamped(port: int) -> None:
    """Publish messages that begin with the time, for ever."""
    with Client(port, "/fast") as publisher:
        publisher.send(operation("advertise", topic="/slow", type="std_msgs/String"))
        rest = "x" * (SLOW_BYTES - 20)
        interval, due = SLOW_BYTES / SLOW_OFFERED, time.monotonic()
        while True:
            text = f"{time.monotonic():020.6f}{rest}"
            publisher.send(operation("publish", topic="/slow", msg={"data": text}))
            due += interval
            time.sleep(max(0.0, due - time.monotonic()))


def _ages_read(port: int, seconds: float) -> list[float]:
    """Read at a limited speed; return the age of each message when it was read."""
    ages = []
    with Client(port, "/slow") as reader:
        reader.send(
            operation("subscribe", topic="/slow", type="std_msgs/String", queue_length=1000)
        )
        start = time.monotonic()
        read = 0
        while (now := time.monotonic()) - start < seconds:
            for message in reader.read(SLOW_BYTES):
                read += len(message)
                sent = float(json.loads(message)["msg"]["data"][:20])
                ages.append(time.monotonic() - sent)
            time.sleep(max(0.0, start + read / SLOW_READ - now))
    return ages
