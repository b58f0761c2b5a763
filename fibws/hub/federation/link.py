"""A link: one hub to one other over a WebSocket, by the subprotocol ``fibws.hub.v1``.

Both ends speak alike. A binary WebSocket message holds one record or several, each a u32 size and
that many bytes, of which the first is the kind. Integers are little-endian:

    0  hello      JSON: the hub, the prefix of the names (see `names.NameView`)
    1  announce   JSON: see `records.Announcement`
    2  interest   u64 publisher, u8 1 to begin or 0 to end
    3  flowing    u64 publisher
    4  message    u64 publisher, u64 sequence, i64 stamp, message in ROS 1's serialization
    5  request    u64 id, u32 n, n bytes of JSON, body
    6  reply      u64 id, u8 1 if it is the last one, u32 n, n bytes of JSON, body
    7  cancel     u64 id
    8  ping       i64 time
    9  pong       i64 time of the ping, i64 own time
    10 part       u64 lane, u8 1 if it is the last one, bytes of a record that is too large for one

Messages leave in the order in which they came while there is room for all of them. Else they wait
in lanes, one of each publisher, which take turns, a part of a large message each: a camera delays
no other topic. A lane keeps its newest messages while the other hub or the network is slow.
Requests, replies and cancels have a lane of their own, and all other records go first. A text
message is an error.
"""

from __future__ import annotations

import logging
import struct
from collections import OrderedDict, deque
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from itertools import count
from typing import Annotated, Any, Protocol

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fibws.access.rights import Principal
from fibws.hub.delivery.clock import Clock, Timer
from fibws.hub.errors import FederationError, NotAllowed
from fibws.hub.federation.backplane import Backplane, Cancel, Network, OnReply, Peer, call_all
from fibws.hub.federation.lanes import CHUNK, OVERHEAD, LinkLanes
from fibws.hub.federation.names import NameView, level_of
from fibws.hub.federation.records import (
    KINDS,
    Announcement,
    HubInfo,
    LinkMessage,
    Reply,
    Request,
    decode_announcement,
    decode_fields,
    encode_announcement,
    encode_fields,
    failure,
    fault,
)
from fibws.hub.log.text import printable
from fibws.hub.websocket.endpoint import Work
from fibws.protocol.websocket import FORBIDDEN, LIMITED, REPLACED, CloseReason, close_reason

logger = logging.getLogger("fibws.hub")

SUBPROTOCOL = "fibws.hub.v1"
UNSENT = 16 * 1024
"""Bytes that may wait at the socket."""
BUSY = 256 * 1024
"""Bytes of waiting records, from which on no changes are announced until some were sent."""
MOST_ANNOUNCED = 1024 * 1024
"""Bytes that one announcement may have; it is read at once."""
MOST_FIELDS = 64 * 1024
"""Bytes that the JSON of a request or a reply may have."""
MOST_AT_ONCE = 4096
"""Records that one WebSocket message may hold; this hub sends fewer."""
PING_INTERVAL = 1.0
LEASE = 4.0
"""Seconds of silence after which a hub counts as lost."""
OPEN_TIMEOUT = 5.0
"""Seconds in which the first record must come."""

HELLO, ANNOUNCE, INTEREST, FLOWING, MESSAGE, REQUEST, REPLY, CANCEL, PING, PONG, PART = range(11)

SAME_HUB = close_reason(4403, "a hub cannot join itself")
LOST = CloseReason(1001, "no sign of life from the other hub")
OVERFULL = close_reason(LIMITED, "too much waits for a hub that does not read")
TOO_MUCH = close_reason(LIMITED, "it has announced too much for this hub's memory (--max-memory)")

_SIZE = struct.Struct("<IB")
_INTEREST = struct.Struct("<QB")
_NUMBER = struct.Struct("<Q")
_MESSAGE = struct.Struct("<QQq")
_REQUEST = struct.Struct("<QI")
_REPLY = struct.Struct("<QBI")
_PING = struct.Struct("<q")
_PONG = struct.Struct("<qq")
_PART = struct.Struct("<QB")


class Hello(BaseModel):
    """The first record of a link.

    Attributes:
        prefix: a global name below which all names of the joining hub lie; empty for none.
    """

    model_config = ConfigDict(frozen=True, strict=True, extra="ignore")

    hub: HubInfo
    prefix: Annotated[str, Field(max_length=200, pattern=r"^((/[A-Za-z][A-Za-z0-9_]*)+)?$")] = ""


