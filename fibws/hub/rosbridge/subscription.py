"""Subscriptions of one client to one topic, under the spelling that it used."""

from __future__ import annotations

import logging
from collections import OrderedDict
from collections.abc import Callable, Iterable
from functools import partial

from fibws.errors import OperationError
from fibws.hub.delivery.clock import Clock, Workers
from fibws.hub.delivery.deflate import LONG, DeflatedFrames, Deflater
from fibws.hub.delivery.fan_out import FanOut
from fibws.hub.delivery.send_queue import Flusher, Frame, SendQueue
from fibws.hub.delivery.throttle import Throttling
from fibws.hub.errors import LimitReached
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import SinkReport, Topic
from fibws.hub.graph.type_group import TypeGroup
from fibws.hub.graph.types import MessageType
from fibws.hub.log.text import INTERNAL_ERROR, is_power_of_ten
from fibws.hub.rosbridge.encodings import PLAIN, EncodeFrame, Encoding, text_frame
from fibws.hub.rosbridge.statuses import RosbridgeStatuses
from fibws.protocol.frame_queue import Lane
from fibws.protocol.operations import Id, Subscribe, Subscribed, encode
from fibws.protocol.serialized import ROS1

logger = logging.getLogger("fibws.hub")

MAX_REGISTRATIONS = 100
"""Ids under which one client may subscribe to one topic, or advertise it."""
SMALL = 100_000
"""Bytes of JSON that `SlowGroup` encodes at once, which takes a few milliseconds at most."""


class RosbridgeGroup(FanOut[Publication, "RosbridgeSubscription"]):
    """Subscriptions of one topic that get the same frames; the topic delivers to it once.

    Args:
        key: its key among the others.
        others: all groups of the hub, of which this is one while it has members.
    """

    __slots__ = ("_answered", "_failures", "_key", "_others", "_type")

    def __init__(
        self,
        key: GroupKey,
        others: Groups,
        encode: EncodeFrame,
        flusher: Flusher,
        clock: Clock,
    ) -> None:
        super().__init__(encode, flusher, clock)
        self._key = key
        self._others = others
        self._failures = 0
        self._type: MessageType | None = None
        """Of the last message."""
        self._answered: dict[int, MessageType] = {}
        """The types, by their numbers, that all members know who get serialized messages."""

    def receive(self, publication: Publication) -> None:
        """Send a message to every subscription; they share the bytes of its frame."""
        if publication.type is not self._type:
            self._type = publication.type
            if self._key[-1].compression == ROS1:
                self._answer(publication.type)
        try:
            self.send(publication)
        except Exception as fault:
            self.fail(fault, self.members())
            return
        if publication.has_invalid_text:
            for member in self.members():
                member.report_invalid_text()

    def _answer(self, type_: MessageType) -> None:
        """Tell clients of serialized messages a type before its first message."""
        number = self._key[0].number_of(type_)
        if self._answered.get(number) is not type_:
            for member in self.members():
                member.answer(type_)
            self._answered[number] = type_

    def fail(self, fault: Exception, members: Iterable[RosbridgeSubscription]) -> None:
        """Report that a message cannot be encoded to its subscribers.

        Some asked before the type was known; any other exception is the hub's own failure.
        """
        if not isinstance(fault, OperationError):
            self._failures += 1
            if is_power_of_ten(self._failures):
                topic, encoding = self._key[0], self._key[-1]
                logger.error(
                    "%s cannot be encoded (compression %s, failure %d)",
                    topic.name,
                    encoding.compression,
                    self._failures,
                    exc_info=fault,
                )
        for member in members:
            member.refuse(fault)

    def receive_alone(
        self, member: RosbridgeSubscription, publication: Publication, *, latched: bool
    ) -> None:
        """Send a message to one subscription; a latched one regardless of its throttle.

        Raises:
            OperationError: it cannot be encoded so.
        """
        frame = publication.cached(self, lambda: self.encode(publication))
        self.send_alone(member, frame, latched=latched)

    def add(self, member: RosbridgeSubscription) -> None:
        """Add a subscription that is in no group."""
        self._others[self._key] = self
        self._type = None
        self._answered.clear()
        super().add(member)

    def remove(self, member: RosbridgeSubscription) -> None:
        """Remove a subscription."""
        super().remove(member)
        if not self:
            del self._others[self._key]


