"""A tool's link to the hub: it says one thing and waits for the answer.

Tools are to answer at once, so nothing is loaded here that a node needs: no asyncio, no models of
operations (together a fifth of a second). The hub checks whatever a tool says.
"""

from __future__ import annotations

import json
import os
import socket
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any, Self, TypeAlias

from websockets.client import ClientProtocol
from websockets.exceptions import InvalidStatus
from websockets.frames import Frame, Opcode
from websockets.http11 import Response
from websockets.uri import parse_uri

from fibws import names
from fibws.errors import (
    HubLost,
    HubUnreachable,
    NoHub,
    OperationRejected,
    ServiceError,
    ServiceTimeout,
    UnknownService,
)
from fibws.node import address

PATIENCE = 5.0
"""Seconds in which a hub must take a connection, and answer what it answers itself."""
# Ctrl-C does not wake a socket on Windows.
_SLICE = 0.5 if sys.platform == "win32" else None
_CHUNK = 2**18
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
        self.url = address.hub_url(hub or os.environ.get(address.ENVIRONMENT) or address.DEFAULT)
        self.namespace = names.check_namespace(os.environ.get("ROS_NAMESPACE", "/"))
        name = names.anonymous(f"fibws_{tool}", pid=os.getpid(), milliseconds=_milliseconds())
        self.node = names.resolve(name)
        """The global name that the tool has as a node."""
        self._operations: deque[Operation] = deque()
        self._fragments: list[bytes] = []
        self._heard: dict[bytes, Hear] = {}
        self._calls = 0
        uri = parse_uri(address.node_url(self.url, self.node))
        # With none at all, TLS would say of nothing that it is an error.
        self._least_wait = 0.001 if uri.secure else 0.0
        self._protocol = ClientProtocol(uri, max_size=None)
        self._socket = self._connect(uri.host, uri.port, secure=uri.secure)
        try:
            self._shake_hands()
        except BaseException:
            self._socket.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *error: object) -> None:
        if kind is not None and issubclass(kind, KeyboardInterrupt):
            self._leave()
        else:
            self.close()

    def close(self) -> None:
        """Say good-bye, and wait until the hub has read all that was sent."""
        try:
            if self._protocol.state.name == "OPEN":
                self._protocol.send_close(1000)
            self._flush()
            deadline = time.monotonic() + PATIENCE
            while (rest := deadline - time.monotonic()) > 0 and self._read(rest):
                pass
        except HubLost:
            pass  # As it should be.
        finally:
            self._socket.close()

    def fileno(self) -> int:
        """For ``select``: when this can be read, there may be something to `receive`."""
        return self._socket.fileno()

    def _leave(self) -> None:
        """Say good-bye and go: what Ctrl-C broke into may be in no state to be gone on with."""
        with suppress(Exception):
            self._protocol.send_close(1000)
            self._flush()
        self._socket.close()

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
        self._protocol.send_text(_json(operation))
        self._flush()

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
        self._heard[b'{"op":"publish","topic":%b,"msg":' % _json(topic)] = hear

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
                yield operation["msg"]
            check(operation)

    def call(
        self, service: str, request: Operation | None = None, timeout: float = PATIENCE
    ) -> dict[str, Any]:
        """Call a service and return its response; what else comes meanwhile is kept for `receive`.

        Args:
            service: its global name.
            request: its arguments by name; what is left out has its default.
            timeout: the most seconds to wait for the response; 0 for ever.

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
            }
        )
        # The hub gives up first, and says so.
        deadline = time.monotonic() + timeout + 1 if timeout else None
        kept: list[Operation] = []
        try:
            while True:
                rest = None if deadline is None else max(0.0, deadline - time.monotonic())
                operation = self.receive(rest)
                if operation is None:
                    raise ServiceTimeout(service, f"no response within {timeout:g} s")
                if operation.get("id") == id_ and operation.get("op") == "service_response":
                    return _response(service, operation)
                if operation.get("id") != id_:
                    kept.append(operation)
        finally:
            self._operations.extendleft(reversed(kept))

    def _connect(self, host: str, port: int, *, secure: bool) -> socket.socket:
        try:
            connected = socket.create_connection((host, port), PATIENCE)
            connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            if not secure:
                return connected
            import ssl  # 20 ms that few need

            return ssl.create_default_context().wrap_socket(connected, server_hostname=host)
        except (ConnectionRefusedError, TimeoutError) as error:
            raise NoHub(self.url, _text(error)) from None
        except OSError as error:
            raise HubUnreachable(self.url, _text(error)) from None

    def _shake_hands(self) -> None:
        self._protocol.send_request(self._protocol.connect())
        try:
            self._flush()
            deadline = time.monotonic() + PATIENCE
            while self._protocol.state.name == "CONNECTING":
                if self._protocol.handshake_exc is not None:
                    raise HubUnreachable(self.url, _fault(self._protocol.handshake_exc))
                if not self._read(deadline - time.monotonic()):
                    raise HubUnreachable(self.url, f"no handshake within {PATIENCE:g} s")
        except HubLost as error:
            fault = self._protocol.handshake_exc
            cause = error.cause if fault is None else _fault(fault)
            raise HubUnreachable(self.url, cause) from None

    def _read(self, timeout: float | None) -> bool:
        """Take in what the hub has sent; False if that was nothing for so many seconds."""
        waits = [each for each in (timeout, _SLICE) if each is not None]
        waited = max(self._least_wait, min(waits)) if waits else None
        self._socket.settimeout(waited)
        try:
            data = self._socket.recv(_CHUNK)
        except (TimeoutError, BlockingIOError):
            return timeout is None or (waited is not None and waited < timeout)
        except OSError as error:
            raise HubLost(self.url, _text(error)) from None
        if data:
            self._protocol.receive_data(data)
        else:
            self._protocol.receive_eof()
        for event in self._protocol.events_received():
            if isinstance(event, Frame):
                self._take(event)
            elif isinstance(event, Response) and self._protocol.handshake_exc is not None:
                raise HubUnreachable(self.url, _fault(self._protocol.handshake_exc))
        self._flush()
        if not data or (self._protocol.close_rcvd is not None and not self._operations):
            close = self._protocol.close_rcvd
            said = "the connection broke" if close is None else close.reason or f"code {close.code}"
            raise HubLost(self.url, said)
        return True

    def _take(self, frame: Frame) -> None:
        if frame.opcode not in (Opcode.TEXT, Opcode.BINARY, Opcode.CONT):
            return
        self._fragments.append(bytes(frame.data))
        if frame.fin:
            data, self._fragments = b"".join(self._fragments), []
            for head, hear in self._heard.items():
                if data.startswith(head):
                    hear(data[len(head) : -1])
                    return
            self._operations.append(json.loads(data))

    def _flush(self) -> None:
        """Send what the protocol has to say; empty bytes stand for the end of the stream."""
        self._socket.settimeout(None)
        try:
            for data in self._protocol.data_to_send():
                if data:
                    self._socket.sendall(data)
        except OSError as error:
            raise HubLost(self.url, _text(error)) from None


def check(operation: Operation) -> None:
    """Raise `OperationRejected` if an operation is the hub's word that it refuses something."""
    if operation.get("op") == "status" and operation.get("level") == "error":
        raise OperationRejected(str(operation.get("msg")))


def _response(service: str, operation: Operation) -> dict[str, Any]:
    values = operation.get("values")
    if operation.get("result") is False:
        text = values if isinstance(values, str) else json.dumps(values)
        if text == f"Service {service} does not exist":
            raise UnknownService(service, text)
        raise ServiceError(service, text)
    return values if isinstance(values, dict) else {}


def _json(value: object) -> bytes:
    return json.dumps(value).encode()


def _milliseconds() -> int:
    return time.time_ns() // 1_000_000


def _text(error: OSError) -> str:
    if type(error).__module__ == "ssl":  # which need not be imported for that
        fault = getattr(error, "verify_message", "")
        return f"its certificate: {fault}" if fault else "it speaks no TLS, so write ws://"
    return (error.strerror or str(error) or type(error).__name__).lower()


def _fault(error: Exception) -> str:
    """Why the handshake failed, in the hub's own words if it is one."""
    if isinstance(error, InvalidStatus):
        body = bytes(error.response.body or b"").decode(errors="replace").strip().rstrip(".")
        if error.response.status_code in (400, 403) and body:
            return body
    return f"what answers there is no hub ({error})"
