"""The hub's URL: what is in it, and where a proxy redirects it to."""

from __future__ import annotations

import os
import re
from urllib.parse import SplitResult, parse_qsl, quote, unquote_plus, urlencode, urljoin, urlsplit

from fibws.errors import InvalidAddress
from fibws.hub_advice import DEFAULT_PORT as DEFAULT_PORT
from fibws.hub_advice import LOOPBACK as LOOPBACK
from fibws.hub_advice import is_loopback as is_loopback

DEFAULT = f"ws://127.0.0.1:{DEFAULT_PORT}"
ENVIRONMENT = "FIBWS_HUB"
_TOKEN_KEY = "token"
_SCHEME_ALONE = re.compile(r"(wss?):/(?!/)", re.IGNORECASE)
"""A scheme that lacks a slash: what follows would be a path at a host called ws."""


def hub_url(address: str | None = None) -> str:
    """Return the URL of an address: ``ws://robot:9090`` for ``robot``.

    A token in it, as in ``ws://robot:9090/?token=...``, is left out: see `token_in`.

    Args:
        address: the hub's address; default $FIBWS_HUB, else this machine.

    Raises:
        InvalidAddress: the address is invalid.
    """
    if not isinstance(address, str | None):
        raise TypeError(f"a hub's address must be a string such as {DEFAULT}, got {address!r}")
    address = without_token((address or os.environ.get(ENVIRONMENT) or DEFAULT).strip())
    if found := _SCHEME_ALONE.match(address):
        raise InvalidAddress(address, f"expected {found[1]}://, got {found[0]}")
    url = address if "://" in address else f"ws://{address}"
    try:
        parts = urlsplit(url)
    except ValueError as error:
        raise InvalidAddress(address, str(error)) from None
    _check(address, url, parts)
    port = _port(address, parts)
    if port is None and url != address:
        # An address that is spelled as a URL has the default port of its scheme.
        return parts._replace(netloc=f"{parts.netloc}:{DEFAULT_PORT}").geturl()
    return url


def _check(address: str, url: str, parts: SplitResult) -> None:
    """Raise InvalidAddress if a part of an address, other than its port, is invalid."""
    if parts.scheme not in ("ws", "wss"):
        expected = {"http": "ws://", "https": "wss://"}.get(parts.scheme, "ws:// or wss://")
        raise InvalidAddress(address, f"expected {expected}, got {parts.scheme}://")
    if address.isdigit() or not parts.hostname or any(each.isspace() for each in url):
        raise InvalidAddress(address, "the host is missing")
    if not _is_host(parts.hostname):
        raise InvalidAddress(address, f"{parts.hostname} is not a host name")
    if parts.username is not None and parts.password is None:
        raise InvalidAddress(address, "it has a user without a password before the @")
    if parts.fragment:
        raise InvalidAddress(address, "it has a # part")


def _is_host(name: str) -> bool:
    """Return whether a host can be looked up: each part of its name has 1 to 63 letters."""
    if name.isascii():
        return all(0 < len(part) < 64 for part in name.removesuffix(".").split("."))
    try:
        name.encode("idna")
    except UnicodeError:
        return False
    return True


def _port(address: str, parts: SplitResult) -> int | None:
    try:
        port = parts.port
    except ValueError:
        text = parts.netloc.rpartition(":")[2]
        fault = f"the port must be a number from 1 to 65535, got {text}"
        raise InvalidAddress(address, fault) from None
    if port == 0:
        raise InvalidAddress(address, "the port is 0")
    if port is None and parts.netloc.endswith(":"):
        raise InvalidAddress(address, "the port is missing after the colon")
    return port


def token_in(address: str) -> str | None:
    """Return the token in an address's query, as in ``robot/?token=...``; None if it has none."""
    found = [value for key, value in map(_key_and_value, _pairs(address)) if key == _TOKEN_KEY]
    return unquote_plus(found[0]) if found and found[0] else None


def without_token(address: str) -> str:
    """Return an address without the token in its query, to be shown; the rest is unchanged."""
    pairs = _pairs(address)
    kept = [pair for pair in pairs if _key_and_value(pair)[0] != _TOKEN_KEY]
    if len(kept) == len(pairs):
        return address
    before, _, rest = address.partition("?")
    _, hash_, fragment = rest.partition("#")
    return f"{before}{'?' if kept else ''}{'&'.join(kept)}{hash_}{fragment}"


def node_url(hub: str, node: str) -> str:
    """Return the hub's URL with the node's name in its query, as ``node=<name>``."""
    parts = urlsplit(hub)
    keys = [*_without_node(parts.query), ("node", node)]
    query = urlencode(keys, safe="/", quote_via=quote)
    return parts._replace(path=parts.path or "/", query=query).geturl()


def page_url(hub: str, path: str = "") -> str:
    """Return the URL of what the hub serves over HTTP: its page, or ``healthz``.

    A hub at ``wss://lab/robot``, behind a proxy, has its page at ``https://lab/robot/``.
    """
    parts = urlsplit(hub)
    scheme = "https" if parts.scheme == "wss" else "http"
    return f"{scheme}://{parts.netloc}{parts.path.rstrip('/')}/{path}"


def redirected(hub: str, location: str) -> str:
    """Return the URL of a hub that an HTTP server redirects to.

    A proxy redirects ``/robot`` to ``/robot/``, often as ``http://``, even if it is reached with
    TLS: on the same host, TLS is kept.

    Args:
        hub: the URL that was requested.
        location: the header ``Location`` of the response; a node's name in it is removed.

    Raises:
        InvalidAddress: it is not an address of a hub, or has no TLS although the request had.
    """
    old = urlsplit(hub)
    try:
        new = urlsplit(urljoin(hub, location))
    except ValueError as error:
        raise InvalidAddress(location, str(error)) from None
    scheme = {"http": "ws", "https": "wss"}.get(new.scheme, new.scheme)
    if scheme not in ("ws", "wss"):
        raise InvalidAddress(location, f"{hub} redirects to it")
    if old.scheme == "wss" and scheme == "ws":
        if new.hostname != old.hostname:
            raise InvalidAddress(location, f"{hub} redirects to it, without TLS")
        scheme, new = "wss", new._replace(netloc=old.netloc)
    return hub_url(new._replace(scheme=scheme, query=urlencode(_without_node(new.query))).geturl())


def _without_node(query: str) -> list[tuple[str, str]]:
    return [(key, value) for key, value in parse_qsl(query, True) if key != "node"]


def _pairs(address: str) -> list[str]:
    """Return the query of an address, which may be invalid, in pieces such as ``a=b``."""
    query = address.partition("?")[2].partition("#")[0]
    return query.split("&") if query else []


def _key_and_value(pair: str) -> tuple[str, str]:
    key, _, value = pair.partition("=")
    return unquote_plus(key), value
