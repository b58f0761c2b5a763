"""Messages of this hub's graph on their way to the hubs that want them."""

from __future__ import annotations

import logging
from collections.abc import Callable
from itertools import count
from weakref import WeakKeyDictionary, WeakValueDictionary

from fibws.errors import FibwsError
from fibws.hub.federation.backplane import Backplane
from fibws.hub.federation.records import LinkMessage
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Source, Topic
from fibws.hub.log.text import is_power_of_ten

logger = logging.getLogger("fibws.hub")

UNLIMITED = 1000
"""Messages that wait for another hub, of a publisher whose queue_size sets no limit."""


class HubOutlet:
    """Sends the messages of one topic; the `Receiver` that all its remote subscribers share."""

    __slots__ = ("__weakref__", "_faults", "_outlets", "_topic")

    def __init__(self, topic: str, outlets: Outlets) -> None:
        self._topic = topic
        self._outlets = outlets
        self._faults = 0

    def receive(self, publication: Publication) -> None:
        """Send a message to the hubs that have asked for its publisher."""
        topic = self._outlets.graph.topics.get(self._topic)
        source = topic.publishers.get(publication.node) if topic is not None else None
        if source is None:
            return
        try:
            self._outlets.send(source, publication)
        except FibwsError as error:
            self._faults += 1
            if is_power_of_ten(self._faults):
                text = "%s: a message cannot be sent to other hubs (%d so far): %s"
                logger.warning(text, self._topic, self._faults, error)


class Outlets:
    """The sources of the graph, and which backplanes have asked for their messages.

    Args:
        progress: returns the sequence number and the stamp of the message that a source has just
            published, if it is a remote one.
    """

    def __init__(self, graph: Graph, progress: Callable[[Source], tuple[int, int] | None]) -> None:
        self.graph = graph
        self._progress = progress
        self._next = count(1)
        self._numbers: WeakKeyDictionary[Source, int] = WeakKeyDictionary()
        self._sources: WeakValueDictionary[int, Source] = WeakValueDictionary()
        self._wanted_by: dict[int, dict[Backplane, None]] = {}
        self._outlets: WeakValueDictionary[str, HubOutlet] = WeakValueDictionary()

    def number(self, source: Source) -> int:
        """Return the number by which other hubs know a source."""
        number = self._numbers.get(source)
        if number is None:
            number = self._numbers[source] = next(self._next)
            self._sources[number] = source
        return number

    def source(self, number: int) -> Source | None:
        """Return the source of a number, unless it is gone."""
        return self._sources.get(number)

    def outlet(self, topic: str) -> HubOutlet:
        """Return what sends the messages of a topic."""
        found = self._outlets.get(topic)
        if found is None:
            found = self._outlets[topic] = HubOutlet(topic, self)
        return found

    def begin(self, backplane: Backplane, number: int) -> None:
        """Send the messages of a source by a backplane from now on."""
        self._wanted_by.setdefault(number, {})[backplane] = None

    def end(self, backplane: Backplane, number: int) -> None:
        """Stop sending messages."""
        found = self._wanted_by.get(number, {})
        found.pop(backplane, None)
        if not found:
            self._wanted_by.pop(number, None)

    def wanted_by(self, backplane: Backplane) -> list[int]:
        """Return the sources that a backplane has asked for."""
        return [number for number, by in self._wanted_by.items() if backplane in by]

    def is_wanted(self, source: Source, without: Backplane) -> bool:
        """Return whether any other backplane has asked for the messages of a source."""
        by = self._wanted_by.get(self.number(source), {})
        return any(backplane is not without for backplane in by)

    def has_interest(self, backplane: Backplane, topic: Topic) -> bool:
        """Return whether a backplane has asked for any source of a topic."""
        sources = topic.publishers.values()
        return any(backplane in self._wanted_by.get(self.number(each), {}) for each in sources)

    def send(self, source: Source, publication: Publication) -> None:
        """Send a message to the hubs that want it; raise `OperationError` if it has no bytes."""
        number = self.number(source)
        for backplane in tuple(self._wanted_by.get(number, ())):
            self._send(backplane, number, source, publication)

    def send_latched(self, backplane: Backplane, number: int, source: Source) -> None:
        """Send the latched message of a source, if there is one, by one backplane."""
        publication = source.recall()
        if publication is not None:
            try:
                self._send(backplane, number, source, publication)
            except FibwsError as error:
                logger.warning("%s: %s", source.topic.name, error)

    def _send(
        self, backplane: Backplane, number: int, source: Source, publication: Publication
    ) -> None:
        progress = self._progress(source)
        sequence, stamp = progress or (source.messages, publication.received)
        limit = source.queue_size if source.queue_size > 0 else UNLIMITED
        backplane.publish(LinkMessage(number, sequence, stamp, publication.ros1()), limit=limit)
