"""CPU of the hub for a point cloud of a megabyte in each encoding: encoded once, then only sent."""

from __future__ import annotations

import base64
import struct
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bench.client import Client, answer_pings, crowd, hear, operation
from bench.machine import on_load_cpu
from bench.measure import Plan, Repeated, microseconds
from bench.report import Report
from bench.servers import Server, running
from fibws.hub.graph.encoding import Encoding, Publication
from fibws.hub.graph.types import Types
from fibws.interfaces import Interfaces

FEW, MANY, MOST = SUBSCRIBERS = (1, 10, 20)
LIMIT_ENCODINGS = 1.5
"""One is what is wanted, MANY would be one for each; what sending costs varies a little."""
SHARE = 0.2
"""Of the planned seconds, for each of many measurements."""
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
    """What is published, how it is asked for, how each frame ends, and a string of its size."""

    name: str
    type: str
    msg: dict[str, Any]
    compression: str
    ending: bytes
    like: Kind | None = None

    @property
    def topic(self) -> str:
        """Return a topic for this type."""
        return f"/bench/{self.type.lower()}"


def _string(size: int) -> Kind:
    """Nearly no work to encode: what is left is to receive it once and to send it."""
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
    """What one message costs the hub, in ms of CPU."""

    by_subscribers: dict[int, Repeated]
    megabytes: float
    """The size of its frame."""

    @property
    def of_more(self) -> float:
        """Return what the subscribers after the first cost, where they are many."""
        return self.by_subscribers[MANY].median - self.by_subscribers[FEW].median


def encodings(plan: Plan, report: Report) -> None:
    """Measure each encoding at each number of subscribers, in turn."""
    alone = _alone(plan)
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
                f"→ {MANY} less → {FEW}",
                "of a string",
                "encoding once",
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


def _alone(plan: Plan) -> dict[Kind, Repeated]:
    """Return what it costs to encode, once and here, in ms."""
    bytearray(8 << 20)  # as the hub does, for the same reason
    types = Types(Interfaces(), time.time_ns, strict=True)
    times = microseconds([_encoder(types, kind) for kind in KINDS], 5 * plan.reps)
    return {
        kind: Repeated.of(each / 1000 for each in found)
        for kind, found in zip(KINDS, times, strict=True)
    }


def _encoder(types: Types, kind: Kind) -> Callable[[], bytes]:
    message_type = types.message(kind.type)
    message = message_type.validate(kind.msg)
    frame = Encoding(kind.compression).framer(kind.topic)
    return lambda: frame(Publication(message, message_type, time.time_ns()))


def _costs(server: Server, plan: Plan, report: Report) -> dict[Kind, Costs]:
    seen: dict[tuple[Kind, int], list[float]] = {}
    sizes: dict[Kind, int] = {}
    with Client(server.port, "/lidar") as lidar, crowd(server.port, MOST, "viewer") as viewers:
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
    """Return the CPU time that one message costs the hub, in ms, and the bytes it has."""
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
            heard = hear(viewers)
            published += 1
            wrong += [each for each in heard if not each.endswith(kind.ending)]
            wrong += heard[len(viewers) :]
        cpu = server.cpu_seconds - cpu
    for viewer in viewers:
        viewer.send(operation("unsubscribe", topic=kind.topic))
        wrong += viewer.settle()
    if wrong:
        text = f"{len(wrong)} messages too many or not as expected: {wrong[0][:100]!r}"
        report.fault(server.name, f"{kind.name} → {len(viewers)}", text)
    return cpu / published * 1000, len(heard[0])
