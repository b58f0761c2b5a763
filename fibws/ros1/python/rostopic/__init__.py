"""rostopic's functions for scripts: topics, their types and fields, and their rates."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Sequence
from time import sleep, time
from typing import Any

import rosgraph
from rosgraph.masterapi import reporting_no_master
from rosgraph.names import script_resolve_name

from fibws.errors import InvalidValue
from fibws.values import rates
from fibws.values.field_paths import Path, Step

__all__ = [
    "ROSTopicBandwidth",
    "ROSTopicDelay",
    "ROSTopicException",
    "ROSTopicHz",
    "ROSTopicIOException",
    "find_by_type",
    "get_info_text",
    "get_topic_class",
    "get_topic_list",
    "get_topic_type",
    "msgevalgen",
]

INTERVAL = 0.1
"""Seconds between two checks whether a topic exists now."""

Evaluate = Callable[[Any], Any]


class ROSTopicException(Exception):
    """The base of rostopic's errors."""


class ROSTopicIOException(ROSTopicException):
    """The hub cannot be reached."""


# Topics


def get_topic_type(
    topic: str, blocking: bool = False
) -> tuple[str, str, Evaluate | None] | tuple[None, None, None]:
    """Return the type of a topic, or of the topic that a field belongs to.

    Args:
        topic: the topic, perhaps followed by the path of a field, as in ``/rosout/msg``.
        blocking: wait until the topic exists, or the node ends.

    Returns:
        The type, the topic's global name, and a function that returns the field of a message, or
        None without a field. Three times None if the topic, or its type, is unknown.

    Raises:
        ROSTopicIOException: the hub cannot be reached.
    """
    name = script_resolve_name("rostopic", topic)
    found = _find(name)
    if found is None and blocking:
        import rospy

        sys.stderr.write(f"WARNING: topic [{name}] does not appear to be published yet\n")
        while found is None and not rospy.is_shutdown():
            sleep(INTERVAL)
            found = _find(name)
    if found is None:
        return None, None, None
    real_name, type_ = found
    return type_, real_name, msgevalgen(name[len(real_name) :])


def get_topic_class(
    topic: str, blocking: bool = False
) -> tuple[Any, str, Evaluate | None] | tuple[None, None, None]:
    """Return the class of a topic's messages; otherwise like `get_topic_type`.

    Raises:
        ROSTopicException: the type is not defined on this machine.
        ROSTopicIOException: the hub cannot be reached.
    """
    type_, name, evaluate = get_topic_type(topic, blocking)
    if type_ is None or name is None:
        return None, None, None
    message_class = _message_class(type_)
    if message_class is None:
        raise ROSTopicException(
            f"Cannot load message class for [{type_}]. Are your messages built?"
        )
    return message_class, name, evaluate


def get_topic_list(
    master: rosgraph.Master | None = None,
) -> tuple[list[tuple[str, str, list[str]]], list[tuple[str, str, list[str]]]]:
    """Return the topics with publishers, and the topics with subscribers.

    Each is a tuple of the name, the type and a list of the nodes.

    Raises:
        ROSTopicIOException: the hub cannot be reached.
    """
    master = master or _master()
    with reporting_no_master(ROSTopicIOException):
        publishers, subscribers, _ = master.getSystemState()
        types: dict[str, str] = dict(master.getTopicTypes())
    published, subscribed = (
        [(name, types.get(name, "unknown type"), nodes) for name, nodes in topics]
        for topics in (publishers, subscribers)
    )
    return published, subscribed


def find_by_type(topic_type: str) -> list[str]:
    """Return the names of the topics of a type.

    Raises:
        ROSTopicIOException: the hub cannot be reached.
    """
    with reporting_no_master(ROSTopicIOException):
        return [name for name, type_ in _master().getTopicTypes() if type_ == topic_type]


def get_info_text(topic: str) -> str:
    """Return a topic's type and nodes, in the format of ``rostopic info``.

    Raises:
        ROSTopicException: the topic is unknown.
        ROSTopicIOException: the hub cannot be reached.
    """
    published, subscribed = get_topic_list()
    found = [each for each in [*published, *subscribed] if each[0] == topic]
    if not found:
        raise ROSTopicException(f"Unknown topic {topic}")
    lines = [f"Type: {found[0][1]}", ""]
    for head, topics in (("Publishers", published), ("Subscribers", subscribed)):
        nodes = [node for name, _, names in topics if name == topic for node in names]
        lines.append(f"{head}: " if nodes else f"{head}: None")
        lines += [f" * {node} ({_uri(node)})" for node in nodes]
        lines.append("")
    return "\n".join([*lines, ""])


def _uri(node: str) -> str:
    with reporting_no_master(ROSTopicIOException):
        try:
            return _master().lookupNode(node)
        except rosgraph.MasterError:
            return f"unknown address {node}"


def _find(name: str) -> tuple[str, str] | None:
    """Return the topic that a global name begins with, and its type."""
    with reporting_no_master(ROSTopicIOException):
        types: dict[str, str] = dict(_master().getTopicTypes())
    if name in types:
        return name, types[name]
    candidates = [each for each in types if name.startswith((f"{each}/", f"{each}["))]
    for topic in sorted(candidates, key=len, reverse=True):
        message_class = _message_class(types[topic])
        if message_class is None or has_field(message_class(), name[len(topic) :]):
            return topic, types[topic]
    return None


def _message_class(type_: str) -> Any:
    import genpy.message

    return genpy.message.get_message_class(type_)


def _master() -> rosgraph.Master:
    return rosgraph.Master("/rostopic")


# Fields of messages


