"""CPU of the hub for messages from and to ROS 1 nodes."""

from __future__ import annotations

import socket
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer

from bench.client import TIMEOUT_SECONDS, Client, operation
from bench.machine import free_port, on_load_cpu
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, running
from fibws.hub.ros1.tcpros import LENGTH, decode_header, encode_header, frame
from fibws.interfaces import Interfaces

IN, OUT = "/bench/in", "/bench/out"
BYTES, TEXT = "std_msgs/UInt8MultiArray", "std_msgs/String"
KIB = 1024
LINKS = (1, 10)
OUT_BYTES, OUT_RATE = 100, 1000
SHARE = 0.5
"""The share of the planned seconds for each of many measurements."""


class Inbound(NamedTuple):
    """A kind of message from a ROS 1 node."""

    name: str
    size: int
    rate: int
    """Messages a second."""
    limit: float
    """Most µs of CPU for one."""


INBOUND = (
    Inbound("100 B", 100, 1000, 120),
    Inbound("64 KiB", 64 * KIB, 500, 120),
    Inbound("6 MB", 6_000_000, 20, 5000),
)
LIMITS_OUT = {1: 100, 10: 300}

# How the hub's client takes messages from ROS 1 nodes.
DROPPED, SENT = "left out by throttle_rate", "sent to a client as cbor-raw"
CLIENTS: dict[str, dict[str, Any]] = {
    DROPPED: {"throttle_rate": 3_600_000},
    SENT: {"compression": "cbor-raw"},
}


@dataclass
class Hub:
    """A hub that is a ROS 1 master, and ways to ask it."""

    server: Server
    master: ServerProxy
    port: int

    def call(self, method: str, *params: Any) -> Any:
        """Call the master; return the value."""
        code, text, value = getattr(self.master, method)("/bench", *params)
        if code != 1:
            raise BenchError(f"{self.server.name}: {method}: {text}")
        return value

    def received(self) -> int:
        """Return how many messages the hub has received by its link."""
        _, subscribed, _ = self.call("getBusStats")
        return sum(link[2] for topic, links in subscribed if topic == IN for link in links)


class Node:
    """A ROS 1 node, whose slave API a thread serves."""

    def __init__(self) -> None:
        """Listen."""
        self._slave = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.settimeout(TIMEOUT_SECONDS)
        self.answer("getPid", 1)
        self.answer("publisherUpdate", 0)
        self.answer("requestTopic", ["TCPROS", *self._listener.getsockname()])
        self._thread = threading.Thread(target=self._slave.serve_forever, args=(0.02,))
        self._thread.start()
        self.api = "http://{}:{}/".format(*self._slave.server_address[:2])

    def answer(self, method: str, value: Any) -> None:
        """Answer calls of a method with a value."""
        self._slave.register_function(lambda *_: [1, "", value], method)

    def accept(self) -> socket.socket:
        """Accept a link from the hub."""
        link, _ = self._listener.accept()
        link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        _header(link)
        interfaces = Interfaces()
        md5sum = interfaces.md5(BYTES)
        definition = interfaces.full_text(BYTES)
        fields = {"type": BYTES, "md5sum": md5sum or "*", "message_definition": definition}
        link.sendall(encode_header(fields))
        return link

    def close(self) -> None:
        """End."""
        self._slave.shutdown()
        self._thread.join()
        self._slave.server_close()
        self._listener.close()


def ros1_links(plan: Plan, report: Report) -> None:
    """Measure each kind of message in turn."""
    costs: dict[tuple[str, ...], list[float]] = {}
    with ExitStack() as stack:
        stack.enter_context(on_load_cpu())
        for name in plan.hubs:
            with _hub(name) as hub:
                for _ in range(plan.reps):
                    for mode in CLIENTS:
                        for kind in INBOUND:
                            cost = _inbound(hub, mode, kind, plan)
                            costs.setdefault((name, mode, kind.name), []).append(cost)
                    for links in LINKS:
                        cost = _outbound(hub, links, plan, report)
                        costs.setdefault((name, "out", str(links)), []).append(cost)
    for key, values in costs.items():
        report.record("ros1-links", case=key, cpu_us=values)
    _report_costs(costs, plan, report)


def _report_costs(costs: dict[tuple[str, ...], list[float]], plan: Plan, report: Report) -> None:
    rows = []
    for name in plan.hubs:
        for mode in CLIENTS:
            for kind in INBOUND:
                what = f"{kind.name} from a ROS 1 node, {mode}"
                found = Repeated.of(costs[name, mode, kind.name])
                limit = kind.limit if mode == DROPPED or kind.size <= KIB else None
                verdict = report.check(name, what, found.median, limit, " µs")
                rows.append((name, what, f"{kind.rate}", f"{found}", verdict))
        for links in LINKS:
            what = f"{OUT_BYTES} B from a JSON client to {links} ROS 1 nodes"
            found = Repeated.of(costs[name, "out", str(links)])
            verdict = report.check(name, what, found.median, LIMITS_OUT[links], " µs")
            rows.append((name, what, f"{OUT_RATE}", f"{found}", verdict))
    report.table(
        f"Messages from and to ROS 1 nodes: µs of the hub's CPU, minimum (median) of {plan.reps}",
        ("server", "message", "a second", "µs", "limit"),
        rows,
    )


@contextmanager
def _hub(name: str) -> Iterator[Hub]:
    port = free_port()
    with tempfile.TemporaryDirectory() as folder:
        state = str(Path(folder) / "state.json")
        with running(name, options=["--ros1", str(port), "--ros1-state", state]) as server:
            with ServerProxy(f"http://127.0.0.1:{port}/") as master:
                yield Hub(server, master, port)


