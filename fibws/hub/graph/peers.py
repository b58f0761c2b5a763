"""Peer lists: the nodes at the other end of a topic, for those who asked to be told."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeAlias

from pydantic_core import to_json

from fibws.errors import LimitReached

Tell: TypeAlias = Callable[[bytes], None]
"""Takes the nodes' names, sorted, as a JSON list."""

MOST_REQUESTS = 10
"""Requests of one owner that may watch: each change is sent to all of them."""


class PeerWatch:
    """The publishers, or the subscriptions, that watch who is at the other end of their topic.

    A node must be reported only once messages pass between it and those who watch.
    """

    __slots__ = ("_known", "_watching")

    def __init__(self) -> None:
        self._watching: dict[object, dict[object, Tell]] = {}
        self._known: list[str] = []

    def __bool__(self) -> bool:
        return bool(self._watching)

    def check_room(self, owner: object, id_: object) -> None:
        """Raise `LimitReached` if one more request of the owner would be too many."""
        requests = self._watching.get(owner, {})
        if len(requests) >= MOST_REQUESTS and id_ not in requests:
            raise LimitReached(
                f"too many requests for the peers of a topic (limit {MOST_REQUESTS})"
            )

    def add(self, owner: object, id_: object, tell: Tell, nodes: Iterable[str]) -> None:
        """Call ``tell`` with the nodes now, and after each change.

        Args:
            owner: the publisher or subscription that watches.
            id_: its request; one of the same id replaces the older one.
            nodes: their names at present.
        """
        if not self._watching:
            self._known = sorted(nodes)
        self._watching.setdefault(owner, {})[id_] = tell
        tell(to_json(self._known))

    def cancel(self, owner: object, id_: object) -> None:
        """End one request, if it is there; others of its owner go on."""
        requests = self._watching.get(owner, {})
        if requests.pop(id_, None) is not None and not requests:
            del self._watching[owner]

    def forget(self, owner: object) -> None:
        """End all requests of an owner."""
        self._watching.pop(owner, None)

    def changed(self, nodes: Iterable[str]) -> None:
        """Tell those who watch, if the nodes are different ones than before."""
        names = sorted(nodes)
        if names == self._known:
            return
        self._known = names
        text = to_json(names)
        # A watcher may end its request, or another one, meanwhile.
        for requests in tuple(self._watching.values()):
            for tell in tuple(requests.values()):
                tell(text)
