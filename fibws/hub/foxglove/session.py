"""Foxglove sessions: what one client of Foxglove's WebSocket protocol asks for.

A session is synchronous and knows no socket: messages come in by `FoxgloveSession.receive_text` and
`receive_binary`, frames go out by the client's send queue. Each part of the protocol has a handler:
`topics`, `services`, `parameters`, and the `feeds` that describe the graph.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import assert_never

from fibws.access.rights import Principal
from fibws.errors import AuthenticationError, FibwsError, InvalidUtf8, OperationError
from fibws.hub.delivery.clock import Clock, Workers
from fibws.hub.errors import LimitReached
from fibws.hub.foxglove.assets import MOST_HELD, AssetFiles, Assets
from fibws.hub.foxglove.client import FoxgloveClient, FoxgloveStatuses
from fibws.hub.foxglove.feeds import (
    Application,
    ChannelFeed,
    GraphFeed,
    GraphKey,
    Schemas,
    ServiceFeed,
    ServiceFeeds,
    UndefinedFeed,
)
from fibws.hub.foxglove.messages import (
    ENCODINGS,
    AdvertiseChannels,
    ClientMessage,
    ClientRequest,
    FetchAsset,
    GetParameters,
    Operation,
    SetParameters,
    SubscribeChannels,
    SubscribeConnectionGraph,
    SubscribeParameterUpdates,
    UnadvertiseChannels,
    UnsubscribeChannels,
    UnsubscribeConnectionGraph,
    UnsubscribeParameterUpdates,
    parse_binary,
    parse_operation,
    text_frame,
    time_frame,
)
from fibws.hub.foxglove.parameters import ParameterAccess
from fibws.hub.foxglove.playback import NANOSECONDS, PlaybackControl
from fibws.hub.foxglove.services import FoxgloveCalls
from fibws.hub.foxglove.topics import Groups, Publications, Subscriptions, unknown_channel
from fibws.hub.foxglove.turns import FeedTurns
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.topic import Topic
from fibws.hub.log.audit import Audit
from fibws.hub.log.text import INTERNAL_ERROR, is_power_of_ten
from fibws.hub.memory.byte_room import ByteRoom
from fibws.hub.node_session import NodeSession
from fibws.hub.settings import Settings
from fibws.hub.websocket.endpoint import Opening, Registration, Work
from fibws.protocol.websocket import Payload

CAPABILITIES = (
    *("clientPublish", "parameters", "parametersSubscribe"),
    *("services", "connectionGraph"),
)
"""The capabilities of every hub."""
ASSETS = "assets"
"""The capability of a hub that has files of robots."""
PLAYBACK = "playbackControl"
"""The capability of a hub on which a bag is played."""
TIME = "time"
"""The capability of a hub that sends the time: while it is simulated."""
ROS_DISTRO = "noetic"
"""Makes the applications interpret types as ROS 1's."""


def ignore(node: str, text: str) -> None:
    """Report nothing."""


