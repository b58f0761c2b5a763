"""``fibws topic delay``; rostopic's own text is in `test_side_by_side`."""

from __future__ import annotations

import json
import time

import pytest

from fibws.cli.topic.delay import Delay, stamp

from ..conftest import Publish, Run


@pytest.mark.parametrize(
    "message",
    [
        b'{"header":{"seq":1,"stamp":{"secs":2,"nsecs":3},"frame_id":""},"point":null}',
        b'{"point":null,"header":{"stamp":{"nsecs":3,"secs":2}}}',
    ],
)
def test_the_stamp_is_in_the_header(message: bytes) -> None:
    assert stamp(message) == 2_000_000_003


@pytest.mark.parametrize("message", [b'{"data":8}', b'{"header":8}', b'{"header":{}}'])
def test_there_may_be_no_stamp(message: bytes) -> None:
    assert stamp(message) is None


def test_what_was_told_is_no_news() -> None:
    delay = Delay()
    assert delay.news() is None
    delay.take(0.5)
    delay.take(1.5)
    news = delay.news()
    assert news is not None
    assert (news[0].mean, news[1]) == (1.0, 2)
    assert delay.news() is None


def test_the_delay_is_the_time_since_the_stamp(run: Run, publish: Publish) -> None:
    header = {"stamp": {"secs": int(time.time()) - 100, "nsecs": 0}}
    publish("/point", "geometry_msgs/PointStamped", {"header": header})
    result = run("topic", "delay", "-n", "1", "/point")
    said, average, rest = result.output.splitlines()
    assert said == "subscribed to [/point]"
    assert 99 <= float(average.removeprefix("average delay: ")) < 199
    assert rest.startswith("\tmin: 1")
    found = json.loads(run("topic", "delay", "-n", "1", "--json", "/point").output)
    assert found.keys() == {"topic", "delay", "min", "max", "std_dev", "window"}


def test_silence_is_told(run: Run, publish: Publish) -> None:
    publish("/point", "geometry_msgs/PointStamped")
    result = run("topic", "delay", "-n", "2", "/point")
    assert result.output.splitlines()[-1] == "no new messages"


def test_a_message_with_no_header_has_no_delay(run: Run, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 8})
    result = run("topic", "delay", "/number")
    assert result.exit_code == 1
    assert result.stderr.startswith("Error: msg does not have header: std_msgs/Int32")
