"""Rosbridge sessions: the operations of one client.

A session is synchronous and knows no socket: messages come in by `RosbridgeSession.receive_text`
and `receive_binary`, frames go out by the client's send queue. Each operation is done by the
handler it belongs to: `topics`, `services` (calls and services), `actions` (goals and actions).

On connections of ``fibws.v1`` binary messages are serialized messages (`protocol.serialized`),
otherwise CBOR, or JSON as the real server takes it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import chain
from typing import Any, assert_never

from pydantic_core import from_json

from fibws.access.rights import Principal
from fibws.errors import AuthenticationError, FibwsError, InvalidUtf8, OperationError
from fibws.hub.delivery.clock import Clock, Workers
from fibws.hub.delivery.deflate import Deflater
from fibws.hub.errors import LimitReached, NotAllowed, TooManyAttempts
from fibws.hub.graph.graph import Graph
from fibws.hub.log.text import INTERNAL_ERROR, is_power_of_ten
from fibws.hub.node_session import NodeSession, RegisteringPart
from fibws.hub.rosbridge.actions import RosbridgeActions, RosbridgeGoals
from fibws.hub.rosbridge.client import RosbridgeClient
from fibws.hub.rosbridge.services import RosbridgeCalls, RosbridgeServices
from fibws.hub.rosbridge.statuses import Report, RosbridgeStatuses, ignore
from fibws.hub.rosbridge.subscription import Groups
from fibws.hub.rosbridge.topics import RosbridgeTopics
from fibws.hub.settings import Settings
from fibws.hub.websocket.endpoint import Opening, Registration, Work
from fibws.protocol.decoding import (
    REQUESTS,
    decode_cbor,
    decode_json,
    decode_operation,
    parse_request,
)
from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import (
    Acknowledge,
    ActionFeedback,
    ActionResult,
    Advertise,
    AdvertiseAction,
    AdvertiseService,
    Auth,
    CallService,
    CancelActionGoal,
    ClearWill,
    Fragment,
    Publish,
    Request,
    SendActionGoal,
    ServiceResponse,
    SetLevel,
    SetWill,
    Subscribe,
    Unadvertise,
    UnadvertiseAction,
    UnadvertiseService,
    Unsubscribe,
)
from fibws.protocol.serialized import SUBPROTOCOL, is_operation
from fibws.protocol.value_limits import FEWEST_BYTES, check_json
from fibws.protocol.websocket import (
    FORBIDDEN,
    LIMITED,
    MISSING_TOKEN,
    UNAUTHENTICATED,
    Payload,
    close_reason,
)

PUBLISH = re.compile(rb'\s*\{\s*"op"\s*:\s*"publish"\s*,')
"""How a text begins that publishes, as nearly all programs write it."""
SMALL = 4096
"""Bytes of a text that is decoded to find out what it is, although it is to be dropped."""

MAX_OBJECTS = 1000
"""Operations in one text."""


MOST_REFUSED = 100
"""Operations of a client without a token that are refused one by one."""


class Rosbridge:
    """The rosbridge protocol of one hub: makes a session for each connection.

    Args:
        clock: the event loop.
        workers: make frames that take long.
        deflater: compresses texts.
        report: takes the node and the reason of each operation that failed.
    """

    def __init__(
        self,
        graph: Graph,
        clock: Clock,
        settings: Settings,
        workers: Workers,
        deflater: Deflater,
        report: Report = ignore,
    ) -> None:
        self.report = report
        self.graph = graph
        self.clock = clock
        self.settings = settings
        self.groups = Groups(workers, deflater)
        self.servers: dict[str, RosbridgeServices] = {}
        """The clients that serve services, by the secrets in the ids of their calls."""

    def open(self, opening: Opening, *, serialized: bool = False) -> RosbridgeSession | TokenWait:
        """Return a new session, or what precedes it if the client has yet to send its token.

        Args:
            serialized: whether the connection speaks ``fibws.v1``.

        Raises:
            NotAllowed: the client may not be the node that it wants to be.
        """
        if opening.log_in is not None and opening.principal is None:
            return TokenWait(self, opening, serialized=serialized)
        return RosbridgeSession(self, opening, serialized=serialized)


class TokenWait:
    """An `Endpoint` for a client that has still to send its token by ``auth``."""

    node = ""
    protocol = "none"
    incomplete_bytes = 0

    def __init__(self, rosbridge: Rosbridge, opening: Opening, *, serialized: bool) -> None:
        self._rosbridge = rosbridge
        self._opening = opening
        self._serialized = serialized
        self._statuses = RosbridgeStatuses(
            "", opening.queue, codes=serialized, is_logged=False, is_page=opening.is_page
        )
        self._refused = 0

    def receive_text(self, data: Payload) -> Work:
        """Open the session if the client proves who it is; otherwise close the connection."""
        try:
            operations = _operations(data)
            for fields in operations:
                session = self._session(fields)
                yield
                if session is not None:
                    yield from session.perform_all(operations, 0)
                elif self._refused > MOST_REFUSED:
                    return
        except AuthenticationError as error:
            limited = isinstance(error, TooManyAttempts)
            self._end(LIMITED if limited else UNAUTHENTICATED, error)
        except NotAllowed as error:
            self._end(FORBIDDEN, error)
        except LimitReached as error:
            self._end(LIMITED, error)
        except OperationError as error:
            self._refuse(None, str(error), error.code)

    def receive_binary(self, data: Payload) -> None:
        """Refuse it: a token comes as text."""
        self._refuse(None, "binary messages need a token", AuthenticationError.code)

    def refuse(self, data: Payload, reason: str, *, is_text: bool) -> None:
        """Refuse it."""
        self._refuse(None, reason, LimitReached.code)

    def registrations(self, what: Registration) -> int:
        """Return 0: the client can register nothing."""
        return 0

    def authorize(self, principal: Principal) -> Work:
        """Do nothing: the client has no rights yet."""
        return iter(())

    def revoke(self) -> None:
        """Do nothing: the client has no rights yet."""

    def leave(self) -> Work:
        """Do nothing: the client has registered nothing."""
        return iter(())

    def _session(self, fields: dict[str, Any]) -> RosbridgeSession | None:
        """Return the session that ``auth`` opens; refuse all other operations."""
        operation = fields.get("op")
        if operation != "auth":
            text = f"{operation}: this hub needs a token; send it by the operation auth first"
            self._refuse(fields.get("id"), text, AuthenticationError.code)
            return None
        opening = self._opening
        assert opening.log_in is not None
        assert opening.replace is not None
        request = parse_request(fields)
        assert isinstance(request, Auth)
        principal = opening.log_in(token_of(request))
        session = RosbridgeSession(
            self._rosbridge, replace(opening, principal=principal), serialized=self._serialized
        )
        opening.replace(session)
        return session

    def _refuse(self, id_: object, text: str, code: str) -> None:
        self._refused += 1
        if self._refused == 1:  # The others are of the same client, which is closed in the end.
            self._opening.refused(text)
        if self._refused > MOST_REFUSED:
            self._opening.close(MISSING_TOKEN)
        else:
            self._statuses.error(id_, text, code=code)

    def _end(self, code: int, error: FibwsError) -> None:
        self._statuses.error(None, f"auth: {error}", code=error.code)
        self._opening.close(close_reason(code, str(error)))


def _operations(data: Payload) -> Iterator[dict[str, Any]]:
    """Yield the operations of a text, one at a time.

    Raises:
        OperationError: the text is not JSON, has a value that is not an object, or too many; the
            operations before that have been yielded.
        InvalidUtf8: it is not UTF-8.
    """
    check_json(data)
    left = MAX_OBJECTS
    for fields in decode_json(data):
        if not left:
            raise OperationError(f"Expected at most {MAX_OBJECTS} operations in one text")
        left -= 1
        yield fields
        del fields  # It must not outlive its operation.


def _without_fragments(operations: Iterator[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Yield the operations of a text that fragments made up; raise `OperationError` for others."""
    for fields in operations:
        if fields.get("op") == "fragment":
            raise OperationError("a fragment must not hold fragments")
        yield fields
        del fields


