"""A tool's connection to the hub: blocking, and quick to import.

Nothing is imported that only nodes need: asyncio and the models of operations take a fifth of a
second. The hub checks the operations that a tool sends.
"""

from __future__ import annotations

import json
import os
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple, Self, TypeAlias

from fibws import hub_address, names
from fibws.client.rosapi_schemas import RESPONSES, schema_error
from fibws.client.websocket import ReceivedMessage, WebSocket
from fibws.credentials import Credentials
from fibws.errors import (
    AccessDenied,
    AuthenticationError,
    MessageTooLarge,
    NoHub,
    OperationError,
    OperationRejected,
    ServiceError,
    ServiceTimeout,
    UnknownService,
)
from fibws.protocol.serialized import ROS1, read_delivery

PATIENCE = 5.0
"""Seconds to wait for the response of one of the hub's own services."""
MOST_KEPT = 10_000
"""Maximum number of operations that are kept during a call; more drop the oldest."""
QUEUE_LENGTH = 1000
"""Messages of a topic that the hub keeps for a tool that reads too slowly."""
CALL_ERRORS: dict[str, type[ServiceError]] = {
    "timeout": ServiceTimeout,
    "unknown_service": UnknownService,
}
"""The errors of failed calls by their codes; others are `ServiceError`."""

Operation: TypeAlias = dict[str, Any]


class RawMessage(NamedTuple):
    """A message of a topic that is not decoded."""

    data: bytes | memoryview
    type: str | None
    """The type of a message in ROS 1's serialization; None for a message in JSON."""


OnMessage: TypeAlias = Callable[[RawMessage], None]


