"""The log of the nodes of other hubs, which arrives while somebody reads /rosout_agg here."""

from __future__ import annotations

from collections.abc import Callable

from fibws.hub.federation.names import level_of
from fibws.hub.federation.records import HubInfo
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import SinkReport, Source, Topic

LOG = "rosgraph_msgs/Log"
ROSOUT = "/rosout"
AGGREGATED = "/rosout_agg"


class _Subscription:
    """The subscription to one log; a `Sink`.

    Args:
        aggregated: publishes the lines with the names of their nodes here; None for /rosout,
            whose lines the hub aggregates anyway.
    """

    def __init__(self, node: str, topic: Topic, aggregated: Source | None) -> None:
        self.node = node
        self.topic = topic
        self._aggregated = aggregated
        self._messages = 0

    def receive(self, publication: Publication) -> None:
        """Publish a line."""
        self._messages += 1
        if self._aggregated is not None:
            self._aggregated.publish({**publication.values(), "name": publication.node})

    def replay(self, publication: Publication) -> None:
        """Ignore a latched message: nodes do not latch their log."""

    def report(self) -> SinkReport:
        """Return the totals."""
        return SinkReport(messages=self._messages)


class LogReader:
    """A node that subscribes to the logs of other hubs; a `GraphNode`.

    Nodes of another hub log to ``/rosout``, and those below a prefix to ``/robot7/rosout``.

    Args:
        call_soon: calls a function in the next turn of the event loop.
        is_remote: returns whether a source belongs to a node of another hub.
        is_joined: returns whether another hub is reached.
    """

    def __init__(
        self,
        graph: Graph,
        hub: HubInfo,
        call_soon: Callable[[Callable[[], None]], object],
        *,
        is_remote: Callable[[Source], bool],
        is_joined: Callable[[], bool],
    ) -> None:
        self.name = f"{ROSOUT}/{level_of(hub.name)}_{hub.id[:6]}"
        self._graph = graph
        self._call_soon = call_soon
        self._is_remote = is_remote
        self._is_joined = is_joined
        self._below_prefixes: set[str] = set()
        """Topics that may be logs of other hubs."""
        self._subscriptions: dict[str, _Subscription] = {}
        self._is_due = False
        graph.rights.internal.add(self.name)
        graph.watch_topics(self._topic_changed)

    def publishing(self) -> tuple[str, ...]:
        """Return nothing: the hub's aggregator publishes."""
        return ()

    def subscribing(self) -> tuple[str, ...]:
        """Return the topics of the logs."""
        return tuple(self._subscriptions)

    def providing(self) -> tuple[str, ...]:
        """Return nothing."""
        return ()

    def replaced(self) -> None:
        """Fail: no client can take its name."""
        raise AssertionError(f"{self.name} is the hub's own")

    def update(self) -> None:
        """Subscribe to the logs of other hubs, or to none if nobody reads them, soon."""
        if not self._is_due:
            self._is_due = True
            self._call_soon(self._update)

    def close(self) -> None:
        """Leave the graph."""
        self._settle({})

    def _topic_changed(self, topic: Topic) -> None:
        if topic.name == AGGREGATED:
            self.update()
        elif topic.name.endswith(ROSOUT) and topic.name != ROSOUT:
            if topic.sources:
                self._below_prefixes.add(topic.name)
            else:
                self._below_prefixes.discard(topic.name)
            self.update()

    def _update(self) -> None:
        self._is_due = False
        aggregated = self._graph.topics.get(AGGREGATED)
        wanted: dict[str, Source | None] = {}
        if aggregated is not None and aggregated.sinks() and self._is_joined():
            wanted[ROSOUT] = None
            source = next(iter(aggregated.sources.values()), None)
            for name in self._below_prefixes:
                topic = self._graph.topics[name]
                is_log = topic.type is not None and topic.type.name == LOG
                if is_log and any(map(self._is_remote, topic.sources.values())):
                    wanted[name] = source
        self._settle(wanted)

    def _settle(self, wanted: dict[str, Source | None]) -> None:
        """Subscribe to these topics alone; the node is in the graph while there are any."""
        for name in self._subscriptions.keys() - wanted.keys():
            old = self._subscriptions.pop(name)
            self._graph.unsubscribe(old.topic, old)
        if wanted and self.name not in self._graph.nodes:
            self._graph.enter(self, self.name, internal=True)
        for name in wanted.keys() - self._subscriptions.keys():
            topic = self._graph.topic(name)
            new = self._subscriptions[name] = _Subscription(self.name, topic, wanted[name])
            self._graph.subscribe(topic, new)
        if not wanted and self.name in self._graph.nodes:
            self._graph.leave(self, self.name)
