"""CPU of the hub for a point cloud of 1 MB in each encoding, by the number of subscribers."""

from __future__ import annotations

import base64
import struct
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bench.client import Client, answer_pings, connect_all, operation, receive_all
from bench.machine import on_load_cpu
from bench.measure import Plan, Repeated, microseconds
from bench.report import Report
from bench.servers import Server, running
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Topic
from fibws.hub.graph.types import Types
from fibws.hub.rosbridge.encodings import Encoding
from fibws.interfaces import Interfaces

FEW, MANY, MOST = SUBSCRIBERS = (1, 10, 20)
LIMIT_ENCODINGS = 1.5
"""The hub should encode once, not once per subscriber; the cost of sending varies a little."""
SHARE = 0.2
"""The share of the planned seconds for each of many measurements."""
FEWEST_MESSAGES = 5

POINTS = 62_500
POINT = struct.Struct("<3fI")
DATA = b"".join(POINT.pack(n * 0.01, n * 0.02, n * 0.03, n) for n in range(POINTS))
CLOUD: dict[str, Any] = {
    "header": {"seq": 0, "stamp": {"secs": 1735689600, "nsecs": 123456789}, "frame_id": "lidar"},
    "height": 1,
    "width": POINTS,
    "fields": [
        {"name": name, "offset": 4 * n, "datatype": 6 if name == "rgb" else 7, "count": 1}
        for n, name in enumerate(("x", "y", "z", "rgb"))
    ],
    "is_bigendian": False,
    "point_step": POINT.size,
    "row_step": len(DATA),
    "data": base64.b64encode(DATA).decode(),
    "is_dense": True,
}


@dataclass(frozen=True, eq=False)
class Kind:
    """A message, the compression to request, the end of each frame, and a string of equal size."""

    name: str
    type: str
    msg: dict[str, Any]
    compression: str
    ending: bytes
    like: Kind | None = None

    @property
    def topic(self) -> str:
        """Return the topic of this type."""
        return f"/bench/{self.type.lower()}"


def _string(size: int) -> Kind:
    """Return a string, which costs almost nothing to encode: only receiving and sending remain."""
    text = "x" * size
    name = f"(a string, {size / 1e6:.2f} MB)"
    return Kind(name, "std_msgs/String", {"data": text}, "none", text.encode() + b'"}}')


def _cloud(compression: str, ending: bytes, like: Kind) -> Kind:
    return Kind(compression, "sensor_msgs/PointCloud2", CLOUD, compression, ending, like)


SHORT, LONG = _string(len(DATA)), _string(len(CLOUD["data"]))
RAW = _cloud("cbor-raw", DATA + b"\x01", SHORT)
KINDS = (
    RAW,
    _cloud("cbor", DATA + b"\x68is_dense\xf5", SHORT),
    _cloud("png", b'"}', SHORT),
    SHORT,
    _cloud("none", CLOUD["data"].encode() + b'","is_dense":true}}', LONG),
    LONG,
)


@dataclass(frozen=True)
class Costs:
    """The hub's CPU time per message, in ms."""

    by_subscribers: dict[int, Repeated]
    megabytes: float
    """The size of the frame."""

    @property
    def of_more(self) -> float:
        """Return the cost of all subscribers but the first, for MANY subscribers."""
        return self.by_subscribers[MANY].median - self.by_subscribers[FEW].median


def encodings(plan: Plan, report: Report) -> None:
    """Measure each encoding at each number of subscribers, in turn."""
    alone = _encoding_costs(plan)
    for hub in plan.hubs:
        with on_load_cpu(), running(hub) as server:
            costs = _costs(server, plan, report)
        report.table(
            f"A point cloud of 1 MB: CPU of the {hub}, ms per message, "
            f"minimum (median) of {plan.reps}",
            (
                "encoding",
                "frame, MB",
                *(f"→ {n}" for n in SUBSCRIBERS),
                f"→ {MANY} minus → {FEW}",
                "same, of a string",
                "one encoding",
                f"encodings → {MANY}",
                "limit",
            ),
            [_row(kind, hub, costs, alone, report) for kind in KINDS],
        )


