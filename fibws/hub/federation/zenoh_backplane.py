"""Hubs on a zenoh network (https://zenoh.io): a backplane with many hubs.

Each hub is a zenoh router, so that hubs need no other program; they can also connect to a zenohd.
Below ``fibws/DOMAIN`` the keys are:

    hubs/HUB                 liveliness token of a hub, whose id HUB is
    HUB/state                announcements, with a counter; a query returns all that has changed
                             after the announcement ``since``, in pieces; without that everything
    HUB/data/NUMBER/TOPIC    messages of one publisher, in ROS 1's serialization; the attachment is
                             u64 sequence, i64 stamp, 16 bytes of the type's md5, the node's name
    HUB/interest             u64 publisher's number, u8 1 or 0, and the id of the hub that has
                             subscribed to its messages, or does not any more
    HUB/request              queries: see `records.Request`; fields are JSON in the attachment
    HUB/cancel               the other hub's id and the number of its request
    HUB/ping                 queries for the hub's time; the counter of announcements is attached

A hub subscribes to the messages that somebody needs, and reports that to their hub, which sends
nothing to the network while nobody does. A matching listener reports subscribers that vanish.

Messages and announcements are dropped for a hub that does not read, so that it delays no other.
Once it reads again, it asks for the announcements that it has missed.

Calls of zenoh may wait for the network: they are made in threads. Its callbacks come in threads,
too, and hand their data to the event loop.
"""

from __future__ import annotations

import asyncio
import logging
import re
import struct
import sys
import time
from collections.abc import Iterator
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from fibws.access.rights import Principal
from fibws.hub.errors import FederationError, NotAllowed
from fibws.hub.federation.backplane import Backplane, Cancel, Network, OnReply, Peer, call_all
from fibws.hub.federation.change_log import ChangeLog
from fibws.hub.federation.names import NameView
from fibws.hub.federation.records import (
    Announcement,
    HubInfo,
    LinkMessage,
    PublisherRecord,
    Request,
    TopicRecord,
    decode_announcement,
    encode_announcement,
    failure,
)
from fibws.hub.federation.zenoh_requests import STATE_TIMEOUT, ZenohRequests
from fibws.hub.federation.zenoh_state import FIRST_RETRY, KnownHub, ZenohState, decode_state
from fibws.hub.log.text import is_power_of_ten, printable
from fibws.hub.zenoh_session import (
    LEASE,
    RETRY,
    Inbox,
    Receivers,
    ZenohCalls,
    ZenohLane,
    ZenohLanes,
    call_in_thread,
    close_session,
    direct,
    lossless,
    lossy,
    open_session,
    preferred,
)

if TYPE_CHECKING:
    import zenoh

logger = logging.getLogger("fibws.hub")

NODE = "/hub_zenoh"
"""The node of the graph that stands for the network."""
PING_INTERVAL = 2.0
ABSENCE = 60.0
"""Seconds until a hub that has announced too much is asked again."""
BUSY = 256 * 1024
"""Bytes of waiting announcements, from which on changes are not announced until some were sent."""
MOST_USERS = 10_000
"""Hubs that may subscribe to one publisher."""

_ATTACHMENT = struct.Struct("<Qq16s")
_COUNTER = struct.Struct("<Q")
_INTEREST = struct.Struct("<QB")
_TIME = struct.Struct("<q")
_FLOWING = b"\x01"
"""The attachment that says that messages pass from now on."""


class _ZenohPublisher:
    """A publisher of this hub that was announced."""

    __slots__ = ("key", "lane", "listener", "md5sum", "node", "publisher", "users")

    def __init__(self, key: str, node: str, md5sum: str) -> None:
        self.key = key
        self.lane = ZenohLane()
        self.node = node.encode()
        self.md5sum = bytes.fromhex(md5sum) if len(md5sum) == 32 else bytes(16)
        self.users: set[str] = set()
        """The ids of the hubs that have subscribed; some may not be known yet."""
        self.publisher: Any = None
        self.listener: Any = None


