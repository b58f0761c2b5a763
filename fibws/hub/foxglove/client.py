"""The state that the parts of one client's session share, and the statuses that it is sent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fibws.access.rights import Right
from fibws.hub.delivery.clock import Clock
from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.errors import LimitReached, NotAllowed
from fibws.hub.foxglove.messages import ERROR, WARNING, text_frame
from fibws.hub.foxglove.turns import FeedTurns
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.view import GraphView
from fibws.hub.log.audit import Audit
from fibws.hub.log.text import ErrorLog, shortened
from fibws.hub.settings import Settings
from fibws.hub.websocket.endpoint import Registration


class FoxgloveStatuses:
    """Sends one client statuses, and logs its errors.

    Args:
        node: the client's name.
        report: takes the node and the reason of each operation that failed.
    """

    __slots__ = ("_errors", "_node", "_queue", "_report")

    def __init__(self, node: str, queue: SendQueue, report: Callable[[str, str], object]) -> None:
        self._node = node
        self._queue = queue
        self._report = report
        self._errors = ErrorLog(node)

    def error(self, text: str, *, code: str = "", fault: Exception | None = None) -> None:
        """Report that an operation failed, to the log as well.

        Args:
            code: the error's; refusals of the policy are not logged, but recorded as audit events.
            fault: an error within the hub, whose traceback is logged.
        """
        self._queue.reply(text_frame("status", level=ERROR, message=shortened(text)))
        self.log(text, code=code, fault=fault)

    def log(self, text: str, *, code: str = "", fault: Exception | None = None) -> None:
        """Log an error that the client is told in another way; arguments as in `error`."""
        self._errors.add(text, code=code, fault=fault)
        self._report(self._node, text)

    def misspelled(self, text: str) -> None:
        """Warn, in the log as well, that a name is likely misspelled."""
        self._errors.add(text, kind="warning")
        self._report(self._node, text)
        self.warning(text)

    def warning(self, text: str) -> None:
        """Report that an operation had no effect, or another one than was meant."""
        self._queue.reply(text_frame("status", level=WARNING, message=shortened(text)))

    def state(self, id_: str, text: str) -> None:
        """Show a warning until an empty text removes it."""
        if text:
            fields = {"level": WARNING, "message": shortened(text), "id": id_}
            self._queue.reply(text_frame("status", **fields))
        else:
            self._queue.reply(text_frame("removeStatus", statusIds=[id_]))


@dataclass(frozen=True, slots=True, eq=False)
class FoxgloveClient:
    """One client: its name, the graph, and the way back to it.

    Attributes:
        view: the graph as the client sees it.
        check_shared: raises `LimitReached` if the clients of the client's address or its principal
            have registered as many of something as they may.
    """

    node: str
    graph: Graph
    view: GraphView
    queue: SendQueue
    clock: Clock
    settings: Settings
    statuses: FoxgloveStatuses
    audit: Audit
    check_shared: Callable[[Registration], None]
    turns: FeedTurns

    def resolve(self, spelling: str) -> str:
        """Return the global name that the client means; raise `InvalidName`."""
        return self.graph.resolve(spelling, self.node)

    def is_allowed(self, right: Right, name: str) -> bool:
        """Return whether the client may do this with a topic, a service or a parameter."""
        return self.graph.rights.allows(self.node, right, name)

    def check_room(self, what: Registration, taken: int) -> None:
        """Raise `LimitReached` if the client has reached a limit of its registrations."""
        limit = getattr(self.settings, f"max_{what}")
        if taken >= limit:
            raise LimitReached(f"too many {what} of one client (limit {limit}, --max-{what})")
        self.check_shared(what)

    def report_withdrawn(self, right: Right, name: str) -> None:
        """Tell the client that it has lost a registration together with the right to it."""
        error = NotAllowed(self.node, right, name)
        self.statuses.error(f"{right}: {error}; it was taken back", code=error.code)
