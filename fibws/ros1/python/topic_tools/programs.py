"""relay, throttle, drop, delay, mux and demux, and commands for a mux; the first argument is the
program.

They pass on the bytes of messages, which they do not decode. Source: topic_tools of ROS Noetic;
delay is that of ROS 2.
"""

from __future__ import annotations

import re
import sys
import threading
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NoReturn

import rospy
from std_msgs.msg import String

from topic_tools.srv import (
    DemuxAdd,
    DemuxDelete,
    DemuxList,
    DemuxSelect,
    MuxAdd,
    MuxDelete,
    MuxList,
    MuxSelect,
)

USAGES = {
    "relay": "IN_TOPIC [OUT_TOPIC]",
    "throttle": "messages IN_TOPIC MSGS_PER_SEC [OUT_TOPIC]\n"
    "       throttle bytes IN_TOPIC BYTES_PER_SEC WINDOW [OUT_TOPIC]",
    "drop": "IN_TOPIC X Y [OUT_TOPIC]",
    "delay": "IN_TOPIC SECONDS [OUT_TOPIC]",
    "mux": "OUT_TOPIC IN_TOPIC1 [IN_TOPIC2 ...]",
    "demux": "IN_TOPIC OUT_TOPIC1 [OUT_TOPIC2 ...]",
    "mux_add": "MUX_NAME TOPIC",
    "mux_delete": "MUX_NAME TOPIC",
    "mux_list": "MUX_NAME",
    "mux_select": "MUX_NAME TOPIC",
}
_COMMANDS = {
    "mux_add": (MuxAdd, 'Adding "{1}" to mux "{0}"'),
    "mux_delete": (MuxDelete, 'Deleting "{1}" from mux "{0}"'),
    "mux_list": (MuxList, 'Listing topics from mux "{0}"'),
    "mux_select": (MuxSelect, 'Selecting "{1}" at mux "{0}"'),
}
"""Services that commands call, and what they say."""
_SWITCHES = {"mux": ("output", "input"), "demux": ("input", "output")}
NONE = "__none"
"""Selects no topic of a mux."""
QUEUE_SIZE = 100
MOST_DELAYED = 10_000
"""Messages that wait in delay; more drop the oldest."""