class Foxglove:
    """Foxglove's protocol of one hub: makes a session for each connection.

    Args:
        name: the hub's, which the applications show.
        readers: read files, beside the work of others: a disk may hang.
        assets: finds the files of robots; None without any.
        report: takes the node and the reason of each operation that failed.
    """

    def __init__(
        self,
        graph: Graph,
        clock: Clock,
        settings: Settings,
        audit: Audit,
        *,
        name: str,
        readers: Workers,
        assets: AssetFiles | None = None,
        asset_room: ByteRoom | None = None,
        report: Callable[[str, str], object] = ignore,
    ) -> None:
        self.graph = graph
        self.clock = clock
        self.settings = settings
        self.audit = audit
        self.name = name
        self.assets = assets
        self.readers = readers
        self.asset_room = asset_room or ByteRoom(MOST_HELD)
        self.report = report
        self.session_id = secrets.token_hex(8)
        """The id by which clients that reconnect know whether the hub has restarted."""
        self.schemas = Schemas()
        self.services = ServiceFeeds(graph)
        self.groups: Groups = {}
        self.sessions: set[FoxgloveSession] = set()
        self.turns = FeedTurns(clock)
        self._topics: dict[str, None] = {}
        """Topics that have changed, of which the sessions are still to be told."""
        self._services: dict[str, None] = {}
        """Services that were added or removed, likewise."""
        self._was_simulated = graph.clock.simulated is not None
        graph.watch_topics(self._topic_changed)
        graph.watch("service", self._service_changed)
        graph.parameters.watch(self._parameter_changed)
        graph.clock.watch(self._time_changed)

    def open(self, opening: Opening, protocol: str) -> FoxgloveSession:
        """Return a new session.

        Raises:
            AuthenticationError: the client has sent no token, which it could not do later.
            NotAllowed: it may not be the node that it wants to be.
        """
        if opening.log_in is not None and opening.principal is None:
            raise AuthenticationError("missing token: append ?token=... to the address")
        return FoxgloveSession(self, opening, protocol)

    def left(self, session: FoxgloveSession) -> None:
        """Forget a session; the second time nothing happens."""
        self.sessions.discard(session)
        if not self.sessions:
            self.turns.cancel(self._tell)
            self._topics.clear()
            self._services.clear()

    def _topic_changed(self, topic: Topic) -> None:
        if self.sessions:
            self._topics[topic.name] = None
            self.turns.wait(self._tell)

    def _service_changed(self, name: str) -> None:
        if self.sessions:
            self._services[name] = None
            self.turns.wait(self._tell)

    def _tell(self) -> None:
        """Tell the sessions together of all that has changed, each in its turn."""
        topics, self._topics = self._topics, {}
        services, self._services = self._services, {}
        for session in self.sessions:
            self.turns.wait(partial(session.changed, topics, services))

    def _parameter_changed(self, name: str, node: str) -> None:
        for session in self.sessions:
            session.parameters.changed(name)

    def _time_changed(self) -> None:
        is_simulated = self.graph.clock.simulated is not None
        for session in self.sessions:
            if is_simulated is not self._was_simulated:
                session.introduce()
            session.send_time()
        self._was_simulated = is_simulated


