"""Topics between ROS 1 nodes and the hub's clients: which links there are, and for how long.

Two ROS 1 nodes exchange messages without the hub. It subscribes at a ROS 1 publisher only while a
client of its own subscribes to the topic, and a publisher of its own costs nothing until a ROS 1
node connects.
"""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Mapping
from itertools import chain, count
from typing import Any

from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.errors import TcprosError
from fibws.hub.foreign.topics import LINGER
from fibws.hub.graph.graph import ROSBRIDGE, Graph
from fibws.hub.graph.topic import Topic
from fibws.hub.ros1.api import Answer
from fibws.hub.ros1.connection import TcprosConnection, describe
from fibws.hub.ros1.http import NodeCalls
from fibws.hub.ros1.inlet import TcprosInlet
from fibws.hub.ros1.nodes import Ros1Nodes
from fibws.hub.ros1.outlet import OutletLink, TcprosOutlet
from fibws.hub.ros1.tcpros import require
from fibws.hub.ros1.topic_registrations import Ros1Publisher
from fibws.hub.settings import Settings


class TopicLinks:
    """All links for topics."""

    def __init__(
        self, graph: Graph, nodes: Ros1Nodes, calls: NodeCalls, clock: Clock, settings: Settings
    ) -> None:
        self._graph = graph
        self._nodes = nodes
        self._calls = calls
        self._clock = clock
        self._settings = settings
        self._inlets: dict[str, dict[str, TcprosInlet]] = {}
        """By topic and publisher."""
        self._lingering: dict[str, Timer] = {}
        self._outlets: dict[str, TcprosOutlet] = {}
        self._numbers = count(1)
        """The ids of links, as for getBusInfo."""

    def outlet(self, topic: str) -> TcprosOutlet:
        """Return what takes the messages of a topic for all ROS 1 subscribers."""
        found = self._outlets.get(topic)
        if found is None:
            most = self._settings.max_queued_bytes
            found = TcprosOutlet(topic, self._graph, self._nodes, most, self._numbers)
            self._outlets[topic] = found
        return found

    def inlets(self) -> Iterator[TcprosInlet]:
        """Return the links from publishers."""
        return chain.from_iterable(each.values() for each in self._inlets.values())

    def changed(self, topic: Topic) -> None:
        """Open and close the links of a topic whose publishers or subscribers have changed."""
        self._remove_stale_inlets(topic.name)
        if self._nodes.topics.publishers(topic.name):
            self._update_inlets(topic)
        self._open_goals(topic.name)
        outlet = self._outlets.get(topic.name)
        if outlet is not None:
            outlet.settle(topic)
            if not outlet.links and not self._nodes.topics.subscribers(topic.name):
                del self._outlets[topic.name]

    def request_topic(
        self, caller: str, topic: str, protocols: list[Any], host: str, port: int
    ) -> Answer:
        """Return how a subscriber can connect to the hub for a topic: by TCPROS."""
        if not self._nodes.topics.has_own_sources(topic):
            return -1, f"Not a publisher of [{topic}]", []
        if any(isinstance(each, list) and each[:1] == ["TCPROS"] for each in protocols):
            return 1, f"ready on {host}:{port}", ["TCPROS", host, port]
        return 0, "no supported protocol implementations", []

    def accept(self, header: Mapping[str, str], connection: TcprosConnection) -> OutletLink:
        """Connect a ROS 1 subscriber; raises `TcprosError`."""
        require(header, "topic", "md5sum", "callerid")
        topic, caller = header["topic"], f"/{header['callerid'].lstrip('/')}"
        if not self._nodes.topics.has_own_sources(topic):
            raise TcprosError(f"[{ROSBRIDGE}] is not a publisher of [{topic}]")
        subscriber = self._nodes.topics.subscriber(caller, topic)
        if subscriber is None:
            raise TcprosError(f"[{caller}] is not registered as a subscriber of [{topic}]")
        return self.outlet(topic).accept(header, subscriber, connection)

    def bus_info(self, node: str) -> list[Any]:
        """Return the links for a node of ours, or for all if it is empty, as getBusInfo does."""
        found = []
        for name, outlet in self._published(node):
            for link in outlet.links:
                text = describe(link.connection.transport)
                other = link.subscriber.node
                found.append([link.number, other, "o", "TCPROS", name, True, text])
        for name, inlets in self._subscribed(node):
            for inlet in inlets.values():
                if inlet.connection is not None:
                    text = inlet.connection.describe()
                    api = inlet.publisher.node.api
                    found.append([inlet.number, api, "i", "TCPROS", name, True, text])
        return found

    def bus_stats(self, node: str) -> list[Any]:
        """Return the totals of the same links, as getBusStats does."""
        published: list[Any] = []
        for name, outlet in self._published(node):
            links = [
                [link.number, link.bytes, link.messages - link.dropped, True]
                for link in outlet.links
            ]
            published.append([name, sum(link.bytes for link in outlet.links), links])
        subscribed: list[Any] = [
            [
                name,
                [
                    [each.number, each.connection.bytes, each.connection.messages, -1, True]
                    for each in inlets.values()
                    if each.connection is not None
                ],
            ]
            for name, inlets in self._subscribed(node)
        ]
        return [published, subscribed, []]

    def _published(self, node: str) -> Iterator[tuple[str, TcprosOutlet]]:
        for name, outlet in self._outlets.items():
            if not node or node in self._graph.topic(name).publishers:
                yield name, outlet

    def _subscribed(self, node: str) -> Iterator[tuple[str, dict[str, TcprosInlet]]]:
        for name, inlets in self._inlets.items():
            if not node or node in self._graph.topic(name).all_subscribers():
                yield name, inlets

    async def close(self) -> None:
        """Close all links."""
        inlets = [inlet for inlets in self._inlets.values() for inlet in inlets.values()]
        for topic in list(self._inlets):
            self._stop_lingering(topic)
            self._close_inlets(topic)
        await asyncio.gather(*(inlet.closed() for inlet in inlets))
        for outlet in self._outlets.values():
            for link in list(outlet.links):
                link.close()

    def _update_inlets(self, topic: Topic) -> None:
        """Open links while a client subscribes, and close them some time after the last one."""
        if any(node not in self._nodes.by_name for node in topic.all_subscribers()):
            self._stop_lingering(topic.name)
            self._open_inlets(topic)
        elif topic.name in self._inlets and topic.name not in self._lingering:
            self._lingering[topic.name] = self._clock.call_later(
                LINGER, lambda: self._close_inlets(topic.name)
            )

    def _open_inlets(self, topic: Topic) -> None:
        server = self._action_server(topic)
        for publisher in self._nodes.topics.publishers(topic.name):
            inlet = self._inlets.get(topic.name, {}).get(publisher.node.name)
            if inlet is None and publisher.is_relayed and self._is_needed(publisher):
                inlets = self._inlets.setdefault(topic.name, {})
                inlets[publisher.node.name] = TcprosInlet(
                    next(self._numbers),
                    publisher,
                    self._calls,
                    lambda: self._caller(self._graph.topic(topic.name)),
                    self._nodes.topics.learn,
                    self._nodes.ping,
                    self._settings.max_message_size,
                )
            elif inlet is not None and server not in (None, inlet.caller):
                inlet.reopen()

    def _is_needed(self, publisher: Ros1Publisher) -> bool:
        """Return whether anybody outside ROS 1 subscribes to messages of a publisher's type."""
        source = publisher.source
        nodes = source.group.listeners if source is not None else ()
        return source is None or any(node not in self._nodes.by_name for node in nodes)

    def _open_goals(self, status: str) -> None:
        """Open the links of an action's goals again if the server of its status is known now."""
        name, _, part = status.rpartition("/")
        for topic in (f"{name}/goal", f"{name}/cancel") if part == "status" else ():
            if topic in self._inlets:
                self._open_inlets(self._graph.topic(topic))

    def _caller(self, topic: Topic) -> str:
        """Return the node that a link of a topic is for, or the hub's name if it is for several."""
        own = [node for node in topic.all_subscribers() if node not in self._nodes.by_name]
        return own[0] if len(own) == 1 else self._action_server(topic) or ROSBRIDGE

    def _action_server(self, topic: Topic) -> str | None:
        """Return the client that serves the action whose goals a topic carries.

        An action's client takes the server for absent unless the node that publishes its status
        has connected to the goals and cancellations (http://wiki.ros.org/actionlib, actionlib's
        ConnectionMonitor).
        """
        name, _, part = topic.name.rpartition("/")
        status = self._graph.topics.get(f"{name}/status") if part in ("goal", "cancel") else None
        if status is None:
            return None
        servers = (node for node in status.publishers if node not in self._nodes.by_name)
        subscribers = topic.all_subscribers()
        return next((node for node in servers if node in subscribers), None)

    def _remove_stale_inlets(self, topic: str) -> None:
        """Close the links that have ended, and those to publishers that may not send any more."""
        if topic not in self._inlets:
            return
        publishers = self._nodes.topics.publishers(topic)
        inlets = self._inlets[topic]
        for name, inlet in list(inlets.items()):
            is_current = inlet.publisher in publishers and inlet.publisher.is_relayed
            if inlet.has_ended or not is_current:
                inlet.close()
                del inlets[name]
        if not inlets:
            del self._inlets[topic]
            self._stop_lingering(topic)

    def _close_inlets(self, topic: str) -> None:
        self._lingering.pop(topic, None)
        for inlet in self._inlets.pop(topic, {}).values():
            inlet.close()

    def _stop_lingering(self, topic: str) -> None:
        timer = self._lingering.pop(topic, None)
        if timer is not None:
            timer.cancel()
