"""The hub's URL, and the node's name in it."""

from __future__ import annotations

import os
from urllib.parse import parse_qsl, quote, urlencode, urlsplit

from fibws.errors import InvalidAddress

DEFAULT_PORT = 9090
DEFAULT = f"ws://127.0.0.1:{DEFAULT_PORT}"
ENVIRONMENT = "FIBWS_HUB"
LOOPBACK = ("127.0.0.1", "::1", "localhost")
"""The addresses of this machine."""


def hub_url(address: str | None = None) -> str:
    """Return the URL of an address: ``ws://robot:9090`` for ``robot``.

    Args:
        address: the hub's address; default $FIBWS_HUB, else this machine.

    Raises:
        InvalidAddress: the address is invalid.
    """
    address = (address or os.environ.get(ENVIRONMENT) or DEFAULT).strip()
    url = address if "://" in address else f"ws://{address}"
    try:
        parts = urlsplit(url)
        port = parts.port
    except ValueError as error:
        raise InvalidAddress(address, str(error)) from None
    if parts.scheme not in ("ws", "wss"):
        raise InvalidAddress(address, f"expected ws:// or wss://, got {parts.scheme}://")
    if address.isdigit():
        raise InvalidAddress(address, "the host is missing")
    if not parts.hostname or any(character.isspace() for character in url):
        raise InvalidAddress(address, "the host is missing")
    if port == 0 or parts.fragment:
        raise InvalidAddress(address, "the port is 0" if port == 0 else "it has a # part")
    if port is None and url != address:
        # An address that is spelled as a URL has the default port of its scheme.
        return parts._replace(netloc=f"{parts.netloc}:{DEFAULT_PORT}").geturl()
    return url


def node_url(hub: str, node: str) -> str:
    """Return the hub's URL with the node's name in its query, as ``node=<name>``."""
    parts = urlsplit(hub)
    keys = [(key, value) for key, value in parse_qsl(parts.query, True) if key != "node"]
    query = urlencode([*keys, ("node", node)], safe="/", quote_via=quote)
    return parts._replace(path=parts.path or "/", query=query).geturl()