class Wire(Protocol):
    """A WebSocket connection."""

    @property
    def is_behind(self) -> bool:
        """Whether the network takes less than there is to write."""

    def wake(self) -> None:
        """Call `Link.next_frame` soon, and again when there is room, until it returns nothing."""

    def close(self, reason: CloseReason) -> None:
        """Close the connection; `Link.closed` is called."""


class Link(Backplane):
    """One end of a link.

    Args:
        kind: ``join`` or ``accept``.
        hub: this one.
        view: that of the joining end; the other end learns it by the hello.
        address: the other hub's, for people.
        now: returns the nanoseconds since 1970.
        max_size: most bytes of one record.
        max_queued: most bytes of messages that wait, and most of calls.
        on_joined: called once the other hub has introduced itself.
    """

    def __init__(
        self,
        kind: str,
        wire: Wire,
        network: Network,
        hub: HubInfo,
        *,
        view: NameView,
        node: str,
        principal: Principal | None,
        address: str,
        clock: Clock,
        now: Callable[[], int],
        max_size: int,
        max_queued: int,
        max_incoming: int,
        on_joined: Callable[[Peer], object] = lambda peer: None,
    ) -> None:
        self.kind = kind
        self.view = view
        self.node = node
        self.principal = principal
        self.peer: Peer | None = None
        self._wire = wire
        self._network = network
        self._hub = hub
        self._address = address
        self._clock = clock
        self._now = now
        self._max_size = max_size
        self._max_queued = max_queued
        self._max_incoming = max_incoming
        self._on_joined = on_joined
        self._incomplete_bytes = 0
        self._control: deque[bytes] = deque()
        self._control_bytes = 0
        self._pong = b""
        """The answer to the newest ping."""
        self._lanes = LinkLanes(
            max_queued, 4 * max_queued + max_size, self._count_sent, self._count_dropped
        )
        self._parts: dict[int, bytearray] = {}
        self._too_large: set[int] = set()
        """The lanes whose present record is too large: its further parts are ignored."""
        self._skipped: set[str] = set()
        """The kinds of invalid records that were logged."""
        self._ids = count(1)
        self._requests: OrderedDict[int, OnReply] = OrderedDict()
        """Own requests that wait for their last reply."""
        self._handled: OrderedDict[int, Cancel] = OrderedDict()
        """The other hub's requests that wait for this one's last reply."""
        self._heard = clock.time()
        self._early: deque[tuple[int, bytes]] = deque()
        """Records that wait until the other hub's clock is known, which tells ages."""
        self._is_closed = False
        self._is_overfull = False
        hello = Hello(hub=hub, prefix=view.prefix if view.is_below else "")
        self._send_control(HELLO, hello.model_dump_json().encode())
        self._timer: Timer = clock.call_later(PING_INTERVAL, self._tick)

    # Sending: see `Backplane`.

    @property
    def peers(self) -> list[Peer]:
        """The other hub, once its clock is known."""
        is_known = self.peer is not None and self.peer.clock_offset is not None
        return [self.peer] if self.peer is not None and is_known else []

    @property
    def is_busy(self) -> bool:
        """Whether announcements would wait."""
        return self._control_bytes > BUSY

    @property
    def waiting_bytes(self) -> int:
        """Bytes of all records that wait for the network."""
        return self._lanes.memory + self._control_bytes

    @property
    def incomplete_bytes(self) -> int:
        """Bytes that are kept of records that came in part."""
        return self._incomplete_bytes

    def shorten(self, size: int) -> None:
        """Drop the oldest messages of the fullest lanes until ``size`` bytes are left."""
        self._lanes.shorten(size)

    def give_up(self) -> None:
        """Close the link; the other hub joins again later."""
        self._wire.close(OVERFULL)

    def leave(self, peer: Peer) -> None:
        """Close the link, since the other hub has announced too much."""
        self._wire.close(TOO_MUCH)

    def announce(self, announcement: Announcement) -> None:
        """Send changes; large ones in several records."""
        data = encode_announcement(announcement)
        if len(data) > CHUNK:
            halves = _halves(announcement)
            if halves is not None:
                for half in halves:
                    self.announce(half)
                return
        if len(data) > MOST_ANNOUNCED:
            hub = self.peer.hub.name if self.peer is not None else self._address
            text = "%d bytes are too many to announce to hub %s (limit is %d): %s"
            logger.warning(text, len(data), printable(hub), MOST_ANNOUNCED, _names(announcement))
            return
        self._send_control(ANNOUNCE, data)

    def publish(self, message: LinkMessage, *, limit: int) -> None:
        """Send a message; see `Backplane`."""
        head = _MESSAGE.pack(message.number, message.sequence, message.stamp)
        if not self._is_closed:
            head = _head(MESSAGE, head, message.data)
            is_behind = self._wire.is_behind
            self._lanes.put_message(
                message.number, head, message.data, limit=max(1, limit), is_behind=is_behind
            )
            self._wire.wake()

    def interest(self, peer: Peer, number: int, *, wanted: bool) -> None:
        """Begin or cease to ask for the messages of a publisher."""
        self._send_control(INTEREST, _INTEREST.pack(number, wanted))

    def flowing(self, number: int) -> None:
        """Report that messages pass."""
        self._send_control(FLOWING, _NUMBER.pack(number))

    def request(self, peer: Peer, request: Request, on_reply: OnReply) -> Cancel:
        """Send a request; see `Backplane`."""
        if self._is_closed:
            on_reply(failure(f"hub {peer.hub.name} is lost", "server_lost"))
            return lambda: None
        fields = encode_fields({"op": request.op, **request.fields})
        is_too_much = len(request.body) + self._lanes.calls_weight > self._max_queued
        if is_too_much and not request.must_arrive:
            on_reply(failure(f"too much waits for hub {peer.hub.name}", "limit"))
            return lambda: None
        id_ = next(self._ids)
        self._requests[id_] = on_reply
        head = _REQUEST.pack(id_, len(fields)) + fields
        self._put_call(REQUEST, head, request.body)

        def cancel() -> None:
            if self._requests.pop(id_, None) is not None and not self._is_closed:
                self._put_call(
                    CANCEL, _NUMBER.pack(id_), b""
                )  # It must not come before its request.

        return cancel

    def replaced(self) -> None:
        """Close the link: its node's name has been taken."""
        self._wire.close(REPLACED)

    async def close(self) -> None:
        """Close the link."""
        self._wire.close(CloseReason(1001, "the hub is shutting down"))

    def _reply(self, id_: int, reply: Reply) -> None:
        if id_ not in self._handled or self._is_closed:
            return
        is_too_much = len(reply.body) + self._lanes.calls_weight > self._max_queued
        if reply.is_final:
            del self._handled[id_]
        elif is_too_much:
            return  # It is a goal's feedback.
        if is_too_much:
            reply = failure("too much waits for this hub", "limit")
        fields = encode_fields(reply.fields)
        if len(fields) > MOST_FIELDS:
            reply = failure(f"the reply has {len(fields)} bytes (limit is {MOST_FIELDS})", "limit")
            fields = encode_fields(reply.fields)
        head = _REPLY.pack(id_, reply.is_final, len(fields)) + fields
        self._put_call(REPLY, head, reply.body)

    def _send_control(self, kind: int, body: bytes) -> None:
        if self._is_closed:
            return
        record = _SIZE.pack(len(body) + 1, kind) + body
        self._control.append(record)
        self._control_bytes += len(record) + OVERHEAD
        self._check_waiting()
        self._wire.wake()

    def _put_call(self, kind: int, head: bytes, body: bytes) -> None:
        if not self._is_closed:
            self._lanes.put_call(_head(kind, head, body), body)
            self._check_waiting()
            self._wire.wake()

    def _check_waiting(self) -> None:
        """Close the link if too much waits that cannot be dropped."""
        waiting = self._control_bytes + self._lanes.calls_weight
        if waiting > 4 * self._max_queued and not self._is_overfull:
            self._is_overfull = True
            self._wire.close(OVERFULL)

    def _count_sent(self, messages: int) -> None:
        if self.peer is not None:
            self.peer.traffic.messages_sent += messages

    def _count_dropped(self) -> None:
        if self.peer is not None:
            self.peer.traffic.dropped += 1

    def next_frame(self) -> bytes | None:
        """Return the next WebSocket message to write: some records; None if nothing waits."""
        parts: list[Any] = []
        size = 0
        was_busy = self.is_busy
        if self._pong:
            parts.append(self._pong)
            size += len(self._pong)
            self._pong = b""
        while self._control and size < CHUNK:
            record = self._control.popleft()
            self._control_bytes -= len(record) + OVERHEAD
            parts.append(record)
            size += len(record)
        for waiting in self._lanes.take_all():
            parts += (waiting.head, waiting.body)
            size += waiting.size
        while self._lanes and size < CHUNK:
            size += self._take(parts)
        if was_busy and not self.is_busy:
            self._network.idle(self)
        if not parts:
            return None
        if self.peer is not None:
            self.peer.traffic.bytes_sent += size
        return b"".join(parts)

    def _take(self, parts: list[Any]) -> int:
        """Take a record, or a part of a large one, of the lane whose turn it is."""
        taken = self._lanes.take()
        if taken.is_part:
            header = _PART.pack(taken.lane, taken.is_last)
            parts += (_SIZE.pack(len(header) + taken.size + 1, PART), header)
        parts += taken.pieces
        return taken.size

    # Receiving.

    def receive(self, data: bytes | bytearray) -> Work:
        """Take a WebSocket message, a record with each step; of an announcement, one of its own.

        A record that cannot be understood is left out, and logged.

        Raises:
            FederationError: nothing after some record can be understood, or is too much.
        """
        self._heard = self._clock.time()
        if self.peer is not None:
            self.peer.traffic.bytes_received += len(data)
        view, at, records = memoryview(data), 0, 0
        while at < len(data) and not self._is_closed:
            records += 1
            if records > MOST_AT_ONCE:
                raise FederationError(f"too many records at once (limit is {MOST_AT_ONCE})")
            if len(data) - at < _SIZE.size:
                raise FederationError("invalid record: its size is cut off")
            size, kind = _SIZE.unpack_from(data, at)
            at += _SIZE.size
            if not 1 <= size <= len(data) - at + 1:
                raise FederationError(f"invalid record: size {size}, of which not all is there")
            yield from self._receive_record(kind, view[at : at + size - 1])
            at += size - 1
            yield
            while self._has_early():
                early, record = self._early.popleft()
                self._incomplete_bytes -= len(record) + OVERHEAD
                yield from self._receive_record(early, memoryview(record))
                yield

    def _has_early(self) -> bool:
        """Return whether records that came before the answer to a ping can be handled now."""
        if self._is_closed or self.peer is None or self.peer.clock_offset is None:
            return False
        return bool(self._early)

    def _receive_record(self, kind: int, body: memoryview) -> Iterable[None]:
        """Take a record at once, but for the steps that are left of a long one."""
        if self.peer is None:
            if kind != HELLO:
                raise FederationError(f"expected hello (0) as the first record, got {kind}")
            self._receive_hello(bytes(body))
            return ()
        if self.peer.clock_offset is None and kind not in (PING, PONG):
            self._early.append((kind, bytes(body)))
            self._incomplete_bytes += len(body) + OVERHEAD
            if self._incomplete_bytes > self._max_incoming:
                raise FederationError("too much has come before the answer to a ping")
            return ()
        if kind == PART:
            return self._receive_part(body)
        try:
            if kind == MESSAGE:
                number, sequence, stamp = _MESSAGE.unpack_from(body)
                self.peer.traffic.messages_received += 1
                message = LinkMessage(number, sequence, stamp, bytearray(body[_MESSAGE.size :]))
                self._network.received(self.peer, message)
            elif (receive := _RECEIVERS.get(kind)) is not None:
                return receive(self, self.peer, body) or ()
            # Other kinds are for later versions.
        except (struct.error, FederationError) as error:
            self._skip(f"record {kind}", f"invalid record of kind {kind}: {error}")
        return ()

    def _skip(self, kind: str, text: str) -> None:
        """Log that a record is left out; the first one of a kind."""
        if kind not in self._skipped and self.peer is not None:
            self._skipped.add(kind)
            hub = printable(self.peer.hub.name)
            logger.warning("Hub %s: %s; more like it are not logged.", hub, printable(text))

    def _receive_hello(self, data: bytes) -> None:
        try:
            hello = Hello.model_validate_json(data)
        except ValidationError as error:
            raise FederationError(f"invalid hello: {fault(error)}") from None
        if hello.hub.id == self._hub.id:
            self._wire.close(SAME_HUB)
            return
        if not self.view.is_below:
            self.view = NameView(
                hello.prefix,
                hub=self._hub.name,
                exported=self.view.exported,
                imported=self.view.imported,
            )
        self.node = self.node or unique_node("joined", hello.hub)
        peer = Peer(hello.hub, self, self._address, connected=self._now())
        try:
            self._network.attach(self)
        except NotAllowed as error:
            self._wire.close(close_reason(FORBIDDEN, str(error)))
            return
        self.peer = peer
        self._ping()

    def _receive_announcement(self, peer: Peer, body: memoryview) -> Work:
        if len(body) > MOST_ANNOUNCED:
            raise FederationError(
                f"an announcement of {len(body)} bytes (limit is {MOST_ANNOUNCED})"
            )
        announcement = decode_announcement(
            body, lambda kind, what: self._skip(kind, f"invalid record: {what}")
        )
        return self._network.announced(peer, announcement)

    def _receive_interest(self, peer: Peer, body: memoryview) -> None:
        number, wanted = _INTEREST.unpack(body)
        self._network.interested(self, number, wanted=bool(wanted))

    def _receive_flowing(self, peer: Peer, body: memoryview) -> None:
        (number,) = _NUMBER.unpack(body)
        self._network.is_flowing(peer, number)

    def _receive_cancel(self, peer: Peer, body: memoryview) -> None:
        (id_,) = _NUMBER.unpack(body)
        cancel = self._handled.pop(id_, None)
        if cancel is not None:
            cancel()

    def _receive_ping(self, peer: Peer, body: memoryview) -> None:
        _PING.unpack(body)
        self._pong = _SIZE.pack(_PONG.size + 1, PONG) + bytes(body)
        self._pong += _PING.pack(self._now())
        self._wire.wake()

    def _receive_part(self, body: memoryview) -> Iterable[None]:
        if len(body) <= _PART.size:
            raise FederationError("invalid record: a part without bytes")
        key, is_last = _PART.unpack_from(body)
        piece = body[_PART.size :]
        parts = self._parts.get(key)
        if parts is None:
            parts = self._parts[key] = bytearray()
            self._incomplete_bytes += OVERHEAD
        if key not in self._too_large:
            parts += piece
            self._incomplete_bytes += len(piece)
            if len(parts) > self._max_size:
                self._refuse_parts(key, parts)
        if self._incomplete_bytes > self._max_incoming:
            raise FederationError(
                f"too much has come in part: limit is {self._max_incoming} bytes "
                "(--max-total-incoming-bytes)"
            )
        if is_last:
            del self._parts[key]
            self._incomplete_bytes -= len(parts) + OVERHEAD
            if key in self._too_large:
                self._too_large.discard(key)
                return ()
            if len(parts) < _SIZE.size:
                raise FederationError("invalid record: its size is cut off")
            _, kind = _SIZE.unpack_from(parts)
            if kind == PART:
                raise FederationError("invalid record: a part of parts")
            return self._receive_record(kind, memoryview(parts)[_SIZE.size :])
        return ()

    def _refuse_parts(self, key: int, parts: bytearray) -> None:
        """Leave out a record that is too large; a request or a reply ends with an error."""
        text = f"a record is too large: limit is {self._max_size} bytes (--max-message-size)"
        self._skip("too large", text)
        _, kind = _SIZE.unpack_from(parts)
        if kind == REQUEST:
            (id_,) = _NUMBER.unpack_from(parts, _SIZE.size)
            if id_ not in self._handled:
                self._handled[id_] = lambda: None
                self._reply(id_, failure(text, "limit"))
        elif kind == REPLY:
            (id_,) = _NUMBER.unpack_from(parts, _SIZE.size)
            self._fail_request(id_, failure(text, "limit"))
        self._too_large.add(key)
        self._incomplete_bytes -= len(parts)
        parts.clear()

    def _receive_request(self, peer: Peer, body: memoryview) -> None:
        id_, size = _REQUEST.unpack_from(body)
        end = _REQUEST.size + size
        if id_ in self._handled:
            raise FederationError(f"request {id_} is still open")
        self._handled[id_] = lambda: None
        try:
            fields = _read_fields(body[_REQUEST.size : end])
        except FederationError as error:
            self._reply(id_, failure(str(error), "invalid_operation"))
            raise
        request = Request(str(fields.pop("op", "")), fields, bytes(body[end:]))
        cancel = self._network.requested(peer, request, lambda reply: self._reply(id_, reply))
        if id_ in self._handled:
            self._handled[id_] = cancel

    def _receive_reply(self, peer: Peer, body: memoryview) -> None:
        id_, is_final, size = _REPLY.unpack_from(body)
        end = _REPLY.size + size
        on_reply = self._requests.get(id_)
        if on_reply is None:
            return  # It was cancelled.
        try:
            fields = _read_fields(body[_REPLY.size : end])
        except FederationError as error:
            self._fail_request(id_, failure(f"invalid reply: {error}", "server_failed"))
            raise
        if is_final:
            del self._requests[id_]
        on_reply(Reply(fields, bytes(body[end:]), bool(is_final)))

    def _fail_request(self, id_: int, reply: Reply) -> None:
        """End an own request, if it still waits."""
        on_reply = self._requests.pop(id_, None)
        if on_reply is not None:
            on_reply(reply)

    def _receive_pong(self, peer: Peer, body: memoryview) -> None:
        sent, theirs = _PONG.unpack(body)
        is_first = peer.clock_offset is None
        peer.measured(sent, theirs, self._now())
        if is_first:
            self._network.joined(peer)
            self._on_joined(peer)

    # The connection.

    def _tick(self) -> None:
        """Ping the other hub, and close a link on which nothing comes."""
        if self._is_closed:
            return
        left = self._heard - self._clock.time()
        left += LEASE if self.peer is not None else OPEN_TIMEOUT
        if left <= 0:
            self._wire.close(LOST)
            left = PING_INTERVAL
        elif self.peer is not None:
            self._ping()
        self._timer = self._clock.call_later(min(PING_INTERVAL, left), self._tick)

    def _ping(self) -> None:
        self._send_control(PING, _PING.pack(self._now()))

    def closed(self, reason: str) -> None:
        """Called when the connection is closed; the second call does nothing.

        Args:
            reason: why, for people.
        """
        if self._is_closed:
            return
        self._is_closed = True
        self._timer.cancel()
        self._control.clear()
        self._lanes.clear()
        self._parts.clear()
        self._incomplete_bytes = 0
        if self.peer is None:
            return
        if self.peer.clock_offset is None:
            self._network.detach(self)
            return
        lost = failure(f"hub {self.peer.hub.name} is lost: {reason}", "server_lost")
        self._network.finish(call_all(self._ends(lost)))
        self._network.lost(self.peer, reason)
        self._network.detach(self)

    def _ends(self, lost: Reply) -> Iterator[Callable[[], object]]:
        """Yield what ends the requests that are open, of both hubs, the oldest first."""
        while self._requests:
            yield partial(self._requests.popitem(last=False)[1], lost)
        while self._handled:
            yield self._handled.popitem(last=False)[1]


