"""Bags with what recordings have, and their messages as lists that programs can compare."""

from __future__ import annotations

from pathlib import Path
from typing import TypeAlias

from fibws.bags import open_reader, open_writer
from fibws.interfaces import Interfaces
from fibws.interfaces.base64text import encode
from fibws.interfaces.serialization import Serializers

INTERFACES = Interfaces()
SERIALIZERS = Serializers(INTERFACES)
START = 1_700_000_000_123_456_789
"""Of the first message, in ns."""

Found: TypeAlias = tuple[str, str, str, str, bool, int, bytes]
"""A message: topic, type, md5sum, callerid, latching, time in ns, bytes."""

PUBLISHERS = [
    ("/number", "std_msgs/Int32", "/talker", False),
    ("/number", "std_msgs/Int32", "/other", False),
    ("/map_name", "std_msgs/String", "/map_server", True),
    ("/pose", "geometry_msgs/PoseStamped", "/robot/localization", False),
    ("groundtruth", "geometry_msgs/TransformStamped", "", False),  # Some datasets name it so.
    ("/tf", "tf2_msgs/TFMessage", "/tf", False),
    ("/image", "sensor_msgs/Image", "/camera", False),
]


def messages() -> list[tuple[int, int, bytes]]:
    """Return messages in the order in which a recorder writes them.

    Each is the number of its publisher, its time in ns, and its bytes.
    """
    found = []
    for number in range(400):
        which = number % len(PUBLISHERS)
        # Messages of several threads arrive a little out of order.
        time = START + number * 10_000_000 - (number % 3) * 15_000_000
        found.append((which, time, SERIALIZERS.of(PUBLISHERS[which][1]).serialize(_fields(number))))
    return found


def _fields(number: int) -> dict[str, object]:
    header = {"seq": number, "stamp": {"secs": number, "nsecs": 5}, "frame_id": "map"}
    point = {"x": number / 8, "y": -1.5, "z": 0.0}
    rotation = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    transform: dict[str, object] = {
        "header": header,
        "child_frame_id": "base",
        "transform": {"translation": point, "rotation": rotation},
    }
    fields: list[dict[str, object]] = [
        {"data": number},
        {"data": -number},
        {"data": f"Straße {number}"},
        {"header": header, "pose": {"position": point, "orientation": rotation}},
        transform,
        {"transforms": [transform] * (number % 5)},
        {
            **{"header": header, "height": 10, "width": number, "encoding": "mono8"},
            **{"is_bigendian": 0, "step": number, "data": encode(bytes(range(10)) * number)},
        },
    ]
    return fields[number % len(fields)]


def write(path: Path, compression: str) -> None:
    """Write a recording by fibws, in chunks that overlap."""
    with open_writer(path, compression, chunk_size=20_000) as writer:
        publishers = [
            writer.connection(
                *(topic, type_, INTERFACES.md5(type_), INTERFACES.full_text(type_)),
                callerid=callerid,
                latching=latching,
            )
            for topic, type_, callerid, latching in PUBLISHERS
        ]
        for which, time, data in messages():
            writer.write(publishers[which], time, data)


def expected() -> list[Found]:
    """Return the messages of the recording in the order of their times."""
    found = []
    for which, time, data in messages():
        topic, type_, callerid, latching = PUBLISHERS[which]
        found.append((topic, type_, INTERFACES.md5(type_), callerid, latching, time, data))
    return sorted(found, key=lambda each: each[5])


def read(path: Path, *, allow_unindexed: bool = False) -> list[Found]:
    """Return the messages that fibws reads."""
    with open_reader(path, allow_unindexed=allow_unindexed) as bag:
        return [
            (each.topic, each.type, each.md5sum, each.callerid, each.latching, time, data)
            for each, time, data in bag.messages()
        ]