def msgevalgen(pattern: str) -> Evaluate | None:
    """Return a function that returns a field of a message; None for the whole message.

    It prints an error and returns None if a message lacks the field.

    Args:
        pattern: the field's path: ``/pose/position/x``, ``/points[0]/x`` or ``/data[2:]``. A path
            through several elements of an array gives a list.
    """
    try:
        path = Path(pattern)
    except InvalidValue as error:
        print(error, file=sys.stderr)
        return None

    def evaluate(message: Any) -> Any:
        try:
            return _pick(message, path.steps)
        except AttributeError as error:
            print(f"no field named {error.name} in {pattern}", file=sys.stderr)
        except IndexError as error:
            print(f"{error}: {pattern}", file=sys.stderr)
        return None

    return evaluate if path else None


def has_field(message: Any, pattern: str) -> bool:
    """Return whether a message has a field; the elements of arrays on its path are not checked."""
    for name in (part.partition("[")[0] for part in pattern.split("/") if part):
        if not hasattr(message, name):
            return False
        message = getattr(message, name)
        if isinstance(message, Sequence):  # It may be empty.
            return True
    return True


def _pick(message: Any, steps: Sequence[Step]) -> Any:
    for number, (name, index) in enumerate(steps, 1):
        message = getattr(message, name)
        if index is not None:
            message = message[index]
            if isinstance(index, slice) and steps[number:]:
                return [_pick(each, steps[number:]) for each in message]
    return message


# Rates


class ROSTopicHz:
    """Measures the rates of topics by calls of `callback_hz`.

    Args:
        window_size: number of latest messages to measure; 50 000 if it is negative.
        filter_expr: returns whether to count a message; by default all are counted.
        use_wtime: use wall time even if time is simulated.
    """

    def __init__(
        self,
        window_size: int,
        filter_expr: Callable[[Any], object] | None = None,
        use_wtime: bool = False,
    ) -> None:
        self.lock = threading.Lock()
        self.filter_expr = filter_expr
        self.use_wtime = use_wtime
        self._window_size = window_size if window_size > 0 else rates.MAX_WINDOW
        self._rates: dict[str | None, rates.MessageRate] = {}

    def callback_hz(self, m: Any, topic: str | None = None) -> None:
        """Count a message that is received now."""
        import rospy

        if self.filter_expr is not None and not self.filter_expr(m):
            return
        now = time() if self.use_wtime else rospy.get_rostime().to_sec()
        if now:  # Simulated time has begun, if it is used.
            with self.lock:
                self._rate(topic).add(now)

    def get_hz(self, topic: str | None = None) -> tuple[float, float, float, float, int] | None:
        """Return the rate in Hz, the min, max and deviation of the intervals, and the count.

        Return None if there is no new message since the last call, or only one message so far.
        """
        with self.lock:
            polled = self._rate(topic).poll()
        if polled is None:
            return None
        rate, seconds, count = polled
        return rate, seconds.least, seconds.most, seconds.deviation, count

    def print_hz(self, topics: Sequence[str | None] = (None,)) -> None:
        """Print the rates of topics."""
        with self.lock:
            polled = rates.poll({str(topic): self._rate(topic) for topic in topics})
        print(rates.rates_text(polled, len(topics)))

    def _rate(self, topic: str | None) -> rates.MessageRate:
        if topic not in self._rates:
            self._rates[topic] = rates.MessageRate(self._window_size)
        return self._rates[topic]


class ROSTopicBandwidth:
    """Measures the bandwidth of a topic by calls of `callback` with messages as `rospy.AnyMsg`.

    Args:
        window_size: number of latest messages to measure.
    """

    def __init__(self, window_size: int = rates.BANDWIDTH_WINDOW) -> None:
        self.lock = threading.Lock()
        self._bandwidth = rates.Bandwidth(window_size or rates.BANDWIDTH_WINDOW)

    def callback(self, data: Any) -> None:
        """Count a message that is received now."""
        with self.lock:
            self._bandwidth.add(len(data._buff), time())

    def print_bw(self) -> None:
        """Print the bandwidth until now, unless there are fewer than two messages."""
        with self.lock:
            measured = self._bandwidth.at(time())
        if measured is not None:
            print(rates.bandwidth_text(*measured))


class ROSTopicDelay:
    """Measures the delays of a topic, from stamps until calls of `callback_delay`.

    Args:
        window_size: number of latest messages to measure; 50 000 if it is negative.
    """

    def __init__(self, window_size: int) -> None:
        self.lock = threading.Lock()
        self._delays = rates.Window(window_size if window_size > 0 else rates.MAX_WINDOW)
        self._is_reported = True

    def callback_delay(self, msg: Any) -> None:
        """Count a message that is received now."""
        import rospy

        if not msg._has_header:
            rospy.logerr("msg does not have header")
            return
        now = rospy.get_rostime().to_sec()
        if now:  # Simulated time has begun, if it is used.
            with self.lock:
                self._delays.add(now - msg.header.stamp.to_sec())
                self._is_reported = False

    def get_delay(self) -> tuple[float, float, float, float, int] | None:
        """Return the mean, min, max and deviation of the delays in seconds, and their number.

        Return None if there is no new message since the last call.
        """
        with self.lock:
            if self._is_reported:
                return None
            self._is_reported = True
            delays = self._delays.summary()
            return delays.mean, delays.least, delays.most, delays.deviation, len(self._delays)

    def print_delay(self) -> None:
        """Print the delays."""
        found = self.get_delay()
        if found is None:
            print("no new messages")
        else:
            print(rates.delay_text(rates.Summary(*found[:4]), found[4]))
