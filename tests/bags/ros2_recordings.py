"""Recordings of ROS 2, written by rosbags: messages in CDR, in MCAP files or SQLite's."""

from __future__ import annotations

import atexit
import shutil
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import yaml
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from .recordings import START

Row = tuple[str, str, int, bytes]
"""A message: topic, type, time in ns, and bytes as in ROS 1."""

OWN_TEXT = """
std_msgs/Header header
float32[<=4] levels
string<=9 name
sensor_msgs/CameraInfo info
"""
Kind = tuple[StoragePlugin, CompressionMode]
"""How a recording is stored."""
KINDS: dict[str, Kind] = {
    f"{plugin.name}-{mode.name}".lower(): (plugin, mode)
    for plugin in (StoragePlugin.MCAP, StoragePlugin.SQLITE3)
    for mode in CompressionMode
    if plugin is StoragePlugin.MCAP or mode is not CompressionMode.STORAGE
}
MCAP: Kind = KINDS["mcap-none"]
NEVER = QosTime(9223372036, 854775807)
LATCHED = Qos(
    history=QosHistory.KEEP_LAST,
    depth=1,
    reliability=QosReliability.RELIABLE,
    durability=QosDurability.TRANSIENT_LOCAL,
    deadline=NEVER,
    lifespan=NEVER,
    liveliness=QosLiveliness.AUTOMATIC,
    liveliness_lease_duration=NEVER,
    avoid_ros_namespace_conventions=False,
)


def types() -> Any:
    """Return the types of ROS 2 Jazzy, and one of a user."""
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(OWN_TEXT, "my_msgs/msg/Battery"))
    return store


STORE: Any = types()


def _message(type_: str, /, **fields: Any) -> Any:
    return STORE.types[type_](**fields)


def _header(number: int) -> Any:
    stamp = _message("builtin_interfaces/msg/Time", sec=number, nanosec=5)
    return _message("std_msgs/msg/Header", stamp=stamp, frame_id="map"[: number % 4])


def _camera_info(number: int) -> Any:
    import numpy as np

    region = _message(
        "sensor_msgs/msg/RegionOfInterest",
        **{"x_offset": 1, "y_offset": 2, "height": 3, "width": 4, "do_rectify": True},
    )
    return _message(
        "sensor_msgs/msg/CameraInfo",
        **{"header": _header(number), "height": 10, "width": number, "distortion_model": "plumb"},
        **{"d": np.arange(number % 6, dtype=float), "k": np.ones(9), "r": np.ones(9)},
        **{"p": np.ones(12), "binning_x": 0, "binning_y": 0, "roi": region},
    )


def messages(number: int) -> list[tuple[str, str, Any]]:
    """Return a topic, a type and a message of each kind."""
    import numpy as np

    point = _message("geometry_msgs/msg/Point", x=number / 8, y=-1.5, z=0.0)
    own = _message(
        "my_msgs/msg/Battery",
        **{"header": _header(number), "levels": np.ones(number % 5, dtype=np.float32)},
        **{"name": "Straße"[: number % 7], "info": _camera_info(number)},
    )
    return [
        ("/number", "std_msgs/msg/Int32", _message("std_msgs/msg/Int32", data=-number)),
        (
            "/point",
            "geometry_msgs/msg/PointStamped",
            _message("geometry_msgs/msg/PointStamped", header=_header(number), point=point),
        ),
        ("/camera_info", "sensor_msgs/msg/CameraInfo", _camera_info(number)),
        (
            "/ping",
            "std_msgs/msg/Empty",
            _message("std_msgs/msg/Empty", structure_needs_at_least_one_member=0),
        ),
        ("/battery", "my_msgs/msg/Battery", own),
    ]


def definition(type_: str) -> str:
    """Return the full text of a type, as rosbag2 records it."""
    text: str = STORE.generate_msgdef(type_, ros_version=2)[0]
    return text


def write(
    folder: Path,
    kind: Kind = MCAP,
    *,
    begin: int = 0,
    end: int = 20,
    latched: bool = False,
) -> None:
    """Write a folder with one file of messages by their numbers, ten of each topic in a second."""
    shutil.copytree(_written(folder.name, kind, begin, end, latched=latched), folder)


def write_split(folder: Path, kind: Kind = MCAP) -> None:
    """Write a folder with three files, the way rosbag2 splits recordings."""
    shutil.copytree(_written_split(folder.name, kind), folder)


def _new_place() -> Path:
    path = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, path)
    return Path(path)


# A folder is written once by each process, and copied: SQLite waits for the disk with each file.
@cache
def _written(name: str, kind: Kind, begin: int, end: int, *, latched: bool) -> Path:
    folder = _new_place() / name
    plugin, mode = kind
    writer = Writer(folder, version=9, storage_plugin=plugin)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {
            topic: writer.add_connection(
                *(topic, type_),
                typestore=STORE,
                offered_qos_profiles=[LATCHED] if latched else (),
            )
            for topic, type_, _ in messages(0)
        }
        for number in range(begin, end):
            for shift, (topic, type_, message) in enumerate(messages(number)):
                data = STORE.serialize_cdr(message, type_)
                writer.write(connections[topic], START + number * 100_000_000 + shift, data)
    return folder


@cache
def _written_split(name: str, kind: Kind) -> Path:
    folder = _new_place() / name
    parts = []
    for number in range(3):
        part = folder.with_name(f"{folder.name}_part{number}")
        write(part, kind, begin=number * 10, end=number * 10 + 10)
        parts.append(part)
    folder.mkdir()
    names = []
    for number, part in enumerate(parts):
        [path] = files(part)
        names.append(f"{folder.name}_{number}.{path.name.partition('.')[2]}")
        path.rename(folder / names[-1])
    metadata = yaml.safe_load((parts[0] / "metadata.yaml").read_text())
    found = metadata["rosbag2_bagfile_information"]
    found["relative_file_paths"] = names
    found["files"] = [{**found["files"][0], "path": name} for name in names]
    (folder / "metadata.yaml").write_text(yaml.safe_dump(metadata))
    for part in parts:
        shutil.rmtree(part)
    return folder


def files(folder: Path) -> list[Path]:
    """Return the files with messages of a folder."""
    return [each for each in sorted(folder.iterdir()) if each.name != "metadata.yaml"]


def rows_by_rosbags(folder: Path) -> list[Row]:
    """Return the messages that rosbags reads, converted by it to ROS 1's serialization."""
    with Reader(folder) as reader:
        return [
            (
                *(connection.topic, connection.msgtype.replace("/msg/", "/"), time),
                bytes(STORE.cdr_to_ros1(data, connection.msgtype)),
            )
            for connection, time, data in reader.messages()
        ]
