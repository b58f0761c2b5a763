"""Transforms by way of tf2_web_republisher's service."""

from __future__ import annotations

import math
import time
from typing import Any

from roslibpy import Message, Topic
from roslibpy.tf import TFClient

from .world import Collected, World

FRAME = "by_service"


def transforms_arrive_by_service(world: World) -> Any:
    ros, received = world.connect(), Collected()
    client = TFClient(
        ros, fixed_frame="world", angular_threshold=0.01, translation_threshold=0.01, rate=50
    )
    client.subscribe(FRAME, received.put)
    topic = Topic(ros, "/tf", "tf2_msgs/TFMessage")
    _move(topic, {"x": 1, "y": 2, "z": 3})
    first = received.many(1)
    _move(topic, {"x": 4, "y": 5, "z": 6})
    transforms = first + received.many(1)
    client.dispose()
    world.settled(ros)
    return transforms


def _move(topic: Any, translation: dict[str, float]) -> None:
    rotation = {"x": 0, "y": 0, "z": math.sqrt(0.5), "w": math.sqrt(0.5)}
    secs, nsecs = divmod(time.time_ns(), 10**9)
    transform = {
        "header": {"stamp": {"secs": secs, "nsecs": nsecs}, "frame_id": "world"},
        "child_frame_id": FRAME,
        "transform": {"translation": translation, "rotation": rotation},
    }
    topic.publish(Message({"transforms": [transform]}))
