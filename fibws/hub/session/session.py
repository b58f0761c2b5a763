"""A session: what one client does, operation by operation.

Synchronous and without a socket: text comes in by `Session.receive`, frames go out by the outbox.
What an operation does is told in the part that it belongs to: `topics`, `services`, `actions`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, assert_never

from fibws.errors import FibwsError, OperationError
from fibws.hub.clock import Clock
from fibws.hub.graph.graph import Graph
from fibws.hub.outbox import Outbox
from fibws.hub.session.actions import Actions
from fibws.hub.session.client import Client
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
        "_client",
        "_close",
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
        self._services: Services | None = None
        self._actions: Actions | None = None

    @property
    def services(self) -> Services:
        """The client's services and calls."""
        if self._services is None:
            self._services = Services(self._client)
        return self._services

    @property
    def actions(self) -> Actions:
        """The client's actions and goals."""
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
            data.decode()
        except UnicodeDecodeError:
            try:
                self._perform(object_of_cbor(data))
            except OperationError as error:
                self._client.statuses.error(None, str(error))
        else:
            self.receive(data)

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
        return set(self._services.provided()) if self._services is not None else set()

    def leave(self) -> None:
        """Take the client's registrations back; the second time nothing happens."""
        self.topics.leave()
        if self._services is not None:
            self._services.leave()
        if self._actions is not None:
            self._actions.leave()
        self._client.graph.leave(self, self.node)

    def _perform_all(self, data: bytes, *, reassembled: bool = False) -> None:
        for number, fields in enumerate(objects(data)):
            if number == MAX_OBJECTS:
                raise OperationError(f"Expected at most {MAX_OBJECTS} operations in one text")
            if reassembled and fields.get("op") == "fragment":
                raise OperationError("fragments within fragments are not put together")
            self._perform(fields)

    def _perform(self, fields: dict[str, Any]) -> None:
        try:
            topic = fields.get("topic")
            if fields.get("op") == "publish" and isinstance(topic, str):
                # Nearly every operation is this one. With a publisher at hand it needs no model:
                # but for its topic and its message, its fields mean nothing any more.
                publisher = self.topics.publishers.get(topic)
                if publisher is not None:
                    self.topics.publish(publisher, fields.get("msg"), fields.get("id"))
                    return
            self._handle(parse_request(fields))
        except FibwsError as error:
            operation = fields.get("op")
            prefix = f"{operation}: " if operation in REQUESTS else ""
            self._client.statuses.error(fields.get("id"), f"{prefix}{error}")

    def _handle(self, request: Request) -> None:
        match request:
            case Publish():
                publisher = self.topics.advertise_by_publishing(request)
                self.topics.publish(publisher, request.msg, request.id)
            case CallService():
                self.services.call(request)
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
                self.actions.send_goal(request)
            case CancelActionGoal():
                self.actions.cancel_goal(request)
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
