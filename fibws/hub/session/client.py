"""What the parts of one client's session have in common."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import count

from fibws import names
from fibws.errors import OperationError
from fibws.hub.clock import Clock
from fibws.hub.frames import text_frame, text_frames
from fibws.hub.graph.graph import Graph
from fibws.hub.outbox import Outbox
from fibws.hub.session.statuses import Statuses
from fibws.hub.settings import Settings


def check_room(taken: int, limit: int, what: str) -> None:
    """Raise `OperationError` if a client has as many of something as it may have."""
    if taken >= limit:
        raise OperationError(
            f"One client may have {limit} {what}, not more (--max-{what} of the hub)"
        )


@dataclass(frozen=True, slots=True, eq=False)
class Client:
    """One client: its name, the graph it is in, and the way back to it."""

    node: str
    graph: Graph
    outbox: Outbox
    clock: Clock
    settings: Settings
    statuses: Statuses
    numbers: Iterator[int] = field(default_factory=lambda: count(1))
    """For ids of the hub's making."""

    def resolve(self, spelling: str) -> str:
        """The global name that the client means."""
        return names.resolve(spelling, node=self.node)

    def reply(self, text: bytes, fragment_size: int | None = None) -> None:
        """Send what may not be dropped, in pieces if it is longer than ``fragment_size``."""
        self.outbox.reply(self.frames(text, fragment_size))

    def frames(self, text: bytes, fragment_size: int | None) -> bytes:
        """The frame of a text, or those of its pieces."""
        return text_frames(text, fragment_size, lambda: f"{self.node}:{next(self.numbers)}")

    def ask(self, text: bytes) -> bool:
        """Ask the client for something on behalf of another; tell whether there is room for it.

        Replies may not be dropped: it must not be others' calls that break its bounds.
        """
        if not self.outbox.has_room(len(text)):
            return False
        self.outbox.reply(text_frame(text))
        return True
