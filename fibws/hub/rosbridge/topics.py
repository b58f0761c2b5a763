"""The topics that one client publishes and subscribes to."""

from __future__ import annotations

from collections import OrderedDict
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import chain, count
from operator import itemgetter
from typing import Any

from fibws.errors import FibwsError, InvalidMessage, InvalidName, OperationError
from fibws.hub.delivery.clock import Timer
from fibws.hub.errors import LimitReached, TypeConflict, UnknownPublisher
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.graph.peers import PeerWatch
from fibws.hub.graph.topic import QUEUE_SIZE, Source, Topic
from fibws.hub.log.text import is_power_of_ten
from fibws.hub.rosbridge.client import RosbridgeClient
from fibws.hub.rosbridge.encodings import COMPRESSIONS
from fibws.hub.rosbridge.peers import PeerReports
from fibws.hub.rosbridge.subscription import MAX_REGISTRATIONS, RosbridgeSubscription
from fibws.hub.rosbridge.wills import Wills
from fibws.hub.websocket.endpoint import Removals, Work
from fibws.protocol.operations import (
    Acknowledge,
    Advertise,
    ClearWill,
    Id,
    Publish,
    SetWill,
    Subscribe,
    Unadvertise,
    Unsubscribe,
    encode,
)
from fibws.protocol.serialized import ROS1, SUBPROTOCOL, read_publish
from fibws.protocol.websocket import Payload

GRACE = 3.0
"""Seconds after a client has connected in which it may publish before it advertises."""
MOST_PENDING_BYTES = 2**20
"""Bytes of JSON that may wait for one client's advertisements."""
PENDING_COST = 300
"""Bytes that a pending message counts for besides its text, to bound floods of small ones."""


@dataclass(slots=True)
class RefusedAdvertise:
    """Why the hub refused a client's advertise, and how many messages it has dropped since then."""

    text: str
    code: str
    dropped: int = 0


