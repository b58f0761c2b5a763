"""Reports of a topic's peers, as one request of a client asks for them."""

from __future__ import annotations

from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.graph.peers import PeerWatch
from fibws.hub.rosbridge.encodings import text_frame
from fibws.protocol.operations import Advertise, Subscribe, encode_fields

NOBODY = b"[]"


class PeerReports:
    """Sends a client who its peers are; a `Watcher`.

    All changes of a turn of the event loop are one report, and so are those that come while the
    client does not read.

    Args:
        peers: those of the topic's other end.
        request: the advertisement or subscription.
        queue: the client's.
    """

    __slots__ = ("_change", "_list", "_peers", "_queue")

    def __init__(self, peers: PeerWatch, request: Advertise | Subscribe, queue: SendQueue) -> None:
        self._peers = peers
        # The first bytes are the same each time; there may be thousands who are told.
        fields = {"op": "peers", "id": request.id, "topic": request.topic}
        self._list = encode_fields(fields)[:-1]
        if request.id is not None:
            del fields["topic"]
        self._change = encode_fields(fields)[:-1] if request.peer_changes else None
        self._queue = queue

    def changed(self) -> None:
        """Report at the end of the turn."""
        self._queue.flusher.call_first(self.report)

    def report(self) -> None:
        """Send what the client does not know, now or when it reads again."""
        self._queue.reply_fresh(self._frames)

    def _frames(self) -> bytes:
        news = self._peers.read(self)
        if news is None:
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