class HubClient:
    """A connection to a hub, open once it is created: ``with HubClient("echo") as client``.

    Args:
        tool: the tool's name, which its node name begins with.
        hub: the hub's address; by default $FIBWS_HUB, or else this machine.
        remapping: the ``from:=to`` arguments of the tool's command line. ``__name`` replaces the
            tool's own name, as in rostopic, whose publishers are rospy nodes.

    Raises:
        InvalidAddress: the address is invalid.
        AccessError: the token is invalid, or its file cannot be read.
        NoHub: nothing listens there.
        HubUnreachable: the server is not a hub, or refuses the connection. A refused token raises
            `NotAuthorized` only as soon as the hub's reply is read.
    """

    def __init__(
        self, tool: str, hub: str | None = None, remapping: names.Remapping | None = None
    ) -> None:
        self.url = hub_address.hub_url(hub)
        self.credentials = Credentials.find(hub)
        """The tool's token: that in the hub's address, in $FIBWS_TOKEN or in $FIBWS_TOKEN_FILE."""
        self._remapping = remapping or names.Remapping()
        namespace = os.environ.get("ROS_NAMESPACE", "/")
        self.namespace = self._remapping.namespace or names.check_namespace(namespace)
        if self._remapping.node_name is not None:
            self.node = names.join(self.namespace, self._remapping.node_name)
        else:
            name = names.anonymous(f"fibws_{tool}", pid=os.getpid(), random=os.urandom(8))
            self.node = names.resolve(name)
        """The tool's global node name."""
        self._operations: deque[Operation] = deque()
        self._subscriptions: dict[str, _RawSubscription] = {}
        """Subscriptions to raw messages by their topics."""
        self._serialized: dict[int, tuple[_RawSubscription, str]] = {}
        """By the topics' numbers in binary frames: the subscription and the topic's type."""
        self._numbers = 0
        self._socket = WebSocket(self.url, self.node, self.credentials)
        self.url = self._socket.url

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *error: object) -> None:
        if kind is not None and issubclass(kind, KeyboardInterrupt):
            self._socket.abort()
        else:
            self.close()

    def close(self) -> None:
        """Close the connection after the hub has read everything that was sent."""
        self._socket.close()

    @property
    def headers(self) -> Mapping[str, str]:
        """The headers of the tool's token, for HTTP requests to the hub."""
        return self._socket.headers

    def certificate_end(self) -> float | None:
        """Return when the hub's certificate ends, in seconds since 1970; None without TLS."""
        return self._socket.certificate_end()

    def fileno(self) -> int:
        """Return the socket's descriptor for ``select``."""
        return self._socket.fileno()

    def resolve(self, name: str) -> str:
        """Return the global name that a name stands for after remapping; it need not exist.

        Raises:
            InvalidName: the name is invalid; one that is not legal in ROS may exist all the same.
        """
        resolved = names.resolve_any(name, namespace=self.namespace, node=self.node)
        for source, target in self._remapping.names.items():
            if names.resolve(source, namespace=self.namespace, node=self.node) == resolved:
                return names.resolve(target, namespace=self.namespace, node=self.node)
        return resolved

    def resolve_namespace(self, name: str) -> str:
        """Return the global namespace for a name, which may end in ``/``."""
        name = name.rstrip("/")
        return self.resolve(name) if name else "/"

    def send(self, operation: Operation) -> None:
        """Send an operation; if the hub refuses it, `receive` returns a status.

        Raises:
            MessageTooLarge: the hub does not take it.
            HubLost: the connection is lost.
        """
        text = _json(operation)
        if len(text) > self._socket.largest:
            names = (operation.get(field) for field in ("topic", "service", "action", "op"))
            raise MessageTooLarge(str(next(filter(None, names))), len(text), self._socket.largest)
        self._socket.send(text)

    def receive(self, timeout: float | None = None) -> Operation | None:
        """Return the hub's next operation, or None after ``timeout`` seconds.

        Messages of `subscribe_raw` are not returned; its callbacks are called.

        Raises:
            HubLost: the connection is lost.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while not self._operations:
            rest = None if deadline is None else deadline - time.monotonic()
            if not self._read(rest) or (rest is not None and rest <= 0 and not self._operations):
                return None
        return self._operations.popleft()

    def subscribe(self, topic: str, *, queue_length: int = QUEUE_LENGTH) -> None:
        """Subscribe to a topic of any type; `messages` returns what is received.

        With headers, the hub writes infinity as a number, and not as null like NaN.
        """
        request = {"op": "subscribe", "topic": topic, "queue_length": queue_length}
        self.send({**request, "headers": True})

    def subscribe_raw(
        self, topic: str, on_message: OnMessage, *, queue_length: int = QUEUE_LENGTH
    ) -> None:
        """Subscribe to a topic of any type without decoding its messages.

        They are in ROS 1's serialization, or in JSON if the server cannot serialize them: it does
        not speak ``fibws.v1``, or the topic's type is not defined.

        Args:
            on_message: called with each message while the tool waits for the hub.
        """
        self._numbers += 1
        subscription = _RawSubscription(topic, on_message, queue_length, f"raw:{self._numbers}")
        self._subscriptions[topic] = subscription
        self.send(subscription.request(serialized=self._socket.serialized))

    def unsubscribe(self, topic: str) -> None:
        """Take back all subscriptions to a topic."""
        self._subscriptions.pop(topic, None)
        self.send({"op": "unsubscribe", "topic": topic})

    def messages(self, topic: str, timeout: float | None = None) -> Iterator[Any]:
        """Iterate over the messages of a topic that was subscribed to.

        It ends when none was received for ``timeout`` seconds; other operations are ignored.

        Raises:
            OperationRejected: the hub refused an operation.
            HubLost: the connection is lost.
        """
        while True:
            operation = self.receive(timeout)
            if operation is None:
                return
            if operation.get("op") == "publish" and operation.get("topic") == topic:
                message = operation.get("msg")
                if isinstance(message, dict):
                    yield message
            check(operation)

    def process(self, seconds: float | None = None) -> None:
        """Process what the hub sends, pings included, for ``seconds`` or without an end.

        Raises:
            OperationRejected: the hub refused an operation.
            HubLost: the connection is lost.
        """
        deadline = None if seconds is None else time.monotonic() + seconds
        rest = seconds
        while (operation := self.receive(rest)) is not None:
            check(operation)
            rest = None if deadline is None else max(0.0, deadline - time.monotonic())
            if rest == 0 and not self._operations:
                return  # A hub that sends without a pause must not delay the return.

    def wait(self, seconds: float) -> None:
        """Wait, and keep what the hub sends for `receive`.

        Raises:
            OperationRejected: the hub has refused an operation.
            HubLost: the connection is lost.
        """
        deadline = time.monotonic() + seconds
        while (rest := deadline - time.monotonic()) > 0:
            self._read(rest)
        for operation in self._operations:
            check(operation)

    def call(
        self,
        service: str,
        request: Operation | None = None,
        timeout: float = PATIENCE,
        headers: dict[str, str] | None = None,
    ) -> Response:
        """Call a service and return its response; other operations are kept for `receive`.

        Args:
            service: its global name.
            request: its arguments by name; missing ones have their defaults.
            timeout: maximum seconds to wait for the response; 0 for no limit.
            headers: sent with the request to a service server that asks for headers.

        Raises:
            UnknownService: the service has no server.
            ServiceTimeout: there was no response in time.
            ServiceError: the call failed; the text is the server's or the hub's. With a hub that
                does not speak ``fibws.v1``, it includes unknown services.
            HubLost: the connection is lost.
        """
        self._numbers += 1
        id_ = f"call:{self._numbers}"
        self.send(
            {
                "op": "call_service",
                "id": id_,
                "service": service,
                "args": request or {},
                **({"timeout": timeout} if timeout else {}),
                **({"headers": headers} if headers else {}),
            }
        )
        # The hub's own timeout comes first.
        deadline = time.monotonic() + timeout + 1 if timeout else None
        kept: deque[Operation] = deque(maxlen=MOST_KEPT)
        try:
            while True:
                rest = None if deadline is None else max(0.0, deadline - time.monotonic())
                operation = self.receive(rest)
                # A hub that sends other operations without a pause must not delay the timeout.
                is_over = rest == 0 and not self._operations and not _answers(operation, id_)
                if operation is None or is_over:
                    raise ServiceTimeout(service, f"no response within {timeout:g} s")
                if _answers(operation, id_):
                    return _response(service, operation)
                if operation.get("id") != id_:
                    kept.append(operation)
        finally:
            self._operations.extendleft(reversed(kept))

    def _read(self, timeout: float | None) -> bool:
        """Process what the hub sends; return False if that is nothing for ``timeout`` seconds."""
        is_news = self._socket.read(timeout)
        while self._socket.messages:
            self._take(self._socket.messages.popleft())
        return is_news

    def _take(self, message: ReceivedMessage) -> None:
        data = message.data
        if message.is_binary and self._socket.serialized:
            self._deliver(data)
            return
        for subscription in self._subscriptions.values():
            if data.startswith(subscription.before):
                text = memoryview(data)[len(subscription.before) : -1]
                subscription.on_message(RawMessage(text, None))
                return
        operation = self._operation(data)
        is_denied = operation.get("code") == AuthenticationError.code
        if is_denied and not self._socket.has_sent_token:
            raise self._socket.missing_token()
        if not self._handle(operation):
            self._operations.append(operation)

    def _deliver(self, data: bytes | bytearray) -> None:
        """Deliver a serialized message, unless its subscription has ended."""
        try:
            delivery = read_delivery(data)
        except OperationError as error:
            raise self._socket.not_a_hub(str(error)) from None
        subscription, type_ = self._serialized.get(delivery.topic, (None, None))
        if subscription is not None and self._subscriptions.get(subscription.topic) is subscription:
            subscription.on_message(RawMessage(delivery.message, type_))

    def _handle(self, operation: Operation) -> bool:
        """Handle an operation of a subscription to raw messages; return whether it is one."""
        match operation:
            case {"op": "subscribed", "id": id_, "topic_id": int(number), "type": str(type_)}:
                subscription = self._subscription(id_)
                if subscription is not None:
                    self._serialized[number] = subscription, type_
                    return True
            case {"op": "status", "level": "error", "id": id_, "code": "unknown_definition"}:
                subscription = self._subscription(id_)
                if subscription is not None and subscription.serialized:
                    # Such messages can only be had as JSON.
                    self.send(subscription.request(serialized=False))
                    return True
            case {"op": "publish", "topic": str(topic)} if topic in self._subscriptions:
                # Other servers may write the fields in another order.
                text = _json(operation.get("msg"))
                self._subscriptions[topic].on_message(RawMessage(text, None))
                return True
        return False

    def _subscription(self, id_: object) -> _RawSubscription | None:
        return next((each for each in self._subscriptions.values() if each.id == id_), None)

    def _operation(self, data: bytes | bytearray) -> Operation:
        try:
            operation = json.loads(data.decode())
        except (ValueError, RecursionError) as error:
            raise self._socket.not_a_hub(f"it sent invalid JSON: {error}") from None
        if not isinstance(operation, dict):
            start = data[:40].decode(errors="replace")
            raise self._socket.not_a_hub(f"it sent {start!r}, expected a JSON object")
        return operation


def is_hub_running(url: str | None = None, tool: str = "tool") -> bool:
    """Return whether a hub runs at an address, even if it wants another token.

    Args:
        url: the hub's address; by default as for `HubClient`.
        tool: the tool's name, which its node name begins with.

    Raises:
        InvalidAddress: the address is invalid.
        HubUnreachable: the server is not a hub, or refuses the connection.
    """
    try:
        HubClient(tool, url).close()
    except NoHub:
        return False
    except AccessDenied:
        pass  # Whether it arrives before the connection is closed depends on timing.
    return True


class _RawSubscription:
    """A subscription to the raw messages of a topic."""

    def __init__(self, topic: str, on_message: OnMessage, queue_length: int, id_: str) -> None:
        self.topic = topic
        self.on_message = on_message
        self.id = id_
        self.serialized = False
        """Whether serialized messages were requested."""
        self.before = b'{"op":"publish","topic":%b,"msg":' % _json(topic)
        """The text before a message in JSON, as fibws sends it; these need not be parsed."""
        self._queue_length = queue_length

    def request(self, *, serialized: bool) -> Operation:
        """Return the operation that requests messages, in ROS 1's serialization or in JSON."""
        self.serialized = serialized
        request = {
            "op": "subscribe",
            "id": self.id,
            "topic": self.topic,
            "queue_length": self._queue_length,
        }
        return request | ({"compression": ROS1} if serialized else {})


