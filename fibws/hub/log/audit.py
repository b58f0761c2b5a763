"""Audit events: logins, refusals, and changes that affect other clients.

An event is one log line of the logger ``fibws.hub.audit``. In the log's text format it is an
ordinary line, in its JSON format an object with the event's name and its fields::

    audit.refused("right", 'publish /cmd_vel: missing right "publish"', node="/joystick")

    {"ts": "2026-01-31T09:26:53.589Z", "level": "warning", "logger": "fibws.hub.audit",
     "event": "refused", "message": "Refused /joystick (guest, 10.0.0.7): publish /cmd_vel: ...",
     "reason": "right", "node": "/joystick", "principal": "guest", "ip": "10.0.0.7"}

A caller names the client by whatever it knows of node, principal and address; of a node that is
connected, the rest is looked up. Refusals are counted in `Audit.refusals` for ``/metrics``. Lines
of logins, refusals and parameters are limited, so that a client which tries a thousand times a
second does not fill the disk.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal, NamedTuple, TypeAlias, get_args

from fibws.hub.log.text import LineLimit, printable

logger = logging.getLogger("fibws.hub.audit")

Reason: TypeAlias = Literal["authentication", "right", "limit", "origin", "address"]
"""Why something was refused: the credentials, a missing right, a limit, the page's origin, or the
address of a ROS 1 node."""

LOGINS_PER_CLIENT = 100
"""Lines a second about logins from one address, each of another principal."""
LOGINS = 1000
"""Lines a second about all logins."""
WRITES_PER_CLIENT = 500
"""Lines a second about parameters that one client sets: a launch file may set hundreds."""
WRITES = 1000
"""Lines a second about parameters that all clients set."""


class ClientIdentity(NamedTuple):
    """A client, as far as it is known; empty texts stand for unknown."""

    principal: str = ""
    ip: str = ""


class Audit:
    """The audit events of one hub.

    Args:
        now: returns the seconds since some moment in the past.
        identify: returns the principal and the address of a connected node.
    """

    def __init__(
        self,
        now: Callable[[], float],
        identify: Callable[[str], ClientIdentity] = lambda node: ClientIdentity(),
    ) -> None:
        self.refusals: dict[Reason, int] = dict.fromkeys(get_args(Reason), 0)
        """How often something was refused so far, by the reason."""
        self._now = now
        self._identify = identify
        self._refused = LineLimit()
        self._logins = LineLimit(LOGINS_PER_CLIENT, LOGINS)
        self._written = LineLimit(WRITES_PER_CLIENT, WRITES)

    def login(self, *, principal: str, node: str = "", ip: str = "") -> None:
        """Record that a client has logged in, unless that was recorded just before."""
        client = self._client(node, principal, ip)
        hidden = self._logins.admit(client["node"] or client["ip"], principal, self._now())
        if hidden is not None:
            text = f"{_named(client)} has logged in{_more(hidden)}"
            self._record(logging.INFO, "login", text, client)

    def refused(
        self, reason: Reason, text: str, *, node: str = "", principal: str = "", ip: str = ""
    ) -> None:
        """Count a refusal, and record it unless the same one was recorded just before.

        Args:
            text: the refusal and its reason, as sent to the client.
        """
        self.refusals[reason] += 1
        client = self._client(node, principal, ip)
        # Without a node, each attempt comes from another port, but from the same address.
        hidden = self._refused.admit(client["node"] or client["ip"], text, self._now())
        if hidden is not None:
            text = f"Refused {_named(client)}: {printable(text).rstrip('.')}{_more(hidden)}"
            self._record(logging.WARNING, "refused", text, {"reason": reason, **client})

    def count(self, reason: Reason) -> None:
        """Count a refusal that is logged elsewhere."""
        self.refusals[reason] += 1

    def connections_refused(self, why: str, count: int) -> None:
        """Record that connections were refused for a limit; each of them has been counted.

        Args:
            count: 0 if they wait until they can be accepted.
        """
        refused = f". {count} refused" if count else ""
        fields = {"reason": "limit", "why": why, "count": str(count)}
        text = f"Cannot accept more connections: {why}{refused}"
        self._record(logging.WARNING, "refused", text, fields)

    def parameter_written(self, parameter: str, *, node: str, deleted: bool = False) -> None:
        """Record that a node has set or deleted a parameter."""
        client = self._client(node)
        did = "deleted" if deleted else "set"
        hidden = self._written.admit(node, f"{did} {parameter}", self._now())
        if hidden is not None:
            text = f"{_named(client)} {did} parameter {printable(parameter)}{_more(hidden)}"
            fields = {"parameter": parameter, **client}
            self._record(logging.INFO, f"parameter_{did}", text, fields)

    def node_killed(self, killed: str, *, node: str) -> None:
        """Record that a node has ended another one."""
        client = self._client(node)
        text = f"{_named(client)} kills {printable(killed)}"
        self._record(logging.INFO, "node_killed", text, {"killed": killed, **client})

    def node_unregistered(self, unregistered: str, *, node: str) -> None:
        """Record that a node has removed another one, which did not answer."""
        client = self._client(node)
        text = f"{_named(client)} unregisters {printable(unregistered)}"
        self._record(
            logging.INFO, "node_unregistered", text, {"unregistered": unregistered, **client}
        )

    def recording_started(self, folder: str, *, node: str) -> None:
        """Record that a node has had the hub begin to record all topics."""
        client = self._client(node)
        text = f"{_named(client)} starts the recording in {printable(folder)}"
        self._record(logging.INFO, "recording_started", text, {"folder": folder, **client})

    def recording_stopped(self, folder: str, *, node: str) -> None:
        """Record that a node has ended the hub's recording."""
        client = self._client(node)
        text = f"{_named(client)} stops the recording in {printable(folder)}"
        self._record(logging.INFO, "recording_stopped", text, {"folder": folder, **client})

    def name_taken(self, *, node: str, principal: str = "", ip: str = "") -> None:
        """Record that a client has lost its node's name to another client.

        Args:
            node: the name.
            principal: of the client that had the name.
            ip: the address of that client.
        """
        client = {"node": node, "principal": principal, "ip": ip}
        text = f"{_named(client)} has lost its name to another client"
        self._record(logging.WARNING, "name_taken", text, client)

    def hub_joined(self, hub: str, address: str, *, node: str) -> None:
        """Record that another hub is reached; ``node`` stands for the link."""
        text = f"Hub {printable(hub)} is connected ({printable(address)})"
        self._record(logging.INFO, "hub_joined", text, {"hub": hub, "node": node})

    def hub_lost(self, hub: str, reason: str, *, node: str) -> None:
        """Record that another hub is not reached any more."""
        text = f"Hub {printable(hub)} is lost: {printable(reason)}"
        fields = {"hub": hub, "node": node, "why": reason}
        self._record(logging.WARNING, "hub_lost", text, fields)

    def reloaded(self, what: str, changes: Sequence[str], files: Sequence[Path]) -> None:
        """Record that something was read again, such as ``tokens`` or ``certificates``.

        Args:
            changes: what is different now. Without any there is a warning, since somebody has
                changed another file than the hub reads.
            files: what was read.
        """
        level, text = logging.INFO, f"Reloaded: {printable(', '.join(changes))}"
        if not changes:
            level, text = logging.WARNING, "Reloaded, but the hub has no files to read again"
            if files:
                names = printable(", ".join(map(str, files)))
                text = f"Reloaded, but nothing has changed in {names}"
        self._record(level, "reloaded", text, {"what": what, "changes": ", ".join(changes)})

    def reload_failed(self, what: str, error: str) -> None:
        """Record that something could not be read again, so that the older one is still used."""
        text = f"Cannot reload {what}: {printable(error)}"
        self._record(logging.ERROR, "reload_failed", text, {"what": what, "error": error})

    def _client(self, node: str, principal: str = "", ip: str = "") -> dict[str, str]:
        known = self._identify(node) if node else ClientIdentity()
        return {"node": node, "principal": principal or known.principal, "ip": ip or known.ip}

    def _record(self, level: int, event: str, text: str, fields: dict[str, str]) -> None:
        logger.log(level, "%s.", text, extra={"event": event, "fields": fields})


def _more(hidden: int) -> str:
    return f" ({hidden} more since the last line)" if hidden else ""


def _named(client: dict[str, str]) -> str:
    """Return how the log calls a client: ``/joystick (guest, 10.0.0.7)``."""
    name, *rest = [printable(each) for each in client.values() if each] or ["a client"]
    return f"{name} ({', '.join(rest)})" if rest else name
