"""Totals of the graph that only grow: messages by topic and calls by service, for ``/metrics``.

Sources and sinks count their own messages. When one leaves, its counts are added to its topic's
here, and so they stay when the topic is gone. A message costs nothing more for that.

Clients may make up names without end, so only some names have totals of their own. All others
share one, under the name `OTHER`.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from itertools import accumulate
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fibws.hub.graph.topic import SinkReport, Source, Topic

MOST_NAMES = 500
"""Topics, and services, that have totals of their own."""
OTHER = "other"
"""Stands for all others; as it does not begin with a slash, nothing has this name."""
CALL_BUCKETS = (0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 5.0, 60.0)
"""Upper bounds in seconds."""


class Histogram:
    """Counts values by upper bounds.

    Args:
        bounds: the upper bounds, rising.
    """

    __slots__ = ("_counts", "bounds", "sum")

    def __init__(self, bounds: Sequence[float]) -> None:
        self.bounds = bounds
        self.sum = 0.0
        """The sum of all values."""
        self._counts = [0] * (len(bounds) + 1)

    def add(self, value: float) -> None:
        """Count a value."""
        self._counts[bisect_left(self.bounds, value)] += 1
        self.sum += value

    def cumulative(self) -> list[int]:
        """Return how many values are at most each bound, and how many there are in all."""
        return list(accumulate(self._counts))


class MessageTotals:
    """The messages of one topic, or of several together.

    Attributes:
        messages: published.
        bytes: of these, as they arrived.
        sent: messages sent to subscribers: one that reaches ten of them counts ten times.
        dropped: of these, by the queues of subscribers that were too slow.
        throttled: left out by the throttle_rate of subscribers.
    """

    __slots__ = ("bytes", "dropped", "messages", "sent", "throttled")

    def __init__(self) -> None:
        self.messages = 0
        self.bytes = 0
        self.sent = 0
        self.dropped = 0
        self.throttled = 0

    def add(self, other: MessageTotals) -> None:
        """Add other totals."""
        self.messages += other.messages
        self.bytes += other.bytes
        self.sent += other.sent
        self.dropped += other.dropped
        self.throttled += other.throttled

    def add_sink(self, report: SinkReport) -> None:
        """Add what a sink has received."""
        self.sent += report.messages
        self.dropped += report.dropped
        self.throttled += report.throttled


class TopicTotals:
    """The messages of all topics, those that are gone included.

    Args:
        topics: those of the graph, by name.
    """

    def __init__(self, topics: Mapping[str, Topic], most: int = MOST_NAMES) -> None:
        self._topics = topics
        self._most = most
        self._left: dict[str, MessageTotals] = {}
        """Totals of disconnected clients, by topic."""
        self._left_others = MessageTotals()
        """The totals of clients that have left all other topics."""
        self._forgotten = MessageTotals()
        """The totals of topics whose places newer topics took."""
        self._others: set[str] = set()
        """Topics that are counted among the others; they stay there until they are removed, so that
        no total decreases."""

    def source_left(self, source: Source) -> None:
        """Keep the totals of a source that leaves."""
        totals = self._of(source.topic.name)
        totals.messages += source.messages
        totals.bytes += source.bytes

    def sink_left(self, topic: Topic, report: SinkReport) -> None:
        """Keep the totals of a sink that leaves."""
        self._of(topic.name).add_sink(report)

    def by_topic(self) -> tuple[dict[str, MessageTotals], MessageTotals]:
        """Return the totals by name, with those of all others as `OTHER`, and their sum.

        The totals of a name may be missing later, if the topic is gone and another one has taken
        its place, but they never go back. Nor does the sum, which has them still.
        """
        self._others &= self._topics.keys()
        self._make_room()
        found: dict[str, MessageTotals] = {}
        for name, left in self._left.items():
            found[name] = total = MessageTotals()
            total.add(left)
        found[OTHER] = others = MessageTotals()
        others.add(self._left_others)
        for name, topic in self._topics.items():
            totals = found.get(name)
            if totals is None:
                is_other = self._of(name) is self._left_others
                totals = others if is_other else found.setdefault(name, MessageTotals())
            for source in topic.publishers.values():
                totals.messages += source.messages
                totals.bytes += source.bytes
            for sink in topic.all_sinks():
                totals.add_sink(sink.report())
        everything = MessageTotals()
        for totals in (*found.values(), self._forgotten):
            everything.add(totals)
        return found, everything

    def _of(self, name: str) -> MessageTotals:
        """Return the totals to which those of a topic's former sources and sinks are added."""
        own = self._left.get(name)
        if own is not None:
            return own
        if name in self._others or len(self._left) >= self._most:
            self._others.add(name)
            return self._left_others
        own = self._left[name] = MessageTotals()
        return own

    def _make_room(self) -> None:
        """Give the totals of topics that are gone to new ones, the oldest first, if need be."""
        wanted = len(self._topics.keys() - self._left.keys() - self._others)
        missing = wanted - (self._most - len(self._left))
        if missing > 0:
            gone = [name for name in self._left if name not in self._topics]
            for name in gone[:missing]:
                self._forgotten.add(self._left.pop(name))


class CallTotals:
    """The calls of services: how many there were, how long they took, and why they failed.

    Args:
        now: returns the nanoseconds since some moment in the past.
    """

    def __init__(self, now: Callable[[], int], most: int = MOST_NAMES) -> None:
        self.now = now
        self.seconds = Histogram(CALL_BUCKETS)
        """How long the calls took that got a response."""
        self.responses: Counter[str] = Counter()
        """Calls that got a response, by service."""
        self.failures: Counter[tuple[str, str]] = Counter()
        """Calls that failed, by service and the error's code, such as ``timeout``."""
        self._names: set[str] = set()
        self._most = most

    def responded(self, service: str, started: int) -> None:
        """Count a response.

        Args:
            started: when the call did.
        """
        self.seconds.add((self.now() - started) / 1e9)
        self.responses[self._name(service)] += 1

    def failed(self, service: str, code: str) -> None:
        """Count a call that failed after it had begun."""
        self.failures[self._name(service), code] += 1

    def refused(self, service: str, code: str) -> None:
        """Count a call that could not begin, possibly because the service is unknown."""
        self.failures[service if service in self._names else OTHER, code] += 1

    def _name(self, service: str) -> str:
        """Return the name under which the calls of a service that exists are counted."""
        if service in self._names:
            return service
        if len(self._names) >= self._most:
            return OTHER
        self._names.add(service)
        return service
