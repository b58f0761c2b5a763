"""Statuses: what the hub has to say to one client about its operations, and to the log."""

from __future__ import annotations

import logging

from fibws.hub.frames import text_frame
from fibws.hub.logtext import is_power_of_ten, printable, shortened
from fibws.hub.outbox import Outbox
from fibws.protocol.operations import Level, Status, encode, legal_id

logger = logging.getLogger("fibws.hub")

_VERBOSITY: dict[Level, int] = {"none": 0, "error": 1, "warning": 2, "info": 3}


class Statuses:
    """Sends a client the statuses that it wants: errors, until it asks for more or for none.

    Args:
        node: the client's name, for the log.
    """

    __slots__ = ("_errors", "_faults", "_level", "_node", "_outbox", "wants_info")

    def __init__(self, node: str, outbox: Outbox) -> None:
        self._node = node
        self._outbox = outbox
        self._errors = 0
        self._faults = 0
        self.set_level("error")

    def set_level(self, level: Level) -> None:
        """From now on send this level and what is graver."""
        self._level = _VERBOSITY[level]
        self.wants_info = level == "info"

    def error(self, id_: object, text: str, fault: Exception | None = None) -> None:
        """Refuse an operation; the log hears of it, too, with the traceback of a fault of ours."""
        self._errors += 1
        self._faults += fault is not None
        if is_power_of_ten(self._errors if fault is None else self._faults):
            logger.log(
                logging.WARNING if fault is None else logging.ERROR,
                "%s: %s (error %d of this client)",
                self._node,
                printable(text),
                self._errors,
                exc_info=fault,
            )
        self._send("error", id_, text)

    def warning(self, id_: object, text: str) -> None:
        """Say that an operation was done otherwise than was meant."""
        self._send("warning", id_, text)

    def info(self, id_: object, text: str) -> None:
        """Say that an operation was done."""
        self._send("info", id_, text)

    def _send(self, level: Level, id_: object, text: str) -> None:
        if _VERBOSITY[level] <= self._level:
            status = Status(id=legal_id(id_), level=level, msg=shortened(text))
            self._outbox.reply(text_frame(encode(status)))
