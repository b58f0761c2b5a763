"""The hub as the master of ROS 1 nodes, beside rosmaster, and the messages from and to them."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from pathlib import Path
from typing import Any
from xmlrpc.client import dumps, loads

from bench.client import Client, operation
from bench.machine import cpus, free_port, on_load_cpu
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.ros1_links import Node, ros1_links
from bench.servers import running

ROSMASTER = "rosmaster"
CALLS = 1000
TOPICS, STATES = 1000, 20
MULTICALL = 500
NODES, TOPICS_OF_NODE = 200, 10
SAVED_NODES = 50
API = "http://127.0.0.1:1/"
"""Of nodes that nobody calls: they only publish, each its own topics."""
RESPONSE_END = b"\r\n\r\n"
LENGTH_FIELD = b"content-length:"

REGISTER, GET, STATE, CHANGED, MULTI = (
    "registerPublisher",
    "getParam",
    f"getSystemState, {TOPICS} topics",
    f"registerPublisher and getSystemState, {TOPICS} topics",
    f"system.multicall of {MULTICALL} setParam",
)
LIMITS = {REGISTER: 1.0, GET: 1.2, MULTI: 1.0}
"""Most times rosmaster's time."""
STATE_LIMIT_US, PAUSE_LIMIT_MS = 2000.0, 5.0
ALL_REGISTER_LIMIT, RESTORE_LIMIT = 2.0, 1.0
"""In seconds."""


def ros1(plan: Plan, report: Report) -> None:
    """Measure the master, and then the links for messages."""
    _master(plan, report)
    ros1_links(plan, report)


class Caller:
    """Makes calls on one connection, and reads the responses without parsing them."""

    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port), 30)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def call(self, request: bytes) -> bytes:
        """Return the response's body."""
        self._socket.sendall(request)
        data = b""
        while (end := data.find(RESPONSE_END)) < 0:
            data += self._receive()
        head = data[:end].lower()
        start = head.index(LENGTH_FIELD) + len(LENGTH_FIELD)
        size = end + len(RESPONSE_END) + int(head[start:].split(b"\r\n", 1)[0])
        parts = [data]
        got = len(data)
        while got < size:
            parts.append(self._receive())
            got += len(parts[-1])
        return b"".join(parts)[end + len(RESPONSE_END) :]

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()

    def _receive(self) -> bytes:
        data = self._socket.recv(1 << 16)
        if not data:
            raise BenchError("a master closed the connection")
        return data


def _request(method: str, *params: Any) -> bytes:
    body = dumps(params, method).encode()
    head = f"POST /RPC2 HTTP/1.1\r\nHost: localhost\r\nContent-Length: {len(body)}\r\n\r\n"
    return head.encode() + body


def _master(plan: Plan, report: Report) -> None:
    calls = CALLS // 10 if plan.quick else CALLS
    costs: dict[tuple[str, str], list[float]] = {}
    names = [*plan.hubs, *([ROSMASTER] if shutil.which(ROSMASTER) else [])]
    for _ in range(plan.reps):
        for name in names:
            with on_load_cpu(), _running(name) as port:
                for what, seconds in _calls(port, calls):
                    costs.setdefault((name, what), []).append(seconds * 1e6)
    for (name, what), values in costs.items():
        report.record("ros1", server=name, case=what, us=values)
    rows = []
    for what in (REGISTER, GET, STATE, CHANGED, MULTI):
        for name in names:
            found = Repeated.of(costs[name, what])
            ratio = verdict = ""
            if (ROSMASTER, what) in costs and name != ROSMASTER:
                times = Repeated.ratio(costs[name, what], costs[ROSMASTER, what])
                ratio = f"{times}"
                verdict = report.check(name, what, times.median, LIMITS.get(what), " times")
            if what == STATE:
                verdict = report.check(name, what, found.median, STATE_LIMIT_US, " µs")
            rows.append((name, what, f"{found.least:,.0f} ({found.median:,.0f})", ratio, verdict))
    report.table(
        f"The master: µs from a call to its response, minimum (median) of {plan.reps}",
        ("server", "call", "µs", "times rosmaster's", "limit"),
        rows,
    )
    _report_load(plan, report)


def _report_load(plan: Plan, report: Report) -> None:
    under_load = []
    for name in plan.hubs:
        most = max(_pauses(name, plan))
        verdict = report.check(name, "pause", most, PAUSE_LIMIT_MS, " ms")
        under_load.append((name, "longest pause for others meanwhile, ms", f"{most:.1f}", verdict))
        for what, measure, limit in (
            (f"{NODES} nodes register {TOPICS_OF_NODE} topics each", _register, ALL_REGISTER_LIMIT),
            (f"{SAVED_NODES} nodes back after kill -9, from exec", _restore, RESTORE_LIMIT),
        ):
            seconds = min(measure(name) for _ in range(plan.reps))
            verdict = report.check(name, what, seconds, limit, " s")
            under_load.append((name, f"{what}, s", f"{seconds:.2f}", verdict))
    report.table("The master under load", ("server", "what", "value", "limit"), under_load)


