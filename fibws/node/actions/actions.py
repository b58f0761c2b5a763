"""What a node's actions have in common."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from itertools import count

from fibws.node.session import Session
from fibws.node.topics import Topics
from fibws.node.types import Types


class Actions:
    """What an action's servers and clients need of their node; each is a part of its session.

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

    def goal_id(self) -> str:
        """A name for a goal over topics, as actionlib's: no other goal on the graph has it."""
        return f"{self.node}-{next(self._goals)}-{self.now() / 1e9:.3f}"
