"""``fibws topic bw``; rostopic's own text is in `test_side_by_side`."""

from __future__ import annotations

import json
import threading

import pytest

from fibws.cli.topic import bw
from fibws.cli.topic.bw import Bandwidth
from fibws.cli.topic.window import Summary

from ..conftest import Publish, Run


def test_bandwidth_is_bytes_by_the_time_since_the_oldest() -> None:
    bandwidth = Bandwidth()
    for moment in (10.0, 11.0):
        bandwidth.take(100, moment)
    news = bandwidth.at(12.0)
    assert news is not None
    rate, sizes, number = news
    assert (rate, sizes.mean, number) == (100.0, 100.0, 2)


def test_one_message_has_no_bandwidth() -> None:
    bandwidth = Bandwidth()
    bandwidth.hear(b"{}")
    assert bandwidth.at(1e9) is None


def test_only_the_newest_messages_count() -> None:
    bandwidth = Bandwidth(2)
    for size, moment in ((1000, 0.0), (10, 1.0), (20, 2.0)):
        bandwidth.take(size, moment)
    news = bandwidth.at(2.0)
    assert news is not None
    assert (news[0], news[2]) == (30.0, 2)


@pytest.mark.parametrize(
    ("rate", "printed"),
    [
        (12.0, "average: 12.00B/s\n\tmean: 1500.00B min: 1000.00B max: 2000.00B window: 2"),
        (5340.0, "average: 5.34KB/s\n\tmean: 1.50KB min: 1.00KB max: 2.00KB window: 2"),
        (2.5e6, "average: 2.50MB/s\n\tmean: 0.00MB min: 0.00MB max: 0.00MB window: 2"),
    ],
)
def test_all_numbers_have_one_unit(rate: float, printed: str) -> None:
    assert bw.text(rate, Summary(1500, 1000, 2000, 500), 2) == printed


def test_the_bytes_are_those_of_the_messages(run: Run, publish: Publish) -> None:
    link = publish("/number", "std_msgs/Int32", {"data": 8})

    def publish_more() -> None:
        while not link.call("/rosapi/subscribers", {"topic": "/number"})["subscribers"]:
            pass
        for _ in range(3):
            link.send({"op": "publish", "topic": "/number", "msg": {"data": 8}})

    thread = threading.Thread(target=publish_more)
    thread.start()
    result = run("topic", "bw", "-n", "1", "--json", "/number")
    thread.join(60)
    found = json.loads(result.output)
    assert found["mean"] == found["min"] == found["max"] == len('{"data":8}')
    assert 2 <= found["window"] <= 4
    assert found["rate"] > 0
