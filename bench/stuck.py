"""Memory of the hub while one viewer of an image topic never reads its socket."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Sequence

from bench.client import Client, operation
from bench.environments import Script, Traffic, on_hub
from bench.machine import memory
from bench.measure import HUB, Plan
from bench.report import Report
from bench.servers import Server

IMAGES = Traffic("sensor_msgs/Image", 921_600, 30, subscribers=2)
TOPIC = "/bench"
SECONDS, QUICK_SECONDS = 20.0, 3.0
"""The default durations; --minutes 10 is the real proof."""
SAMPLES, LONGEST_INTERVAL = 10, 10.0
"""The number of samples in a short run, and the most seconds between two in a long one."""
SETTLE_SECONDS = 60.0
"""The time that memory may grow without limit; half of the duration if that is less."""
LIMIT_GROWTH_PERCENT = 20.0


def stuck(plan: Plan, report: Report) -> None:
    """Publish images to a viewer that reads and to one that does not; watch the hub's memory."""
    default = QUICK_SECONDS if plan.quick else SECONDS
    seconds = default if plan.minutes is None else plan.minutes * 60
    count = IMAGES.count(seconds)
    with on_hub() as (_, environment):
        assert environment.hub is not None
        common = (IMAGES.type, str(IMAGES.size))
        with (
            StuckViewer(environment.hub) as viewer,
            environment.script("node_subscriber.py", *common, "0", str(count)) as healthy,
        ):
            healthy.line()
            numbers = (f"{IMAGES.hz:g}", "0", str(count), str(IMAGES.subscribers))
            with environment.script("node_publisher.py", *common, *numbers) as publisher:
                publisher.line()
                samples: list[tuple[float, float]] = []
                report.table(
                    f"A viewer that never reads, {IMAGES.hz:g} images of 921.6 kB a second for "
                    f"{seconds:g} s",
                    ("seconds", "memory of the hub, MB", "stuck viewers dropped so far"),
                    _samples(environment.hub, viewer, seconds, samples, report),
                )
                _check_growth(samples, seconds, report)
                _check_delivery(publisher, healthy, count, report)


class StuckViewer:
    """A viewer that subscribes, never reads, and connects again when the hub drops it."""

    def __init__(self, hub: Server) -> None:
        """Connect, and connect an observer that asks the hub about the viewer."""
        self.dropped = 0
        self._port = hub.port
        self._observer = Client(hub.port, "/observer")
        self._viewer = self._connected()

    def check(self) -> None:
        """Connect again if the hub has dropped the viewer."""
        call = operation("call_service", service="/rosapi/subscribers", args={"topic": TOPIC})
        self._observer.send(call)
        (response,) = self._observer.receive()
        if "/stuck" not in json.loads(response)["values"]["subscribers"]:
            self.dropped += 1
            self._viewer.close()
            self._viewer = self._connected()

    def _connected(self) -> Client:
        client = Client(self._port, "/stuck")
        client.send(operation("subscribe", topic=TOPIC, type=IMAGES.type))
        return client

    def __enter__(self) -> StuckViewer:
        """Do nothing; the viewer is connected."""
        return self

    def __exit__(self, *failure: object) -> None:
        """Disconnect."""
        self._viewer.close()
        self._observer.close()


def _samples(
    hub: Server,
    viewer: StuckViewer,
    seconds: float,
    samples: list[tuple[float, float]],
    report: Report,
) -> Iterator[Sequence[str]]:
    """Yield one row of the table after each interval, and keep its time and memory."""
    interval = min(LONGEST_INTERVAL, seconds / SAMPLES)
    start = time.monotonic()
    while (elapsed := time.monotonic() - start) < seconds:
        time.sleep(min(interval, seconds - elapsed))
        viewer.check()
        elapsed, size = time.monotonic() - start, memory(hub.pid)["VmRSS"] / 1e6
        samples.append((elapsed, size))
        report.record("stuck", seconds=elapsed, rss_mb=size, dropped=viewer.dropped)
        yield f"{elapsed:.1f}", f"{size:.1f}", f"{viewer.dropped}"


def _check_growth(samples: Sequence[tuple[float, float]], seconds: float, report: Report) -> None:
    settled = min(SETTLE_SECONDS, seconds / 2)
    before = max(size for elapsed, size in samples if elapsed <= settled + 1)
    after = max(size for elapsed, size in samples if elapsed > settled)
    growth = 100 * (after / before - 1)
    what = "a viewer that never reads, growth of memory"
    verdict = report.check(HUB, what, growth, LIMIT_GROWTH_PERCENT, " %")
    print(f"\nGrowth after the first {settled:g} s: {growth:.1f} % {verdict}")


def _check_delivery(publisher: Script, healthy: Script, count: int, report: Report) -> None:
    publisher.line()
    received = json.loads(healthy.line())["received"]
    if received != count:
        report.fault(HUB, "beside a stuck viewer", f"lost {count - received} of {count}")
