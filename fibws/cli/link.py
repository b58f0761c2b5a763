"""A tool's link to the hub: it says one thing and waits for the answer.

Tools are to answer at once, so nothing is loaded here that a node needs: no asyncio, no models of
operations (together a fifth of a second). The hub checks whatever a tool says.
"""

from __future__ import annotations

import json
import os
import time
from collections import deque
from collections.abc import Callable, Iterator
from typing import Any, Self, TypeAlias

from fibws import names
from fibws.cli.answers import ANSWERS, fault
from fibws.cli.stream import Stream
from fibws.errors import (
    OperationRejected,
    ServiceError,
    ServiceTimeout,
    UnknownService,
)
from fibws.node import address

PATIENCE = 5.0
"""Seconds in which a hub must answer what it answers itself."""
MOST_KEPT = 10_000
"""Operations that come while a call is waited for and are kept; more drop the oldest."""
QUEUE_LENGTH = 1000
"""Messages that the hub is to keep of a topic, unless told otherwise, for a tool that is slow."""

Operation: TypeAlias = dict[str, Any]
Hear: TypeAlias = Callable[[bytes], None]
"""Is given the JSON text of a message."""


class Link:
    """One connection to a hub, open from its making on: ``with Link("echo") as link``.

    Args:
        tool: what the tool is called; the node's name is made of it.
        hub: the hub's address; else $FIBWS_HUB, else this machine.

    Raises:
        InvalidAddress: it is no address of a hub.
        NoHub: nothing answers there.
        HubUnreachable: what answers is no hub, or will not have this tool.
    """

    def __init__(self, tool: str, hub: str | None = None) -> None:
        self.url = address.hub_url(hub)
        self.namespace = names.check_namespace(os.environ.get("ROS_NAMESPACE", "/"))
        name = names.anonymous(f"fibws_{tool}", pid=os.getpid(), milliseconds=_milliseconds())
        self.node = names.resolve(name)
        """The global name that the tool has as a node."""
        self._operations: deque[Operation] = deque()
        self._heard: dict[str, tuple[bytes, Hear]] = {}
        self._calls = 0
        self._stream = Stream(self.url, self.node)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *error: object) -> None:
        if kind is not None and issubclass(kind, KeyboardInterrupt):
            self._stream.leave()
        else:
            self.close()

    def close(self) -> None:
        """Say good-bye, and wait until the hub has read all that was sent."""
        self._stream.close()

    def fileno(self) -> int:
        """For ``select``: when this can be read, there may be something to `receive`."""
        return self._stream.fileno()

    def resolve(self, name: str) -> str:
        """The global name that a name stands for here; it raises `InvalidName` if it is none."""
        return names.resolve(name, namespace=self.namespace, node=self.node)

    def resolve_namespace(self, name: str) -> str:
        """The global namespace that a name stands for, which may end in ``/``; that of all is /."""
        name = name.rstrip("/")
        return self.resolve(name) if name else "/"

    def send(self, operation: Operation) -> None:
        """Send an operation; what the hub has against it comes by `receive`, as a status.

        Raises:
            HubLost: there is no hub any more.
        """
        self._stream.send(_json(operation))

    def receive(self, timeout: float | None = None) -> Operation | None:
        """The next operation that the hub sends, or None if none has come in ``timeout`` seconds.

        What `hear` listens to is none.

        Raises:
            HubLost: there is no hub any more.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while not self._operations:
            rest = None if deadline is None else deadline - time.monotonic()
            if not self._read(rest) or (rest is not None and rest <= 0 and not self._operations):
                return None
        return self._operations.popleft()

    def subscribe(self, topic: str, *, queue_length: int = QUEUE_LENGTH) -> None:
        """Ask for the messages of a topic, whichever type it has."""
        self.send({"op": "subscribe", "topic": topic, "queue_length": queue_length})

    def hear(self, topic: str, hear: Hear) -> None:
        """Have the JSON text of a topic's messages given to ``hear`` when they are received.

        Much less is done with each than with an operation. The topic is to be subscribed to, too.
        """
        self._heard[topic] = b'{"op":"publish","topic":%b,"msg":' % _json(topic), hear

    def messages(self, topic: str, timeout: float | None = None) -> Iterator[Any]:
        """The messages of a topic that was subscribed to, as they come.

        Ends when none has come for ``timeout`` seconds; other operations are passed over.

        Raises:
            OperationRejected: the hub has refused something.
            HubLost: there is no hub any more.
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

    def heed(self, seconds: float | None = None) -> None:
        """Take in what the hub says, and answer its pings, for so many seconds, or for ever.

        Raises:
            OperationRejected: the hub has refused something.
            HubLost: there is no hub any more.
        """
        deadline = None if seconds is None else time.monotonic() + seconds
        rest = seconds
        while (operation := self.receive(rest)) is not None:
            check(operation)
            rest = None if deadline is None else max(0.0, deadline - time.monotonic())
            if rest == 0 and not self._operations:
                return  # Who never stops talking is not heeded for ever.

    def call(
        self,
        service: str,
        request: Operation | None = None,
        timeout: float = PATIENCE,
        headers: dict[str, str] | None = None,
    ) -> dict[str, Any]:
        """Call a service and return its response; what else comes meanwhile is kept for `receive`.

        Args:
            service: its global name.
            request: its arguments by name; what is left out has its default.
            timeout: the most seconds to wait for the response; 0 for ever.
            headers: what a provider that asks for headers is told beside the request.

        Raises:
            UnknownService: nobody offers it.
            ServiceTimeout: there was no response in time.
            ServiceError: it failed; the text is the provider's own, or the hub's.
            HubLost: there is no hub any more.
        """
        self._calls += 1
        id_ = f"call:{self._calls}"
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
        # The hub gives up first, and says so.
        deadline = time.monotonic() + timeout + 1 if timeout else None
        kept: deque[Operation] = deque(maxlen=MOST_KEPT)
        try:
            while True:
                rest = None if deadline is None else max(0.0, deadline - time.monotonic())
                operation = self.receive(rest)
                # Who never stops talking has not answered either.
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
        """Take in what the hub has sent; False if that was nothing for so many seconds."""
        is_news = self._stream.read(timeout)
        while self._stream.messages:
            self._take(self._stream.messages.popleft())
        return is_news

    def _take(self, message: bytes) -> None:
        for head, hear in self._heard.values():
            if message.startswith(head):
                hear(message[len(head) : -1])
                return
        operation = self._operation(message)
        for topic, (_, hear) in self._heard.items():
            if operation.get("op") == "publish" and operation.get("topic") == topic:
                hear(_json(operation.get("msg")))  # Another kind of hub writes it otherwise.
                return
        self._operations.append(operation)

    def _operation(self, data: bytes) -> Operation:
        try:
            operation = json.loads(data.decode())
        except (ValueError, RecursionError) as error:
            raise self._stream.no_hub(f"it sends what is no JSON: {error}") from None
        if not isinstance(operation, dict):
            raise self._stream.no_hub(
                f"it sends {data[:40].decode(errors='replace')!r}, no JSON object"
            )
        return operation


