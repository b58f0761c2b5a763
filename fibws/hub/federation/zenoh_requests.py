"""Requests between hubs on a zenoh network: queries, and their replies."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from itertools import chain, count
from typing import TYPE_CHECKING, Any

from fibws.hub.errors import FederationError
from fibws.hub.federation.backplane import Cancel, Network, OnReply, Peer
from fibws.hub.federation.records import Reply, Request, decode_fields, encode_fields, failure
from fibws.hub.zenoh_session import Inbox, Receivers, direct, lossless

if TYPE_CHECKING:
    import zenoh

STATE_TIMEOUT = 5.0
"""Seconds in which a hub must tell what it has."""
REQUEST_TIMEOUT = 24 * 3600.0
"""Seconds, which zenoh needs to know; the hub of the caller ends calls much earlier."""
MOST_EARLY = 1000
"""Requests of a hub that are kept until it has told what it has."""


class ZenohRequests:
    """The requests of this hub to others, and theirs to this one.

    Args:
        network: handles the requests of others.
        hub: the id of this one.
        base: what all keys begin with.
        peers: the hubs that are known, by their ids.
        inbox: where zenoh's callbacks hand their data to the event loop.
        receivers: sends what waits for a hub.
        max_queued: most bytes that may wait for one hub.
        session: returns the session, which is opened later.
        report: logs what is wrong with the data of a hub.
    """

    def __init__(
        self,
        network: Network,
        hub: str,
        loop: asyncio.AbstractEventLoop,
        base: str,
        peers: Mapping[str, Peer],
        inbox: Inbox,
        receivers: Receivers,
        max_queued: int,
        *,
        session: Callable[[], zenoh.Session],
        report: Callable[[Exception, str], object],
    ) -> None:
        self._network = network
        self._hub = hub
        self._loop = loop
        self._base = base
        self._peers = peers
        self._inbox = inbox
        self._receivers = receivers
        self._max_queued = max_queued
        self._session = session
        self._report = report
        self._ids = count(1)
        self._requests: dict[int, tuple[str, OnReply, Any]] = {}
        """Own requests by their ids: the hub, what takes replies, and what ends the query."""
        self._handled: dict[tuple[str, str], Cancel] = {}
        self._early_queries: dict[str, list[zenoh.Query]] = {}
        """Requests of hubs that are not known yet, by their ids."""

    def _is_full(self, hub: str, size: int) -> bool:
        """Return whether too much waits for a hub to send it so many bytes more."""
        return self._receivers.waiting(hub) + size > self._max_queued

    def send(self, peer: Peer, request: Request, on_reply: OnReply) -> Cancel:
        """Query another hub; see `Backplane.request`."""
        import zenoh

        if self._is_full(peer.hub.id, len(request.body)) and not request.must_arrive:
            on_reply(failure(f"too much waits for hub {peer.hub.name}", "limit"))
            return lambda: None
        id_, token = next(self._ids), zenoh.CancellationToken()
        self._requests[id_] = peer.hub.id, on_reply, token
        fields = {"op": request.op, **request.fields, "hub": self._hub, "id": str(id_)}
        attachment = encode_fields(fields)

        def replied(reply: zenoh.Reply) -> None:
            sample = reply.ok
            if sample is not None and sample.attachment is not None:
                body = sample.payload.to_bytes()
                self._inbox.put(self._replied, id_, sample.attachment.to_bytes(), body)

        def get() -> None:
            self._session().get(
                f"{self._base}/{peer.hub.id}/request",
                direct(replied, lambda: self._inbox.put(self._ended, id_)),
                payload=request.body,
                attachment=attachment,
                timeout=REQUEST_TIMEOUT,
                consolidation=zenoh.ConsolidationMode.NONE,
                cancellation_token=token,
                **lossless(),
            )

        self._receivers.call(peer.hub.id, get, len(request.body))

        def cancel() -> None:
            if self._requests.pop(id_, None) is not None:
                key, data = f"{self._base}/{peer.hub.id}/cancel", f"{self._hub} {id_}".encode()
                put = partial(self._session().put, key, data, **lossless())
                self._receivers.call(peer.hub.id, put, len(data))
                self._receivers.call(peer.hub.id, token.cancel)

        return cancel

    def close(self) -> None:
        """Forget requests that wait until their hub is known."""
        self._early_queries.clear()

    def ends(self, hub: str, lost: Reply) -> Iterator[Callable[[], object]]:
        """Return what ends the requests that are open, of this hub and of one that is lost."""
        requests = [id_ for id_, (of, *_) in self._requests.items() if of == hub]
        handled = [each for each in self._handled if each[0] == hub]
        return chain(
            (partial(self._fail_request, id_, lost) for id_ in requests),
            (partial(self._end_handled, each) for each in handled),
        )

    def _fail_request(self, id_: int, reply: Reply) -> None:
        """End an own request, if it still waits."""
        found = self._requests.pop(id_, None)
        if found is not None:
            found[1](reply)

    def _end_handled(self, request: tuple[str, str]) -> None:
        """Abandon a request of another hub, unless it has ended."""
        cancel = self._handled.pop(request, None)
        if cancel is not None:
            cancel()

    def answer_early(self, hub: str) -> None:
        """Answer the requests of a hub that came before it was known, or is not known in time."""
        for query in self._early_queries.pop(hub, ()):
            self.answer(query, is_late=True)

    def answer(self, query: zenoh.Query, *, is_late: bool = False) -> None:
        """Handle a request of another hub."""
        attachment, payload = query.attachment, query.payload
        try:
            fields = decode_fields(attachment.to_bytes() if attachment is not None else b"")
        except FederationError as error:
            self._report(error, "")
            return
        hub = str(fields.pop("hub", ""))
        peer = self._peers.get(hub)
        id_ = str(fields.pop("id", ""))
        op = str(fields.pop("op", ""))

        def reply(found: Reply) -> None:
            if found.is_final and peer is not None:
                self._handled.pop((peer.hub.id, id_), None)
            self._reply(query, hub, found)

        if peer is None:
            waiting = self._early_queries.setdefault(hub, [])
            if is_late or len(waiting) >= MOST_EARLY:
                reply(failure("this hub does not know yours yet", "unknown_hub"))
                return
            waiting.append(query)
            self._loop.call_later(STATE_TIMEOUT, self.answer_early, hub)
            return
        body = payload.to_bytes() if payload is not None else b""
        handled = peer.hub.id, id_
        self._handled[handled] = lambda: None
        cancel = self._network.requested(peer, Request(op, fields, body), reply)
        if handled in self._handled:
            self._handled[handled] = cancel

    def _reply(self, query: zenoh.Query, hub: str, reply: Reply) -> None:
        """Answer a request of a hub; if too much waits for it, with an error alone."""
        if self._is_full(hub, len(reply.body)):
            if not reply.is_final:
                return  # It is a goal's feedback.
            reply = failure("too much waits for this hub", "limit")
        key = f"{self._base}/{self._hub}/request"
        head = encode_fields({**reply.fields, "final": reply.is_final})

        def send() -> None:
            query.reply(key, reply.body, attachment=head)
            if reply.is_final:
                query.drop()  # type: ignore[no-untyped-call]

        self._receivers.call(hub, send, len(reply.body))

    def cancelled(self, data: bytes) -> None:
        """End a request that another hub has cancelled."""
        hub, _, id_ = data.decode("ascii", "replace").partition(" ")
        self._end_handled((hub, id_))

    def _replied(self, id_: int, head: bytes, body: bytes) -> None:
        found = self._requests.get(id_)
        if found is None:
            return
        hub, on_reply, _ = found
        try:
            fields = decode_fields(head)
        except FederationError as error:
            self._report(error, hub)
            return
        is_final = bool(fields.pop("final", True))
        if is_final:
            del self._requests[id_]
        on_reply(Reply(fields, body, is_final))

    def _ended(self, id_: int) -> None:
        """Fail a request whose query has ended without a last reply."""
        self._fail_request(id_, failure("the other hub did not answer", "server_lost"))