def _row(
    kind: Kind,
    hub: str,
    costs: Mapping[Kind, Costs],
    alone: Mapping[Kind, Repeated],
    report: Report,
) -> Sequence[str]:
    cost = costs[kind]
    by_subscribers = (f"{cost.by_subscribers[n]}" for n in SUBSCRIBERS)
    sizes = (kind.name, f"{cost.megabytes:.2f}", *by_subscribers, f"{cost.of_more:.2f}")
    if kind.like is None:
        return (*sizes, "", f"{alone[kind]}", "", "")
    sending = costs[kind.like].of_more
    times = 1 + (cost.of_more - sending) / alone[kind].median
    limit = LIMIT_ENCODINGS if kind is RAW else None
    verdict = report.check(hub, f"{kind.name}, encodings → {MANY}", times, limit)
    return (*sizes, f"{sending:.2f}", f"{alone[kind]}", f"{times:.2f}", verdict)


def _encoding_costs(plan: Plan) -> dict[Kind, Repeated]:
    """Return the CPU time of one encoding, measured in this process, in ms."""
    bytearray(8 << 20)  # Raises the thresholds of malloc, as the hub does.
    types = Types(Interfaces(), time.time_ns, strict=True)
    times = microseconds([_encoder(types, kind) for kind in KINDS], 5 * plan.reps)
    return {
        kind: Repeated.of(each / 1000 for each in found)
        for kind, found in zip(KINDS, times, strict=True)
    }


def _encoder(types: Types, kind: Kind) -> Callable[[], object]:
    message_type = types.message(kind.type)
    message = message_type.validate(kind.msg)
    encode = Encoding(kind.compression).for_topic(Topic(kind.topic), kind.topic)

    return lambda: encode(Publication(message_type, "/bench", b"{}", time.time_ns(), message))


def _costs(server: Server, plan: Plan, report: Report) -> dict[Kind, Costs]:
    seen: dict[tuple[Kind, int], list[float]] = {}
    sizes: dict[Kind, int] = {}
    with (
        Client(server.port, "/lidar") as lidar,
        connect_all(server.port, MOST, "viewer") as viewers,
    ):
        for kind in KINDS:
            lidar.send(operation("advertise", topic=kind.topic, type=kind.type))
        for rep in range(plan.reps):
            for kind in KINDS:
                for n in SUBSCRIBERS:
                    answer_pings([lidar, *viewers])
                    cost, sizes[kind] = _cost(server, kind, lidar, viewers[:n], plan, report)
                    seen.setdefault((kind, n), []).append(cost)
                    report.record(
                        "encodings",
                        server=server.name,
                        encoding=kind.name,
                        subscribers=n,
                        rep=rep,
                        cpu_ms=cost,
                        frame_bytes=sizes[kind],
                    )
    return {
        kind: Costs({n: Repeated.of(seen[kind, n]) for n in SUBSCRIBERS}, sizes[kind] / 1e6)
        for kind in KINDS
    }


def _cost(
    server: Server,
    kind: Kind,
    lidar: Client,
    viewers: Sequence[Client],
    plan: Plan,
    report: Report,
) -> tuple[float, int]:
    """Return the hub's CPU time per message, in ms, and the bytes of its frame."""
    publish = operation("publish", topic=kind.topic, msg=kind.msg)
    subscribe = operation("subscribe", topic=kind.topic, compression=kind.compression)
    wrong: list[bytes] = []
    for viewer in viewers:
        viewer.send(subscribe)
        viewer.settle()
    for phase_seconds in (plan.warm_seconds, plan.seconds):
        published, cpu = 0, server.cpu_seconds
        end = time.perf_counter() + phase_seconds * SHARE
        while published < FEWEST_MESSAGES or time.perf_counter() < end:
            lidar.send(publish)
            received = receive_all(viewers)
            published += 1
            wrong += [each for each in received if not each.endswith(kind.ending)]
            wrong += received[len(viewers) :]
        cpu = server.cpu_seconds - cpu
    for viewer in viewers:
        viewer.send(operation("unsubscribe", topic=kind.topic))
        wrong += viewer.settle()
    if wrong:
        text = f"{len(wrong)} unexpected messages, the first: {wrong[0][:100]!r}"
        report.fault(server.name, f"{kind.name} → {len(viewers)}", text)
    return cpu / published * 1000, len(received[0])
