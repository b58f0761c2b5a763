"""Definitions of types that this hub lacks, and other hubs describe."""

from __future__ import annotations

import random
from collections import OrderedDict
from collections.abc import Callable, Iterator
from typing import NamedTuple, TypeAlias

from fibws.errors import InterfaceError
from fibws.hub.delivery.clock import Clock
from fibws.hub.federation.backplane import Peer
from fibws.hub.federation.records import Kind, Reply, Request
from fibws.hub.federation.retries import OVERLOADED, Retries
from fibws.hub.graph.graph import Graph
from fibws.interfaces.folders import Kind as TypeKind

MOST_KNOWN = 10_000
"""Definitions that are kept, and hubs and types for which it is known that they are not told."""
PASSING = frozenset({"limit", "server_lost", "timeout", "internal_error", "unknown_hub"})
"""The codes of failures after which the same hub is asked again, ever later."""

User: TypeAlias = tuple[Kind, str]
"""The kind and the name of what needs a definition."""


class DefinitionPending(Exception):
    """A hub is asked for a definition."""


class _Key(NamedTuple):
    """A type, by the kind, the name and the md5 that another hub has announced."""

    kind: TypeKind
    type: str
    md5sum: str


class _Failure:
    """The failures of one hub to describe a type.

    Attributes:
        retries: when it is asked again; None if it does not describe the type.
        waiting: what needs the definition; None unless the hub is to be asked again later.
    """

    __slots__ = ("retries", "waiting")

    def __init__(self, retries: Retries | None) -> None:
        self.retries = retries
        self.waiting: set[User] | None = None


class RemoteDefinitions:
    """Finds the definitions of types, and asks other hubs for those that are unknown.

    A hub that does not have a type, or does not tell it, is not asked for that again. One that
    could not answer is, after a second, then ever later, to 30 seconds.

    Args:
        arrived: called with the kind and the name of what waits for a definition that is there now,
            or may be asked for again.
        chance: returns a random number from 0 to 1.
    """

    def __init__(
        self,
        graph: Graph,
        clock: Clock,
        arrived: Callable[[Kind, str], None],
        chance: Callable[[], float] = random.random,
    ) -> None:
        self._graph = graph
        self._clock = clock
        self._arrived = arrived
        self._chance = chance
        self._texts: OrderedDict[_Key, str] = OrderedDict()
        self._asked: dict[_Key, set[User]] = {}
        """What waits for a hub's answer."""
        self._failures: OrderedDict[tuple[str, _Key], _Failure] = OrderedDict()
        """By the id of a hub, which is that of one run, and what it was asked for."""

    def find(self, peer: Peer, kind: TypeKind, type_: str, md5sum: str, user: User) -> str | None:
        """Return the text of a type; None if it is known to the peer's node, or the hub lacks it.

        Args:
            peer: the hub to ask.
            user: what needs it.

        Raises:
            DefinitionPending: the hub is asked for it.
        """
        if md5sum and self._known_md5sum(peer.backplane.node, kind, type_) == md5sum:
            return None
        key = _Key(kind, type_, md5sum)
        text = self._texts.get(key)
        if text is not None:
            return text
        failure = self._failures.get((peer.hub.id, key))
        if failure is not None and failure.retries is None:
            return None
        if key in self._asked:
            self._asked[key].add(user)
        elif failure is not None and failure.waiting is not None:
            failure.waiting.add(user)
        else:
            self._asked[key] = {user}
            request = Request("describe", {"kind": kind, "type": type_})
            peer.backplane.request(peer, request, lambda reply: self._answered(peer, key, reply))
        raise DefinitionPending

    def forget(self, peer: Peer) -> Iterator[None]:
        """Forget the failures of a hub that is lost, in steps: it may tell more when it is back."""
        for each in [each for each in self._failures if each[0] == peer.hub.id]:
            failure = self._failures.pop(each, None)
            if failure is not None:
                self._tell(failure.waiting or set())
            yield

    def _answered(self, peer: Peer, key: _Key, reply: Reply) -> None:
        users = self._asked.pop(key, set())
        text = reply.fields.get("text")
        if isinstance(text, str):
            self._failures.pop((peer.hub.id, key), None)
            self._texts[key] = text
            if len(self._texts) > MOST_KNOWN:
                self._texts.popitem(last=False)
            self._tell(users)
            return
        failure = self._failed(peer, key, is_passing=reply.fields.get("code") in PASSING)
        if failure.retries is None:
            self._tell(users)
            return
        # What is announced by another hub, too, asks that one at once.
        failure.waiting = set()
        self._tell(users)
        delay = failure.retries.delay(OVERLOADED)
        self._clock.call_later(delay, lambda: self._ask_again(failure))

    def _failed(self, peer: Peer, key: _Key, *, is_passing: bool) -> _Failure:
        id_ = peer.hub.id, key
        failure = self._failures.pop(id_, None) or _Failure(Retries(self._chance))
        if not is_passing:
            failure.retries = None
        self._failures[id_] = failure
        for _ in range(2):
            if len(self._failures) > MOST_KNOWN:
                oldest, other = self._failures.popitem(last=False)
                if other.waiting is not None:  # It would be asked again at once.
                    self._failures[oldest] = other
        return failure

    def _ask_again(self, failure: _Failure) -> None:
        """Let a hub be asked again that could not answer."""
        users, failure.waiting = failure.waiting or set(), None
        self._tell(users)

    def _tell(self, users: set[User]) -> None:
        for user in users:
            self._arrived(*user)

    def _known_md5sum(self, node: str, kind: TypeKind, type_: str) -> str | None:
        """Return the md5 of a type as a node knows it; those of an action's parts in one text."""
        try:
            known = self._graph.definitions.known_to(node, kind, type_)
            if kind == "msg":
                return known.md5(type_)
            if kind == "srv":
                return known.service_md5(type_)
            action = known.action(type_)
            parts = action.goal, action.feedback, action.result
            return "".join(known.md5(part.type) for part in parts)
        except InterfaceError:
            return None
