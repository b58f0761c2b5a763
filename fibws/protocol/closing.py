"""Why the hub closes a connection: WebSocket close codes (RFC 6455, section 7.4.1) with reasons.

Codes from 4000 on are ours; a client that sees one should not come back by itself.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Closing:
    """A close code and its reason, which the client's close event shows."""

    code: int
    reason: str


SHUTDOWN = Closing(1001, "the hub is shutting down")
INVALID_UTF8 = Closing(1007, "a text is not UTF-8")
STALLED = Closing(1008, "stopped reading for too long")
OVERFULL = Closing(1008, "too many replies wait to be read")
FRAGMENTS = Closing(1009, "too many fragments in one message")
SILENT = Closing(1011, "no answer to a ping")
REPLACED = Closing(4001, "new node registered with same name")
KILLED = Closing(4002, "shutdown request: user request")
