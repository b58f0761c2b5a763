"""The nodes at the other side of a topic, as a publisher or a subscription hears of them."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncIterator

MOST_CHANGES = 1000
"""How many changes wait for one slow reader; then the newest ones stay."""


class Peers:
    """The subscribers of a publisher's topic, or the publishers of a subscription's.

    The hub tells them only if that was asked for, by ``peers=True`` of `Node.advertise` or
    `Node.subscribe`; else there are none, and no change ever comes.
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
        """Their global names, sorted; none before the hub's first word, and while there is no hub.

        It may be asked in any thread.
        """
        return list(self._names or ())

    @property
    def told(self) -> bool:
        """Whether the hub has told them; a rosbridge that is no hub of fibws never does."""
        return self._names is not None

    async def changes(self) -> AsyncIterator[list[str]]:
        """Give `names` as they are, once the hub has told them, and then after each change.

        A peer that goes and comes back while the reader is busy is seen to do so, since each change
        waits for it. It ends with the publisher, the subscription or the node, whatever the reason.
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

    def take(self, names: list[str]) -> None:
        """These are the peers now."""
        if names != self._names:
            self._names = names
            for waiting in self._readers:
                waiting.append(names)
            self._news.set()

    def lose(self) -> None:
        """There is no hub, and so no peer."""
        if self._names:
            self.take([])

    def end(self) -> None:
        """No change will come any more."""
        self._names = None
        self._ended = True
        self._news.set()