class RosbridgeTopics:
    """One client's publishers and subscriptions."""

    __slots__ = (
        "_advertisements",
        "_client",
        "_grace_ends",
        "_latch_quota",
        "_more",
        "_numbered",
        "_pending",
        "_refused",
        "_spellings",
        "_wills",
        "sources",
        "subscriptions",
    )

    def __init__(self, client: RosbridgeClient) -> None:
        self._client = client
        self._latch_quota: LatchQuota | None = None
        self._grace_ends = client.clock.time() + GRACE
        self._pending: PendingPublishes | None = None
        self._refused: OrderedDict[str, RefusedAdvertise] = OrderedDict()
        """By the topics' global names, until they are advertised or unadvertised."""
        self.sources: dict[str, Source] = {}
        """By the spelling of the topic's name that the client used."""
        self._spellings: dict[Source, list[str]] = {}
        """The keys of each source in `sources`."""
        self._advertisements: dict[Source, dict[Id, int | None]] = {}
        """The ids that each source is advertised under, with its numbers in binary frames."""
        self._wills: Wills | None = None
        self._numbered: dict[int, Source] = {}
        """By the number that binary frames name."""
        self.subscriptions: dict[str, RosbridgeSubscription] = {}
        """By the spelling of the topic's name that the client used."""
        self._more: dict[str, list[RosbridgeSubscription]] = {}
        """By the same: those of further types that it has named."""

    @property
    def pending_bytes(self) -> int:
        """Bytes of messages that wait for their topic's type."""
        return self._pending.size if self._pending is not None else 0

    # Publishing.

    def publish_serialized(self, data: Payload) -> None:
        """Publish the message of a binary frame.

        Raises:
            UnknownPublisher: the client has not advertised under the frame's number.
            OperationError, InvalidMessage: as `read_publish` and `Source.publish_serialized`.
        """
        number, node, message = read_publish(data)
        source = self._numbered.get(number)
        if source is None:
            raise UnknownPublisher(number)
        try:
            source.publish_serialized(message, node)
        except InvalidMessage as error:
            raise InvalidMessage(f"{source.topic.name}: {error}") from None

    def advertise(self, request: Advertise) -> None:
        """Register a publisher, or another advertisement of one."""
        known = self.sources.get(request.topic)
        if known is not None and request.peers:
            known.group.watching_sinks.check_room(known, request.id)
        source = self._register(request, request.type, request.definition, request.md5sum)
        self._count_advertisement(source, request)
        self._refused.pop(source.topic.name, None)
        if request.headers is not None:
            headers = self._client.graph.header(self._client.node, request.headers)
            source.set_headers(headers)
        if request.keep_seq:
            source.keeps_sequence = True
        name, type_ = source.topic.name, source.type
        statuses = self._client.statuses
        if not type_.checked:
            text = f"{name}: messages of type {type_.name} are not checked"
            statuses.unchecked(request.id, text, type_)
        self._client.check_legal(request.id, request.topic, name)
        statuses.info(request.id, f"{self._client.node} publishes {name} ({type_.name})")
        topic = source.topic
        # The log, which every node writes to, does not show who reads it.
        if topic.name not in self._client.graph.rights.guards or self._client.graph.rights.allows(
            self._client.node, "subscribe", topic.name
        ):
            self._watch(request, topic, source.group.watching_sinks, source)
        self._publish_pending(topic)

    def refuse_advertise(self, fields: dict[str, Any], text: str, code: str) -> None:
        """Drop the topic's messages, those that wait included, until it is advertised.

        Args:
            fields: of the operation that was refused.
            text: the reason.
        """
        spelling = fields.get("topic")
        if not isinstance(spelling, str) or spelling in self.sources:
            return
        try:
            topic = self._client.resolve(spelling)
        except InvalidName:
            return
        if len(self._refused) >= self._client.settings.max_advertisements:
            self._refused.popitem(last=False)
        self._refused[topic] = RefusedAdvertise(text, code)
        if self._pending is not None:
            for request in self._pending.take(topic):
                self._drop(topic, request)

    def unadvertise(self, request: Unadvertise) -> None:
        """Take back an advertisement; the source goes with the last."""
        source = self.sources.get(request.topic)
        if source is None:
            with suppress(InvalidName):
                self._refused.pop(self._client.resolve(request.topic), None)
            return
        source.group.watching_sinks.cancel(source, request.id)
        advertisements = self._advertisements.get(source, {})
        for id_ in list(advertisements) if request.id is None else [request.id]:
            self._release(source, advertisements.pop(id_, None))
        if advertisements:
            return
        self._advertisements.pop(source, None)
        for spelling in self._spellings.pop(source):
            del self.sources[spelling]
        if self._wills is not None:
            self._wills.clear(source)
        self._client.graph.remove_source(source)

    def set_will(self, request: SetWill) -> None:
        """Keep a message for when the client has gone; advertise its topic if need be."""
        source = self.sources.get(request.topic)
        if source is None:
            topic = self._topic(request.topic)
            self._client.graph.rights.check(self._client.node, "publish", topic.name)
            type_ = request.type or (topic.type.name if topic.type is not None else None)
            if type_ is None:
                raise OperationError(
                    f"{request.topic} has no type yet; advertise it first, or give the type"
                )
            source = self._register(request, type_, None, None)
        if self._wills is None:
            client = self._client
            allowed = client.graph.rights.allows_source
            self._wills = Wills(client.node, self._quota(), client.clock, allowed)
        self._wills.set(source, request.msg, request.timeout)
        self._client.statuses.info(request.id, f"{source.topic.name} has a will")

    def clear_will(self, request: ClearWill) -> None:
        """Forget the message for when the client has gone."""
        source = self.sources.get(request.topic)
        if source is not None and self._wills is not None:
            self._wills.clear(source)

    def report_defaults(self, source: Source, msg: object, id_: Any) -> None:
        """Tell a client that wants to know it which fields of its message were left out."""
        missing = source.type.missing(msg if isinstance(msg, dict) else {})
        if missing:
            self._client.statuses.info(id_, f"publish: defaults used for {', '.join(missing)}")

    def publish(self, request: Publish) -> None:
        """Publish a message that is for one node alone, or that was not advertised.

        The latter waits until its topic has a type.
        """
        source = self.sources.get(request.topic)
        if source is None:
            topic = self._topic(request.topic)
            # Before anything that depends on whether there is such a topic.
            self._client.graph.rights.check(self._client.node, "publish", topic.name)
            if topic.name in self._refused:
                self._drop(topic.name, request)
                return
            if topic.type is None and self._wait(topic, request):
                return
            self._publish_pending(topic)
            source = self._advertise_by_publishing(request)
        self._publish(source, request)

    def _publish(self, source: Source, request: Publish) -> None:
        to = None if request.to is None else self._client.resolve(request.to)
        source.publish(request.msg, to=to)
        if self._client.statuses.wants_info:
            self.report_defaults(source, request.msg, request.id)

    def _drop(self, topic: str, request: Publish) -> None:
        """Drop a message whose advertise was refused; report the 1st, the 10th, the 100th ..."""
        refused = self._refused[topic]
        refused.dropped += 1
        if is_power_of_ten(refused.dropped):
            text = f"publish: {topic} could not be advertised: {refused.text}"
            self._client.statuses.error(
                request.id, f"{text} (messages dropped: {refused.dropped})", code=refused.code
            )

    def _advertise_by_publishing(self, request: Publish) -> Source:
        topic = self._topic(request.topic)
        if topic.type is None:
            raise OperationError(
                f"Cannot infer topic type for topic {request.topic} as it is not yet advertised"
            )
        source = self._register(request, topic.type.name, None, None)
        self._client.check_legal(request.id, request.topic, topic.name)
        return source

    def _wait(self, topic: Topic, request: Publish) -> bool:
        """Keep a message until its topic has a type, if there is time and room for that."""
        if self._pending is None:
            if self._client.clock.time() >= self._grace_ends:
                return False
            self._pending = PendingPublishes(self)
        return self._pending.put(topic.name, request)

    def _publish_pending(self, topic: Topic) -> None:
        """Publish the messages that waited for the topic's type."""
        if self._pending is not None:
            for request in self._pending.take(topic.name):
                self._publish_late(request)

    def _publish_late(self, request: Publish) -> None:
        try:
            self._publish(self._advertise_by_publishing(request), request)
        except FibwsError as error:
            self._client.statuses.error(request.id, f"publish: {error}", code=error.code)

    def _register(
        self,
        request: Advertise | Publish | SetWill,
        type_: str,
        definition: str | None,
        md5sum: str | None,
    ) -> Source:
        if request.topic not in self.sources:
            self._client.check_room("advertisements", len(self.sources))
        source = self._client.graph.advertise(
            self._topic(request.topic),
            self._client.node,
            type_,
            definition,
            latch=not isinstance(request, SetWill) and request.latch,
            quota=self._quota(),
            queue_size=request.queue_size if isinstance(request, Advertise) else QUEUE_SIZE,
            serialized=isinstance(request, Advertise) and request.publisher is not None,
            md5sum=md5sum,
            on_conflict=partial(self._report_conflict, request.id, request.topic),
        )
        if self.sources.get(request.topic) is not source:
            self.sources[request.topic] = source
            self._spellings.setdefault(source, []).append(request.topic)
        return source

    def _report_conflict(self, id_: Id, topic: str, text: str) -> None:
        statuses = self._client.statuses
        if text:
            statuses.conflict(id_, f"advertise: {text}")
        else:
            statuses.info(id_, f"{topic} has one type again")

    def _quota(self) -> LatchQuota:
        if self._latch_quota is None:
            client = self._client
            self._latch_quota = client.graph.latch_quota(
                client.settings.max_latched_bytes,
                client.node,
                lambda text: client.statuses.error(None, text, code=LimitReached.code),
            )
        return self._latch_quota

    def _count_advertisement(self, source: Source, request: Advertise) -> None:
        advertisements = self._advertisements.setdefault(source, {})
        if len(advertisements) >= MAX_REGISTRATIONS and request.id not in advertisements:
            raise LimitReached(
                f"too many advertisements of {source.topic.name} (limit {MAX_REGISTRATIONS})"
            )
        older = advertisements.get(request.id)
        advertisements[request.id] = request.publisher
        self._release(source, older)
        if request.publisher is not None:
            self._numbered[request.publisher] = source

    def _release(self, source: Source, number: int | None) -> None:
        """Free a number unless another advertisement of the source, or another source, has it."""
        others = self._advertisements.get(source, {}).values()
        if number is not None and self._numbered.get(number) is source and number not in others:
            del self._numbered[number]

    # Subscribing.

    def subscribe(self, request: Subscribe) -> None:
        """Add a request to the subscription of the topic that is spelled so, and of its type."""
        client = self._client
        present = self._present(request.topic)
        topic = present[0].topic if present else self._topic(request.topic)
        if request.compression not in COMPRESSIONS:
            request = self._with_known_compression(request, topic)
        if request.credit is not None and request.compression != ROS1:
            raise OperationError(
                f"credit needs serialized messages: subscribe with the compression {ROS1} "
                f"on a connection of {SUBPROTOCOL}"
            )
        if len(present) > 1 and request.type is None:
            present = self._merge(present)
        subscription = self._request(request, topic, present)
        for each in present:
            if each is not subscription and request.id in each.requests:
                self._cancel(each, request.id)
        client.check_legal(request.id, request.topic, topic.name)
        type_ = topic.type_for(subscription)
        if type_ is not None and (
            (type_.fault and request.definition is not None) or (type_.meant and request.type)
        ):
            text = f"{topic.name}: messages of type {type_.name} are not checked"
            client.statuses.unchecked(request.id, text, type_)
        if type_ is None:
            client.statuses.info(request.id, f"{topic.name} waits for a publisher to have a type")
        topic.replay(subscription)

    def _present(self, spelling: str) -> list[RosbridgeSubscription]:
        """Return the subscriptions of a topic; several if the client names several types."""
        first = self.subscriptions.get(spelling)
        return [] if first is None else [first, *self._more.get(spelling, ())]

    def _request(
        self, request: Subscribe, topic: Topic, present: list[RosbridgeSubscription]
    ) -> RosbridgeSubscription:
        """Add a request to one of the present subscriptions, or to a new one; return that."""
        for subscription in present:
            try:
                self._request_of(subscription, request)
            except TypeConflict:
                if not subscription.takes_all:
                    continue
                # It gets the messages of all types anyway, each of them once.
                self._request_of(subscription, request.model_copy(update={"type": None}))
            return subscription
        client = self._client
        client.check_room("subscriptions", self.subscription_count)
        subscription = RosbridgeSubscription(
            client.node,
            topic,
            request.topic,
            client.graph,
            client.groups,
            client.queue,
            client.clock,
            client.statuses,
            queue_length=client.settings.queue_length,
            follow=self._follow,
        )
        self._request_of(subscription, request)
        if present:
            self._more.setdefault(request.topic, []).append(subscription)
        else:
            self.subscriptions[request.topic] = subscription
        return subscription

    def _request_of(self, subscription: RosbridgeSubscription, request: Subscribe) -> None:
        """Add a request to a subscription, and have its peers reported."""
        topic = subscription.topic
        watched = topic.watching(subscription)
        if request.peers:
            watched.check_room(subscription, request.id)
        subscription.request(request)
        watching = topic.watching(subscription)
        # All of them, if the first request that names a type has brought other publishers.
        for each in (request,) if watching is watched else subscription.requests.values():
            self._watch(each, topic, watching, subscription)

    def _merge(self, present: list[RosbridgeSubscription]) -> list[RosbridgeSubscription]:
        """Return one subscription for the requests of several, before one for all types comes."""
        first, *others = present
        if sum(len(each.requests) for each in present) >= MAX_REGISTRATIONS:
            raise LimitReached(
                f"too many subscriptions to {first.topic.name} (limit {MAX_REGISTRATIONS})"
            )
        for subscription in others:
            requests = tuple(subscription.requests.values())
            self._cancel(subscription, None)
            for each in requests:
                self._request_of(first, each.model_copy(update={"type": None}))
        return [first]

    @property
    def subscription_count(self) -> int:
        """How many subscriptions there are, by topics and types."""
        return len(self.subscriptions) + sum(map(len, self._more.values()))

    def unsubscribe(self, request: Unsubscribe) -> None:
        """Take back one request, or all; the subscription goes with the last."""
        for subscription in self._present(request.topic):
            self._cancel(subscription, request.id)

    def _cancel(self, subscription: RosbridgeSubscription, id_: Id) -> None:
        topic = subscription.topic
        watched = topic.watching(subscription)
        watched.cancel(subscription, id_)
        subscription.cancel(id_)
        if not subscription.requests:
            self._remove(subscription)
        elif (watching := topic.watching(subscription)) is not watched:
            for each in subscription.requests.values():
                self._watch(each, topic, watching, subscription)

    def _remove(self, subscription: RosbridgeSubscription) -> None:
        """Forget a subscription that has no requests."""
        spelling = subscription.spelling
        others = [each for each in self._present(spelling) if each is not subscription]
        self._more.pop(spelling, None)
        if others:
            self.subscriptions[spelling] = others[0]
            if others[1:]:
                self._more[spelling] = others[1:]
        else:
            del self.subscriptions[spelling]

    def acknowledge(self, request: Acknowledge) -> None:
        """Take messages as processed by the client, unless it has unsubscribed since."""
        count = request.count
        for subscription in self._present(request.topic):
            taken = min(count, subscription.unacknowledged)
            subscription.acknowledge(taken)
            count -= taken

    def _follow(self, subscription: RosbridgeSubscription) -> None:
        """Subscribe again, since a type that the client names has another definition now."""
        topic, statuses = subscription.topic, self._client.statuses
        try:
            subscription.name_again()
            watching = topic.watching(subscription)
            for each in subscription.requests.values():
                self._watch(each, topic, watching, subscription)
            topic.replay(subscription)
        except FibwsError as error:
            statuses.error(
                next(iter(subscription.requests)), f"subscribe: {error}", code=error.code
            )

    def _with_known_compression(self, request: Subscribe, topic: Topic) -> Subscribe:
        """Return the request with a compression that is possible."""
        if request.compression == ROS1 and self._client.serialized:
            return request
        self._client.statuses.warning(
            request.id,
            f"{topic.name}: compression must be one of {', '.join(COMPRESSIONS)}, "
            f"got {request.compression}",
        )
        return request.model_copy(update={"compression": "none"})

    # Both.

    def withdraw_forbidden(self) -> Work:
        """Take back, one by one, what the client's rights do not allow any more."""
        graph, node = self._client.graph, self._client.node
        for spelling, source in list(self.sources.items()):
            if spelling in self.sources and not graph.rights.allows_source(source):
                self.unadvertise(Unadvertise(topic=spelling))
                self._client.report_withdrawn("publish", source.topic.name)
            yield
        for spelling, subscription in list(self.subscriptions.items()):
            name = subscription.topic.name
            if spelling in self.subscriptions and not graph.rights.allows(node, "subscribe", name):
                self.unsubscribe(Unsubscribe(topic=spelling))
                self._client.report_withdrawn("subscribe", name)
            yield

    def leave(self) -> Removals:
        """Publish the wills, accept nothing more, and return what is to be removed."""
        if self._pending is not None:
            self._pending.close()
        if self._wills is not None:
            self._wills.publish()
        sources, self._spellings = list(self._spellings), {}
        subscriptions = [*self.subscriptions.values(), *chain(*self._more.values())]
        self.subscriptions = {}
        self._more.clear()
        self.sources.clear()
        self._advertisements.clear()
        self._numbered.clear()
        graph = self._client.graph
        graph.abandon(chain(sources, subscriptions))
        return (
            (graph.remove_source, sources),
            (lambda subscription: subscription.cancel(None), subscriptions),
        )

    def _watch(
        self, request: Advertise | Subscribe, topic: Topic, peers: PeerWatch, owner: object
    ) -> None:
        """Send the client its peers from now on, if a request asks for them."""
        if request.peers:
            client = self._client
            view = client.graph.view(client.node)
            shows = view.sees_node if view.hides_users(topic) else None
            reports = PeerReports(peers, request, client.queue, client.clock, shows)
            peers.add(owner, request.id, reports)
        else:
            peers.cancel(owner, request.id)

    def _topic(self, spelling: str) -> Topic:
        return self._client.graph.topic(self._client.resolve(spelling))


