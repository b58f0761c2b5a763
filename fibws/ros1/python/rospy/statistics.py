"""What subscribers measure of their messages, on /statistics.

They do if the parameter /enable_statistics is true when the process subscribes for the first time.
Source: http://wiki.ros.org/Topics#Topic_statistics.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, Any, NamedTuple

from rospy import core
from rospy.msg import Message
from rospy.names import get_caller_id
from rospy.rostime import Duration, Time

if TYPE_CHECKING:
    import asyncio

    from rospy.topics import Publisher

TOPIC = "/statistics"

LENGTH_FIELD = 4
"""Bytes before each message in ROS's transport, which count as traffic."""

MOST_PUBLISHERS = 1_000
"""Publishers of one topic to measure at a time; the one that was silent longest is forgotten."""

_LEFT_OUT = (TOPIC, "/clock")
_task: asyncio.Task[Settings | None] | None = None


class Settings(NamedTuple):
    """How long to measure before the result is published: parameters that all nodes share.

    Attributes:
        min_elements: the window is doubled if it has fewer messages.
        max_elements: the window is halved if it has more.
        min_window: the shortest window that halving gives, in seconds.
        max_window: the longest window, in seconds.
    """

    min_elements: float = 10
    max_elements: float = 100
    min_window: float = 4
    max_window: float = 64


async def measurement(topic: str) -> TopicMeasurement | None:
    """Return what measures a topic's messages; None if no statistics are wanted of it.

    Call this in the node's loop.
    """
    global _task
    if topic in _LEFT_OUT:
        return None
    if _task is None:
        import asyncio

        _task = asyncio.create_task(_read_settings())
    settings = await _task
    return None if settings is None else TopicMeasurement(topic, settings)


async def _read_settings() -> Settings | None:
    """Return the parameters; None if statistics are not enabled, or the hub has none."""
    from fibws.errors import ServiceError

    try:
        if await _parameter("/enable_statistics") is not True:
            return None
        values = {
            "min_elements": await _parameter("/statistics_window_min_elements"),
            "max_elements": await _parameter("/statistics_window_max_elements"),
            "min_window": await _parameter("/statistics_window_min_size"),
            "max_window": await _parameter("/statistics_window_max_size"),
        }
    except ServiceError:
        return None
    numbers = {name: value for name, value in values.items() if type(value) in (int, float)}
    return Settings(**numbers)


async def _parameter(name: str) -> Any:
    import json

    request = {"name": name, "default": "null"}
    response = await core.background.node.call("/rosapi/get_param", "rosapi/GetParam", request)
    return json.loads(response.value)


class TopicMeasurement:
    """Measures the messages of one topic, apart for each of its publishers.

    Its methods are called in the one thread of the topic's callbacks.
    """

    def __init__(self, topic: str, settings: Settings) -> None:
        self._topic = topic
        self._settings = settings
        self._windows: dict[str, Window] = {}
        """By the publishers' names; the one with the newest message is the last."""
        self._publisher: Publisher | None = None

    def add(self, message: Message, size: int) -> None:
        """Count a message, and publish the statistics when it is time for that.

        Args:
            message: with its connection header.
            size: its bytes when serialized.
        """
        now = Time.now()
        name = message._connection_header.get("callerid", "")
        window = self._windows.pop(name, None)
        if window is None:
            window = Window(now)
            if len(self._windows) == MOST_PUBLISHERS:
                del self._windows[next(iter(self._windows))]
        self._windows[name] = window
        window.add(message, size + LENGTH_FIELD, now)
        if window.is_complete(now):
            self._publish(name, window.result(now, self._settings))

    def close(self) -> None:
        """Stop publishing."""
        if self._publisher is not None:
            self._publisher.unregister()
            self._publisher = None

    def _publish(self, publisher: str, fields: dict[str, Any]) -> None:
        from rosgraph_msgs.msg import TopicStatistics

        from rospy.topics import Publisher

        if self._publisher is None:
            self._publisher = Publisher(TOPIC, TopicStatistics, queue_size=10)
        self._publisher.publish(
            TopicStatistics(
                topic=self._topic, node_pub=publisher, node_sub=get_caller_id(), **fields
            )
        )


class Window:
    """The messages of one publisher since the last result.

    As in ROS, the first result has the first message only, and each later one is published with the
    first message after the end of its period: 1 s in the beginning, adapted by `Settings`.
    """

    def __init__(self, start: Time) -> None:
        self._start = start
        self._period = 1.0
        self._last_result: Time | None = None
        self._last_arrival: Time | None = None
        self._seq: int | None = None
        self._clear()

    def _clear(self) -> None:
        self._periods = Series()
        self._ages = Series()
        self._delivered = self._dropped = self._traffic = 0

    def add(self, message: Message, size: int, now: Time) -> None:
        """Count a message of ``size`` bytes that has arrived ``now``."""
        if self._delivered and self._last_arrival is not None:
            self._periods.add((now - self._last_arrival).to_sec())
        self._last_arrival = now
        self._delivered += 1
        self._traffic += size
        if not message._has_header:
            return
        header = message.header
        self._ages.add((now - header.stamp).to_sec())
        seq: int | None = getattr(header, "seq", None)  # ROS 2's has none.
        if self._seq is not None and seq is not None and seq > self._seq:
            self._dropped += seq - self._seq - 1
        self._seq = seq

    def is_complete(self, now: Time) -> bool:
        """Return whether the result is to be published; after a jump back in time it is, too."""
        last = self._last_result
        return last is None or not 0 <= (now - last).to_sec() <= self._period

    def result(self, now: Time, settings: Settings) -> dict[str, Any]:
        """Return the fields of TopicStatistics, and begin a new window."""
        fields = {
            "window_start": self._start,
            "window_stop": now,
            "delivered_msgs": self._delivered,
            "dropped_msgs": min(self._dropped, 2**31 - 1),
            "traffic": min(self._traffic, 2**31 - 1),
            **self._periods.fields("period"),
            **self._ages.fields("stamp_age"),
        }
        self._adapt(settings)
        self._start = self._last_result = now
        self._clear()
        return fields

    def _adapt(self, settings: Settings) -> None:
        count = self._delivered
        if count > settings.max_elements and self._period / 2 >= settings.min_window:
            self._period /= 2
        elif count < settings.min_elements and self._period * 2 <= settings.max_window:
            self._period *= 2


class Series:
    """The mean, the standard deviation and the maximum of numbers that are not kept (Welford)."""

    def __init__(self) -> None:
        self._count = 0
        self._mean = self._squares = self._most = 0.0

    def add(self, value: float) -> None:
        """Add a number of seconds."""
        self._most = value if self._count == 0 else max(self._most, value)
        self._count += 1
        before = value - self._mean
        self._mean += before / self._count
        self._squares += before * (value - self._mean)

    def fields(self, name: str) -> dict[str, Duration]:
        """Return them as fields of TopicStatistics; they are 0 if there are no numbers."""
        deviation = sqrt(self._squares / self._count) if self._count else 0.0
        return {
            f"{name}_mean": _duration(self._mean),
            f"{name}_stddev": _duration(deviation),
            f"{name}_max": _duration(self._most),
        }


def _duration(seconds: float) -> Duration:
    """Return a duration of at most 68 years, which is what its field can hold."""
    limit = float(2**31 - 1)
    found: Duration = Duration.from_sec(max(-limit, min(limit, seconds)))
    return found
