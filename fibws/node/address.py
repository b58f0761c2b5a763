"""Where a node finds its hub, and how it says there who it is."""

from __future__ import annotations

import os
from urllib.parse import parse_qsl, quote, urlencode, urlsplit

from fibws.errors import InvalidAddress

DEFAULT_PORT = 9090
DEFAULT = f"ws://127.0.0.1:{DEFAULT_PORT}"
ENVIRONMENT = "FIBWS_HUB"
LOOPBACK = ("127.0.0.1", "::1", "localhost")
"""What names this machine."""


def hub_url(address: str | None = None) -> str:
    """The URL that an address stands for: ``robot`` is ``ws://robot:9090``.

    Args:
        address: where the hub is; by default where $FIBWS_HUB says, or else on this machine.

    Raises:
        InvalidAddress: it is no address of a hub.
    """
    address = (address or os.environ.get(ENVIRONMENT) or DEFAULT).strip()
    url = address if "://" in address else f"ws://{address}"
    try:
        parts = urlsplit(url)
        port = parts.port
    except ValueError as error:
        raise InvalidAddress(address, str(error)) from None
    if parts.scheme not in ("ws", "wss"):
        raise InvalidAddress(address, f"a hub speaks ws:// or wss://, not {parts.scheme}://")
    if address.isdigit():
        raise InvalidAddress(address, "a number alone names no host")
    if not parts.hostname or any(character.isspace() for character in url):
        raise InvalidAddress(address, "it names no host")
    if port == 0 or parts.fragment:
        raise InvalidAddress(address, "its port is 0" if port == 0 else "it has a # part")
    if port is None and url != address:
        # Only what is spelled as a URL has a URL's default, which is 80.
        return parts._replace(netloc=f"{parts.netloc}:{DEFAULT_PORT}").geturl()
    return url


def node_url(hub: str, node: str) -> str:
    """The hub's URL with the node's name in its query, as the key ``node``."""
    parts = urlsplit(hub)
    keys = [(key, value) for key, value in parse_qsl(parts.query, True) if key != "node"]
    query = urlencode([*keys, ("node", node)], safe="/", quote_via=quote)
    return parts._replace(path=parts.path or "/", query=query).geturl()