class SlowGroup(RosbridgeGroup):
    """A group whose large messages are encoded in a thread, one at a time.

    Meanwhile the newest message waits, and takes the place of an older one, which counts as
    dropped. Messages for one subscription alone wait by themselves, and so do the latched ones of
    each publisher.

    Args:
        make: makes the frame of a message in JSON, in any thread.
        workers: the threads.
    """

    __slots__ = ("_jobs", "_make", "_running", "_workers")

    def __init__(
        self,
        key: GroupKey,
        others: Groups,
        make: Callable[[bytes], Frame],
        flusher: Flusher,
        clock: Clock,
    ) -> None:
        super().__init__(key, others, lambda each: make(each.json()), flusher, clock)
        self._make = make
        self._workers = others.workers
        self._jobs: OrderedDict[object, _Job] = OrderedDict()
        self._running: _Job | None = None

    def receive(self, publication: Publication) -> None:
        """Send a message to every subscription that wants it, once it is encoded."""
        text = publication.json()
        wanting = []
        for member in self.members():
            if publication.has_invalid_text:
                member.report_invalid_text()
            if self.wants(member):
                wanting.append(member)
            else:
                member.throttled += 1
        self._add(None, _Job(text, wanting, latched=False))

    def receive_alone(
        self, member: RosbridgeSubscription, publication: Publication, *, latched: bool
    ) -> None:
        """Send a message to one subscription, once it is encoded."""
        key = (member, publication.node) if latched else member
        self._add(key, _Job(publication.json(), [member], latched=latched))

    def remove(self, member: RosbridgeSubscription) -> None:
        """Remove a subscription, for which nothing waits any more."""
        for job in filter(None, (self._running, *self._jobs.values())):
            if member in job.members:
                job.give_up(member)
        super().remove(member)

    def _add(self, key: object, job: _Job) -> None:
        replaced = self._jobs.pop(key, None)
        if replaced is not None:
            replaced.drop()
        self._jobs[key] = job
        job.hold()
        if self._running is None:
            self._go_on()

    def _go_on(self) -> None:
        """Encode what waits: small messages now, the next large one in a thread."""
        while self._jobs:
            job = self._running = self._jobs.popitem(last=False)[1]
            if job.members and len(job.text) >= SMALL:
                self._workers.run(partial(job.encode, self._make), self._encoded)
                return
            if job.members:
                job.encode(self._make)
            self._send(job)
        self._running = None

    def _encoded(self) -> None:
        if self._running is not None:
            self._send(self._running)
            self._go_on()

    def _send(self, job: _Job) -> None:
        members = list(job.members)
        for member in members:
            job.give_up(member)
        if job.fault is not None:
            self.fail(job.fault, members)
        elif job.frame is not None:
            for member in members:
                self.send_alone(member, job.frame, latched=job.latched)


class _Job:
    """A message that a `SlowGroup` is to encode, for some of its members.

    Its bytes count as kept for the client of each of them.
    """

    __slots__ = ("fault", "frame", "latched", "members", "text")

    def __init__(self, text: bytes, members: list[RosbridgeSubscription], *, latched: bool) -> None:
        self.text = text
        self.members = members
        self.latched = latched
        self.frame: Frame | None = None
        self.fault: Exception | None = None

    def encode(self, make: Callable[[bytes], Frame]) -> None:
        """Make the frame, in any thread."""
        try:
            self.frame = make(self.text)
        except Exception as fault:
            self.fault = fault

    def hold(self) -> None:
        """Count the bytes for each member; those without room for them lose the message."""
        size = len(self.text)
        for member in list(self.members):
            member.queue.throttled_bytes += size
            if member.queue.exceeded and member.queue.kept_bytes > size:
                self._drop_for(member)

    def drop(self) -> None:
        """Count the message as dropped for all members."""
        for member in list(self.members):
            self._drop_for(member)

    def give_up(self, member: RosbridgeSubscription) -> None:
        """Count the bytes for one of the members no longer."""
        self.members.remove(member)
        member.queue.throttled_bytes -= len(self.text)

    def _drop_for(self, member: RosbridgeSubscription) -> None:
        self.give_up(member)
        member.lane.dropped += 1
        member.queue.dropped += 1


