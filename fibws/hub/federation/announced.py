"""The announcements of other hubs, translated to the names of this hub."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping
from sys import getsizeof
from typing import Any, NamedTuple, TypeVar

from fibws.hub.federation.backplane import Peer
from fibws.hub.federation.records import (
    EARLIEST,
    LATEST,
    MOST_RECORDS,
    Announcement,
    Kind,
    NodeRecord,
    PublisherRecord,
    TopicRecord,
    TypeUsers,
)
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.log.text import is_power_of_ten, printable

logger = logging.getLogger("fibws.hub")

KINDS: tuple[Kind, ...] = ("nodes", "topics", "services", "actions")
"""The kinds of records that are kept here; `shared_parameters` keeps records of parameters."""

RECORD = 1300
"""Bytes of memory that a record of a node, a service or an action takes, about, beside its texts
and parts."""
HOP = 300
"""Bytes of memory that a hub on a node's path takes, about."""
TOPIC = 5200
"""Bytes of memory that a topic with its record takes, about, beside its texts and users."""
PUBLISHER = 1800
"""Bytes of memory that a publisher takes, about, beside its texts; most are attached."""
SUBSCRIBER = 700
"""Bytes of memory that a subscriber takes, about, beside its texts."""

T = TypeVar("T")


class RemoteUsers(NamedTuple):
    """A `TypeUsers` with the names of this hub."""

    type: str
    md5sum: str
    publishers: dict[str, PublisherRecord]
    """By node."""
    subscribers: frozenset[str]


class RemoteTopic(NamedTuple):
    """A `TopicRecord` with the names of this hub."""

    by_type: tuple[RemoteUsers, ...]

    @property
    def subscribers(self) -> frozenset[str]:
        """The nodes that subscribe, with whatever type."""
        return frozenset[str]().union(*(each.subscribers for each in self.by_type))

    @property
    def users(self) -> set[str]:
        """All nodes that publish or subscribe."""
        return set(self.subscribers).union(*(each.publishers for each in self.by_type))


class PeerGraph:
    """The announcements of one hub.

    Args:
        quota: bounds its latched messages that are kept here.
    """

    def __init__(self, peer: Peer, quota: LatchQuota) -> None:
        self.peer = peer
        self.quota = quota
        self.is_lost = False
        self.is_left = False
        """Whether this hub is about to leave it, since its records take too much memory."""
        self.bytes = 0
        """The memory of its records, about, and of what is attached for them."""
        self.names: dict[Kind, set[str]] = {kind: set() for kind in KINDS}
        self.topics_of: dict[str, set[str]] = {}
        """The topics that each node uses."""
        self.served_by: dict[str, set[tuple[Kind, str]]] = {}
        """The services and actions that each node serves."""
        self.size = 0
        """Records, and the users of topics, that are kept."""
        self.ignored = 0

    def local_time(self, theirs: int) -> int:
        """Return the time of this hub's clock at a time of the other's; both in nanoseconds."""
        here = theirs - round((self.peer.clock_offset or 0.0) * 1e9)
        return min(max(EARLIEST, here), LATEST)