def check(operation: Operation) -> None:
    """Raise `OperationRejected` if an operation is the hub's word that it refuses something."""
    if operation.get("op") == "status" and operation.get("level") == "error":
        raise OperationRejected(str(operation.get("msg")))


def _answers(operation: Operation | None, id_: str) -> bool:
    """Whether an operation is the response to the call of that id."""
    return (
        operation is not None
        and operation.get("id") == id_
        and operation.get("op") == "service_response"
    )


def _response(service: str, operation: Operation) -> dict[str, Any]:
    values = operation.get("values")
    if operation.get("result") is False:
        text = values if isinstance(values, str) else json.dumps(values)
        if text == f"Service {service} does not exist":
            raise UnknownService(service, text)
        raise ServiceError(service, text)
    return Values(service, values if isinstance(values, dict) else {})


class Values(dict[str, Any]):
    """A service's response by the names of its fields.

    A field that is not there, or is not what the hub's service of that name answers, raises
    `ServiceError` when it is asked for: another kind of hub may lack it.
    """

    def __init__(self, service: str, values: dict[str, Any]) -> None:
        super().__init__(values)
        self._service = service

    def __getitem__(self, name: str) -> Any:
        value = super().__getitem__(name)
        shape = ANSWERS.get(self._service, {}).get(name)
        if shape is not None and (wrong := fault(value, shape, name)):
            raise self._error(f"told what is none of its answers, {wrong}")
        return value

    def __missing__(self, name: str) -> Any:
        raise self._error(f"told no {name}")

    def _error(self, told: str) -> ServiceError:
        return ServiceError(
            self._service, f"{self._service} {told}: this may be another kind of hub"
        )


def _json(value: object) -> bytes:
    return json.dumps(value).encode()


def _milliseconds() -> int:
    return time.time_ns() // 1_000_000
