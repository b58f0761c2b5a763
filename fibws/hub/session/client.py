"""What the parts of one client's session have in common."""

from __future__ import annotations

from dataclasses import dataclass

from fibws import names
from fibws.errors import OperationError
from fibws.hub.clock import Clock
from fibws.hub.framing import text_frame
from fibws.hub.graph.graph import Graph
from fibws.hub.outbox import Outbox
from fibws.hub.session.statuses import Statuses
from fibws.hub.settings import Settings
from fibws.protocol.operations import Operation, encode


@dataclass(frozen=True, slots=True, eq=False)
class Client:
    """One client: its name, the graph it is in, and the way back to it."""

    node: str
    graph: Graph
    outbox: Outbox
    clock: Clock
    settings: Settings
    statuses: Statuses

    def resolve(self, spelling: str) -> str:
        """The global name that the client means."""
        return names.resolve(spelling, node=self.node)

    def check_room(self, taken: int, setting: str) -> None:
        """Raise `OperationError` if the client has as many of something as it may have."""
        limit = getattr(self.settings, setting)
        if taken >= limit:
            what = setting.removeprefix("max_")
            raise OperationError(
                f"One client may have {limit} {what}, not more (--max-{what} of the hub)"
            )

    def send(self, operation: Operation) -> None:
        """Send what may not be dropped."""
        self.outbox.reply(text_frame(encode(operation)))