def _calls(port: int, count: int) -> Iterator[tuple[str, float]]:
    """Yield each kind of call with the seconds that one takes."""
    caller = Caller(port)

    def seconds(requests: Sequence[bytes]) -> float:
        start = time.perf_counter()
        for each in requests:
            caller.call(each)
        return (time.perf_counter() - start) / len(requests)

    def register(number: int) -> bytes:
        node, topic = f"/n{number % 100}", f"/topic_{number}"
        return _request("registerPublisher", node, topic, "std_msgs/Int32", API)

    yield REGISTER, seconds([register(number) for number in range(count)])
    for number in range(count, TOPICS):
        caller.call(register(number))
    caller.call(_request("setParam", "/n", "/gain", 0.5))
    yield GET, seconds([_request("getParam", "/n", "/gain")] * count)
    state = _request("getSystemState", "/n")
    yield STATE, seconds([state] * STATES)
    changed = [each for number in range(STATES) for each in (register(TOPICS + number), state)]
    yield CHANGED, 2 * seconds(changed)
    calls = [
        {"methodName": "setParam", "params": ["/n", f"/many/p{number}", number]}
        for number in range(MULTICALL)
    ]
    yield MULTI, seconds([_request("system.multicall", calls)] * 5)
    caller.close()


def _pauses(name: str, plan: Plan) -> list[float]:
    """Return how long a client of the hub waits for a response while the master is used, in ms."""
    found: list[float] = []
    with on_load_cpu(), _hub(name) as (port, websocket_port, _):
        # In a process of its own: threads of this one would have to wait for each other.
        user = get_context("spawn").Process(target=_use, args=(port, 1 if plan.quick else 3))
        with Client(websocket_port, "/bench") as client:
            user.start()
            while user.is_alive():
                start = time.perf_counter()
                client.send(operation("call_service", service="/rosapi/get_time"))
                client.receive()
                found.append((time.perf_counter() - start) * 1e3)
                time.sleep(0.001)
        user.join()
    return found


def _use(port: int, rounds: int) -> None:
    for _ in range(rounds):
        for _ in _calls(port, CALLS // 2):
            pass


def _register(name: str) -> float:
    """Return the seconds in which many nodes register all their topics."""
    with _hub(name) as (port, _, _):
        start = time.perf_counter()
        for number in range(NODES):
            caller = Caller(port)  # Each node has its own connection.
            for topic in range(TOPICS_OF_NODE):
                topic_name = f"/robot_{number}/topic_{topic}"
                of_node = f"/robot_{number}", topic_name, "std_msgs/Int32", API
                caller.call(_request("registerPublisher", *of_node))
            caller.close()
        return time.perf_counter() - start


class _SavedNodes(Node):
    """Nodes of one process, which a restarted hub asks what they have."""

    def __init__(self) -> None:
        super().__init__()
        topics = [[f"/saved_{number}", "std_msgs/Int32"] for number in range(SAVED_NODES)]
        self.answer("getPublications", topics)
        self.answer("getSubscriptions", [])


def _restore(name: str) -> float:
    """Return the seconds from a hub's start until all nodes of a killed one are registered."""
    nodes = _SavedNodes()
    try:
        with tempfile.TemporaryDirectory() as folder:
            state = Path(folder) / "state.json"
            with suppress(BenchError), _hub(name, state) as (port, _, pid):
                caller = Caller(port)
                for number in range(SAVED_NODES):
                    of_node = f"/node_{number}", f"/saved_{number}", "std_msgs/Int32", nodes.api
                    caller.call(_request("registerPublisher", *of_node))
                caller.close()
                _wait_for(
                    lambda: state.exists() and state.read_text().count("/saved_") >= SAVED_NODES
                )
                os.kill(pid, signal.SIGKILL)
            start = time.perf_counter()
            with _hub(name, state, port) as (port, _, _):
                caller = Caller(port)
                request = _request("getSystemState", "/bench")
                _wait_for(lambda: caller.call(request).count(b"/saved_") == SAVED_NODES)
                seconds = time.perf_counter() - start
                caller.close()
                return seconds
    finally:
        nodes.close()


def _saved(state: Path) -> int:
    return state.read_text().count('"/saved_')


def _wait_for(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 30
    while not condition():
        if time.monotonic() > deadline:
            raise BenchError("the nodes were not registered")
        time.sleep(0.005)


@contextmanager
def _hub(
    name: str, state: Path | None = None, port: int | None = None
) -> Iterator[tuple[int, int, int]]:
    """A hub; yields the ports of its master and of its WebSocket, and its process."""
    port = port or free_port()
    with tempfile.TemporaryDirectory() as folder:
        path = str(state or Path(folder) / "state.json")
        with running(name, options=["--ros1", str(port), "--ros1-state", path]) as server:
            yield port, server.port, server.pid


@contextmanager
def _running(name: str) -> Iterator[int]:
    """A master, ROS's own or a hub; yields its port."""
    if name != ROSMASTER:
        with _hub(name) as (port, _, _):
            yield port
        return
    port = free_port()
    process = subprocess.Popen(
        [ROSMASTER, "--core", "-p", str(port)],
        env={"PATH": "/usr/bin:/bin", "ROS_IP": "127.0.0.1", "HOME": "/tmp"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        if chosen := cpus():
            os.sched_setaffinity(process.pid, {chosen.server})
        _wait_for(lambda: _answers(port))
        yield port
    finally:
        process.kill()
        process.wait()


def _answers(port: int) -> bool:
    try:
        caller = Caller(port)
    except ConnectionError:
        return False
    loads(caller.call(_request("getPid", "/bench")))
    caller.close()
    return True