def _inbound(hub: Hub, mode: str, kind: Inbound, plan: Plan) -> float:
    """Return the CPU time of a message from a ROS 1 node in µs."""
    # An empty layout, and the bytes.
    body = bytes(8) + frame(kind.size - 12) + bytes(kind.size - 12)
    message = frame(len(body)) + body
    node = Node()
    try:
        with Client(hub.server.port, "/bench_viewer") as viewer:
            hub.call("registerPublisher", IN, BYTES, node.api)
            viewer.send(operation("subscribe", topic=IN, **CLIENTS[mode]))
            with node.accept() as link:
                stop = threading.Event()
                reader = threading.Thread(target=_drain, args=(viewer, stop))
                reader.start()
                try:
                    _send(hub, link, message, kind.rate, plan.warm_seconds * SHARE)
                    return _send(hub, link, message, kind.rate, plan.seconds * SHARE)
                finally:
                    hub.call("unregisterPublisher", IN, node.api)
                    stop.set()
                    viewer.send(operation("unsubscribe", topic=IN))
                    viewer.send(operation("call_service", service="/rosapi/get_time"))
                    reader.join()
    finally:
        node.close()


def _send(hub: Hub, link: socket.socket, message: bytes, rate: int, seconds: float) -> float:
    """Send messages at a rate; return the CPU time of one in µs, once all were received."""
    before, count = hub.received(), max(5, round(rate * seconds))
    cpu, due = hub.server.cpu_seconds, time.perf_counter()
    for _ in range(count):
        link.sendall(message)
        due += 1 / rate
        time.sleep(max(0.0, due - time.perf_counter()))
    cpu = hub.server.cpu_seconds - cpu
    deadline = time.monotonic() + TIMEOUT_SECONDS
    while hub.received() - before < count:
        if time.monotonic() > deadline:
            raise BenchError(f"{hub.server.name} received too few of {count} messages")
        time.sleep(0.01)
    return cpu / count * 1e6


def _outbound(hub: Hub, links: int, plan: Plan, report: Report) -> float:
    """Return the CPU time of a message to ROS 1 nodes in µs."""
    text = "x" * (OUT_BYTES - LENGTH)
    publish = operation("publish", topic=OUT, msg={"data": text})
    node = Node()
    try:
        with Client(hub.server.port, "/bench_talker") as talker, ExitStack() as stack:
            talker.send(operation("advertise", topic=OUT, type=TEXT))
            talker.settle()
            readers = [
                stack.enter_context(_Reader(hub, node, f"/bench_listener_{number}"))
                for number in range(links)
            ]
            _publish(hub, talker, publish, readers, plan.warm_seconds * SHARE)
            cost, lost = _publish(hub, talker, publish, readers, plan.seconds * SHARE)
            if lost:
                report.fault(hub.server.name, f"{links} links", f"{lost} messages lost")
            return cost
    finally:
        node.close()


def _publish(
    hub: Hub, talker: Client, publish: bytes, readers: Sequence[_Reader], seconds: float
) -> tuple[float, int]:
    """Publish at a rate; return the CPU time of a message in µs, and how many were lost."""
    count = max(5, round(OUT_RATE * seconds))
    expected = [reader.bytes + count * (LENGTH + OUT_BYTES) for reader in readers]
    cpu, due = hub.server.cpu_seconds, time.perf_counter()
    for _ in range(count):
        talker.send(publish)
        due += 1 / OUT_RATE
        time.sleep(max(0.0, due - time.perf_counter()))
    talker.settle()
    cpu = hub.server.cpu_seconds - cpu
    deadline = time.monotonic() + TIMEOUT_SECONDS
    while [reader.bytes for reader in readers] != expected and time.monotonic() < deadline:
        time.sleep(0.01)
    missing = sum(expected) - sum(reader.bytes for reader in readers)
    return cpu / count * 1e6, missing // (LENGTH + OUT_BYTES)


class _Reader:
    """A ROS 1 subscriber, which a thread reads for."""

    def __init__(self, hub: Hub, node: Node, name: str) -> None:
        self.bytes = 0
        self._hub = hub
        self._name = name
        self._api = node.api
        _call(hub, "registerSubscriber", name, OUT, TEXT, node.api)
        self._link = socket.create_connection(("127.0.0.1", hub.port), TIMEOUT_SECONDS)
        header = {"callerid": name, "topic": OUT, "type": TEXT, "md5sum": "*"}
        self._link.sendall(encode_header(header))
        fields = _header(self._link)
        if "error" in fields:
            raise BenchError(f"{hub.server.name}: {fields['error']}")
        self._thread = threading.Thread(target=self._read)

    def __enter__(self) -> _Reader:
        self._thread.start()
        return self

    def __exit__(self, *failure: object) -> None:
        _call(self._hub, "unregisterSubscriber", self._name, OUT, self._api)
        self._thread.join()
        self._link.close()

    def _read(self) -> None:
        buffer = memoryview(bytearray(1 << 16))
        self._link.settimeout(None)
        while size := self._link.recv_into(buffer):
            self.bytes += size


def _call(hub: Hub, method: str, *params: Any) -> None:
    code, text, _ = getattr(hub.master, method)(*params)
    if code != 1:
        raise BenchError(f"{hub.server.name}: {method}: {text}")


def _header(link: socket.socket) -> dict[str, str]:
    """Read a connection header."""
    link.settimeout(TIMEOUT_SECONDS)
    size = int.from_bytes(link.recv(LENGTH, socket.MSG_WAITALL), "little")
    fields = decode_header(link.recv(size, socket.MSG_WAITALL))
    link.settimeout(None)
    return fields


def _drain(viewer: Client, stop: threading.Event) -> None:
    """Read what a client receives, until a response after the end."""
    while not stop.is_set():
        for message in viewer.receive():
            if message.startswith(b'{"op":"service_response"'):
                return
