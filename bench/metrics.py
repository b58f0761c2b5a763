"""CPU of the hub for one scrape of /metrics, and how long another client waits meanwhile."""

from __future__ import annotations

import socket
import time

from bench.client import Client, connect_all, operation
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, running

TOPICS, ROBOTS = 1000, 20
LIMIT_MS = 5.0
REQUEST = (
    b"GET /metrics HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n"
    b"Accept: application/openmetrics-text;version=1.0.0\r\n\r\n"
)


def metrics(plan: Plan, report: Report) -> None:
    """Scrape a hub with a thousand topics, each with a publisher and a subscriber."""
    rows = []
    for hub in plan.hubs:
        with running(hub) as server, connect_all(server.port, ROBOTS, "robot") as robots:
            for number in range(TOPICS):
                topic = f"/robot_{number % ROBOTS}/topic_{number}"
                publisher, subscriber = robots[number % ROBOTS], robots[(number + 1) % ROBOTS]
                publisher.send(operation("advertise", topic=topic, type="std_msgs/Int32"))
                subscriber.send(operation("subscribe", topic=topic))
            for robot in robots:
                robot.settle()
            costs, waits, idle = _measure(server, robots[0], plan)
        cost, wait = Repeated.of(costs), Repeated.of(waits)
        report.record("metrics", server=hub, cpu_ms=costs, wait_ms=waits, idle_ms=idle)
        rows.append(
            (
                hub,
                f"{cost.least:.1f} ({cost.median:.1f})",
                report.check(hub, "/metrics", cost.median, LIMIT_MS, " ms"),
                f"{wait.median:.1f} ({max(waits):.1f})",
                f"{Repeated.of(idle).median:.2f}",
            )
        )
    report.table(
        f"/metrics of a hub with {TOPICS} topics, compressed",
        (
            "server",
            "CPU of a scrape, ms, minimum (median)",
            "limit",
            "another client's ping during one, ms, median (maximum)",
            "without one",
        ),
        rows,
    )


def _measure(
    server: Server, client: Client, plan: Plan
) -> tuple[list[float], list[float], list[float]]:
    """Return in ms: the CPU of each scrape, and a client's pings during them and between them."""
    costs, waits, idle = [], [], []
    end = time.monotonic() + plan.warm_seconds + plan.seconds
    while time.monotonic() < end:
        idle.append(_ping(client))
        with socket.create_connection(("127.0.0.1", server.port)) as scraper:
            before = server.cpu_seconds
            scraper.sendall(REQUEST)
            waits.append(_ping(client))
            response = b""
            while chunk := scraper.recv(1 << 16):
                response += chunk
            costs.append((server.cpu_seconds - before) * 1000)
        if not response.startswith(b"HTTP/1.1 200"):
            raise BenchError(f"{server.name}: /metrics answers {response[:60]!r}")
    skipped = len(costs) // 10
    return costs[skipped:], waits[skipped:], idle[skipped:]


def _ping(client: Client) -> float:
    start = time.perf_counter()
    client.settle()
    return (time.perf_counter() - start) * 1000
