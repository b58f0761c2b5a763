"""A session: what one client does, operation by operation.

Synchronous and without a socket: text comes in by `Session.receive`, frames go out by the outbox.
What an operation does is told in the part that it belongs to: `topics`, `calls` and `services`,
`goals` and `actions`.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from typing import Any, assert_never

from fibws.errors import FibwsError, InvalidUtf8, OperationError
from fibws.hub.clock import Clock
from fibws.hub.graph.graph import Graph
from fibws.hub.outbox import Outbox
from fibws.hub.session.actions import Actions
from fibws.hub.session.calls import Calls
from fibws.hub.session.client import Client
from fibws.hub.session.goals import Goals
from fibws.hub.session.services import Services
from fibws.hub.session.statuses import Statuses
from fibws.hub.session.topics import Topics
from fibws.hub.settings import Settings
from fibws.protocol.cbor import object_of_cbor
from fibws.protocol.closing import REPLACED, Closing
from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import (
    ActionFeedback,
    ActionResult,
    Advertise,
    AdvertiseAction,
    AdvertiseService,
    Auth,
    CallService,
    CancelActionGoal,
    Fragment,
    Publish,
    Request,
    SendActionGoal,
    ServiceResponse,
    SetLevel,
    Subscribe,
    Unadvertise,
    UnadvertiseAction,
    UnadvertiseService,
    Unsubscribe,
)
from fibws.protocol.parsing import REQUESTS, parse_request
from fibws.protocol.text import objects

MAX_OBJECTS = 1000
"""Operations in one text: a megabyte of ``{}{}{}`` would keep all others waiting."""


class Session:
    """One client's part in the graph, from its handshake to its leaving.

    Args:
        node: the client's global name, or None for one of the hub's making.
        close: closes the client's connection.
    """

    __slots__ = (
        "_actions",
        "_calls",
        "_client",
        "_close",
        "_goals",
        "_reassembly",
        "_services",
        "node",
        "topics",
    )

    def __init__(
        self,
        node: str | None,
        graph: Graph,
        outbox: Outbox,
        clock: Clock,
        settings: Settings,
        close: Callable[[Closing], None],
    ) -> None:
        self._close = close
        self._reassembly: Reassembly | None = None
        self.node = graph.enter(self, node)
        statuses = Statuses(self.node, outbox)
        self._client = Client(self.node, graph, outbox, clock, settings, statuses)
        self.topics = Topics(self._client)
        # Most clients have to do with topics alone, and there may be thousands of them.
        self._calls: Calls | None = None
        self._services: Services | None = None
        self._goals: Goals | None = None
        self._actions: Actions | None = None

    @property
    def calls(self) -> Calls:
        """What the client calls."""
        if self._calls is None:
            self._calls = Calls(self._client)
        return self._calls

    @property
    def services(self) -> Services:
        """What the client is called for."""
        if self._services is None:
            self._services = Services(self._client)
        return self._services

    @property
    def goals(self) -> Goals:
        """What the client wants done."""
        if self._goals is None:
            self._goals = Goals(self._client)
        return self._goals

    @property
    def actions(self) -> Actions:
        """What the client does for others."""
        if self._actions is None:
            self._actions = Actions(self._client)
        return self._actions

    def receive(self, data: bytes) -> None:
        """Do what a text asks for; what is wrong with it is answered by a status.

        Raises:
            InvalidUtf8: the bytes are no text.
        """
        try:
            self._perform_all(data)
        except OperationError as error:
            self._client.statuses.error(None, str(error))

    def receive_binary(self, data: bytes) -> None:
        """Do what binary data ask for: JSON text, as the real server takes it, or CBOR."""
        try:
            if data[:1] < b"\x80":  # No map in CBOR begins with an ASCII character.
                self.receive(data)
            else:
                self._perform(object_of_cbor(data), len(data))
        except (OperationError, InvalidUtf8) as error:
            self._client.statuses.error(None, f"Expected JSON text or CBOR: {error}")

    def replaced(self) -> None:
        """Another client has taken this one's name."""
        self.leave()
        self._close(REPLACED)

    def publishing(self) -> set[str]:
        """The global names of the topics that the client publishes."""
        return {publisher.topic.name for publisher in self.topics.publishers.values()}

    def subscribing(self) -> set[str]:
        """The global names of the topics that the client subscribes to."""
        return {each.topic.name for each in self.topics.subscriptions.values()}

    def providing(self) -> set[str]:
        """The global names of the services that the client provides."""
        names = set(self._services.names()) if self._services is not None else set()
        return names.union(self._actions.services() if self._actions is not None else ())

    def leave(self) -> None:
        """Take the client's registrations back; the second time nothing happens."""
        with ExitStack() as stack:  # Whatever fails of this, the rest is done.
            stack.callback(self._client.graph.leave, self, self.node)
            for part in (self._actions, self._goals, self._services, self._calls, self.topics):
                if part is not None:
                    stack.callback(part.leave)

    def _perform_all(self, data: bytes, *, reassembled: bool = False) -> None:
        size = len(data)
        for number, fields in enumerate(objects(data)):
            if number == MAX_OBJECTS:
                raise OperationError(f"Expected at most {MAX_OBJECTS} operations in one text")
            if reassembled and fields.get("op") == "fragment":
                raise OperationError("fragments within fragments are not put together")
            self._perform(fields, size)
            size = 0  # The bytes count once, however many operations share them.

    def _perform(self, fields: dict[str, Any], size: int) -> None:
        try:
            topic = fields.get("topic")
            if fields.get("op") == "publish" and isinstance(topic, str):
                # Nearly every operation is this one. With a publisher at hand it needs no model:
                # but for its topic and its message, its fields mean nothing any more.
                publisher = self.topics.publishers.get(topic)
                if publisher is not None and "to" not in fields:
                    self.topics.publish(publisher, fields.get("msg"), fields.get("id"), size)
                    return
            self._handle(parse_request(fields))
        except FibwsError as error:
            self._refuse(fields, str(error))
        except Exception as fault:
            self._refuse(fields, "this failed in the hub, whose log says why", fault)

    def _refuse(self, fields: dict[str, Any], text: str, fault: Exception | None = None) -> None:
        """Say what is wrong with an operation; who waits because of it is told as well."""
        operation, id_ = fields.get("op"), fields.get("id")
        prefix = f"{operation}: " if operation in REQUESTS else ""
        self._client.statuses.error(id_, f"{prefix}{text}", fault)
        match operation:
            case "call_service":
                self.calls.refuse(fields, text)
            case "service_response":
                self.services.spoil(id_, text)
            case "send_action_goal":
                self.goals.refuse(fields, text)
            case "action_result":
                self.actions.spoil(id_, text)

    def _handle(self, request: Request) -> None:
        match request:
            case Publish():
                self.topics.publish_parsed(request)
            case CallService():
                self.calls.call(request)
            case ServiceResponse():
                self.services.respond(request)
            case Subscribe():
                self.topics.subscribe(request)
            case Unsubscribe():
                self.topics.unsubscribe(request)
            case Advertise():
                self.topics.advertise(request)
            case Unadvertise():
                self.topics.unadvertise(request)
            case AdvertiseService():
                self.services.advertise(request)
            case UnadvertiseService():
                self.services.unadvertise(request)
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
                self.actions.unadvertise(request)
            case Fragment():
                self._reassemble(request)
            case Auth():
                # A hub that asks nobody for a password has nothing against who shows one.
                self._client.statuses.warning(request.id, "auth: this hub asks for none")
            case SetLevel():
                self._client.statuses.set_level(request.level)
            case _:
                assert_never(request)

    def _reassemble(self, fragment: Fragment) -> None:
        client = self._client
        if self._reassembly is None:
            self._reassembly = Reassembly(max_size=client.settings.max_fragment_bytes)
        text = self._reassembly.add(fragment, client.clock.time())
        if text is not None:
            self._perform_all(text.encode(), reassembled=True)
