"""CPU of one message in JSON and in ROS 1's serialization, without a network."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from pydantic import BaseModel
from pydantic_core import from_json, to_json

from bench import naive
from bench.measure import HUB, Plan, Repeated, microseconds
from bench.report import Report
from fibws.interfaces import Interfaces, Message, Validators
from fibws.interfaces.serialization import Serializers, class_codec
from fibws.msg import geometry_msgs, sensor_msgs, std_msgs, tf2_msgs


class Int32(BaseModel):
    """std_msgs/Int32."""

    data: int


class Time(BaseModel):
    """A time, as ROS 1 and rosbridge write it."""

    secs: int
    nsecs: int


class Header(BaseModel):
    """std_msgs/Header."""

    seq: int
    stamp: Time
    frame_id: str


class Point(BaseModel):
    """geometry_msgs/Point."""

    x: float
    y: float
    z: float


class Quaternion(BaseModel):
    """geometry_msgs/Quaternion."""

    x: float
    y: float
    z: float
    w: float


class Pose(BaseModel):
    """geometry_msgs/Pose."""

    position: Point
    orientation: Quaternion


class PoseStamped(BaseModel):
    """geometry_msgs/PoseStamped."""

    header: Header
    pose: Pose


class LaserScan(BaseModel):
    """sensor_msgs/LaserScan."""

    header: Header
    angle_min: float
    angle_max: float
    angle_increment: float
    time_increment: float
    scan_time: float
    range_min: float
    range_max: float
    ranges: list[float]
    intensities: list[float]


STAMP: dict[str, Any] = {"secs": 1735689600, "nsecs": 123456789}
HEADER: dict[str, Any] = {"seq": 7, "stamp": STAMP, "frame_id": "map"}
POSE: dict[str, Any] = {
    "position": {"x": 1.25, "y": -0.5, "z": 0.0},
    "orientation": {"x": 0.0, "y": 0.0, "z": 0.7071067811865476, "w": 0.7071067811865476},
}
SCAN: dict[str, Any] = {
    "header": HEADER,
    "angle_min": -3.14159,
    "angle_max": 3.14159,
    "angle_increment": 0.00873,
    "time_increment": 0.0,
    "scan_time": 0.1,
    "range_min": 0.12,
    "range_max": 12.0,
    "ranges": [round(0.5 + i * 0.013, 3) for i in range(720)],
    "intensities": [],
}


@dataclass(frozen=True)
class Sample:
    """A message, its naive model, and the limit of the ratio of the hub's time to naive's."""

    type_name: str
    msg: dict[str, Any]
    model: type[BaseModel]
    against_naive: float

    @property
    def text(self) -> str:
        """Return the publish operation as JSON."""
        operation = {"op": "publish", "topic": "/bench/codecs", "msg": self.msg}
        return json.dumps(operation, separators=(",", ":"))


SAMPLES = (
    Sample("std_msgs/Int32", {"data": 123456}, Int32, 0.25),
    Sample("geometry_msgs/PoseStamped", {"header": HEADER, "pose": POSE}, PoseStamped, 0.4),
    Sample("sensor_msgs/LaserScan", SCAN, LaserScan, 0.3),
)


MESSAGES: tuple[tuple[str, Message], ...] = (
    ("std_msgs/Int32", std_msgs.Int32(123456)),
    (
        "sensor_msgs/LaserScan, 720 ranges",
        sensor_msgs.LaserScan(ranges=[0.5 + i / 64 for i in range(720)]),  # exact as float32
    ),
    (
        "tf2_msgs/TFMessage, 20 transforms",
        tf2_msgs.TFMessage([geometry_msgs.TransformStamped(child_frame_id="arm")] * 20),
    ),
    ("sensor_msgs/Image, 921,600 B", sensor_msgs.Image(data=bytes(range(256)) * 3600)),
)


def codecs(plan: Plan, report: Report) -> None:
    """Time the hub's code and naive's on each sample in turn, then serialization."""
    _measure_json(plan, report)
    _measure_serialization(plan, report)


def _measure_serialization(plan: Plan, report: Report) -> None:
    """Time what a publisher, the hub and a subscriber each do with a serialized message."""
    serializers = Serializers(Interfaces())
    rounds = 20 * plan.reps
    rows = []
    for title, message in MESSAGES:
        codec = class_codec(type(message))
        data = codec.serialize(message)
        check = serializers.of(message._type).check
        if codec.deserialize(data) != message:
            report.fault(HUB, message._type, "deserialized to another message")
        times = microseconds(
            (
                partial(codec.serialize, message),
                partial(check, data),
                partial(codec.deserialize, data),
            ),
            rounds,
        )
        report.record("serialization", message=title, times=times)
        rows.append((title, *(f"{Repeated.of(each)}" for each in times)))
    report.table(
        f"ROS 1's serialization: CPU µs, minimum (median) of {rounds}",
        ("message", "serialize (publisher)", "check (hub)", "deserialize (subscriber)"),
        rows,
    )


def _measure_json(plan: Plan, report: Report) -> None:
    validators = Validators(Interfaces(), time.time_ns)
    rounds = 20 * plan.reps
    rows = []
    for sample in SAMPLES:
        text, data = sample.text, sample.text.encode()
        validate = validators.of(sample.type_name).validate

        def ours(data: bytes = data, validate: Callable[[Any], Any] = validate) -> bytes:
            operation = from_json(data)
            operation["msg"] = validate(operation["msg"])
            return to_json(operation, inf_nan_mode="null")

        def reference(text: str = text, model: type[BaseModel] = sample.model) -> str:
            return naive.relayed(json.loads(text), model)

        # The hub rounds float32 fields to the precision of float32: round naive's as well.
        if json.loads(ours())["msg"] != validate(json.loads(reference())["msg"]):
            report.fault(HUB, sample.type_name, "the results of hub and naive differ")
        times = microseconds((ours, reference), rounds)
        cost, its_cost = (Repeated.of(each) for each in times)
        ratio = cost / its_cost
        report.record("codecs", type=sample.type_name, ours=times[0], naive=times[1])
        rows.append(
            (
                f"{sample.type_name}, {len(data):,} B",
                f"{cost}",
                f"{its_cost}",
                f"{ratio}",
                report.check(HUB, f"codecs, {sample.type_name}", ratio.least, sample.against_naive),
            )
        )
    report.table(
        f"Parse, validate, serialise: CPU µs, minimum (median) of {rounds}",
        ("message", "hub", "naive", "hub : naive", "limit"),
        rows,
    )