def check(operation: Operation) -> None:
    """Raise `OperationRejected` if an operation reports that the hub refused another one."""
    if operation.get("op") == "status" and operation.get("level") == "error":
        raise OperationRejected(str(operation.get("msg")))


def _answers(operation: Operation | None, id_: str) -> bool:
    """Return whether an operation is the response to the call of this id."""
    return (
        operation is not None
        and operation.get("id") == id_
        and operation.get("op") == "service_response"
    )


def _response(service: str, operation: Operation) -> Response:
    values = operation.get("values")
    if operation.get("result") is False:
        text = values if isinstance(values, str) else json.dumps(values)
        code = operation.get("code")
        raise CALL_ERRORS.get(str(code), ServiceError)(service, text, code)
    response = Response(service, values if isinstance(values, dict) else {})
    header = operation.get("header")
    response.header = header if isinstance(header, dict) else {}
    return response


class Response(dict[str, Any]):
    """The fields of a service's response by their names.

    Reading a field that is missing, or that does not fit the type of the hub's own service, raises
    `ServiceError`: other rosbridge servers may lack it.
    """

    def __init__(self, service: str, values: dict[str, Any]) -> None:
        super().__init__(values)
        self._service = service
        self.header: dict[str, str] = {}
        """If the call had headers: ``callerid``, the server's node."""

    def __getitem__(self, name: str) -> Any:
        value = super().__getitem__(name)
        schema = RESPONSES.get(self._service, {}).get(name)
        if schema is not None and (error := schema_error(value, schema, name)):
            raise self._error(f"returned an unexpected response, {error}")
        return value

    def __missing__(self, name: str) -> Any:
        raise self._error(f"returned no {name}")

    def _error(self, fault: str) -> ServiceError:
        text = f"{self._service} {fault}: this may be another kind of hub"
        return ServiceError(self._service, text)


def _json(value: object) -> bytes:
    return json.dumps(value).encode()
