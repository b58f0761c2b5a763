"""Messages to the service manager: systemd learns when the hub is ready, alive, and about to end.

This is the protocol of sd_notify(3): datagrams of ``NAME=value`` lines to the socket that the
variable ``NOTIFY_SOCKET`` names. With ``WatchdogSec=`` in the unit file, systemd restarts a hub
whose event loop has not sent ``WATCHDOG=1`` for so long.
"""

from __future__ import annotations

import logging
import os
import socket
import time
from collections.abc import Callable, Mapping

from fibws.hub.delivery.clock import Clock, Timer

logger = logging.getLogger("fibws.hub")

SHORTEST_WATCHDOG = 0.02
"""Least seconds of the watchdog: with fewer, the hub would do nothing else than feed it."""


class ServiceManager:
    """Informs the service manager, if there is one.

    Args:
        clock: the event loop.
        status: returns a line for ``systemctl status``.
        environment: the variables that the process was started with.
    """

    def __init__(
        self,
        clock: Clock,
        status: Callable[[], str],
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        self._address = environment.get("NOTIFY_SOCKET", "")
        self._interval = _watchdog_seconds(environment) / 2
        self._clock = clock
        self._status = status
        self._socket: socket.socket | None = None
        self._timer: Timer | None = None
        self._fault = ""
        """Why the last message could not be sent."""
        if self._address and hasattr(socket, "AF_UNIX"):
            flags = socket.SOCK_DGRAM | getattr(socket, "SOCK_CLOEXEC", 0)
            self._socket = socket.socket(socket.AF_UNIX, flags)
            self._socket.setblocking(False)

    def ready(self) -> None:
        """Report that clients can connect; from now on the watchdog is fed."""
        self._send(READY="1", STATUS=self._status())
        if self._interval and self._timer is None:
            self._feed()

    def reloading(self) -> None:
        """Report that files are read again; `ready` ends that."""
        microseconds = time.monotonic_ns() // 1000  # systemd's clock, CLOCK_MONOTONIC
        self._send(RELOADING="1", MONOTONIC_USEC=str(microseconds))

    def stopping(self) -> None:
        """Report that the hub is about to end."""
        self._send(STOPPING="1", STATUS=self._status())

    def close(self) -> None:
        """Send nothing more."""
        if self._timer is not None:
            self._timer.cancel()
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _feed(self) -> None:
        self._send(WATCHDOG="1", STATUS=self._status())
        self._timer = self._clock.call_later(self._interval, self._feed)

    def _send(self, **values: str) -> None:
        if self._socket is None:
            return
        text = "\n".join(f"{name}={value}" for name, value in values.items())
        # A name that begins with @ is in Linux's abstract namespace.
        address = f"\0{self._address[1:]}" if self._address.startswith("@") else self._address
        fault = ""
        try:
            self._socket.sendto(text.encode(), address)
        except OSError as error:
            fault = error.strerror or str(error)  # The latter for a path that is too long.
        if fault and fault != self._fault:
            logger.warning("Cannot notify the service manager: %s.", fault)
        self._fault = fault


def _watchdog_seconds(environment: Mapping[str, str]) -> float:
    """Return the seconds after which systemd restarts a silent hub; 0 if it never does."""
    process = environment.get("WATCHDOG_PID", "")
    microseconds = environment.get("WATCHDOG_USEC", "")
    is_number = microseconds.isascii() and microseconds.isdecimal() and int(microseconds) > 0
    if not is_number or (process and process != str(os.getpid())):
        return 0.0
    return max(int(microseconds) / 1_000_000, SHORTEST_WATCHDOG)