class FoxgloveSession(NodeSession[FoxgloveClient], Application):
    """One client's session, from its handshake until it leaves; an `Endpoint` and a `GraphNode`."""

    __slots__ = (
        "_assets",
        "_channels",
        "_dropped",
        "_foxglove",
        "_graph_feed",
        "_playback",
        "_publications",
        "_services",
        "_subscriptions",
        "_undefined",
        "calls",
        "parameters",
        "protocol",
    )

    def __init__(self, foxglove: Foxglove, opening: Opening, protocol: str) -> None:
        graph = foxglove.graph
        self.protocol = protocol
        self._foxglove = foxglove
        self._close = opening.close
        self._dropped = 0
        """Messages dropped because the client sends too much."""
        self.node = graph.enter(self, opening.node, opening.principal)
        self._client = client = FoxgloveClient(
            self.node,
            graph,
            graph.view(self.node),
            opening.queue,
            foxglove.clock,
            foxglove.settings,
            FoxgloveStatuses(self.node, opening.queue, foxglove.report),
            foxglove.audit,
            opening.check_room,
            foxglove.turns,
        )
        self._subscriptions = Subscriptions(client, foxglove.groups)
        self._publications = Publications(client)
        self._channels = ChannelFeed(client, foxglove.schemas, self._subscriptions.end)
        self._undefined = UndefinedFeed(client)
        self._services = ServiceFeed(client, foxglove.services)
        self._graph_feed: GraphFeed | None = None
        self._playback = PlaybackControl(client, self.introduce)
        self._assets = Assets(client, foxglove.assets, foxglove.readers, foxglove.asset_room)
        self.calls = FoxgloveCalls(client, self._services)
        self.parameters = ParameterAccess(client)
        foxglove.sessions.add(self)
        self.introduce()
        self.send_time()
        self._channels.open(graph.topics)
        self._undefined.open(graph.topics)
        self._services.open(graph.services)
        self._playback.changed(*graph.services)

    # As an endpoint.

    @property
    def incomplete_bytes(self) -> int:
        """Bytes that are kept of an answer."""
        return self.parameters.answer_bytes

    def receive_text(self, data: Payload) -> Work:
        """Perform an operation, its items one by one; reply to errors with a status.

        The steps raise `InvalidUtf8` if the bytes are not UTF-8.
        """
        try:
            yield from self._perform(parse_operation(data))
        except InvalidUtf8:
            raise
        except FibwsError as error:
            self._client.statuses.error(str(error), code=error.code)
        except Exception as fault:
            self._client.statuses.error(INTERNAL_ERROR, fault=fault)

    def receive_binary(self, data: Payload) -> None:
        """Publish a message, or call a service; reply to errors with a status."""
        try:
            message = parse_binary(data)
            if isinstance(message, ClientMessage):
                self._publications.publish(*message)
            elif isinstance(message, ClientRequest):
                self.calls.call(message)
            else:
                self._playback.control(message)
        except FibwsError as error:
            self._client.statuses.error(str(error), code=error.code)
        except Exception as fault:
            self._client.statuses.error(INTERNAL_ERROR, fault=fault)

    def refuse(self, data: Payload, reason: str, *, is_text: bool) -> None:
        """Drop a message that is published, and count it; refuse anything else.

        Raises:
            InvalidUtf8: it is a text, but not UTF-8.
        """
        try:
            if is_text:
                operation = parse_operation(data)
                raise LimitReached(f"{operation.op}: {reason}")
            message = parse_binary(data)
            if isinstance(message, ClientRequest):
                self.calls.refuse(message, reason)
                return
            if not isinstance(message, ClientMessage):
                raise LimitReached(f"playback: {reason}")
            self._dropped += 1
            if is_power_of_ten(self._dropped):
                raise LimitReached(f"{reason}; messages dropped: {self._dropped}")
        except OperationError as error:
            self._client.statuses.error(str(error), code=error.code)

    def registrations(self, what: Registration) -> int:
        """Return the number of the client's subscriptions or advertisements."""
        if what == "subscriptions":
            return len(self._subscriptions.by_id)
        return len(self._publications)

    def authorize(self, principal: Principal) -> Work:
        """Use the rights of a principal from now on; see `Endpoint.authorize`."""
        graph = self._client.graph
        graph.authorize(self, self.node, principal)
        self._channels.changed(*graph.topics, *self._channels.known)
        self._undefined.changed(*graph.topics, *self._undefined.known)
        self._services.changed(*graph.services, *self._services.known)
        self._playback.changed(*graph.services)
        if self._graph_feed is not None:
            self._graph_feed.changed(*_graph_keys(graph), *self._graph_feed.known)
        parts = (self.calls, self._playback, self._publications, self._subscriptions)
        return self._withdraw_forbidden(parts)

    def leave(self) -> Work:
        """Take the client's node back; see `Endpoint.leave`. The second time nothing happens."""
        self._foxglove.left(self)
        feeds = (self._channels, self._undefined, self._services, self._graph_feed)
        ends = [part.leave for part in (self.parameters, self._assets, self._playback)]
        ends += [feed.close for feed in feeds if feed is not None]
        return self._leave((self.calls, self._publications, self._subscriptions), ends)

    # As a node.

    def publishing(self) -> set[str]:
        """Return the global names of the topics that the client publishes."""
        return self._publications.names()

    def subscribing(self) -> set[str]:
        """Return the global names of the topics that the client subscribes to."""
        return self._subscriptions.names().union(self._playback.names())

    def providing(self) -> Sequence[str]:
        """Return nothing: clients of this protocol serve no services."""
        return ()

    # What the hub reports.

    def introduce(self) -> None:
        """Say what the hub can do: once, and when its time begins or ends to be simulated."""
        self._client.queue.reply_fresh(self._server_info)

    def send_time(self) -> None:
        """Send the time if it is simulated; a client that does not read gets the newest only."""
        if self._client.graph.clock.simulated is not None:
            self._client.queue.reply_fresh(self._time)

    def changed(self, topics: Iterable[str], services: Iterable[str]) -> None:
        """Called when topics' users or types have changed, or services were added or removed.

        Nothing happens once the client has left.
        """
        if self not in self._foxglove.sessions:
            return
        self._channels.changed(*topics)
        self._undefined.changed(*topics)
        self._services.changed(*services)
        self._playback.changed(*topics, *services)
        if self._graph_feed is not None:
            self._graph_feed.changed(
                *((False, name) for name in topics), *((True, name) for name in services)
            )

    def _server_info(self) -> bytes:
        capabilities = list(CAPABILITIES)
        if self._foxglove.assets is not None:
            capabilities.append(ASSETS)
        if self._client.graph.clock.simulated is not None:
            capabilities.append(TIME)
        start = end = None
        if self._playback.range is not None:
            capabilities.append(PLAYBACK)
            start, end = map(_split, self._playback.range)
        return text_frame(
            "serverInfo",
            name=self._foxglove.name,
            capabilities=capabilities,
            supportedEncodings=ENCODINGS,
            metadata={"ROS_DISTRO": ROS_DISTRO},
            sessionId=self._foxglove.session_id,
            dataStartTime=start,
            dataEndTime=end,
        )

    def _time(self) -> bytes:
        simulated = self._client.graph.clock.simulated
        return b"" if simulated is None else time_frame(simulated)

    # Operations.

    # One case for each operation, all of which mypy demands.
    def _perform(self, operation: Operation) -> Work:  # noqa: C901
        match operation:
            case SubscribeChannels():
                yield from self._subscribe(operation)
            case UnsubscribeChannels():
                yield from self._unsubscribe(operation)
            case AdvertiseChannels():
                yield from self._advertise(operation)
            case UnadvertiseChannels():
                yield from self._unadvertise(operation)
            case GetParameters():
                yield from self.parameters.get(operation)
            case SetParameters():
                yield from self.parameters.set(operation)
            case SubscribeParameterUpdates():
                yield from self.parameters.watch(operation.names)
            case UnsubscribeParameterUpdates():
                yield from self.parameters.unwatch(operation.names)
            case SubscribeConnectionGraph():
                self._follow_graph()
            case UnsubscribeConnectionGraph():
                self._unfollow_graph()
            case FetchAsset():
                self._assets.fetch(operation)
            case _:
                assert_never(operation)

    def _subscribe(self, request: SubscribeChannels) -> Work:
        """Subscribe to some channels; one that fails does not affect the others."""
        for each in request.subscriptions:
            try:
                channel = self._channels.find(each.channel)
                if channel is None:
                    raise unknown_channel(each.channel)
                self._subscriptions.add(each.id, channel)
            except FibwsError as error:
                self._client.statuses.error(f"subscribe: {error}", code=error.code)
            yield

    def _unsubscribe(self, request: UnsubscribeChannels) -> Work:
        for id_ in request.subscriptions:
            self._subscriptions.remove(id_)
            yield

    def _advertise(self, request: AdvertiseChannels) -> Work:
        """Publish some topics; one that fails does not affect the others."""
        for channel in request.channels:
            try:
                self._publications.add(channel)
            except FibwsError as error:
                text = f"advertise: {channel.topic}: {error}"
                self._client.statuses.error(text, code=error.code)
            yield

    def _unadvertise(self, request: UnadvertiseChannels) -> Work:
        for id_ in request.channels:
            self._publications.remove(id_)
            yield

    def _follow_graph(self) -> None:
        if self._graph_feed is None:
            self._graph_feed = GraphFeed(self._client)
            self._graph_feed.open(_graph_keys(self._client.graph))

    def _unfollow_graph(self) -> None:
        if self._graph_feed is not None:
            self._graph_feed.close()
            self._graph_feed = None


def _graph_keys(graph: Graph) -> list[GraphKey]:
    """Return the keys of everything that a `GraphFeed` is about."""
    topics, services = graph.topics, graph.services
    return [*((False, name) for name in topics), *((True, name) for name in services)]


def _split(time: int) -> dict[str, int]:
    """Return a time in nanoseconds as the server's description has it."""
    sec, nsec = divmod(time, NANOSECONDS)
    return {"sec": sec, "nsec": nsec}
