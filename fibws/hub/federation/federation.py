"""The federation of a hub: its graph and those of other hubs, joined by backplanes.

    graph ── Offers ── Backplane ── other hubs ── Backplane ── RemoteGraph ── graph

A message passes from its source to the `HubOutlet` that the remote subscribers share, and from
there, if the other hub has asked for that publisher, by the backplane to the `RemotePublisher`
there, which publishes it. A hub in between does the same again. Every hub announces to each
backplane what has not come by it, with the hubs on the way, and takes each node by its shortest
way: so there are no loops, and no message arrives twice.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, replace
from functools import partial
from itertools import chain
from typing import Any

from fibws.hub.delivery.clock import Loop
from fibws.hub.errors import NotAllowed
from fibws.hub.federation.announced import PeerGraph
from fibws.hub.federation.backplane import Backplane, Cancel, OnReply, Peer, Traffic
from fibws.hub.federation.calls import RemoteCalls
from fibws.hub.federation.offers import LinkNode, Offers
from fibws.hub.federation.outlets import Outlets
from fibws.hub.federation.records import (
    Announcement,
    HubInfo,
    Kind,
    LinkMessage,
    ParameterRecord,
    Reply,
    Request,
)
from fibws.hub.federation.remote import RemoteGraph
from fibws.hub.federation.remote_logs import LogReader
from fibws.hub.federation.remote_nodes import RemoteNode
from fibws.hub.federation.remote_topics import RemotePublisher
from fibws.hub.federation.shared_parameters import SharedParameters
from fibws.hub.graph.graph import Graph, Watched
from fibws.hub.graph.topic import Source
from fibws.hub.log.audit import Audit
from fibws.hub.memory.account import Bound, Holding
from fibws.hub.settings import Settings
from fibws.names import MAX_LENGTH

MOST_TOTALS = 1000
"""Hubs whose totals are kept after they were lost."""

KIND_OF: dict[Watched, Kind] = {"node": "nodes", "service": "services", "action": "actions"}


class Federation:
    """Joins the graph of this hub with those of others; the `Network` of its backplanes.

    Args:
        hub: this one.
    """

    def __init__(
        self,
        graph: Graph,
        hub: HubInfo,
        loop: Loop,
        settings: Settings,
        audit: Audit,
        loaded: Mapping[str, int],
    ) -> None:
        self.hub = hub
        self.graph = graph
        self._loop = loop
        self._audit = audit
        self._offers: dict[Backplane, Offers] = {}
        self._nodes: dict[Backplane, LinkNode] = {}
        self._awaited: set[tuple[Backplane, int]] = set()
        """Remote sources that were asked for, and whose messages do not pass yet."""
        self._watchers: list[Callable[[], object]] = []
        self._traffic: OrderedDict[tuple[str, str], Traffic] = OrderedDict()
        """The totals of each hub that is or was reached, by kind of backplane and id."""
        self._calls = RemoteCalls(graph, loop, settings.service_timeout)
        self._outlets = Outlets(graph, self._progress)
        self._remote = RemoteGraph(
            graph,
            hub,
            loop,
            loop.call_soon,
            self._outlets,
            self._calls,
            max_latched_bytes=settings.max_latched_bytes,
            flowing=self._flowing,
        )
        self._parameters = SharedParameters(
            graph, hub.id, settings.share_params, partial(self._changed, "parameters"), loaded
        )
        self._logs = LogReader(
            graph,
            hub,
            loop.call_soon,
            is_remote=self._remote.topics.by_source.__contains__,
            is_joined=lambda: bool(self.peers),
        )
        graph.watch_topics(lambda topic: self._changed("topics", topic.name))
        for watched, kind in KIND_OF.items():
            graph.watch(watched, partial(self._changed, kind))

    @property
    def backplanes(self) -> list[Backplane]:
        """The backplanes that are attached."""
        return list(self._offers)

    def queued(self) -> Iterator[Holding]:
        """Yield what waits for other hubs."""
        for each in self._offers:
            if each.waiting_bytes:
                yield Holding(
                    self.graph.policy.owner(each.node),
                    partial(_waiting_bytes, each),
                    shorten=partial(_shorten, each),
                    end=partial(_give_up, each),
                )

    def incoming(self) -> Iterator[Holding]:
        """Yield what has come in part by the links that this hub has opened."""
        for each in self._offers:
            if each.kind != "accept" and each.incomplete_bytes:
                yield Holding(
                    self.graph.policy.owner(each.node),
                    partial(_incomplete_bytes, each),
                    end=partial(_give_up, each),
                )

    def records(self) -> Iterator[Holding]:
        """Yield what each hub has announced; one that has announced too much is left."""
        for home in self._remote.homes():
            yield Holding(
                self.graph.policy.owner(home.peer.backplane.node),
                partial(_record_bytes, home),
                end=partial(_leave, home),
            )

    def watch(self, changed: Callable[[], object]) -> None:
        """Call a function whenever a hub is reached or lost."""
        self._watchers.append(changed)

    @property
    def peers(self) -> list[Peer]:
        """The hubs that are reached directly."""
        return [peer for backplane in self._offers for peer in backplane.peers]

    def links(self) -> list[dict[str, Any]]:
        """Return the links to hubs that are reached, as fibws_msgs/HubLink."""
        return [{**_link(peer), "fault": ""} for peer in self.peers]

    def report(self, caller: str, broken: list[dict[str, Any]]) -> dict[str, Any]:
        """Return the links and the known hubs, as a fibws_msgs/GetHubs response.

        Args:
            caller: a node; it gets addresses only if it may see them.
            broken: the links that are not connected.
        """
        links = [*self.links(), *broken]
        if not self.graph.policy.allows_all and not self.graph.policy.is_admin(caller):
            links = [{**link, "address": ""} for link in links]
        hubs: dict[str, dict[str, Any]] = {
            peer.hub.id: {**_hub(peer.hub), "link": peer.hub.name, "distance": 1}
            for peer in self.peers
        }
        for _, node in self.graph.view(caller).all_nodes():
            if isinstance(node, RemoteNode):
                link, distance = node.home.peer.hub.name, len(node.record.path)
                new = {**_hub(node.hub), "link": link, "distance": distance}
                hub = hubs.setdefault(node.hub.id, new)
                hub["nodes"] = hub.get("nodes", 0) + 1
        return {
            "stamp": _time(self.graph.now()),
            "hub": _hub(self.hub),
            "links": links,
            "hubs": sorted(hubs.values(), key=lambda hub: (hub["name"], hub["id"])),
        }

    def close(self) -> None:
        """Detach what is left; all backplanes are closed."""
        self._logs.close()
        self._remote.close()

    # The backplanes: see `Network`.

    def attach(self, backplane: Backplane) -> None:
        """Announce everything on a backplane from now on.

        Raises:
            NotAllowed: the policy forbids its node.
        """
        node = LinkNode(backplane)
        self.graph.enter(node, backplane.node, backplane.principal)
        self._nodes[backplane] = node
        self._parameters.attach(backplane.view)
        self._offers[backplane] = offers = Offers(
            backplane,
            self.hub,
            self.graph,
            self._remote,
            self._parameters,
            self._outlets,
            self._loop.call_soon,
        )
        offers.offer_all()

    def detach(self, backplane: Backplane) -> None:
        """Forget a backplane; its peers have been lost before."""
        offers = self._offers.pop(backplane, None)
        if offers is None:
            return
        offers.close()
        self.graph.leave(self._nodes.pop(backplane), backplane.node)
        self.finish(self._end_all(backplane))

    def finish(self, steps: Iterator[None]) -> None:
        """Take some steps in turns."""
        self._remote.finish(steps)

    def _end_all(self, backplane: Backplane) -> Iterator[None]:
        """Send nothing more by a backplane, which is closed; a source with each step."""
        for number in self._outlets.wanted_by(backplane):
            self.interested(backplane, number, wanted=False)
            yield

    def idle(self, backplane: Backplane) -> None:
        """Continue to announce changes."""
        if offers := self._offers.get(backplane):
            offers.resume()

    def joined(self, peer: Peer) -> None:
        """Called when a hub is reached; its totals continue if it was reached before."""
        before = self._traffic.pop((peer.backplane.kind, peer.hub.id), None)
        if before is not None:
            peer.traffic = before.plus(peer.traffic)
        self._traffic[peer.backplane.kind, peer.hub.id] = peer.traffic
        if len(self._traffic) > MOST_TOTALS:
            self._traffic.popitem(last=False)
        self._audit.hub_joined(peer.hub.name, peer.address, node=peer.backplane.node)
        self._remote.joined(peer)
        self._report_change()

    def lost(self, peer: Peer, reason: str) -> None:
        """Detach what only this hub has brought."""
        self._audit.hub_lost(peer.hub.name, reason, node=peer.backplane.node)
        self._remote.lost(peer)
        self._calls.lost(peer)
        self._report_change()

    def announced(self, peer: Peer, announcement: Announcement) -> Iterator[None]:
        """Attach what a hub has, a record with each step; nothing more once the hub is lost."""
        home = self._remote.home(peer)
        return chain(
            self._remote.announced(home, announcement),
            self._take_parameters(home, announcement.parameters),
        )

    def _take_parameters(
        self, home: PeerGraph, records: Mapping[str, ParameterRecord | None]
    ) -> Iterator[None]:
        backplane = home.peer.backplane
        for name, record in records.items():
            if home.is_lost:
                return
            if local := backplane.view.inward(name):
                self._parameters.take(local, record, backplane)
            yield

    def interested(self, backplane: Backplane, number: int, *, wanted: bool) -> None:
        """Begin or cease to send the messages of a publisher."""
        source = self._outlets.source(number)
        if not wanted:
            self._outlets.end(backplane, number)
            self._awaited.discard((backplane, number))
            self._interest_changed(number)
            return
        if source is None or not self._may_send(backplane, source.topic.name):
            return
        self._outlets.begin(backplane, number)
        for peer in backplane.peers:
            for node in self._remote.topics.subscribers(source.topic.name, self._remote.home(peer)):
                source.group.watching_sinks.linked(node)
        publisher = self._remote.topics.by_source.get(source)
        if publisher is not None and not publisher.is_flowing:
            self._awaited.add((backplane, number))
        else:
            self._outlets.send_latched(backplane, number, source)
            backplane.flowing(number)
        self._interest_changed(number)

    def is_flowing(self, peer: Peer, number: int) -> None:
        """Called when messages begin to pass that were asked for."""
        self._remote.topics.is_flowing(self._remote.home(peer), number)

    def received(self, peer: Peer, message: LinkMessage) -> None:
        """Deliver a message."""
        self._remote.topics.received(self._remote.home(peer), message)

    def requested(self, peer: Peer, request: Request, reply: OnReply) -> Cancel:
        """Handle a request, in the name of the node that has made it if that is known."""
        view, asked = peer.backplane.view, dict(request.fields)
        for key in ("service", "action"):
            if key in asked:
                asked[key] = view.inward(str(asked[key])) or ""
                if not view.may_export(asked[key]):
                    asked[key] = ""
        if "node" in asked:
            asked["node"] = view.own_node(str(asked["node"]))
        if request.op == "older_node":
            closed_at = str(asked.get("closed_at"))[:MAX_LENGTH]
            self._remote.reported_older(str(asked.get("node")), closed_at)
            reply(Reply({}))
            return lambda: None
        caller = view.inward(str(asked.get("caller", ""))) or ""
        node = self.graph.nodes.get(caller)
        if not isinstance(node, RemoteNode) or node.home.peer is not peer:
            caller = peer.backplane.node
        return self._calls.handle(peer, replace(request, fields=asked), caller, reply)

    # The graph.

    def _report_change(self) -> None:
        self._logs.update()
        for changed in self._watchers:
            changed()

    def _changed(self, kind: Kind, name: str) -> None:
        for offers in self._offers.values():
            offers.changed(kind, name)

    def _may_send(self, backplane: Backplane, topic: str) -> bool:
        """Return whether the hubs of a backplane may get the messages of a topic."""
        try:
            self.graph.rights.check(backplane.node, "subscribe", topic)
        except NotAllowed:
            return False
        view = backplane.view
        return view.may_export(topic) and view.outward(topic) is not None

    def _flowing(self, publisher: RemotePublisher) -> None:
        """Report to other hubs that messages of a remote publisher pass."""
        assert publisher.source is not None
        number = self._outlets.number(publisher.source)
        for each in [each for each in self._awaited if each[1] == number]:
            self._awaited.discard(each)
            each[0].flowing(number)

    def _progress(self, source: Source) -> tuple[int, int] | None:
        """Return the sequence number and the stamp of a remote source's newest message."""
        publisher = self._remote.topics.by_source.get(source)
        return None if publisher is None else (publisher.sequence or 0, publisher.stamp)

    def _interest_changed(self, number: int) -> None:
        source = self._outlets.source(number)
        if source is not None and source in self._remote.topics.by_source:
            self._remote.interest_changed(source.topic.name)


