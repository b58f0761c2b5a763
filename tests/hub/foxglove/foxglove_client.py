"""A client of Foxglove's protocol without sockets."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from typing import Any

from fibws.access.rights import Principal
from fibws.hub.delivery.send_queue import Bytes, SendQueue
from fibws.hub.foxglove import SUBPROTOCOLS
from fibws.hub.foxglove.assets import AssetFiles
from fibws.hub.foxglove.session import Foxglove
from fibws.hub.log.audit import Audit
from fibws.hub.websocket.endpoint import Opening
from fibws.protocol.websocket import CloseReason

from ..fakes import BINARY, TEXT, FakeHub, InlineWorkers, finish, frames


class FoxgloveHub(FakeHub):
    """A graph with clients of Foxglove's protocol, and others, that have no sockets."""

    def __init__(self, *, assets: AssetFiles | None = None, **settings: Any) -> None:
        super().__init__(**settings)
        self.reported: list[tuple[str, str]] = []
        self.audit = Audit(self.clock.time)
        self.foxglove = Foxglove(
            self.graph,
            self.clock,
            self.settings,
            self.audit,
            name="test",
            readers=InlineWorkers(),
            assets=assets,
            report=lambda node, text: self.reported.append((node, text)),
        )

    def foxglove_client(
        self, node: str | None = "/foxglove", *, principal: Principal | None = None
    ) -> FoxgloveClient:
        """Return a new client."""
        return FoxgloveClient(self, node, principal)

    @property
    def empty(self) -> bool:
        """Whether nothing is left of any client."""
        foxglove = self.foxglove
        return super().empty and not (foxglove.groups or foxglove.sessions or self.clock.timers)


class FoxgloveClient:
    """A client: sends operations and binary messages, and receives the hub's."""

    def __init__(self, hub: FoxgloveHub, node: str | None, principal: Principal | None) -> None:
        self.writes: list[Bytes] = []
        self.closings: list[CloseReason] = []
        self.queue = SendQueue(
            self.writes.append, self.fail, hub.flusher, max_bytes=hub.settings.max_queued_bytes
        )
        self._hub = hub
        opening = Opening(node, self.queue, self._close, principal)
        self.session = hub.foxglove.open(opening, SUBPROTOCOLS[0])
        self.channels: dict[str, dict[str, Any]] = {}
        """The channels that the hub offers, by topics."""
        self.services: dict[str, dict[str, Any]] = {}
        self.info: dict[str, Any] = {}
        self.operations: list[str] = []
        """The names of the operations that came."""

    def fail(self) -> None:
        raise AssertionError("a write failed")

    def send(self, op: str, **fields: Any) -> None:
        """Send an operation."""
        finish(self.session.receive_text(json.dumps({"op": op, **fields}).encode()))

    def send_binary(self, data: bytes) -> None:
        self.session.receive_binary(data)

    def publish(self, channel: int, data: bytes) -> None:
        """Publish a message."""
        self.send_binary(struct.pack("<BI", 1, channel) + data)

    def call(self, service: int, data: bytes, call: int = 1, encoding: str = "ros1") -> None:
        """Call a service."""
        name = encoding.encode()
        self.send_binary(struct.pack("<BIII", 2, service, call, len(name)) + name + data)

    def subscribe(self, topic: str, id_: int = 0) -> None:
        """Subscribe to a topic that the hub offers."""
        self.receive()
        channel = self.channels[topic]["id"]
        self.send("subscribe", subscriptions=[{"id": id_, "channelId": channel}])

    def advertise(self, topic: str, type_: str, id_: int = 1, **fields: Any) -> None:
        """Publish a topic from now on."""
        channel = {"id": id_, "topic": topic, "encoding": "ros1", "schemaName": type_, **fields}
        self.send("advertise", channels=[channel])

    def receive(self) -> list[dict[str, Any] | bytes]:
        """Return what came except for descriptions, which update `channels` and `services`."""
        self._hub.clock.advance(0)
        self._hub.clock.turn()
        received: list[dict[str, Any] | bytes] = []
        for first, payload in frames(b"".join(self.writes)):
            if first == BINARY:
                received.append(payload)
                continue
            assert first == TEXT
            fields = json.loads(payload)
            self.operations.append(fields["op"])
            if not self._describe(fields):
                received.append(fields)
        self.writes.clear()
        return received

    def receive_operations(self) -> list[str]:
        """Return the names of the operations that came, descriptions included."""
        self.operations.clear()
        self.receive()
        return list(self.operations)

    def receive_one(self, op: str) -> dict[str, Any]:
        """Return the one operation that came."""
        received = self.receive()
        assert len(received) == 1, received
        assert isinstance(received[0], dict)
        assert received[0]["op"] == op, received
        return received[0]

    def receive_statuses(self, level: int = 2) -> list[str]:
        """Return the texts of the statuses that came, all of one level; nothing else may have."""
        received = self.receive()
        texts = []
        for each in received:
            assert isinstance(each, dict)
            assert (each["op"], each["level"]) == ("status", level), received
            texts.append(each["message"])
        return texts

    def receive_messages(self) -> list[tuple[int, int, bytes]]:
        """Return the subscription, the time and the bytes of each message that came."""
        messages = []
        for each in self.receive():
            assert isinstance(each, bytes), each
            kind, subscription, time = struct.unpack_from("<BIQ", each)
            assert kind == 1
            messages.append((subscription, time, each[13:]))
        return messages

    def receive_response(self) -> tuple[int, int, str, bytes]:
        """Return service, call, encoding and bytes of the one response that came."""
        [received] = self.receive()
        assert isinstance(received, bytes), received
        kind, service, call, size = struct.unpack_from("<BIII", received)
        assert kind == 3
        return service, call, received[13 : 13 + size].decode(), received[13 + size :]

    def _close(self, reason: CloseReason) -> None:
        self.closings.append(reason)
        self.disconnect()

    def disconnect(self) -> None:
        finish(self.session.leave())

    def pause(self) -> None:
        """Read nothing more for a while."""
        self.receive()
        self.queue.pause()

    def _describe(self, fields: dict[str, Any]) -> bool:
        match fields["op"]:
            case "serverInfo":
                self.info = fields
            case "advertise":
                self.channels.update((each["topic"], each) for each in fields["channels"])
            case "advertiseServices":
                self.services.update((each["name"], each) for each in fields["services"])
            case "unadvertise":
                _forget(self.channels, fields["channelIds"])
            case "unadvertiseServices":
                _forget(self.services, fields["serviceIds"])
            case _:
                return False
        return True


def _forget(known: dict[str, dict[str, Any]], ids: Sequence[int]) -> None:
    for id_ in ids:
        for name in [name for name, each in known.items() if each["id"] == id_]:
            del known[name]
