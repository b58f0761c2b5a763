"""Peers: the nodes at the other end of a topic, and who watches them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Iterable
from functools import cached_property
from typing import Protocol

from pydantic_core import to_json

from fibws.hub.errors import LimitReached

MOST_REQUESTS = 10
"""Requests of one owner that may watch: each change is sent to all of them."""
MOST_CHANGES = 64
"""Changes that are kept for slow watchers, or twice as many as there are nodes."""


class PeerNews:
    """The news for one watcher.

    Args:
        names: those of the nodes that are there.
        removed: the nodes that have left since the watcher last read; None if that is forgotten.
        added: the nodes that have joined; those in both lists have left and come back.
    """

    def __init__(
        self, names: Iterable[str], removed: Iterable[str] | None, added: Iterable[str] = ()
    ) -> None:
        self._names = names
        self._removed = None if removed is None else set(removed)
        self._added = set(added)

    def only(self, known: set[str], shows: Callable[[str], bool]) -> PeerNews:
        """Return the news for a watcher from which some nodes are hidden.

        A node that becomes visible later is in them once it, or all names, are new again.

        Args:
            known: the nodes that the watcher has been told of; it is brought up to date.
            shows: returns whether the watcher may learn of a node.
        """
        if self._removed is None:
            known.clear()
            known.update(filter(shows, self._names))
            return PeerNews(known, None)
        removed = known.intersection(self._removed)
        known -= removed
        added = set(filter(shows, self._added))
        known |= added
        return PeerNews(known, removed, added)

    def __bool__(self) -> bool:
        return self._removed is None or bool(self._removed or self._added)

    @cached_property
    def names(self) -> bytes:
        """The names of all nodes, sorted, as a JSON list."""
        return to_json(sorted(self._names))

    @cached_property
    def names_between(self) -> bytes | None:
        """The same without the nodes that have left and come back, if there are any."""
        returned = self._added.intersection(self._removed or ())
        return to_json(sorted(set(self._names) - returned)) if returned else None

    @cached_property
    def changes(self) -> tuple[bytes, bytes] | None:
        """The names removed and those then added, as JSON lists; None if they are forgotten."""
        if self._removed is None:
            return None
        return to_json(sorted(self._removed)), to_json(sorted(self._added))


class Watcher(Protocol):
    """One request for reports of the nodes."""

    def changed(self) -> None:
        """Called when there are changes to `read`; further ones are not announced before that."""

    def report(self) -> None:
        """Read the news and send them, unless the client is too slow for that at present."""


class PeerWatch:
    """The publishers, or the subscriptions, that watch who is at the other end of their topic.

    A watcher reads all names first, and then the changes since. Unread changes are kept once for
    all watchers; a watcher that has missed too many reads all names again.

    A node must be reported only once messages pass between it and those who watch.

    Args:
        nodes: their names, which the topic keeps up to date.
    """

    __slots__ = (
        "_behind",
        "_changes",
        "_news",
        "_nodes",
        "_start",
        "_unlinked",
        "_up_to_date",
        "_watching",
    )

    def __init__(self, nodes: Collection[str]) -> None:
        self._nodes = nodes
        self._unlinked: set[str] = set()
        self._watching: dict[object, dict[object, Watcher]] = {}
        """By the owners and the ids of their requests."""
        self._up_to_date: dict[Watcher, None] = {}
        self._behind: dict[Watcher, int] = {}
        """The other watchers, each with the number of the first change that it has not read."""
        self._changes: list[tuple[str, bool]] = []
        """Nodes, each with whether it has joined; else it has left."""
        self._start = 0
        """The number of the first kept change."""
        self._news: dict[int, PeerNews] = {}
        """The news since each change, for watchers that have read equally much."""

    def __len__(self) -> int:
        return len(self._up_to_date) + len(self._behind)

    def check_room(self, owner: object, id_: object) -> None:
        """Raise `LimitReached` if one more request of the owner would be too many."""
        requests = self._watching.get(owner, {})
        if len(requests) >= MOST_REQUESTS and id_ not in requests:
            raise LimitReached(
                f"too many requests for the peers of a topic (limit {MOST_REQUESTS})"
            )

    def add(self, owner: object, id_: object, watcher: Watcher) -> None:
        """Have a watcher report the nodes now, and their changes.

        Args:
            owner: the publisher or subscription that watches.
            id_: its request; one of the same id replaces the older one.
        """
        self.cancel(owner, id_)
        self._watching.setdefault(owner, {})[id_] = watcher
        self._behind[watcher] = -1
        watcher.report()

    def cancel(self, owner: object, id_: object) -> None:
        """End one request, if it is there; others of its owner continue."""
        requests = self._watching.get(owner, {})
        watcher = requests.pop(id_, None)
        if watcher is not None:
            self._remove(watcher)
            if not requests:
                del self._watching[owner]

    def forget(self, owner: object) -> None:
        """End all requests of an owner."""
        for watcher in self._watching.pop(owner, {}).values():
            self._remove(watcher)

    def joined(self, node: str) -> None:
        """Record that a node has come."""
        if node not in self._unlinked:
            self._change(node, joined=True)

    def left(self, node: str) -> None:
        """Record that a node has left."""
        if node in self._unlinked:
            self._unlinked.discard(node)
        else:
            self._change(node, joined=False)

    def unlinked(self, node: str) -> None:
        """Record that no messages pass to or from a node, which may be there or join later.

        ROS 1 nodes need a connection for each topic.
        """
        if node not in self._unlinked:
            if node in self._nodes:
                self._change(node, joined=False)
            self._unlinked.add(node)

    def copy_unlinked(self, other: PeerWatch, nodes: Container[str]) -> None:
        """Record that no messages pass to or from the nodes that another watch lists."""
        self._unlinked.update(node for node in other._unlinked if node in nodes)

    def linked(self, node: str) -> None:
        """Record that messages pass now."""
        if node in self._unlinked:
            self._unlinked.discard(node)
            self._change(node, joined=True)

    def report(self) -> None:
        """Let all watchers report their unread changes without further delay."""
        for watcher in tuple(self._behind):
            watcher.report()

    def read(self, watcher: Watcher) -> PeerNews | None:
        """Return the changes that are new to a watcher, and mark them as read."""
        first = self._behind.pop(watcher, None)
        if first is None:
            return None
        news = self._news.get(first)
        if news is None:
            news = self._news[first] = self._since(first)
        self._up_to_date[watcher] = None
        self._forget_changes()
        return news or None

    def _change(self, node: str, *, joined: bool) -> None:
        if not self._watching:
            return
        if len(self._changes) >= max(MOST_CHANGES, 2 * len(self._nodes)):
            self._start += len(self._changes)
            self._changes.clear()
        number = self._start + len(self._changes)
        self._changes.append((node, joined))
        self._news.clear()
        if self._up_to_date:
            news_to, self._up_to_date = self._up_to_date, {}
            self._behind.update(dict.fromkeys(news_to, number))
            for watcher in news_to:
                watcher.changed()

    def _since(self, first: int) -> PeerNews:
        if first < self._start:
            return PeerNews(self._linked(), None)
        changes = self._changes[first - self._start :]
        latest = dict(changes)
        earliest = dict(reversed(changes))
        removed = (node for node, joined in earliest.items() if not joined)
        added = (node for node, joined in latest.items() if joined)
        return PeerNews(self._linked(), removed, added)

    def _linked(self) -> Iterable[str]:
        if not self._unlinked:
            return self._nodes
        return [node for node in self._nodes if node not in self._unlinked]

    def _remove(self, watcher: Watcher) -> None:
        self._up_to_date.pop(watcher, None)
        self._behind.pop(watcher, None)
        self._forget_changes()

    def _forget_changes(self) -> None:
        if not self._behind:
            self._start += len(self._changes)
            self._changes.clear()
            self._news.clear()
