"""What a node's actions have in common."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Iterator
from itertools import count

from fibws.errors import OperationRejected
from fibws.node.part import Part
from fibws.node.session import Session
from fibws.node.topics import Topics
from fibws.node.types import Types
from fibws.protocol.operations import (
    ActionFeedback,
    ActionResult,
    CancelActionGoal,
    Reply,
    SendActionGoal,
)


class Actions(Part):
    """The part of a session that serves actions and sends goals; each of those is a part of it.

    Args:
        node: the node's name.
        session: the node's, with its ``topics`` and its ``types``.
        wait_for_service: waits for a service, given its name and the most seconds to wait.
        now: gives the nanoseconds since 1970.
    """

    def __init__(
        self,
        node: str,
        session: Session,
        topics: Topics,
        types: Types,
        wait_for_service: Callable[[str, float | None], Awaitable[None]],
        now: Callable[[], int],
    ) -> None:
        self.node = node
        self.session = session
        self.topics = topics
        self.types = types
        self.wait_for_service = wait_for_service
        self.now = now
        self._goals = count(1)
        self._parts: dict[Part, None] = {}
        session.join(self)

    def goal_id(self) -> str:
        """A name for a goal over topics, as actionlib's: no other goal on the graph has it."""
        return f"{self.node}-{next(self._goals)}-{self.now() / 1e9:.3f}"

    def join(self, part: Part) -> None:
        """Let a server or a client take part."""
        self.session.check()
        self._parts[part] = None

    def parts(self) -> list[Part]:
        """The servers and clients that take part."""
        return list(self._parts)

    def leave(self, part: Part) -> None:
        """Let it take part no more."""
        self._parts.pop(part, None)

    def greeting(self) -> Iterator[bytes]:
        """The registrations of all."""
        for part in self._parts:
            yield from part.greeting()

    def receive(self, reply: Reply) -> bool:
        """Hand on what one of them waits for; it may come late, when it does no more."""
        return any(part.receive(reply) for part in self._parts) or isinstance(
            reply, SendActionGoal | CancelActionGoal | ActionFeedback | ActionResult
        )

    def refuse(self, id_: str, fault: OperationRejected) -> bool:
        """Hand on a refusal."""
        return any(part.refuse(id_, fault) for part in self.parts())

    def lose(self) -> None:
        """Let all know."""
        for part in self.parts():
            part.lose()

    def end(self, fault: Exception | None) -> None:
        """Let all know."""
        for part in self.parts():
            part.end(fault)