class _Recipients:
    """Who gets a frame of a `DeflatingGroup`.

    Attributes:
        members: the subscriptions.
        latched: whether their throttles let it pass.
        form: keeps the frame for subscriptions that come later; None if it is not latched.
    """

    __slots__ = ("form", "latched", "members")

    def __init__(
        self,
        members: Iterable[RosbridgeSubscription],
        *,
        latched: bool = False,
        form: _Form | None = None,
    ) -> None:
        self.members = dict.fromkeys(members)
        self.latched = latched
        self.form = form


class _Form:
    """The frame of a latched message, once it is compressed."""

    __slots__ = ("frame",)

    def __init__(self) -> None:
        self.frame: bytes | None = None


class DeflatingGroup(RosbridgeGroup):
    """A group whose frames are compressed, once for all members.

    Long ones are compressed in a thread; those that follow wait, and none is dropped.

    Args:
        encode_text: makes the frame of a message, without compression.
    """

    __slots__ = ("_encode_text", "_frames")

    def __init__(
        self,
        key: GroupKey,
        others: Groups,
        encode_text: Callable[[Publication], bytes],
        flusher: Flusher,
        clock: Clock,
    ) -> None:
        self._encode_text = encode_text
        self._frames: DeflatedFrames[_Recipients]
        self._frames = DeflatedFrames(others.deflater, key[-1].deflate, self._send)
        super().__init__(
            key, others, lambda each: self._frames.deflated(encode_text(each)), flusher, clock
        )

    def receive(self, publication: Publication) -> None:
        """Send a message to every subscription that wants it, once it is compressed."""
        if not self._targets and not any(map(self.wants, self._throttles)):
            super().receive(publication)  # It only counts the message.
            return
        try:
            frame = self._encode_text(publication)
        except Exception as fault:
            self.fail(fault, self.members())
            return
        if self._frames.is_sent_at_once(frame) and len(frame) <= LONG:
            super().receive(publication)
            return
        wanting = []
        for member in self.members():
            if publication.has_invalid_text:
                member.report_invalid_text()
            if self.wants(member):
                wanting.append(member)
            else:
                member.throttled += 1
        if wanting:
            self._frames.put(frame, _Recipients(wanting))

    def receive_alone(
        self, member: RosbridgeSubscription, publication: Publication, *, latched: bool
    ) -> None:
        """Send a message to one subscription, once it is compressed; many may ask for it."""
        form = publication.cached(self, _Form)
        newest = self._frames.newest()
        if newest is not None and newest.form is form and newest.latched == latched:
            newest.members[member] = None
        else:
            frame = form.frame or self._encode_text(publication)
            self._frames.put(frame, _Recipients([member], latched=latched, form=form))

    def remove(self, member: RosbridgeSubscription) -> None:
        """Remove a subscription, which gets what waits for it as it is."""
        for waiting in self._frames:
            if member in waiting.recipients.members:
                del waiting.recipients.members[member]
                self.send_alone(member, waiting.frame, latched=waiting.recipients.latched)
        super().remove(member)

    def _send(self, frame: bytes, recipients: _Recipients) -> None:
        if recipients.form is not None:
            recipients.form.frame = frame
        for member in recipients.members:
            self.send_alone(member, frame, latched=recipients.latched)


GroupKey = tuple[Topic, TypeGroup | None, str, Encoding]
"""A topic, the group of the type that the members name, the topic's name as they spell it, and how
they want messages."""


