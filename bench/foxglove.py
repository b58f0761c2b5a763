"""Foxglove's protocol: large images beside ``cbor-raw``, and thousands of channels at once."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable

from bench.client import BINARY, Client, frame, operation, receive_all
from bench.machine import on_load_cpu
from bench.measure import BenchError, Plan, Repeated
from bench.report import Report
from bench.servers import Server, running
from fibws.hub.foxglove import SUBPROTOCOLS
from fibws.hub.foxglove.messages import MESSAGE_HEAD_SIZE
from fibws.interfaces import Interfaces
from fibws.interfaces.serialization import Serializers
from fibws.protocol.serialized import SUBPROTOCOL, publish_head

WIDTH, HEIGHT, HZ = 1920, 1080, 30
TOPIC = "/bench_image"
LIMIT_IMAGE = 1.05
"""Of the CPU that the same images cost with rosbridge's ``cbor-raw``."""
CHANNELS = 3000
LIMIT_CHANNELS = 100.0
"""Milliseconds."""
BATCH = 10
"""Images in a row to one kind of viewer, before the other one has its turn."""


def foxglove(plan: Plan, report: Report) -> None:
    """Measure both on each hub."""
    image = _image()
    for hub in plan.hubs:
        with on_load_cpu(), running(hub) as server:
            costs = _image_costs(server, image, plan, report)
            times = _channel_times(server, plan, report)
        raw, ours = (Repeated.of(each) for each in costs)
        ratio = Repeated.ratio(costs[1], costs[0])
        size = len(image) / 1e6
        verdict = report.check(hub, "images in Foxglove's protocol", ratio.median, LIMIT_IMAGE)
        report.table(
            f"An image of {size:.1f} MB to one viewer: CPU of the {hub}, ms per message, "
            f"minimum (median) of {len(costs[0])}",
            ("cbor-raw", "Foxglove", "ratio", f"Foxglove at {HZ} Hz", "limit"),
            [(f"{raw}", f"{ours}", f"{ratio}", f"{ours.median * HZ / 10:.1f} %", verdict)],
        )
        taken = Repeated.of(times)
        verdict = report.check(hub, f"{CHANNELS} channels", taken.median, LIMIT_CHANNELS, " ms")
        report.table(
            f"{CHANNELS} channels advertised to a client that connects, ms, "
            f"minimum (median) of {len(times)}",
            ("until the last one has come", "limit"),
            [(f"{taken}", verdict)],
        )


def _image() -> bytes:
    """Return a serialized sensor_msgs/Image."""
    values = {
        "header": {"seq": 0, "stamp": {"secs": 1, "nsecs": 2}, "frame_id": "camera"},
        "height": HEIGHT,
        "width": WIDTH,
        "encoding": "rgb8",
        "is_bigendian": 0,
        "step": 3 * WIDTH,
        "data": "",
    }
    empty = Serializers(Interfaces()).of("sensor_msgs/Image").serialize(values)
    size = 3 * WIDTH * HEIGHT
    return empty[:-4] + size.to_bytes(4, "little") + bytes(size)


def _image_costs(
    server: Server, image: bytes, plan: Plan, report: Report
) -> tuple[list[float], list[float]]:
    """Return the CPU in ms per image for a viewer of ``cbor-raw``, and for one of Foxglove's."""
    publish = frame(publish_head(1) + image, BINARY)
    costs: tuple[list[float], list[float]] = ([], [])
    with (
        Client(server.port, "/camera", subprotocol=SUBPROTOCOL) as camera,
        Client(server.port, "/raw") as raw,
        Client(server.port, "/studio", subprotocol=SUBPROTOCOLS[0]) as studio,
    ):
        camera.send(operation("advertise", topic=TOPIC, type="sensor_msgs/Image", publisher=1))
        camera.settle()
        channels: dict[str, int] = {}
        while TOPIC not in channels:
            channels.update(_channels(studio.receive()))
        subscriptions = [{"id": 1, "channelId": channels[TOPIC]}]
        switches = (
            (
                raw,
                operation("subscribe", topic=TOPIC, compression="cbor-raw"),
                operation("unsubscribe", topic=TOPIC),
            ),
            (
                studio,
                operation("subscribe", subscriptions=subscriptions),
                operation("unsubscribe", subscriptionIds=[1]),
            ),
        )
        for rep in range(1 + (2 if plan.quick else 4 * plan.reps)):
            for (viewer, on, off), found in zip(switches, costs, strict=True):
                viewer.send(on)
                viewer.settle()
                cpu = server.cpu_seconds
                for _ in range(BATCH):
                    camera.send(publish)
                    [message] = receive_all([viewer])
                    if len(message) < MESSAGE_HEAD_SIZE + len(image):
                        raise BenchError(f"an image came with {len(message)} bytes")
                cost = (server.cpu_seconds - cpu) / BATCH * 1000
                viewer.send(off)
                viewer.settle()
                if rep:  # The first one warms up.
                    found.append(cost)
    for rep, (of_raw, of_foxglove) in enumerate(zip(*costs, strict=True)):
        report.record("foxglove", server=server.name, rep=rep, raw=of_raw, foxglove=of_foxglove)
    return costs


def _channel_times(server: Server, plan: Plan, report: Report) -> list[float]:
    """Return the milliseconds until a client that connects knows all channels."""
    types = Interfaces().messages("sensor_msgs")
    topics = [f"/bench/topic{number}" for number in range(CHANNELS)]
    times = []
    with Client(server.port, "/robot") as robot:
        for number, topic in enumerate(topics):
            robot.send(operation("advertise", topic=topic, type=types[number % len(types)]))
        robot.settle()
        for rep in range(1 + plan.reps):
            start = time.perf_counter()
            with Client(server.port, f"/studio{rep}", subprotocol=SUBPROTOCOLS[0]) as studio:
                known: set[str] = set()
                arrived = start
                while not known.issuperset(topics):
                    messages = studio.receive()
                    arrived = time.perf_counter()
                    known.update(_channels(messages))
            if rep:
                times.append((arrived - start) * 1000)
                report.record("foxglove", server=server.name, rep=rep, channels=times[-1])
    return times


def _channels(messages: Iterable[bytes]) -> dict[str, int]:
    """Return the ids of the channels that messages offer, by their topics."""
    found = {}
    for message in messages:
        if message.startswith(b'{"op":"advertise",'):
            found.update({each["topic"]: each["id"] for each in json.loads(message)["channels"]})
    return found