class Announced:
    """The records of all hubs, by kind and name.

    Args:
        changed: called with the kind and the name of each record that has changed.
    """

    def __init__(self, changed: Callable[[Kind, str], None]) -> None:
        self._changed = changed
        self._records: dict[Kind, dict[str, dict[PeerGraph, Any]]] = {kind: {} for kind in KINDS}
        self._lost: set[PeerGraph] = set()
        """The lost hubs of which records are still kept."""

    def of(self, kind: Kind, name: str) -> Mapping[PeerGraph, Any]:
        """Return the records of a name, by the hubs that have announced them."""
        found = self._records[kind].get(name, {})
        if not self._lost:
            return found
        return {home: record for home, record in found.items() if home not in self._lost}

    def take(self, home: PeerGraph, announcement: Announcement) -> Iterator[None]:
        """Take changes of what a hub has, a record with each step.

        Names that it may not use are ignored, as is the rest once the hub is lost.
        """
        for kind in KINDS:
            for name, record in announcement.of(kind).items():
                if home.is_lost:
                    return
                self._take_one(home, kind, name, record)
                yield

    def _take_one(self, home: PeerGraph, kind: Kind, name: str, record: Any) -> None:
        peer, view = home.peer, home.peer.backplane.view
        local = view.inward(name)
        if not local:
            return
        if kind == "nodes":
            self._set(home, kind, local, record)
        elif kind == "topics":
            self._set(home, kind, local, _translated(record, local, peer))
        elif view.may_import(local):
            self._set(home, kind, local, _renamed(record, peer))

    def forget(self, home: PeerGraph) -> Iterator[None]:
        """Forget a hub that is lost; return the steps that remove its records."""
        home.is_lost = True
        self._lost.add(home)
        return self._remove_all(home)

    def _remove_all(self, home: PeerGraph) -> Iterator[None]:
        for kind, names in home.names.items():
            for name in list(names):
                self._remove(home, kind, name)
                yield
        self._lost.discard(home)

    def _set(self, home: PeerGraph, kind: Kind, name: str, record: Any) -> None:
        if record is None:
            self._remove(home, kind, name)
            return
        self._remove_record(home, kind, name)
        size = _size(kind, record)
        if home.size + size > MOST_RECORDS:
            self._changed(kind, name)
            home.ignored += 1
            if is_power_of_ten(home.ignored):
                text = "Hub %s announces too much (limit is %d records): %d are ignored."
                logger.warning(text, printable(home.peer.hub.name), MOST_RECORDS, home.ignored)
            return
        home.size += size
        home.bytes += _bytes(name, record)
        home.names[kind].add(name)
        self._records[kind].setdefault(name, {})[home] = record
        if kind == "topics":
            for node in record.users:
                home.topics_of.setdefault(node, set()).add(name)
        elif kind != "nodes":
            home.served_by.setdefault(record.node, set()).add((kind, name))
        self._changed(kind, name)

    def _remove(self, home: PeerGraph, kind: Kind, name: str) -> None:
        if self._remove_record(home, kind, name):
            self._changed(kind, name)

    def _remove_record(self, home: PeerGraph, kind: Kind, name: str) -> bool:
        """Remove a record and its nodes' indexes; return whether there was one."""
        record = self._records[kind].get(name, {}).get(home)
        if record is None:
            return False
        home.size -= _size(kind, record)
        home.bytes -= _bytes(name, record)
        home.names[kind].discard(name)
        records = self._records[kind]
        del records[name][home]
        if not records[name]:
            del records[name]
        if kind == "topics":
            for node in record.users:
                _discard(home.topics_of, node, name)
        elif kind != "nodes":
            _discard(home.served_by, record.node, (kind, name))
        return True


def _size(kind: Kind, record: Any) -> int:
    """Return how much a record counts towards `MOST_RECORDS`."""
    if kind != "topics":
        return 1
    return sum(1 + len(each.publishers) + len(each.subscribers) for each in record.by_type)


def _bytes(name: str, record: Any) -> int:
    """Return about how much memory a record takes, and what is attached for it."""
    if isinstance(record, NodeRecord):
        texts = [text for hub in record.path for text in (hub.name, hub.version)]
        size = RECORD + len(record.path) * HOP
    elif isinstance(record, RemoteTopic):
        users = record.by_type
        texts = [
            text for each in users for text in (each.type, *each.publishers, *each.subscribers)
        ]
        publishers = sum(len(each.publishers) for each in users)
        subscribers = sum(len(each.subscribers) for each in users)
        size = TOPIC + publishers * PUBLISHER + subscribers * SUBSCRIBER
    else:
        texts, size = [record.type, record.node], RECORD
    return size + sum(map(getsizeof, (name, *texts)))


def _translated(record: TopicRecord | None, name: str, peer: Peer) -> RemoteTopic | None:
    """Return a topic's record with this hub's names, and without what may not be used."""
    if record is None:
        return None
    return RemoteTopic(tuple(_translated_users(each, name, peer) for each in record.by_type()))


def _translated_users(record: TypeUsers, name: str, peer: Peer) -> RemoteUsers:
    view = peer.backplane.view
    publishers: Iterator[tuple[str | None, PublisherRecord]] = iter(())
    subscribers: Iterator[str | None] = iter(())
    if view.may_import(name):
        publishers = ((view.inward(each.node), each) for each in record.publishers)
    if view.may_export(name):
        subscribers = (view.inward(each) for each in record.subscribers)
    return RemoteUsers(
        record.type,
        record.md5sum,
        {node: each for node, each in publishers if node},
        frozenset(node for node in subscribers if node),
    )


def _renamed(record: Any, peer: Peer) -> Any:
    """Return the record of a service or an action with this hub's name of its node."""
    node = peer.backplane.view.inward(record.node) if record is not None else None
    return record.model_copy(update={"node": node}) if node else None


def _discard(sets: dict[str, set[T]], key: str, value: T) -> None:
    found = sets.get(key)
    if found is not None:
        found.discard(value)
        if not found:
            del sets[key]
