"""The subscribers of a publisher, and the publishers of a subscription."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Iterable

from fibws.public_classes import Public, made_by

MOST_CHANGES = 1000
"""Most changes that wait for one slow reader; then the oldest are dropped."""


@made_by("publishers and subscriptions")
class Peers(Public):
    """The subscribers of a publisher's topic, or the publishers of a subscription's.

    The hub reports them only if ``peers=True`` was given to `Node.advertise` or `Node.subscribe`;
    otherwise the list stays empty and never changes.
    """

    def __init__(self) -> None:
        self._names: list[str] | None = None
        self._readers: list[deque[list[str]]] = []
        self._news = asyncio.Event()
        self._ended = False

    def __repr__(self) -> str:
        return f"<Peers {', '.join(self.names)}>"

    @property
    def names(self) -> list[str]:
        """Their global names, sorted; empty until the hub reports them, and while there is no hub.

        It may be read in any thread.
        """
        return list(self._names or ())

    @property
    def known(self) -> bool:
        """Whether the hub has reported them; a rosbridge_suite server never does."""
        return self._names is not None

    async def changes(self) -> AsyncIterator[list[str]]:
        """Yield `names` once the hub has reported them, and again after each change.

        Every change is yielded, so that a peer that left and came back while the reader was busy
        is seen to do so. The iteration ends with the publisher, the subscription or the node.
        """
        waiting: deque[list[str]] = deque(maxlen=MOST_CHANGES)
        if self._names is not None:
            waiting.append(self._names)
        self._readers.append(waiting)
        try:
            while True:
                while waiting:
                    yield list(waiting.popleft())
                if self._ended:
                    return
                self._news.clear()
                await self._news.wait()
        finally:
            self._readers.remove(waiting)

    def _update(self, names: list[str]) -> None:
        """Set the peers' names."""
        if names != self._names:
            self._names = names
            for waiting in self._readers:
                waiting.append(names)
            self._news.set()

    def _change(self, removed: Iterable[str], added: Iterable[str]) -> None:
        """Remove peers, and then add others, which may be removed ones."""
        left, joined = set(removed), set(added)
        before = self._names or []
        remaining = [name for name in before if name not in left] if left else before
        if left & joined:
            self._update(remaining)
        self._update(sorted(joined.union(remaining)))

    def _on_disconnect(self) -> None:
        """Forget the peers: there is no hub."""
        if self._names:
            self._update([])

    def _end(self) -> None:
        """End all iterations of `changes`."""
        self._names = None
        self._ended = True
        self._news.set()
