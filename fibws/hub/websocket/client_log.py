"""Log lines and audit events about one client's connection."""

from __future__ import annotations

import logging
import math
import re
from typing import Protocol

from fibws.access.rights import Principal
from fibws.hub.delivery.send_queue import SendQueue
from fibws.hub.log.audit import Audit, Reason
from fibws.hub.websocket.endpoint import Endpoint
from fibws.protocol.websocket import (
    FORBIDDEN,
    LIMITED,
    REPLACED,
    UNAUTHENTICATED,
    CloseReason,
)

logger = logging.getLogger("fibws.hub")

REFUSALS: dict[int, Reason] = {
    UNAUTHENTICATED: "authentication",
    FORBIDDEN: "right",
    LIMITED: "limit",
}
"""The reasons of close codes that are refusals, for the audit."""
OWN_TOOL = re.compile(r"(/\w+)*/fibws_[a-z_]+_\d+_\d+", re.ASCII)
"""The names of fibws's commands: each `fibws topic list` is a connection of a moment."""
INTERVAL = 10.0
"""Seconds between two log lines about one client's dropped messages."""


class LoggedClient(Protocol):
    """A client's connection, as far as its log uses it."""

    endpoint: Endpoint | None
    principal: Principal | None
    address: str
    peer: str
    queue: SendQueue

    @property
    def name(self) -> str:
        """The client's name in the log."""

    @property
    def limited(self) -> int:
        """Messages that were dropped because they were more than the client may send."""


class ClientLog:
    """The log of one client's connection."""

    __slots__ = ("_audit", "_dropped", "_dropped_at", "_limited")

    def __init__(self, audit: Audit) -> None:
        self._audit = audit
        self._dropped = 0
        self._dropped_at = -math.inf
        self._limited = 0

    def connected(self, client: LoggedClient, node: str) -> None:
        """Log that the client is a node now."""
        principal = f" as {client.principal.title}" if client.principal is not None else ""
        logger.log(
            _level(client),
            "%s has connected from %s%s.",
            node,
            client.peer,
            principal,
            extra=_event("connected", client),
        )

    def logged_in(self, client: LoggedClient, principal: Principal) -> None:
        """Record a login."""
        self._audit.login(principal=principal.title, ip=client.address)

    def left(self, client: LoggedClient) -> None:
        """Log that the client's connection is lost."""
        level, extra = _level(client), _event("left", client)
        logger.log(level, "%s has left.", client.name, extra=extra)

    def closed(self, client: LoggedClient, reason: CloseReason, *, level: int) -> None:
        """Log that the hub closes the connection, or record that as a refusal.

        Args:
            level: of the log line.
        """
        refused = REFUSALS.get(reason.code)
        node, principal = _node(client), _principal(client)
        if refused is not None:
            text = reason.reason
            self._audit.refused(refused, text, node=node, principal=principal, ip=client.address)
            return
        if reason is REPLACED:
            self._audit.name_taken(node=node, principal=principal, ip=client.address)
        text = "%s is closed: %s."
        logger.log(level, text, client.name, reason.reason, extra=_event("closed", client, reason))

    def report_drops(self, client: LoggedClient, now: float, reason: str) -> None:
        """Log and record messages that were dropped since the last call.

        Args:
            now: seconds of the loop's clock.
            reason: why messages were dropped that were more than the client may send.
        """
        if client.limited != self._limited:
            self._limited = client.limited
            text, node = f"messages are dropped: {reason}", _node(client)
            principal, address = _principal(client), client.address
            self._audit.refused("limit", text, node=node, principal=principal, ip=address)
        new = client.queue.dropped - self._dropped
        if new and now - self._dropped_at >= INTERVAL:
            self._dropped = client.queue.dropped
            self._dropped_at = now
            logger.warning(
                "%s reads too slowly: %d messages dropped, %d in all.",
                client.name,
                new,
                client.queue.dropped,
                extra=_event("dropped", client),
            )


def _level(client: LoggedClient) -> int:
    """Return the level of the lines that a client has come or left.

    It is lower for commands, unless the client has logged in: anybody may take such a name.
    """
    is_tool = client.principal is None and OWN_TOOL.fullmatch(_node(client))
    return logging.DEBUG if is_tool else logging.INFO


def _node(client: LoggedClient) -> str:
    return client.endpoint.node if client.endpoint is not None else ""


def _principal(client: LoggedClient) -> str:
    return client.principal.title if client.principal is not None else ""


def _event(
    event: str, client: LoggedClient, reason: CloseReason | None = None
) -> dict[str, object]:
    """Return the fields of a line in the log's JSON format."""
    fields: dict[str, object] = {"ip": client.address}
    if client.endpoint is not None:
        fields["node"] = client.endpoint.node
    if client.principal is not None:
        fields["principal"] = client.principal.title
    if reason is not None:
        fields["code"] = reason.code
    return {"event": event, "fields": fields}
