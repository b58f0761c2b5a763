"""What to do if no hub is found at an address; which addresses are this machine's."""

from __future__ import annotations

import os
import re
from urllib.parse import urlsplit

from fibws.command_names import command_name, is_set_up

DEFAULT_PORT = 9090
LOOPBACK = ("127.0.0.1", "::1", "localhost")
"""The addresses of this machine."""
_LOOPBACK_NETWORK = re.compile(r"127(\.[0-9]{1,3}){3}")


def is_loopback(host: str) -> bool:
    """Return whether a host is this machine: what is sent there is on no network."""
    return host.lower() in LOOPBACK or _LOOPBACK_NETWORK.fullmatch(host) is not None


def advice(hub: str, *, answers: bool = False) -> str:
    """Return what to do if no hub is found at an address: sentences without the last full stop.

    Args:
        hub: the URL that was tried.
        answers: whether something answers there which is not a hub.
    """
    parts = urlsplit(hub)
    host, port, is_secure = parts.hostname or "", parts.port, parts.scheme == "wss"
    is_local = is_loopback(host)
    if port is None:
        shown = f"[{host}]" if ":" in host else host
        others = [f"{parts.scheme}://{shown}:{DEFAULT_PORT}"]
        if not is_secure and not is_local:
            others.append(f"wss://{shown}{parts.path.rstrip('/')}")
        tried = 443 if is_secure else 80
        return f"Without a port in the address, it is {tried}: perhaps {' or '.join(others)}"
    if answers and port == 443 and not is_secure:
        return f"Perhaps {parts._replace(scheme='wss').geturl()}"
    if not is_local:
        return "Check the address, and that the hub there was started with --host"
    command = command_name("core" if is_set_up(os.environ) else "hub")
    option = f" --port {port}" if port != DEFAULT_PORT else ""
    if answers:
        free = port + 1 if port < 65535 else 0
        return (
            f"Check which program listens there, or start a hub elsewhere: {command} --port {free}"
        )
    return f"Start one with: {command}{option}{' --self-signed' if is_secure else ''}"
