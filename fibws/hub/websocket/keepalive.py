"""Keepalive: deadlines of one connection for handshake, pongs, reading, and the close handshake."""

from __future__ import annotations

from typing import Literal

from fibws.hub.settings import Settings
from fibws.protocol.websocket import SILENT, STALLED, CloseReason

Verdict = CloseReason | Literal["ping", "abort"] | None
"""The action due for a client: close it, ping it, cut it off, or nothing."""


class Keepalive:
    """Keeps one client's deadlines; all times are seconds of one steady clock.

    Args:
        now: when the socket was opened.
    """

    __slots__ = (
        "_closing_since",
        "_open",
        "_paused_since",
        "_pinged_at",
        "_pong_due",
        "_settings",
        "_since",
        "_unsent",
    )

    def __init__(self, settings: Settings, now: float) -> None:
        self._settings = settings
        self._since = self._pinged_at = now
        self._open = False
        self._pong_due: float | None = None
        self._paused_since: float | None = None
        self._unsent = 0
        self._closing_since: float | None = None

    def opened(self) -> None:
        """Called when the handshake is done."""
        self._open = True

    def ponged(self) -> None:
        """Called when the client has answered a ping."""
        self._pong_due = None

    def behind(self, now: float) -> None:
        """Extend the deadline of the pong: the client sends, or has sent what was not read."""
        if self._pong_due is not None:
            self._pong_due = now + self._settings.ping_timeout

    def paused(self, now: float, unsent: int) -> None:
        """Called when the socket's buffer is full; ``unsent`` decreases while the client reads.

        A client that asks for a large file needs no handshake: it has the time of one for each
        piece that it is sent.
        """
        self._paused_since = now
        self._unsent = unsent
        if not self._open:
            self._since = now

    def sends(self, now: float) -> None:
        """Called when the next piece of a large file is there for a client without handshake."""
        self._since = now

    def resumed(self) -> None:
        """Called when the socket takes data again."""
        self._paused_since = None

    def closing(self, now: float) -> None:
        """Called when the last frame is on its way, so that the client must close."""
        self._closing_since = now

    def excuse(self, seconds: float) -> None:
        """Extend all deadlines: the hub was busy for so long and read nothing meanwhile."""
        self._since += seconds
        if self._pong_due is not None:
            self._pong_due += seconds
        if self._paused_since is not None:
            self._paused_since += seconds
        if self._closing_since is not None:
            self._closing_since += seconds

    def verdict(self, now: float, unsent: int) -> Verdict:
        """Return the overdue action; ``unsent`` decreases while the client reads."""
        settings = self._settings
        self._see_progress(now, unsent)
        if self._closing_since is not None:
            return "abort" if now - self._closing_since > settings.close_timeout else None
        if not self._open:
            return "abort" if now - self._since > settings.open_timeout else None
        if self._paused_since is not None and now - self._paused_since > settings.stall_timeout:
            return STALLED
        if self._pong_due is not None and now > self._pong_due:
            return SILENT
        if settings.ping_interval and now - self._pinged_at >= settings.ping_interval:
            return self._ping(now)
        return None

    def _see_progress(self, now: float, unsent: int) -> None:
        """Restart the deadlines of a slow client that reads, though its socket is never empty."""
        if self._paused_since is not None:
            if unsent < self._unsent:
                self._paused_since = now
                self._pong_due = None
                if not self._open:
                    self._since = now
            self._unsent = unsent

    def _ping(self, now: float) -> Literal["ping"] | None:
        """Ping, unless a pong is missing already or the ping would wait behind other bytes."""
        self._pinged_at = now
        if self._pong_due is not None or self._paused_since is not None:
            return None
        self._pong_due = now + self._settings.ping_timeout
        return "ping"