class Groups(dict[GroupKey, RosbridgeGroup]):
    """All groups of a hub.

    Args:
        workers: make frames that take long.
        deflater: compresses frames.
    """

    def __init__(self, workers: Workers, deflater: Deflater) -> None:
        super().__init__()
        self.workers = workers
        self.deflater = deflater


class RosbridgeSubscription:
    """The requests of one client for one topic, merged; a `Sink` of the topic.

    Args:
        node: the client's name.
        spelling: the topic's name as the client wrote it, and will read it.
        queue: the client's send queue.
        groups: those of the hub.
        queue_length: messages kept for a slow client that named no queue_length.
        follow: calls `name_again`, when the publishers of the type that the client names have
            another definition of it.
    """

    __slots__ = (
        "_answered",
        "_clock",
        "_complained",
        "_conflict",
        "_default",
        "_graph",
        "_group",
        "_groups",
        "_on_follow",
        "_reported_text",
        "_statuses",
        "encoding",
        "lane",
        "node",
        "queue",
        "requests",
        "sent",
        "spelling",
        "throttled",
        "throttling",
        "topic",
        "unacknowledged",
    )

    def __init__(
        self,
        node: str,
        topic: Topic,
        spelling: str,
        graph: Graph,
        groups: Groups,
        queue: SendQueue,
        clock: Clock,
        statuses: RosbridgeStatuses,
        *,
        queue_length: int,
        follow: Callable[[RosbridgeSubscription], object],
    ) -> None:
        self.node = node
        self.topic = topic
        self.spelling = spelling
        self.queue = queue
        self.lane = Lane(queue_length)
        self.throttling: Throttling | None = None
        self.sent = 0
        self.throttled = 0
        self.unacknowledged = 0
        self.requests: dict[Id, Subscribe] = {}
        self.encoding = PLAIN
        self._graph = graph
        self._groups = groups
        self._group: RosbridgeGroup | None = None
        self._clock = clock
        self._statuses = statuses
        self._complained = False
        self._answered: dict[int, MessageType] = {}
        """The types that were reported to the client, by their numbers."""
        self._conflict = ""
        """Why messages of others do not pass, as it was reported."""
        self._reported_text = False
        self._default = queue_length
        self._on_follow = follow

    # As a sink.

    def receive(self, publication: Publication) -> None:
        """Take a message that is for this client alone."""
        if self._group is not None:
            self.answer(publication.type)
            try:
                self._group.receive_alone(self, publication, latched=False)
            except Exception as fault:
                self._group.fail(fault, [self])
                return
            if publication.has_invalid_text:
                self.report_invalid_text()

    def replay(self, publication: Publication) -> None:
        """Take a latched message regardless of the throttle; raise `OperationError`."""
        if self._group is not None:
            self.answer(publication.type)
            self._group.receive_alone(self, publication, latched=True)
            if publication.has_invalid_text:
                self.report_invalid_text()

    def report(self) -> SinkReport:
        """Return its settings and totals."""
        group, throttling = self._group, self.throttling
        # In the order of its fields: a scrape of /metrics makes thousands of these.
        return SinkReport(
            self.lane.limit,
            0.0 if throttling is None else throttling.period * 1000,
            self.encoding.compression,
            self.sent if group is None else group.sent_to(self),
            self.lane.dropped,
            self.throttled if group is None or throttling is None else group.throttled_for(self),
        )

    # As the client's requests.

    def request(self, request: Subscribe) -> None:
        """Add a request; one of the same id replaces the older one.

        Raises:
            LimitReached: there are too many.
            OperationError: as `Graph.subscribe`; nothing has changed then.
        """
        if len(self.requests) >= MAX_REGISTRATIONS and request.id not in self.requests:
            raise LimitReached(
                f"too many subscriptions to {self.topic.name} (limit {MAX_REGISTRATIONS})"
            )
        self._change({**self.requests, request.id: _as_kept(request)}, request)
        type_ = self.topic.type_for(self)
        if type_ is not None and request.compression == ROS1:
            self._note_answer(type_)
            self._send_subscribed(request, type_)

    def cancel(self, id_: Id) -> None:
        """Remove the request of this id, or all if it is None; an unknown id changes nothing."""
        if id_ is not None and id_ not in self.requests:
            return
        requests = {key: each for key, each in self.requests.items() if id_ not in (None, key)}
        if requests:
            self._change(requests, None)
            return
        self.requests = requests
        self._join(None, requests)
        self._graph.unsubscribe(self.topic, self)
        self.queue.forget(self.lane)

    def follow(self) -> None:
        """Follow the publishers of the type that the client names to another definition of it."""
        self._on_follow(self)

    def name_again(self) -> None:
        """Subscribe again with the type that the requests name; raises as `request`."""
        named = next((each for each in self.requests.values() if each.type is not None), None)
        if named is not None:
            self._change(self.requests, named, keeps_type=False)
            type_ = self.topic.type_for(self)
            if type_ is not None:
                self.answer(type_)

    @property
    def takes_all(self) -> bool:
        """Whether a request names no type, so that it gets the messages of all."""
        return any(each.type is None for each in self.requests.values())

    def acknowledge(self, count: int) -> None:
        """Take messages as processed by the client."""
        if self._group is not None:
            self._group.acknowledge(self, count)

    def answer(self, type_: MessageType) -> None:
        """Tell a client of serialized messages the topic's number and type, unless it knows them.

        That answers its requests, and precedes the first message if the topic had no type before.
        """
        if self.encoding.compression != ROS1:
            return
        if self._answered.get(self.topic.number_of(type_)) is type_:
            return
        self._note_answer(type_)
        for request in self.requests.values():
            if request.compression == ROS1:
                self._send_subscribed(request, type_)

    def _note_answer(self, type_: MessageType) -> None:
        if len(self._answered) > MAX_REGISTRATIONS:
            self._answered.clear()  # Of types that it had before; an answer may come twice.
        self._answered[self.topic.number_of(type_)] = type_

    def report_conflict(self, text: str) -> None:
        """Report why messages of others do not pass; an empty text says that they do."""
        if text != self._conflict:
            self._conflict = text
            for request in self.requests.values():
                self._send_conflict(request)

    def _send_conflict(self, request: Subscribe) -> None:
        if request.type is None:
            return
        if self._conflict:
            self._statuses.conflict(request.id, f"subscribe: {self._conflict}")
        else:
            self._statuses.info(request.id, f"{self.topic.name} has one type again")

    def refuse(self, fault: Exception) -> None:
        """Report, once, that messages cannot be encoded as the client asked."""
        if not self._complained:
            self._complained = True
            compression = self.encoding.compression
            id_ = next(
                (each.id for each in self.requests.values() if each.compression == compression),
                None,
            )
            text, code = INTERNAL_ERROR, "internal_error"
            if isinstance(fault, OperationError):
                text, code = str(fault), fault.code
            self._statuses.error(id_, f"subscribe: {text}", code=code)

    def report_invalid_text(self) -> None:
        """Report, once, that a string was changed since it is not UTF-8."""
        if not self._reported_text and self.encoding.compression not in (ROS1, "cbor-raw"):
            self._reported_text = True
            id_ = next(iter(self.requests), None)
            self._statuses.warning(
                id_,
                f"subscribe: {self.topic.name} has strings that are not UTF-8; "
                "their invalid bytes are replaced by U+FFFD",
            )

    def _change(
        self, requests: dict[Id, Subscribe], new: Subscribe | None, *, keeps_type: bool = True
    ) -> None:
        """Subscribe to the topic as the requests ask, in the group of those who ask the same."""
        encoding = Encoding.merged(requests.values()).deflated(self.queue.deflate)
        others = [each for each in requests.values() if new is None or each.id != new.id]
        type_ = next((each.type for each in others if each.type is not None), None)
        keeps_type = keeps_type and type_ is not None
        if new is not None and new.type is not None:
            type_ = new.type
        joined: list[RosbridgeGroup] = []

        def receiver(type_group: TypeGroup | None) -> RosbridgeGroup:
            joined.append(self._group_of(encoding, type_group))
            return joined[0]

        names_fields = any(map(_names_fields, requests.values()))
        self._graph.subscribe(
            self.topic,
            self,
            new.type if new is not None else None,
            receiver=receiver,
            follow=None if type_ is None or names_fields else self.follow,
            keeps_type=keeps_type,
            takes_all=any(each.type is None for each in requests.values()),
            needs_definition=encoding.needs_definition or names_fields,
            serialized=encoding.needs_definition,
            definition=new.definition if new is not None else None,
            md5sum=new.md5sum if new is not None else None,
            on_conflict=self.report_conflict,
        )
        self.requests = requests
        self.encoding = encoding
        self._join(joined[0], requests)
        if type_ is None:
            self._conflict = ""
        elif new is not None and self._conflict:
            self._send_conflict(new)

    def _group_of(self, encoding: Encoding, type_: TypeGroup | None) -> RosbridgeGroup:
        # Frames of `ROS1` do not hold the topic's name.
        spelling = "" if encoding.compression == ROS1 else self.spelling
        key = (self.topic, type_, spelling, encoding)
        group = self._groups.get(key)
        if group is None:
            flusher = self.queue.flusher
            if encoding.is_slow:
                make = encoding.png_maker(self.spelling)
                group = SlowGroup(key, self._groups, make, flusher, self._clock)
            elif encoding.deflate:
                encode_text = encoding.text_encoder(self.spelling)
                group = DeflatingGroup(key, self._groups, encode_text, flusher, self._clock)
            else:
                encode_frame = encoding.for_topic(self.topic, self.spelling)
                group = RosbridgeGroup(key, self._groups, encode_frame, flusher, self._clock)
        return group

    def _join(self, group: RosbridgeGroup | None, requests: dict[Id, Subscribe]) -> None:
        """Move to a group, with the throttle and the limit of all requests together.

        The lowest throttle_rate and the highest queue_length count, as rosbridge's specification
        says, and the highest credit. A request without queue_length means the default, one without
        credit an unlimited one.
        """
        period, queue_length, credit = 0.0, 0, 0
        if requests:
            asked = requests.values()
            period = min(max(0, request.throttle_rate) for request in asked) / 1000
            queue_length = max(max(0, request.queue_length) for request in asked)
            if all(request.credit for request in asked):
                credit = max(request.credit or 0 for request in asked)
            self.lane.limit = max(
                request.queue_length if request.queue_length > 0 else self._default
                for request in asked
            )
        throttling = Throttling(period, queue_length, credit) if period or credit else None
        if group is self._group and throttling == self.throttling:
            return
        if self._group is not None:
            self._group.remove(self)
        self.throttling = throttling
        self._group = group
        if group is not None:
            group.add(self)

    def _send_subscribed(self, request: Subscribe, type_: MessageType) -> None:
        answer = Subscribed(
            id=request.id,
            topic=request.topic,
            topic_id=self.topic.number_of(type_),
            type=type_.name,
            md5sum=type_.md5sum or "",
            credit=request.credit,
            definition=self._definition(type_) if request.send_definition else None,
        )
        self.queue.reply(text_frame(encode(answer)))

    def _definition(self, type_: MessageType) -> str | None:
        codecs = type_.codecs
        return codecs.definitions.full_text(type_.name) if codecs is not None else None


def _as_kept(request: Subscribe) -> Subscribe:
    """Return a request without the texts about its type, which may be long; empty ones stand for
    them.
    """
    texts = {name: "" for name in ("definition", "md5sum") if getattr(request, name) is not None}
    return request.model_copy(update=texts) if texts else request


def _names_fields(request: Subscribe) -> bool:
    """Return whether a request defines the fields of its type, and not only its name."""
    return request.definition is not None or request.md5sum is not None