def token_of(request: Auth) -> str:
    """Return the token of an operation; raise `AuthenticationError` if it has none."""
    if request.token is None:
        raise AuthenticationError("missing token")
    return request.token


class RosbridgeSession(NodeSession[RosbridgeClient]):
    """One client's session, from its handshake until it leaves; an `Endpoint` and a `GraphNode`."""

    __slots__ = (
        "_actions",
        "_calls",
        "_count_operations",
        "_dropped",
        "_goals",
        "_log_in",
        "_reassembly",
        "_services",
        "_sources",
        "_statuses",
        "topics",
    )

    def __init__(
        self,
        rosbridge: Rosbridge,
        opening: Opening,
        *,
        serialized: bool,
    ) -> None:
        graph, queue = rosbridge.graph, opening.queue
        self._close = opening.close
        self._count_operations = opening.count_operations
        self._log_in = opening.log_in
        self._dropped = 0
        """Messages dropped because the client sends too much."""
        self._reassembly: Reassembly | None = None
        self.node = graph.enter(self, opening.node, opening.principal)
        self._statuses = RosbridgeStatuses(
            self.node,
            queue,
            rosbridge.report,
            codes=serialized,
            is_page=opening.is_page and not serialized,
        )
        self._client = RosbridgeClient(
            self.node,
            graph,
            rosbridge.groups,
            rosbridge.servers,
            queue,
            rosbridge.clock,
            rosbridge.settings,
            self._statuses,
            serialized,
            opening.check_room,
        )
        self.topics = RosbridgeTopics(self._client)
        self._sources = self.topics.sources
        # Most clients use topics alone, and there may be thousands of them.
        self._calls: RosbridgeCalls | None = None
        self._services: RosbridgeServices | None = None
        self._goals: RosbridgeGoals | None = None
        self._actions: RosbridgeActions | None = None

    @property
    def calls(self) -> RosbridgeCalls:
        """The services that the client calls."""
        if self._calls is None:
            self._calls = RosbridgeCalls(self._client)
        return self._calls

    @property
    def services(self) -> RosbridgeServices:
        """The services that the client serves."""
        if self._services is None:
            self._services = RosbridgeServices(self._client)
        return self._services

    @property
    def goals(self) -> RosbridgeGoals:
        """The goals that the client sends."""
        if self._goals is None:
            self._goals = RosbridgeGoals(self._client)
        return self._goals

    @property
    def actions(self) -> RosbridgeActions:
        """The actions that the client serves."""
        if self._actions is None:
            self._actions = RosbridgeActions(self._client)
        return self._actions

    # As an endpoint.

    @property
    def protocol(self) -> str:
        """The protocol's name."""
        return SUBPROTOCOL if self._client.serialized else "rosbridge"

    @property
    def incomplete_bytes(self) -> int:
        """Bytes that are kept of fragments, and of messages that wait for their topic's type."""
        fragments = self._reassembly.size if self._reassembly is not None else 0
        return fragments + self.topics.pending_bytes

    def receive_text(self, data: Payload) -> Work | None:
        """Perform the operations in a text, the only one at once; reply to errors with a status.

        The steps raise `InvalidUtf8` if the bytes are not UTF-8.
        """
        if len(data) <= FEWEST_BYTES:
            # Nearly every text: it is short, and one object.
            try:
                fields = from_json(data)
            except ValueError:
                fields = None
            if type(fields) is dict:
                return self.perform(fields, len(data))
            fields = None  # It may be large, and is decoded once more for the error.
        return self.perform_all(_operations(data), len(data))

    def receive_binary(self, data: Payload) -> Work | None:
        """Perform the operations of a binary message; reply to errors with a status."""
        if self._client.serialized:
            if is_operation(data):
                return self._perform_serialized(data)
            try:
                self.topics.publish_serialized(data)
            except Exception as error:
                self._refuse_serialized(error)
            return None
        if data[:1] < b"\x80":  # No map in CBOR begins with an ASCII character.
            return self._receive_binary_text(data)
        try:
            return self.perform(decode_cbor(bytes(data)), len(data))
        except OperationError as error:
            self._refuse_undecoded(error)
        return None

    def _perform_serialized(self, data: Payload) -> Work | None:
        """Perform an operation with serialized values; reply to errors with a status."""
        try:
            return self.perform(decode_operation(data), len(data))
        except FibwsError as error:
            self._statuses.error(None, str(error), code=error.code)
        return None

    def _receive_binary_text(self, data: Payload) -> Work:
        """Perform the operations of a JSON text that came as a binary message."""
        try:
            yield from self.receive_text(data) or ()
        except InvalidUtf8 as error:
            self._refuse_undecoded(error)

    def _refuse_undecoded(self, error: FibwsError) -> None:
        self._statuses.error(None, f"Expected JSON text or CBOR: {error}", code=error.code)

    def refuse(self, data: Payload, reason: str, *, is_text: bool) -> Work | None:
        """Drop what a message publishes; reply to each other operation with an error.

        Of a long text that begins with a publish, nothing more is looked at. The steps raise
        `InvalidUtf8` if it is a text, but not UTF-8.
        """
        if not is_text and self._client.serialized and not is_operation(data):
            self._drop(reason)
        elif not is_text and self._client.serialized:
            try:
                self._refuse_excess(decode_operation(data), reason)
            except FibwsError as error:
                self._statuses.error(None, str(error), code=error.code)
        elif not is_text and data[:1] >= b"\x80":
            try:
                self._refuse_excess(decode_cbor(bytes(data)), reason)
            except OperationError as error:
                self._statuses.error(None, str(error), code=error.code)
        elif PUBLISH.match(data) and (len(data) > SMALL or data.count(b'"op"') == 1):
            self._drop(reason)
        else:
            return self._refuse_all(_operations(data), reason)
        return None

    def registrations(self, what: Registration) -> int:
        """Return how many of something the client has registered."""
        if what == "subscriptions":
            return self.topics.subscription_count
        services = self._services.names() if self._services is not None else ()
        actions = self._actions.services() if self._actions is not None else ()
        return len(self.topics.sources) + len(services) + len(actions)

    def authorize(self, principal: Principal) -> Work:
        """Use the rights of a principal from now on; see `Endpoint.authorize`."""
        self._client.graph.authorize(self, self.node, principal)
        return self._withdraw_forbidden(self._parts())

    def leave(self) -> Work:
        """Take the client's node back; see `Endpoint.leave`. The second time nothing happens."""
        self._reassembly = None
        return self._leave(self._parts())

    def _parts(self) -> list[RegisteringPart]:
        parts = (self._actions, self._goals, self._services, self._calls, self.topics)
        return [part for part in parts if part is not None]

    # As a node.

    def publishing(self) -> set[str]:
        """Return the global names of the topics that the client publishes."""
        return {source.topic.name for source in self.topics.sources.values()}

    def subscribing(self) -> set[str]:
        """Return the global names of the topics that the client subscribes to."""
        return {each.topic.name for each in self.topics.subscriptions.values()}

    def providing(self) -> set[str]:
        """Return the global names of the services that the client serves."""
        names = set(self._services.names()) if self._services is not None else set()
        return names.union(self._actions.services() if self._actions is not None else ())

    # Operations.

    def perform_all(self, operations: Iterator[dict[str, Any]], size: int) -> Work:
        """Perform the operations of a text, of which ``size`` bytes have come; reply to errors.

        The first one counts as the message itself, unless its bytes have counted before.
        """
        try:
            for fields in operations:
                work = self.perform(fields, size)
                if not size:
                    self._count_operations(1)
                size = 0  # The bytes count once, however many operations share them.
                del fields  # Not two at a time: they take many times their text's memory.
                yield
                if work is not None:
                    yield from work
        except OperationError as error:
            self._statuses.error(None, str(error), code=error.code)

    def perform(self, fields: dict[str, Any], size: int) -> Work | None:
        """Perform one operation, of which ``size`` bytes have come; reply to errors.

        Returns:
            What is left to do: the operations of a text that this was the last fragment of.
        """
        try:
            if fields.get("op") == "publish" and "to" not in fields:
                # Nearly every operation is this one. Once advertised it needs no model: apart from
                # its topic and its message, its fields mean nothing any more.
                topic = fields.get("topic")
                source = self._sources.get(topic) if type(topic) is str else None
                if source is not None:
                    msg = fields.get("msg")
                    source.publish(msg, size)
                    if self._statuses.wants_info:
                        self.topics.report_defaults(source, msg, fields.get("id"))
                    return None
            return self._handle(parse_request(fields))
        except FibwsError as error:
            self._refuse(fields, str(error), error.code)
        except Exception as fault:
            self._refuse(fields, INTERNAL_ERROR, "internal_error", fault)
        return None

    def _refuse_all(self, operations: Iterator[dict[str, Any]], reason: str) -> Work:
        """Refuse the operations of a text."""
        try:
            for fields in operations:
                self._refuse_excess(fields, reason)
                del fields
                yield
        except OperationError as error:
            self._statuses.error(None, str(error), code=error.code)

    def _refuse_excess(self, fields: dict[str, Any], reason: str) -> None:
        """Refuse an operation of a client that sends too much; messages are only counted."""
        if fields.get("op") == "publish":
            self._drop(reason)
        else:
            self._refuse(fields, reason, LimitReached.code)

    def _drop(self, reason: str) -> None:
        """Count a message that is dropped; report the 1st, the 10th, the 100th ..."""
        self._dropped += 1
        if is_power_of_ten(self._dropped):
            text = f"publish: {reason}; messages dropped: {self._dropped}"
            self._statuses.error(None, text, code=LimitReached.code)

    def _refuse_serialized(self, error: Exception) -> None:
        if isinstance(error, FibwsError):
            self._statuses.error(None, f"publish: {error}", code=error.code)
        else:
            text = f"publish: {INTERNAL_ERROR}"
            self._statuses.error(None, text, error, code="internal_error")

    def _refuse(
        self, fields: dict[str, Any], text: str, code: str, fault: Exception | None = None
    ) -> None:
        """Report the error of an operation, also to the client that waits for its outcome."""
        operation, id_ = fields.get("op"), fields.get("id")
        prefix = f"{operation}: " if operation in REQUESTS else ""
        self._statuses.error(id_, f"{prefix}{text}", fault, code)
        match operation:
            case "advertise":
                self.topics.refuse_advertise(fields, text, code)
            case "call_service":
                self.calls.refuse(fields, text, code)
            case "service_response":
                self.services.fail_malformed_response(id_, text, code)
            case "send_action_goal":
                self.goals.refuse(fields, text, code)
            case "action_result":
                self.actions.fail_malformed_result(id_, text, code)

    # One case for each operation, all of which mypy demands.
    def _handle(self, request: Request) -> Work | None:  # noqa: C901, PLR0912
        match request:
            case Publish():
                self.topics.publish(request)
            case CallService():
                self.calls.call(request)
            case ServiceResponse():
                self.services.respond(request)
            case Subscribe():
                self.topics.subscribe(request)
            case Unsubscribe():
                self.topics.unsubscribe(request)
            case Acknowledge():
                self.topics.acknowledge(request)
            case Advertise():
                self.topics.advertise(request)
            case Unadvertise():
                self.topics.unadvertise(request)
            case AdvertiseService():
                self.services.advertise(request)
            case UnadvertiseService():
                return self.services.unadvertise(request)
            case SendActionGoal():
                self.goals.send(request)
            case CancelActionGoal():
                self.goals.cancel(request)
            case ActionFeedback():
                self.actions.feedback(request)
            case ActionResult():
                self.actions.result(request)
            case AdvertiseAction():
                self.actions.advertise(request)
            case UnadvertiseAction():
                return self.actions.unadvertise(request)
            case Fragment():
                return self._reassemble(request)
            case Auth():
                return self._authenticate(request)
            case SetWill():
                self.topics.set_will(request)
            case ClearWill():
                self.topics.clear_will(request)
            case SetLevel():
                self._statuses.set_level(request.level)
            case _:
                assert_never(request)
        return None

    def _authenticate(self, request: Auth) -> Work | None:
        """Change to the principal of a token; a wrong token changes nothing."""
        if self._log_in is None:
            # A hub without authentication accepts all credentials.
            text = "auth: ignored, no authentication is enabled"
            self._statuses.warning(request.id, text)
            return None
        principal = self._log_in(token_of(request))
        try:
            withdrawing = self.authorize(principal)
        except NotAllowed as error:
            # The client is whom it has proved to be, and that one may not be this node. Operations
            # in the same text must not outlive it.
            self.revoke()
            close = partial(self._close, close_reason(FORBIDDEN, str(error)))
            self._client.clock.call_later(0, close)
            raise
        text = f"auth: this client is {principal.name}"
        return chain(withdrawing, self._inform(request.id, text))

    def _inform(self, id_: Any, text: str) -> Work:
        self._statuses.info(id_, text)
        yield

    def _reassemble(self, fragment: Fragment) -> Work | None:
        """Add a fragment; return what is left to do if its text is complete."""
        client = self._client
        if self._reassembly is None:
            self._reassembly = Reassembly(max_size=client.settings.max_fragment_bytes)
        text = self._reassembly.add(fragment, client.clock.time())
        if text is None:
            return None
        data = text.encode()
        del text
        return self.perform_all(_without_fragments(_operations(data)), len(data))
