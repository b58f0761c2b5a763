"""Reports of a topic's peers, as one request of a client asks for them."""

from __future__ import annotations

from collections.abc import Callable

from fibws.hub.delivery.clock import Clock
from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.graph.peers import PeerWatch
from fibws.hub.rosbridge.encodings import text_frame
from fibws.protocol.operations import Advertise, Subscribe, encode_fields

NOBODY = b"[]"
MOST_AT_ONCE = 40
"""Most watchers that all get a report at the end of the turn."""
PACE = 0.00025
"""Seconds for each of more watchers: if nodes join one by one, each is told at most so often that
this takes some 3 % of a CPU."""


class PeerReports:
    """Sends a client who its peers are; a `Watcher`.

    All changes of a turn of the event loop are one report, and so are those that come while the
    client does not read, or within a tenth of a second where 400 nodes watch each other.

    Args:
        peers: those of the topic's other end.
        request: the advertisement or subscription.
        queue: the client's.
        shows: returns whether the client may learn of a node; None if it may of all.
    """

    __slots__ = ("_change", "_clock", "_known", "_list", "_peers", "_queue", "_shows")

    def __init__(
        self,
        peers: PeerWatch,
        request: Advertise | Subscribe,
        queue: SendQueue,
        clock: Clock,
        shows: Callable[[str], bool] | None = None,
    ) -> None:
        self._peers = peers
        self._shows = shows
        self._known: set[str] = set()
        """The nodes that the client was told of, if there may be others."""
        # The first bytes are always the same, and there may be thousands of reports.
        fields = {"op": "peers", "id": request.id, "topic": request.topic}
        self._list = encode_fields(fields)[:-1]
        if request.id is not None:
            del fields["topic"]
        self._change = encode_fields(fields)[:-1] if request.peer_changes else None
        self._queue = queue
        self._clock = clock

    def changed(self) -> None:
        """Report at the end of the turn, or later if there are many watchers."""
        watchers = len(self._peers)
        if watchers <= MOST_AT_ONCE:
            self._queue.flusher.call_first(self.report)
        else:
            self._clock.call_later(watchers * PACE, self.report)

    def report(self) -> None:
        """Send the changes that the client does not know, now or when it reads again."""
        self._queue.reply_fresh(self._frames)

    def _frames(self) -> bytes:
        news = self._peers.read(self)
        if news is not None and self._shows is not None:
            news = news.only(self._known, self._shows)
        if not news:
            return b""
        text = self._change
        if text is not None and news.changes is not None:
            removed, added = news.changes
            if removed != NOBODY:
                text = b'%b,"removed":%b' % (text, removed)
            if added != NOBODY:
                text = b'%b,"added":%b' % (text, added)
            return text_frame(text + b"}")
        # A node that has come back must be seen to have left.
        lists = (news.names_between, news.names)
        texts = (b'%b,"nodes":%b}' % (self._list, names) for names in lists if names is not None)
        return b"".join(map(text_frame, texts))