class PendingPublishes:
    """Messages of a client that has just connected and not advertised yet; they wait for that.

    roslibpy that has lost its hub and found it again publishes for a second before it advertises
    again.
    """

    def __init__(self, topics: RosbridgeTopics) -> None:
        self._topics = topics
        self._clock = topics._client.clock
        self._end = topics._grace_ends
        self._waiting: dict[str, list[tuple[int, Publish]]] = {}
        """By topic; all are numbered in the order in which they came."""
        self._numbers = count()
        self.size = 0
        """Bytes of all of them."""
        self._timer: Timer | None = None

    def put(self, topic: str, message: Publish) -> bool:
        """Keep a message until its topic has a type; return whether there is room for it."""
        now = self._clock.time()
        size = _size(message)
        if now >= self._end or self.size + size > MOST_PENDING_BYTES:
            return False
        self._waiting.setdefault(topic, []).append((next(self._numbers), message))
        self.size += size
        if self._timer is None:
            self._timer = self._clock.call_later(self._end - now, self._give_up)
        return True

    def take(self, topic: str) -> list[Publish]:
        """Remove and return the messages of a topic."""
        taken = [message for _, message in self._waiting.pop(topic, ())]
        self.size -= sum(map(_size, taken))
        return taken

    def close(self) -> None:
        """Drop all messages."""
        self._waiting.clear()
        self.size = 0
        if self._timer is not None:
            self._timer.cancel()

    def _give_up(self) -> None:
        late, self._waiting = self._waiting, {}
        self.size = 0
        for _, message in sorted(chain(*late.values()), key=itemgetter(0)):
            self._topics._publish_late(message)


def _size(message: Publish) -> int:
    return len(encode(message)) + PENDING_COST
