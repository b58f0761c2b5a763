"""What a session is made of."""

from __future__ import annotations

from collections.abc import Iterable

from fibws.errors import OperationRejected
from fibws.protocol.operations import Reply


class Part:
    """One kind of what a node does on the graph: its topics, its calls, its services, its goals.

    It joins its session (`Session.join`), which tells it what happens. A part takes note of what
    concerns it, and leaves the others of these methods as they are here.
    """

    def greeting(self) -> Iterable[bytes]:
        """What a new connection is told first: all that is registered, as encoded operations."""
        return ()

    def receive(self, reply: Reply) -> bool:
        """Take what the hub sent, if it is for this part; tell whether it was."""
        return False

    def refuse(self, id_: str, fault: OperationRejected) -> bool:
        """The hub refused the operation of this id; tell whether it was this part's."""
        return False

    def lose(self) -> None:
        """The connection is gone, and with it all answers that are still due."""

    def end(self, fault: Exception | None) -> None:
        """The node is over, because of ``fault`` if there is one. Called once, and last."""