class Output:
    """A topic that gets the type of the first message.

    Args:
        name: its name.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self._publisher: rospy.Publisher | None = None
        self._lock = threading.Lock()

    def publish(self, message: Any) -> None:
        """Publish a message as it was received; latch it if its publisher does."""
        with self._lock:
            if self._publisher is None:
                latch = message._connection_header.get("latching") == "1"
                self._publisher = rospy.Publisher(
                    self.name, rospy.AnyMsg, latch=latch, queue_size=QUEUE_SIZE
                )
        self._publisher.publish(message)


class Throttle:
    """Whether a message may pass, at most so many in a second.

    Args:
        rate: messages per second.
    """

    def __init__(self, rate: float) -> None:
        self._period = 1 / rate
        self._last: float | None = None

    def passes(self, message: Any) -> bool:
        """Return whether a message that arrives now passes."""
        now = rospy.get_time()
        # Simulated time may start again.
        if self._last is not None and 0 <= now - self._last < self._period:
            return False
        self._last = now
        return True


class ByteThrottle:
    """Whether a message may pass, at most so many bytes in a second.

    Args:
        rate: bytes per second.
        window: the seconds over which they are counted.
    """

    def __init__(self, rate: float, window: float) -> None:
        self._most = rate * window
        self._window = window
        self._sent: deque[tuple[float, int]] = deque()

    def passes(self, message: Any) -> bool:
        """Return whether a message that arrives now passes."""
        now = rospy.get_time()
        while self._sent and not 0 <= now - self._sent[0][0] < self._window:
            self._sent.popleft()
        if sum(size for _, size in self._sent) >= self._most:
            return False
        self._sent.append((now, len(message._buff)))
        return True


class Drop:
    """Whether a message may pass: not the first ``dropped`` of each ``total``."""

    def __init__(self, dropped: int, total: int) -> None:
        self._dropped, self._total = dropped, total
        self._count = 0

    def passes(self, message: Any) -> bool:
        """Return whether the next message passes."""
        count, self._count = self._count, (self._count + 1) % self._total
        return count >= self._dropped


class Delay:
    """Publishes each message later.

    Args:
        seconds: how much later.
        output: where.
    """

    def __init__(self, seconds: float, output: Output) -> None:
        self._delay = rospy.Duration.from_sec(seconds)
        self._output = output
        self._waiting: deque[tuple[rospy.Time, Any]] = deque(maxlen=MOST_DELAYED)
        self._news = threading.Condition()

    def put(self, message: Any) -> None:
        """Keep a message until it is time."""
        with self._news:
            self._waiting.append((rospy.Time.now() + self._delay, message))
            self._news.notify()

    def run(self) -> None:
        """Publish messages until the node ends."""
        while not rospy.is_shutdown():
            with self._news:
                if not self._waiting:
                    self._news.wait(0.1)
                    continue
                due, message = self._waiting.popleft()
            rospy.sleep(due - rospy.Time.now())
            if not rospy.is_shutdown():
                self._output.publish(message)


class Switch:
    """One of several topics is selected; services select another one, add, delete and list them.

    Args:
        name: ``mux`` or ``demux``, the prefix of the services besides the node's own.
        services: the classes of its services, by ``select``, ``add``, ``delete`` and ``list``.
        topics: the names of the topics, the first of which is selected unless ``~initial_topic``
            names another one.
    """

    def __init__(self, name: str, services: Mapping[str, Any], topics: Sequence[str]) -> None:
        self._services = services
        self._topics = [rospy.resolve_name(each) for each in topics]
        self._selected = NONE
        self._lock = threading.RLock()
        self._state = rospy.Publisher("~selected", String, latch=True, queue_size=1)
        first = rospy.get_param("~initial_topic", topics[0])
        self._select(first if first == NONE else rospy.resolve_name(first))
        prefixes = {rospy.resolve_name("~"): "~", rospy.resolve_name(name): f"{name}/"}
        for prefix in prefixes.values():
            for service, function in (
                ("select", self._on_select),
                ("add", self._on_add),
                ("delete", self._on_delete),
                ("list", self._on_list),
            ):
                rospy.Service(f"{prefix}{service}", services[service], function)

    def use(self, topic: str) -> None:
        """Use a topic, or none for `NONE`; subclasses override it."""
        raise NotImplementedError

    def _select(self, topic: str) -> None:
        self.use(topic)
        self._selected = topic
        self._state.publish(topic)

    def _on_select(self, request: Any) -> Any:
        with self._lock:
            topic = request.topic if request.topic == NONE else rospy.resolve_name(request.topic)
            if topic != NONE and topic not in self._topics:
                known = ", ".join(self._topics)
                raise rospy.ServiceException(f"unknown topic {topic}: expected {known} or {NONE}")
            before = self._selected
            self._select(topic)
            return self._services["select"]._response_class(before)

    def _on_add(self, request: Any) -> Any:
        with self._lock:
            topic = rospy.resolve_name(request.topic)
            if request.topic == NONE or topic in self._topics:
                raise rospy.ServiceException(f"{topic} is there already, or not a topic")
            self._topics.append(topic)
            return self._services["add"]._response_class()

    def _on_delete(self, request: Any) -> Any:
        with self._lock:
            topic = rospy.resolve_name(request.topic)
            if topic == self._selected:
                raise rospy.ServiceException(f"{topic} is selected: select another one first")
            if topic not in self._topics:
                raise rospy.ServiceException(f"unknown topic {topic}")
            self._topics.remove(topic)
            return self._services["delete"]._response_class()

    def _on_list(self, request: Any) -> Any:
        return self._services["list"]._response_class(list(self._topics))


class Mux(Switch):
    """Passes on the messages of the selected topic.

    Args:
        output: the name of the topic that gets the messages.
        inputs: the names of the topics.
    """

    def __init__(self, output: str, inputs: Sequence[str]) -> None:
        self._output = Output(output)
        self._subscriber: rospy.Subscriber | None = None
        services = {"select": MuxSelect, "add": MuxAdd, "delete": MuxDelete, "list": MuxList}
        super().__init__("mux", services, inputs)

    def use(self, topic: str) -> None:
        """Subscribe to a topic instead of the one before."""
        if self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber = None
        if topic != NONE:
            self._subscriber = rospy.Subscriber(topic, rospy.AnyMsg, self._output.publish)


class Demux(Switch):
    """Passes the messages of one topic on to the selected one.

    Args:
        source: the name of the topic that the messages come from.
        outputs: the names of the topics.
    """

    def __init__(self, source: str, outputs: Sequence[str]) -> None:
        self._outputs: dict[str, Output] = {}
        self._output: Output | None = None
        services = {"select": DemuxSelect, "add": DemuxAdd, "delete": DemuxDelete}
        super().__init__("demux", {**services, "list": DemuxList}, outputs)
        rospy.Subscriber(source, rospy.AnyMsg, self._forward)

    def use(self, topic: str) -> None:
        """Publish on a topic from now on."""
        if topic == NONE:
            self._output = None
        else:
            self._output = self._outputs.setdefault(topic, Output(topic))

    def _forward(self, message: Any) -> None:
        output = self._output
        if output is not None:
            output.publish(message)


def main(program: str, arguments: Sequence[str]) -> None:
    """Run a program of `USAGES` with its arguments until the node ends."""
    try:
        _run(program, list(arguments))
    except rospy.ROSInterruptException:
        pass


def _command(program: str, arguments: Sequence[str]) -> None:
    """Call a service of a mux; this is not a node."""
    service_class, text = _COMMANDS[program]
    expected = USAGES[program].count(" ") + 1
    if len(arguments) != expected:
        _fail(program, f"expected {expected} arguments, got {len(arguments)}")
    name = f"{arguments[0]}/{program.partition('_')[2]}"
    print(f'Waiting for service "{name}"', flush=True)
    rospy.wait_for_service(name)
    print(text.format(*arguments), flush=True)
    try:
        response = rospy.ServiceProxy(name, service_class)(*arguments[1:])
    except rospy.ServiceException as error:
        sys.exit(f"Service call failed: {error}")
    if program == "mux_list":
        print(response.topics)


def _run(program: str, arguments: list[str]) -> None:
    if program in _COMMANDS:
        _command(program, arguments)
        return
    if program in _SWITCHES:
        _run_switch(program, arguments)
        return
    kind = arguments.pop(0) if program == "throttle" and arguments else ""
    if program == "throttle" and kind not in ("messages", "bytes"):
        _fail(program, f"expected messages or bytes, got {kind!r}")
    counts = {"relay": 1, "drop": 3, "delay": 2, "throttle": 3 if kind == "bytes" else 2}
    count = counts[program]
    if not count <= len(arguments) <= count + 1:
        _fail(program, f"expected {count} or {count + 1} arguments, got {len(arguments)}")
    name = arguments[0]
    numbers = [_number(program, each) for each in arguments[1:count]]
    suffix = f"{name}_{program}"
    rospy.init_node(re.sub(r"\W+", "_", suffix).strip("_"), anonymous=True)
    output = Output(arguments[count] if len(arguments) > count else suffix)
    if program == "delay":
        delay = Delay(numbers[0], output)
        rospy.Subscriber(name, rospy.AnyMsg, delay.put)
        delay.run()
        return
    passes = _filter(program, kind, numbers)

    def forward(message: Any) -> None:
        if passes(message):
            output.publish(message)

    rospy.Subscriber(name, rospy.AnyMsg, forward)
    rospy.spin()


def _run_switch(program: str, arguments: list[str]) -> None:
    if len(arguments) < 2:
        first, others = _SWITCHES[program]
        _fail(program, f"expected an {first} and at least one {others}")
    rospy.init_node(program)
    switch = Mux if program == "mux" else Demux
    switch(arguments[0], arguments[1:])
    rospy.spin()


def _filter(program: str, kind: str, numbers: list[float]) -> Callable[[Any], bool]:
    """Return what says whether a message passes."""
    if program == "throttle":
        limit = ByteThrottle(*numbers) if kind == "bytes" else Throttle(*numbers)
        return limit.passes
    if program == "drop":
        dropped, total = map(int, numbers)
        if not total or dropped > total:
            _fail(program, f"expected X from 0 to Y, and Y from 1 on, got {dropped} and {total}")
        return Drop(dropped, total).passes
    return _always


def _always(message: Any) -> bool:
    return True


def _number(program: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        _fail(program, f"expected a number, got {text!r}")
    if not 0 <= number < float("inf") or (number == 0 and program == "throttle"):
        _fail(program, f"expected a number above 0, got {text}")
    if program == "drop" and number != int(number):
        _fail(program, f"expected an integer, got {text}")
    return number


def _fail(program: str, fault: str) -> NoReturn:
    sys.stderr.write(f"usage: {program} {USAGES[program]}\n{program}: {fault}\n")
    sys.exit(1)


if __name__ == "__main__":
    words = rospy.myargv()[1:]
    main(words[0], words[1:])
