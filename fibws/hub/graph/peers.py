"""Who is at one side of a topic, for those at its other side who ask to be told."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeAlias

from fibws.errors import OperationError
from fibws.protocol.operations import Id, json_of

Tell: TypeAlias = Callable[[bytes], None]
"""Is given the nodes' names, sorted, as JSON text."""

MOST_REQUESTS = 10
"""Requests of one owner that may ask: each change is told to all of them."""


class Peers:
    """Those who ask for the nodes at the other side of a topic; mostly there are none.

    Whoever reports the nodes does so once messages go between them and those who ask.
    """

    __slots__ = ("_asking", "_known")

    def __init__(self) -> None:
        self._asking: dict[object, dict[Id, Tell]] = {}
        self._known: list[str] = []

    def __bool__(self) -> bool:
        return bool(self._asking)

    def check_room(self, owner: object, id_: Id) -> None:
        """Raise `OperationError` if too many of the owner's requests ask for one more to do so."""
        requests = self._asking.get(owner, {})
        if len(requests) >= MOST_REQUESTS and id_ not in requests:
            raise OperationError(f"{MOST_REQUESTS} requests for the peers of one topic are enough")

    def ask(self, owner: object, id_: Id, tell: Tell, nodes: Iterable[str]) -> None:
        """Tell of the nodes, which are these now, and then of each change.

        Args:
            owner: the publisher or subscription that asks.
            id_: the request of it that does; one of the same id replaces the older.
            nodes: their names, some of them perhaps more than once.
        """
        if not self._asking:
            self._known = sorted(set(nodes))
        self._asking.setdefault(owner, {})[id_] = tell
        tell(json_of(self._known))

    def cancel(self, owner: object, id_: Id) -> None:
        """One request asks no more, if it did; its owner's others may."""
        requests = self._asking.get(owner, {})
        if requests.pop(id_, None) is not None and not requests:
            del self._asking[owner]

    def forget(self, owner: object) -> None:
        """None of its requests asks any more."""
        self._asking.pop(owner, None)

    def changed(self, nodes: Iterable[str]) -> None:
        """Report the nodes after something has begun or ended; told are only other ones."""
        names = sorted(set(nodes))
        if names == self._known:
            return
        self._known = names
        text = json_of(names)
        for requests in self._asking.values():
            for tell in requests.values():
                tell(text)