def unique_node(role: str, hub: HubInfo) -> str:
    """Return a name for the node that stands for a hub."""
    return f"/{role}_{level_of(hub.name)}_{hub.id[:6]}"


def _head(kind: int, head: bytes, body: Any) -> bytes:
    """Return the beginning of a record: its size, its kind and the fields before its body."""
    return _SIZE.pack(len(head) + len(body) + 1, kind) + head


def _read_fields(data: memoryview) -> dict[str, Any]:
    if len(data) > MOST_FIELDS:
        raise FederationError(f"fields of {len(data)} bytes (limit is {MOST_FIELDS})")
    return decode_fields(data)


def _names(announcement: Announcement) -> str:
    """Return the names in an announcement."""
    return ", ".join(name for kind in KINDS for name in announcement.of(kind))


def _halves(announcement: Announcement) -> tuple[Announcement, Announcement] | None:
    """Return two announcements with half the records each; None if there is only one record."""
    entries = [
        (kind, name, record) for kind in KINDS for name, record in announcement.of(kind).items()
    ]
    if len(entries) < 2:
        return None
    made: list[Announcement] = []
    for half in (entries[: len(entries) // 2], entries[len(entries) // 2 :]):
        kinds: dict[str, Any] = {}
        for kind, name, record in half:
            kinds.setdefault(kind, {})[name] = record
        made.append(Announcement.model_construct(None, **kinds))
    return made[0], made[1]


_RECEIVERS: dict[int, Callable[[Link, Peer, memoryview], Iterable[None] | None]] = {
    ANNOUNCE: Link._receive_announcement,
    INTEREST: Link._receive_interest,
    FLOWING: Link._receive_flowing,
    REQUEST: Link._receive_request,
    REPLY: Link._receive_reply,
    CANCEL: Link._receive_cancel,
    PING: Link._receive_ping,
    PONG: Link._receive_pong,
}
"""The handlers of records by kind, except messages and parts."""