def _hub(hub: HubInfo) -> dict[str, Any]:
    return {"id": hub.id, "name": hub.name, "version": hub.version}


def _link(peer: Peer) -> dict[str, Any]:
    return {
        **_hub(peer.hub),
        **{each.name: getattr(peer.traffic, each.name) for each in fields(peer.traffic)},
        "kind": peer.backplane.kind,
        "address": peer.address,
        "since": _time(peer.connected),
        "round_trip": peer.round_trip or 0.0,
        "clock_offset": peer.clock_offset or 0.0,
    }


def _time(stamp: int) -> dict[str, int]:
    secs, nsecs = divmod(stamp, 1_000_000_000)
    return {"secs": secs, "nsecs": nsecs}


def _waiting_bytes(backplane: Backplane) -> int:
    return backplane.waiting_bytes


def _incomplete_bytes(backplane: Backplane) -> int:
    return backplane.incomplete_bytes


def _record_bytes(home: PeerGraph) -> int:
    return 0 if home.is_left else home.bytes


def _leave(home: PeerGraph, bound: Bound) -> None:
    home.is_left = True
    home.peer.backplane.leave(home.peer)


def _shorten(backplane: Backplane, size: int, least: int, bound: Bound) -> None:
    backplane.shorten(size)


def _give_up(backplane: Backplane, bound: Bound) -> None:
    backplane.give_up()
