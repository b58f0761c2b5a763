"""A `Header` without ``seq``, as ROS 2 has it, arrives as it was sent, in every encoding."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fibws.interfaces import Interfaces
from fibws.protocol.serialized import publish_head, read_delivery

from .fakes import BINARY, NANOSECONDS, Client, FakeHub
from .foxglove.foxglove_client import FoxgloveClient, FoxgloveHub

TYPE = "geometry_msgs/PointStamped"
STAMP = {"secs": 1_795_784_625, "nsecs": 5}
HEADER = {"stamp": STAMP, "frame_id": "map"}
VALUES = {"header": HEADER, "point": {"x": 1.0, "y": 2.0, "z": 3.0}}
DATA = struct.pack("<III3s3d", 1_795_784_625, 5, 3, b"map", 1, 2, 3)


@pytest.fixture
def interfaces(tmp_path: Path) -> Interfaces:
    """The standard types, but with ROS 2's Header."""
    folder = tmp_path / "std_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Header.msg").write_text("builtin_interfaces/Time stamp\nstring frame_id\n")
    return Interfaces([tmp_path])


@pytest.fixture
def hub(interfaces: Interfaces) -> FoxgloveHub:
    return FoxgloveHub(interfaces=interfaces)


def publish_json(hub: FoxgloveHub) -> None:
    client = hub.client("/talker")
    client.send("advertise", "/p", type=TYPE)
    client.send("publish", "/p", msg=VALUES)


def publish_serialized(hub: FoxgloveHub) -> None:
    client = hub.client("/talker", serialized=True)
    client.send("advertise", "/p", type=TYPE, publisher=1)
    client.send_binary(publish_head(1) + DATA)


def publish_by_foxglove(hub: FoxgloveHub) -> None:
    client = hub.foxglove_client()
    client.advertise("/p", TYPE)
    client.publish(1, DATA)


def subscriber(hub: FoxgloveHub, **fields: Any) -> Client:
    client = hub.client("/listener", serialized=fields.get("compression") == "ros1")
    client.send("subscribe", "/p", type=TYPE, **fields)
    client.receive()
    return client


def receive_json(hub: FoxgloveHub) -> Callable[[], object]:
    client = subscriber(hub)
    return lambda: client.receive_one("publish")["msg"]


def receive_cbor(hub: FoxgloveHub) -> Callable[[], object]:
    client = subscriber(hub, compression="cbor")
    return lambda: client.receive_cbor()[0]["msg"]


def receive_cbor_raw(hub: FoxgloveHub) -> Callable[[], object]:
    client = subscriber(hub, compression="cbor-raw")
    return lambda: client.receive_cbor()[0]["msg"]["bytes"]


def receive_serialized(hub: FoxgloveHub) -> Callable[[], object]:
    client = subscriber(hub, compression="ros1")

    def receive() -> bytes:
        [(first, payload)] = client.receive_frames()
        assert first == BINARY
        return bytes(read_delivery(payload).message)

    return receive


def receive_by_foxglove(hub: FoxgloveHub) -> Callable[[], object]:
    client: FoxgloveClient = hub.foxglove_client("/foxglove_listener")
    hub.client("/first").send("advertise", "/p", type=TYPE)
    client.subscribe("/p")
    return lambda: client.receive_messages()[0][2]


@pytest.mark.parametrize(
    "publish",
    [publish_json, publish_serialized, publish_by_foxglove],
)
@pytest.mark.parametrize(
    ("subscribe", "expected"),
    [
        (receive_json, VALUES),
        (receive_cbor, VALUES),
        (receive_cbor_raw, DATA),
        (receive_serialized, DATA),
        (receive_by_foxglove, DATA),
    ],
)
def test_message_arrives_as_it_was_sent(
    hub: FoxgloveHub,
    publish: Callable[[FoxgloveHub], None],
    subscribe: Callable[[FoxgloveHub], Callable[[], object]],
    expected: object,
) -> None:
    receive = subscribe(hub)
    publish(hub)
    assert receive() == expected


def test_stamp_that_is_left_out_is_the_current_time(hub: FoxgloveHub) -> None:
    client = subscriber(hub)
    talker = hub.client("/talker")
    talker.send("publish", "/p", type=TYPE, msg={})
    secs, nsecs = divmod(NANOSECONDS, 10**9)
    stamp = {"secs": secs, "nsecs": nsecs}
    assert client.receive_one("publish")["msg"]["header"] == {"stamp": stamp, "frame_id": ""}


def test_header_of_other_fields_gets_no_stamp(tmp_path: Path) -> None:
    folder = tmp_path / "std_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Header.msg").write_text("string frame_id\nuint32 seq\nstring stamp\n")
    hub = FakeHub(interfaces=Interfaces([tmp_path]))
    client, talker = hub.client("/listener"), hub.client("/talker")
    client.send("subscribe", "/p", type=TYPE)
    talker.send("advertise", "/p", type=TYPE)
    talker.send("publish", "/p", msg={"header": {"frame_id": "map"}})
    header = {"frame_id": "map", "seq": 0, "stamp": ""}
    assert client.receive_one("publish")["msg"]["header"] == header
