"""``fibws topic delay``; `test_side_by_side` compares its output with rostopic's."""

from __future__ import annotations

import json
import struct
import time

import pytest
from hub_in_thread import Publish, Run

from fibws.cli.topic.delay import Delay, json_stamp, serialized_stamp
from fibws.client.hub_client import RawMessage


@pytest.mark.parametrize(
    "message",
    [
        b'{"header":{"seq":1,"stamp":{"secs":2,"nsecs":3},"frame_id":""},"point":null}',
        b'{"point":null,"header":{"stamp":{"nsecs":3,"secs":2}}}',
    ],
)
def test_stamp_is_read_from_json(message: bytes) -> None:
    assert json_stamp(message) == json_stamp(memoryview(message)) == 2_000_000_003


@pytest.mark.parametrize("message", [b'{"data":8}', b'{"header":8}', b'{"header":{}}'])
def test_json_without_a_stamp_has_none(message: bytes) -> None:
    assert json_stamp(message) is None


def test_stamp_is_read_from_a_serialized_header() -> None:
    message = struct.pack("<IIII", 1, 2, 3, 0)
    assert serialized_stamp(memoryview(message)) == 2_000_000_003
    assert serialized_stamp(message[:11]) is None


def test_serialized_messages_of_another_type_are_ignored() -> None:
    delay = Delay()
    delay.type = "std_msgs/Header"
    message = struct.pack("<IIII", 1, 2, 3, 0)
    delay.receive(RawMessage(message, "shape_msgs/Plane"))
    assert delay.poll() is None
    delay.receive(RawMessage(message, "std_msgs/Header"))
    assert delay.poll() is not None


def test_poll_returns_nothing_without_new_messages() -> None:
    delay = Delay()
    assert delay.poll() is None
    delay.add(0.5)
    delay.add(1.5)
    polled = delay.poll()
    assert polled is not None
    assert (polled[0].mean, polled[1]) == (1.0, 2)
    assert delay.poll() is None


def test_delay_is_the_time_since_the_stamp(run: Run, publish: Publish) -> None:
    header = {"stamp": {"secs": int(time.time()) - 100, "nsecs": 0}}
    publish("/point", "geometry_msgs/PointStamped", {"header": header})
    result = run("topic", "delay", "-n", "1", "/point")
    said, average, rest = result.output.splitlines()
    assert said == "subscribed to [/point]"
    assert 99 <= float(average.removeprefix("average delay: ")) < 199
    assert rest.startswith("\tmin: 1")
    found = json.loads(run("topic", "delay", "-n", "1", "--json", "/point").output)
    assert found.keys() == {"topic", "delay", "min", "max", "std_dev", "window"}


def test_missing_messages_are_reported(run: Run, publish: Publish) -> None:
    publish("/point", "geometry_msgs/PointStamped")
    result = run("topic", "delay", "-n", "2", "/point")
    assert result.output.splitlines()[-1] == "no new messages"


def test_type_without_a_header_is_an_error(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    result = run("topic", "delay", "/number")
    assert result.exit_code == 1
    assert result.stderr.startswith("Error: msg does not have header: std_msgs/Int32")
