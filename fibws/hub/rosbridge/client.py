"""The state that the handlers of one client's session share."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import count
from typing import TYPE_CHECKING, Any

from fibws import names
from fibws.access.rights import Right
from fibws.hub.delivery.clock import Clock
from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.errors import LimitReached, NotAllowed
from fibws.hub.graph.body import Body
from fibws.hub.graph.graph import Graph
from fibws.hub.rosbridge.encodings import text_frames
from fibws.hub.rosbridge.statuses import RosbridgeStatuses
from fibws.hub.rosbridge.subscription import Groups
from fibws.hub.settings import Settings
from fibws.hub.websocket.endpoint import Registration
from fibws.protocol.operations import Id, encode_fields, plain_json
from fibws.protocol.serialized import VALUES, operation_head
from fibws.protocol.websocket import BINARY, server_frame

if TYPE_CHECKING:
    from fibws.hub.rosbridge.services import RosbridgeServices


def check_room(taken: int, limit: int, what: str) -> None:
    """Raise `LimitReached` if a client has as many of something as it may have."""
    if taken >= limit:
        raise LimitReached(f"too many {what} of one client (limit {limit}, --max-{what})")


@dataclass(frozen=True, slots=True, eq=False)
class RosbridgeClient:
    """One client: its name, the graph, and the way back to it.

    Attributes:
        groups: the groups of subscriptions of the hub.
        servers: the clients of the hub that serve services, by their secrets.
        serialized: whether the connection speaks ``fibws.v1``.
        check_shared: raises `LimitReached` if the clients of the client's address or its principal
            have registered as many of something as they may.
        numbers: for ids that the hub makes up.
    """

    node: str
    graph: Graph
    groups: Groups
    servers: dict[str, RosbridgeServices]
    queue: SendQueue
    clock: Clock
    settings: Settings
    statuses: RosbridgeStatuses
    serialized: bool
    check_shared: Callable[[Registration], None]
    numbers: Iterator[int] = field(default_factory=lambda: count(1))

    def report_withdrawn(self, right: Right, name: str) -> None:
        """Tell the client that it has lost a registration together with the right to it."""
        error = NotAllowed(self.node, right, name)
        self.statuses.error(None, f"{right}: {error}; it was taken back", code=error.code)

    def check_room(self, what: Registration, taken: int) -> None:
        """Raise `LimitReached` if the client has registered as many of something as it may."""
        check_room(taken, getattr(self.settings, f"max_{what}"), what)
        self.check_shared(what)

    def resolve(self, spelling: str) -> str:
        """Return the global name that the client means; raise `InvalidName`."""
        return self.graph.resolve(spelling, self.node)

    def check_legal(self, id_: Id, spelling: str, name: str) -> None:
        """Warn the client if the name that it has registered is not a legal one.

        Args:
            id_: the operation's.
            name: the global name.
        """
        if not names.is_legal(spelling):
            self.statuses.warning(
                id_,
                f"{name}: {spelling!r} is not a legal ROS graph name. "
                "This may cause problems with other ROS tools",
            )

    def reply(self, text: bytes, fragment_size: int | None = None) -> None:
        """Send a text that may not be dropped, in pieces if it is longer than that."""
        self.queue.reply(self.frames(text, fragment_size))

    def frames(self, text: bytes, fragment_size: int | None) -> bytes:
        """Return the frame of a text, or those of its pieces."""
        return text_frames(text, fragment_size, lambda: f"{self.node}:{next(self.numbers)}")

    def forward_request(self, frame: bytes) -> bool:
        """Send another client's request; return False if the send queue is half full.

        Replies are never dropped, and the calls of others must not make the client overfull.
        """
        if not self.queue.has_room(len(frame)):
            return False
        self.queue.reply(frame)
        return True

    def body_frames(
        self,
        fields: dict[str, Any],
        body: Body,
        *,
        serialized: bool,
        fragment_size: int | None = None,
    ) -> bytes:
        """Return the frames of an operation with a request, a response, a goal or the like.

        In JSON, rosbridge's clients get null for infinity.

        Args:
            fields: of the operation, without the body.
            serialized: whether the body is sent in ROS 1's serialization, in one frame.

        Raises:
            OperationError: the body cannot be converted.
        """
        if serialized:
            payload = operation_head(encode_fields(fields)) + body.ros1()
            return server_frame(BINARY, payload)
        values = body.json() if self.serialized else plain_json(body.json())
        texts = {VALUES[fields["op"]]: values}
        text = encode_fields(fields, exact=False, **texts)
        return self.frames(text, fragment_size)

    def code(self, code: str | None) -> str | None:
        """Return an error's code if the client is sent those."""
        return code if self.serialized else None
