"""Statuses: reports to one client about its operations, and to the log."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable
from typing import TypeAlias

from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.errors import TypeConflict
from fibws.hub.graph.types import AnyType
from fibws.hub.log.text import ErrorLog, is_power_of_ten, printable, shortened
from fibws.hub.rosbridge.encodings import text_frame
from fibws.protocol.operations import Level, Status, encode, legal_id

logger = logging.getLogger("fibws.hub")

_VERBOSITY: dict[Level, int] = {"none": 0, "error": 1, "warning": 2, "info": 3}

ROSLIB_ID = re.compile(r"[a-z_]+:.+:(\d+|[0-9a-f]{8}-[0-9a-f-]{27})", re.ASCII)
"""Ids that roslib makes up, such as ``publish:/chatter:3``; version 2 has a UUID at the end."""

Report: TypeAlias = Callable[[str, str], object]
"""Takes the node and the reason of an operation that failed."""


def ignore(node: str, text: str) -> None:
    """Report nothing."""


class RosbridgeStatuses:
    """Sends a client the statuses that it wants: errors, unless it asks for more or for none.

    Args:
        node: the client's name, for the log.
        report: reports each error to others than the client and the log.
        codes: whether errors are sent with their codes, as on connections of ``fibws.v1``.
        is_logged: whether errors are logged.
        is_page: whether the client is a web page. Most pages use roslib, which emits a status with
            an id as ``status:ID``, of an id that it keeps to itself. So that pages get such a
            status by ``ros.on("status")``, it has the id as ``operation``.
    """

    __slots__ = (
        "_codes",
        "_errors",
        "_is_logged",
        "_is_page",
        "_level",
        "_node",
        "_notices",
        "_queue",
        "_report",
        "wants_info",
    )

    def __init__(
        self,
        node: str,
        queue: SendQueue,
        report: Report = ignore,
        *,
        codes: bool,
        is_logged: bool = True,
        is_page: bool = False,
    ) -> None:
        self._node = node
        self._report = report
        self._queue = queue
        self._codes = codes
        self._is_logged = is_logged
        self._is_page = is_page
        self._notices = 0
        self._errors = ErrorLog(node)
        self.set_level("error")

    def set_level(self, level: Level) -> None:
        """Send this level and more severe ones from now on."""
        self._level = _VERBOSITY[level]
        self.wants_info = level == "info"

    def error(
        self, id_: object, text: str, fault: Exception | None = None, code: str | None = None
    ) -> None:
        """Report that an operation failed, to the log as well.

        Args:
            id_: the operation's.
            fault: an error within the hub, whose traceback is logged.
            code: names the error for programs.
        """
        if self._is_logged:
            self._errors.add(text, code=code, fault=fault)
        self._send("error", id_, text, code)
        self._report(self._node, text)

    def warning(self, id_: object, text: str) -> None:
        """Report that an operation was done in another way than the client meant."""
        self._send("warning", id_, text)

    def displaced(self, name: str, node: str) -> None:
        """Report that another node serves a service or an action of the client now."""
        self._notice(None, f"{name} has another server now: {node}")

    def conflict(self, id_: object, text: str) -> None:
        """Report that others use a topic with another type.

        Args:
            id_: that of the client's registration.
            text: the reason.
        """
        self._notice(id_, text, TypeConflict.code)

    def _notice(self, id_: object, text: str, code: str | None = None) -> None:
        """Send a warning that clients get at the default level, too, and that is logged."""
        self._notices += 1
        if is_power_of_ten(self._notices):
            logger.warning(
                "%s: %s (warning %d to this client)", self._node, printable(text), self._notices
            )
        if self._level:
            self._put("warning", id_, text, code)
        self._report(self._node, text)

    def unchecked(self, id_: object, text: str, type_: AnyType) -> None:
        """Report that something's messages are not checked, to the log as well.

        Clients get the warning about a misspelled type at the default level, too.

        Args:
            id_: the operation's.
            type_: the type, whose definition is unknown.
        """
        if type_.meant:
            text = f"{text}: the package is unknown; did you mean {type_.meant}?"
            self._errors.add(text, kind="warning")
            self._report(self._node, text)
            if self._level:
                self._put("warning", id_, text)
            return
        fault = type_.fault
        self._errors.add(f"{text}: {fault or 'the definition is unknown'}", kind="warning")
        self.warning(id_, f"{text}: {fault}" if fault else text)

    def info(self, id_: object, text: str) -> None:
        """Report that an operation was done."""
        self._send("info", id_, text)

    def _send(self, level: Level, id_: object, text: str, code: str | None = None) -> None:
        if _VERBOSITY[level] <= self._level:
            self._put(level, id_, text, code)

    def _put(self, level: Level, id_: object, text: str, code: str | None = None) -> None:
        id_ = legal_id(id_)
        operation = None
        if self._is_page and isinstance(id_, str) and ROSLIB_ID.fullmatch(id_):
            id_, operation = None, id_
        status = Status(
            id=id_,
            operation=operation,
            level=level,
            msg=shortened(text),
            code=code if self._codes else None,
        )
        self._queue.reply(text_frame(encode(status)))