class ZenohBackplane(Backplane):
    """All hubs of a domain on a zenoh network.

    Args:
        hub: this one.
        principal: whose rights the other hubs have.
        domain: hubs of other domains on the same network are not seen.
        listen: endpoints to listen on, such as ``tcp/0.0.0.0:7447``.
        connect: endpoints to connect to, or ``auto``.
        config: a file of zenoh's, for TLS and access control.
        max_queued: most bytes of messages that wait for the network, and for the event loop.
    """

    kind = "zenoh"
    node = NODE

    def __init__(
        self,
        network: Network,
        hub: HubInfo,
        loop: asyncio.AbstractEventLoop,
        *,
        principal: Principal | None,
        domain: str,
        listen: tuple[str, ...],
        connect: tuple[str, ...],
        config: Path | None,
        max_queued: int,
    ) -> None:
        self.view = NameView(hub=hub.name)
        self.principal = principal
        self.dropped = 0
        self._network = network
        self._hub = hub
        self._loop = loop
        self._domain = domain
        self._base = f"fibws/{quote(domain, safe='')}"
        self._listen = listen
        self._connect = connect
        self._config = config
        self._session: zenoh.Session
        self._inbox = Inbox(loop, max_queued)
        self._control = ZenohCalls("zenoh-control")
        self._receivers = Receivers("zenoh-receivers")
        """For what waits for a hub, by its id."""
        self._lanes = ZenohLanes("zenoh", max_queued, self._count_dropped)
        self._peers: dict[str, Peer] = {}
        """By the ids of the hubs."""
        self._alive: set[str] = set()
        """The hubs that have a token."""
        self._known: dict[str, KnownHub] = {}
        self._log = ChangeLog()
        self._publishers: dict[int, _ZenohPublisher] = {}
        self._wanted: set[tuple[str, int]] = set()
        """The publishers of other hubs, by hub and number, whose messages are asked for."""
        self._subscribers: dict[tuple[str, int], Any] = {}
        """The subscribers for messages of other hubs; used in the thread for control."""
        self._declared: list[Any] = []
        self._own_token: Any = None
        self._is_attached = False
        """Whether hubs may join: not while their rights change, nor if these forbid it."""
        self._requests = ZenohRequests(
            network,
            hub.id,
            loop,
            self._base,
            self._peers,
            self._inbox,
            self._receivers,
            max_queued,
            session=lambda: self._session,
            report=self._report,
        )
        self._faults = 0
        self._skipped: set[tuple[str, str]] = set()
        """The kinds of invalid records that were logged, by hub."""
        self._is_open = False
        self._timer: asyncio.TimerHandle | None = None

    def report(self) -> dict[str, Any]:
        """Return what is wrong while no hub is reached, as a fibws_msgs/HubLink."""
        address = ", ".join((*self._listen, *self._connect))
        fault = f"no other hub of domain {self._domain} is reached"
        return {"kind": self.kind, "address": address, "fault": fault}

    async def open(self) -> None:
        """Connect to the network.

        Raises:
            HubError: zenoh is not installed, or the configuration or an endpoint is invalid.
            NotAllowed: the policy forbids the node.
        """
        self._session = await open_session(
            self._listen, self._connect, self._config, flags=("--zenoh-listen", "--zenoh")
        )
        self._control.start()
        self._lanes.start()
        self._is_open = True
        self._network.attach(self)
        self._is_attached = True
        await call_in_thread(self._declare)
        self._timer = self._loop.call_later(PING_INTERVAL, self._ping)

    def _declare(self) -> None:
        """Declare what all hubs have; the token last, as others then ask for the state."""
        import zenoh

        session, own = self._session, f"{self._base}/{self._hub.id}"
        put, requests = self._inbox.put, self._requests
        self._declared = [
            session.declare_queryable(
                f"{own}/state", direct(lambda query: put(self._answer_state, query)), complete=True
            ),
            session.declare_queryable(
                f"{own}/request",
                direct(lambda query: put(requests.answer, query)),
                complete=True,
            ),
            session.declare_queryable(
                f"{own}/ping",
                lambda query: query.reply(
                    f"{own}/ping",
                    _TIME.pack(time.time_ns()),
                    attachment=_COUNTER.pack(self._log.counter),
                ),
                complete=True,
            ),
            session.declare_subscriber(
                f"{own}/interest",
                direct(lambda sample: put(self._interest, sample.payload.to_bytes())),
            ),
            session.declare_subscriber(
                f"{own}/cancel",
                direct(lambda sample: put(requests.cancelled, sample.payload.to_bytes())),
            ),
            session.declare_subscriber(
                f"{self._base}/*/state",
                direct(
                    lambda sample: put(
                        self._changed,
                        str(sample.key_expr).split("/")[2],
                        sample.payload.to_bytes(),
                        sample.attachment.to_bytes() if sample.attachment is not None else b"",
                    ),
                ),
            ),
            session.liveliness().declare_subscriber(
                f"{self._base}/hubs/*",
                direct(
                    lambda sample: put(
                        self._token,
                        str(sample.key_expr).rpartition("/")[2],
                        sample.kind == zenoh.SampleKind.PUT,
                    ),
                ),
                history=True,
            ),
        ]
        self._declare_token()

    def _declare_token(self) -> None:
        token = f"{self._base}/hubs/{self._hub.id}"
        self._own_token = self._session.liveliness().declare_token(token)

    def _undeclare_token(self) -> None:
        _undeclare(self._own_token)
        self._own_token = None

    def set_principal(self, principal: Principal | None) -> None:
        """Give the other hubs the rights of a principal: leave them, and join them again."""
        if principal == self.principal:
            return
        self.principal = principal
        for hub in list(self._peers):
            self._lose(hub, "it has other rights now")
        self._known.clear()
        self._control.call(self._undeclare_token)
        for number in list(self._publishers):
            self._control.call(partial(self._close_publisher, self._publishers.pop(number)))
        self._log = ChangeLog(self._log.counter)
        if self._is_attached:
            self._network.detach(self)
            self._is_attached = False
        self._network.finish(self._join_again(principal))

    def _join_again(self, principal: Principal | None) -> Iterator[None]:
        """Join the network, once all is removed that the other hubs had here."""
        if self._is_open and self.principal is principal:
            try:
                self._network.attach(self)
            except NotAllowed as error:
                logger.warning("No hub is joined over zenoh: %s.", printable(str(error)))
                return
            self._is_attached = True
            self._control.call(self._declare_token)
            for hub in self._alive:
                self._begin(hub)
        yield

    # Sending: see `Backplane`.

    @property
    def peers(self) -> list[Peer]:
        """The hubs of the domain."""
        return list(self._peers.values())

    @property
    def waiting_bytes(self) -> int:
        """Bytes of messages and requests that wait for the network, and from it."""
        return self._lanes.bytes + self._receivers.bytes + self._inbox.bytes

    @property
    def is_busy(self) -> bool:
        """Whether announcements would wait."""
        return self._control.bytes > BUSY

    def announce(self, announcement: Announcement) -> None:
        """Send changes, and declare the publishers in them."""
        for name, record in announcement.topics.items():
            self._update_publishers(name, self._log.find("topics", name), record)
        counter = _COUNTER.pack(self._log.add(announcement))
        data = encode_announcement(announcement)
        key = f"{self._base}/{self._hub.id}/state"

        def send() -> None:
            # It must not overtake messages, nor wait for a hub that does not read.
            self._session.put(key, data, attachment=counter, **lossy())
            if self._control.bytes <= BUSY:
                self._inbox.put(self._network.idle, self)

        self._control.call(send, len(data))

    def _update_publishers(self, topic: str, older: Any, newer: Any) -> None:
        """Declare the publishers of a topic that are new, and undeclare those that are gone."""
        before = {each.number for each, _ in _publishers(older)}
        for each, md5sum in _publishers(newer):
            before.discard(each.number)
            if each.number not in self._publishers:
                key = _data_key(self._base, self._hub.id, each.number, topic)
                found = self._publishers[each.number] = _ZenohPublisher(key, each.node, md5sum)
                self._control.call(partial(self._open, each.number, found))
        for number in before:
            gone = self._publishers.pop(number, None)
            if gone is not None:
                self._control.call(partial(self._close_publisher, gone))
                self._network.interested(self, number, wanted=False)

    def _open(self, number: int, publisher: _ZenohPublisher) -> None:
        publisher.publisher = self._session.declare_publisher(publisher.key, **lossy())
        publisher.listener = publisher.publisher.declare_matching_listener(
            direct(lambda status: self._inbox.put(self._matched, number))
        )
        self._lanes.open(publisher.lane)

    def _close_publisher(self, publisher: _ZenohPublisher) -> None:
        self._lanes.drain(publisher.lane)
        _undeclare(publisher.listener, publisher.publisher)

    def publish(self, message: LinkMessage, *, limit: int) -> None:
        """Send a message; see `Backplane`."""
        found = self._publishers.get(message.number)
        if found is None:
            return
        attachment = _ATTACHMENT.pack(message.sequence, message.stamp, found.md5sum) + found.node
        data, size = message.data, len(message.data)
        if isinstance(data, memoryview):
            data = bytes(data)
        put = partial(self._put, found, data, attachment)
        self._lanes.send(found.lane, put, size, max(1, limit))
        for hub in found.users:
            if peer := self._peers.get(hub):
                peer.traffic.messages_sent += 1
                peer.traffic.bytes_sent += size

    def flowing(self, number: int) -> None:
        """Report that messages of a publisher pass."""
        found = self._publishers.get(number)
        if found is not None:
            put = partial(self._session.put, found.key, b"", attachment=_FLOWING, **preferred())
            self._control.call(put)

    def _put(self, publisher: _ZenohPublisher, data: bytes | bytearray, attachment: bytes) -> None:
        publisher.publisher.put(data, attachment=attachment)

    def interest(self, peer: Peer, number: int, *, wanted: bool) -> None:
        """Subscribe to the messages of a publisher, or end that."""
        hub = peer.hub.id
        key = f"{self._base}/{hub}/data/{number}/**"

        def arrived(sample: zenoh.Sample) -> None:
            data = sample.payload.to_bytes()
            attachment = sample.attachment
            head = attachment.to_bytes() if attachment is not None else b""
            self._inbox.put(self._arrived, hub, number, head, data, size=max(1, len(data)))

        def subscribe() -> None:
            is_wanted = (hub, number) in self._wanted
            if not is_wanted:
                _undeclare(self._subscribers.pop((hub, number), None))
            elif (hub, number) not in self._subscribers:
                found = self._session.declare_subscriber(key, direct(arrived))
                self._subscribers[hub, number] = found
            if is_wanted is wanted:
                report = _INTEREST.pack(number, wanted) + self._hub.id.encode()
                self._put_for(hub, "interest", report)

        if wanted:
            self._wanted.add((hub, number))
        else:
            self._wanted.discard((hub, number))
        self._control.call(subscribe)

    def _put_for(self, hub: str, key: str, data: bytes) -> None:
        """Send something to one hub, after what waits for it."""
        put = partial(self._session.put, f"{self._base}/{hub}/{key}", data, **lossless())
        self._receivers.call(hub, put, len(data))

    def request(self, peer: Peer, request: Request, on_reply: OnReply) -> Cancel:
        """Query another hub; see `Backplane`."""
        return self._requests.send(peer, request, on_reply)

    def leave(self, peer: Peer) -> None:
        """Leave a hub that has announced too much; it is asked again after `ABSENCE`."""
        hub, reason = peer.hub.id, "it has announced too much"
        self._lose(hub, reason)
        self._known[hub] = known = KnownHub()
        known.is_asked = True
        self._loop.call_later(ABSENCE, self._ask, hub, known)

    def replaced(self) -> None:
        """Do nothing: the node's name is the hub's own."""

    async def close(self) -> None:
        """Leave the network."""
        if not self._is_open:
            return
        self._is_open = False
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        for hub in list(self._peers):
            self._lose(hub, "this hub ends")
        if self._is_attached:
            self._network.detach(self)
        self._inbox.close()
        self._requests.close()
        await asyncio.to_thread(self._close_session)

    def _close_session(self) -> None:
        _undeclare(self._own_token, *reversed(self._declared))
        self._control.close()
        self._receivers.close()
        self._lanes.close()
        close_session(self._session)
        self._control.join(LEASE)
        self._receivers.join(LEASE)
        self._lanes.join(LEASE)

    # Other hubs.

    def _token(self, hub: str, is_alive: bool) -> None:
        """Called when a hub's token appears or disappears."""
        if hub == self._hub.id:
            return
        if not is_alive:
            self._alive.discard(hub)
            self._lose(hub, "it has left the zenoh network")
        elif hub not in self._alive:
            self._alive.add(hub)
            self._begin(hub)

    def _begin(self, hub: str) -> None:
        """Ask a hub for everything that it has, if hubs may join."""
        if not self._is_attached:
            return
        self._known[hub] = known = KnownHub()
        self._ask(hub, known)

    def _ask(self, hub: str, known: KnownHub) -> None:
        """Ask a hub for what it has announced since what is known."""
        if self._known.get(hub) is not known:
            return
        known.is_asked = True
        key = f"{self._base}/{hub}/state?since={known.counter};hub={self._hub.id}"
        times: list[int] = []
        answers: list[bytes] = []

        def replied(reply: zenoh.Reply) -> None:
            times.append(time.time_ns())
            if reply.ok is not None:
                answers.append(reply.ok.payload.to_bytes())

        def ended() -> None:
            self._inbox.put(self._told, hub, known, answers, times)

        def get() -> None:
            times.append(time.time_ns())
            self._session.get(key, direct(replied, ended), timeout=STATE_TIMEOUT, **lossless())

        self._receivers.call(hub, get)

    def _told(self, hub: str, known: KnownHub, answers: list[bytes], times: list[int]) -> None:
        """Take what a hub has told, or ask again.

        Args:
            times: when it was asked, and when it answered.
        """
        if self._known.get(hub) is not known:
            return
        known.is_asked = False
        try:
            state = decode_state(answers[0], partial(self._skip, hub)) if answers else None
        except FederationError as error:
            self._report(error, hub)
            return
        if state is None or state.hub.id != hub:
            # Its token may arrive before the network knows that it can be asked.
            known.is_asked = True
            known.delay = min(2 * known.delay, RETRY)
            self._loop.call_later(known.delay, self._ask, hub, known)
            return
        if state.since != known.counter:
            logger.info("Hub %s: announcements were lost.", printable(state.hub.name))
            self._lose(hub, "announcements were lost")
            self._begin(hub)
            return
        known.delay, known.counter = FIRST_RETRY / 2, state.counter
        peer = self._peers.get(hub)
        if peer is None:
            peer = self._join(state, times)
        self._take(peer, state.announcement)
        if state.more:
            self._ask(hub, known)
        else:
            self._catch_up(peer, known)

    def _join(self, state: ZenohState, times: list[int]) -> Peer:
        address = f"zenoh, domain {self._domain}"
        peer = Peer(state.hub, self, address, connected=time.time_ns())
        peer.measured(times[0], state.time, times[1])
        self._peers[peer.hub.id] = peer
        self._network.joined(peer)
        self._requests.answer_early(peer.hub.id)
        return peer

    def _lose(self, hub: str, reason: str) -> None:
        peer = self._peers.pop(hub, None)
        self._known.pop(hub, None)
        self._skipped = {each for each in self._skipped if each[0] != hub}
        lost = failure(f"the hub is lost: {reason}", "server_lost")
        # It may be back, and subscribe again, before the steps are taken.
        used = [(number, each) for number, each in self._publishers.items() if hub in each.users]
        for _, publisher in used:
            publisher.users.discard(hub)
        unused = (partial(self._end_unused, *each) for each in used)
        self._network.finish(call_all(chain(self._requests.ends(hub, lost), unused)))
        self._wanted = {each for each in self._wanted if each[0] != hub}
        self._receivers.forget(hub)
        self._control.call(lambda: self._forget_subscribers(hub))
        if peer is not None:
            self._network.lost(peer, reason)

    def _forget_subscribers(self, hub: str) -> None:
        for key in [key for key in self._subscribers if key[0] == hub]:
            _undeclare(self._subscribers.pop(key))

    def _changed(self, hub: str, data: bytes, attachment: bytes) -> None:
        """Take changes of what a hub has."""
        if hub == self._hub.id or len(attachment) != _COUNTER.size:
            return
        (counter,) = _COUNTER.unpack(attachment)
        known, peer = self._known.get(hub), self._peers.get(hub)
        if known is not None and counter > known.counter:
            known.keep(counter, data)
            if peer is not None and not known.is_asked:
                self._catch_up(peer, known)

    def _catch_up(self, peer: Peer, known: KnownHub) -> None:
        """Take the announcements that follow what is known; ask for those that are missing."""
        hub = peer.hub.id
        while (data := known.take_next()) is not None:
            try:
                announcement = decode_announcement(data, partial(self._skip, hub))
            except FederationError as error:
                self._report(error, hub)
                continue
            self._take(peer, announcement)
        if known.has_gap:
            self._ask(hub, known)

    def _take(self, peer: Peer, announcement: Announcement) -> None:
        """Take what a hub announces in turns, after what it has announced before."""
        self._network.finish(self._network.announced(peer, announcement))

    def _answer_state(self, query: zenoh.Query) -> None:
        """Tell another hub what it does not know yet; everything if it cannot ask for that."""
        asked = str(query.parameters.get("since") or "")
        since = int(asked) if re.fullmatch("[0-9]{1,19}", asked) else 0
        since = since if self._log.covers(since) else 0
        piece = self._log.piece(since) if asked else self._log.piece(0, sys.maxsize)
        state = ZenohState.model_construct(
            None,
            hub=self._hub,
            time=time.time_ns(),
            counter=piece.counter,
            announcement=piece.announcement,
            since=since,
            more=not piece.is_last,
        )
        data = state.model_dump_json(exclude_defaults=True).encode()
        key = f"{self._base}/{self._hub.id}/state"

        def reply() -> None:
            query.reply(key, data)
            query.drop()  # type: ignore[no-untyped-call]

        self._receivers.call(str(query.parameters.get("hub") or ""), reply, len(data))

    # Messages.

    def _matched(self, number: int) -> None:
        """Called when no hub subscribes to a publisher any longer."""
        found = self._publishers.get(number)
        if found is not None and found.publisher is not None:
            if found.users and not found.publisher.matching_status.matching:
                found.users.clear()
                self._network.interested(self, number, wanted=False)

    def _interest(self, data: bytes) -> None:
        """Send a publisher's messages, as a hub has subscribed to them, or to none any more."""
        if len(data) < _INTEREST.size:
            return
        number, wanted = _INTEREST.unpack_from(data)
        found = self._publishers.get(number)
        hub = data[_INTEREST.size :].decode("ascii", "replace")
        if found is None:
            return
        if wanted and len(found.users) < MOST_USERS:
            found.users.add(hub)
            self._network.interested(self, number, wanted=True)
        elif not wanted:
            self._forget_user(number, found, hub)

    def _forget_user(self, number: int, publisher: _ZenohPublisher, hub: str) -> None:
        """Remove a hub from a publisher's users."""
        if hub in publisher.users:
            publisher.users.discard(hub)
            self._end_unused(number, publisher)

    def _end_unused(self, number: int, publisher: _ZenohPublisher) -> None:
        if not publisher.users:
            self._network.interested(self, number, wanted=False)

    def _arrived(self, hub: str, number: int, head: bytes, data: bytes) -> None:
        peer = self._peers.get(hub)
        if peer is None:
            return
        if head == _FLOWING:
            self._network.is_flowing(peer, number)
            return
        if len(head) < _ATTACHMENT.size:
            self._report(FederationError("a message has no valid attachment"), hub)
            return
        sequence, stamp, _ = _ATTACHMENT.unpack_from(head)
        peer.traffic.messages_received += 1
        peer.traffic.bytes_received += len(data)
        self._network.received(peer, LinkMessage(number, sequence, stamp, data))

    # Health.

    def _ping(self) -> None:
        interval = max(PING_INTERVAL, len(self._peers) / 10)
        self._timer = self._loop.call_later(interval, self._ping)
        for hub, peer in self._peers.items():
            self._control.call(partial(self._ping_one, hub, peer))

    def _ping_one(self, hub: str, peer: Peer) -> None:
        sent = time.time_ns()

        def replied(reply: zenoh.Reply) -> None:
            now = time.time_ns()
            if reply.ok is not None and len(reply.ok.payload) == _TIME.size:
                (theirs,) = _TIME.unpack(reply.ok.payload.to_bytes())
                self._inbox.put(peer.measured, sent, theirs, now)
                counter = reply.ok.attachment
                if counter is not None and len(counter) == _COUNTER.size:
                    self._inbox.put(self._promised, hub, *_COUNTER.unpack(counter.to_bytes()))

        key = f"{self._base}/{hub}/ping"
        self._session.get(key, replied, timeout=PING_INTERVAL, **preferred())

    def _promised(self, hub: str, counter: int) -> None:
        """Ask for announcements that should have come since the last ping but one."""
        known = self._known.get(hub)
        if known is not None:
            if known.promised > known.counter and not known.is_asked and hub in self._peers:
                self._ask(hub, known)
            known.promised = counter

    def _count_dropped(self) -> None:
        self.dropped += 1

    def _skip(self, hub: str, kind: str, text: str) -> None:
        """Log that a record of a hub is left out; the first one of a kind."""
        if (hub, kind) not in self._skipped:
            self._skipped.add((hub, kind))
            line = "Hub %s on zenoh: invalid record: %s; more like it are not logged."
            logger.warning(line, hub, printable(text))

    def _report(self, error: Exception, hub: str) -> None:
        """Log what is wrong with the data of a hub; not each time."""
        self._faults += 1
        if is_power_of_ten(self._faults):
            text = "Hub %s on zenoh (%d faults so far): %s"
            logger.warning(text, hub or "?", self._faults, printable(str(error)))


def _data_key(base: str, hub: str, number: int, topic: str) -> str:
    return f"{base}/{hub}/data/{number}{quote(topic, safe='/')}"


def _undeclare(*declared: Any) -> None:
    for each in declared:
        if each is not None:
            each.undeclare()


def _publishers(record: TopicRecord | None) -> Iterator[tuple[PublisherRecord, str]]:
    """Yield the publishers of all types of a topic, with the md5 of their type."""
    for users in record.by_type() if record is not None else ():
        for each in users.publishers:
            yield each, users.md5sum
