"""What a proxy in front of the hub says about its clients: address, scheme, host.

Anybody can send the headers ``X-Forwarded-For``, ``X-Forwarded-Proto`` and ``X-Forwarded-Host``, so
they count only if the connection comes from a trusted proxy (``--trusted-proxy``). Of several
values, each proxy has appended its own on the right.

`TrustedProxies.resolve` puts the facts into the request's headers, where everything else finds
them: ``Host`` is the name in the browser's address bar, as far as it is known, and
``X-Forwarded-Proto`` is how the browser's connection is secured. Headers of strangers are removed,
except ``X-Forwarded-For``: while it is there, nobody knows which machine the client is.
"""

from __future__ import annotations

import ipaddress
import logging
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import TypeAlias

from websockets.datastructures import Headers

from fibws.errors import SettingError

Address: TypeAlias = ipaddress.IPv4Address | ipaddress.IPv6Address
Network: TypeAlias = ipaddress.IPv4Network | ipaddress.IPv6Network

logger = logging.getLogger("fibws.hub")

FORWARDED, FOR = "Forwarded", "X-Forwarded-For"
PROTO, HOST = "X-Forwarded-Proto", "X-Forwarded-Host"
_WITH_PORT = re.compile(r"\[([^\]]*)\](?::\d+)?|([\d.]+):\d+")


class TrustedProxies:
    """The proxies whose headers count.

    Args:
        networks: their addresses or networks, such as ``127.0.0.1`` and ``10.0.0.0/8``.

    Raises:
        HubError: a network is invalid.
    """

    def __init__(self, networks: Iterable[str]) -> None:
        self._networks = [parse_network(each, "--trusted-proxy") for each in networks]
        self._has_warned = False

    def resolve(self, peer: str, headers: Headers, *, tls: bool) -> str:
        """Return the client's address, and put the facts into the request's headers.

        Args:
            peer: the address that the connection comes from.
            tls: whether the connection itself has TLS.
        """
        address, scheme, host = peer, "https" if tls else "http", None
        used = [PROTO, HOST]
        if self._is_trusted(_parse(peer)):
            hops = [_parse(each) for each in _values(headers, FOR)]
            address = self._client(peer, hops)
            if hops and None not in hops:
                used.append(FOR)
            # Its connection to the hub says nothing about the browser's connection to the proxy.
            scheme = next(_values(headers, PROTO), "http").lower()
            host = next(_values(headers, HOST), None)
        else:
            self._warn(peer, headers)
        for name in (*used, *(["Host"] if host is not None else [])):
            if name in headers:
                del headers[name]
        headers[PROTO] = "https" if scheme in ("https", "wss") else "http"
        if host is not None:
            headers["Host"] = host
        return address

    def _warn(self, peer: str, headers: Headers) -> None:
        """Log once that there seems to be a proxy which is not trusted."""
        name = next((each for each in (FOR, FORWARDED) if each in headers), None)
        if name is None or self._has_warned:
            return
        self._has_warned = True
        logger.warning(
            "A request from %s has the header %s, which does not count. If a proxy is there, start "
            "the hub with --trusted-proxy %s: otherwise all clients behind it share one address "
            "and its limits.",
            *(peer, name, peer),
        )

    def _client(self, peer: str, hops: Sequence[Address | None]) -> str:
        """Return the address of the nearest hop that is not a trusted proxy.

        Args:
            hops: the addresses before ``peer``, the nearest first; None for what is no address.
        """
        client = peer
        for address in hops:
            if address is None:  # A proxy may hide an address; further ones may be forged.
                break
            client = str(address)
            if not self._is_trusted(address):
                break
        return client

    def _is_trusted(self, address: Address | None) -> bool:
        return address is not None and any(address in network for network in self._networks)


def parse_network(text: str, flag: str) -> Network:
    """Return the network or the address that a flag names.

    Raises:
        HubError: it is invalid.
    """
    try:
        return ipaddress.ip_network(text.strip(), strict=False)
    except ValueError:
        raise SettingError(
            f"{flag} must be an IP address or a network such as 10.0.0.0/8, got {text}"
        ) from None


def is_secure(headers: Headers) -> bool:
    """Return whether the browser's connection has TLS; the headers are resolved."""
    return headers.get(PROTO) == "https"


def _values(headers: Headers, name: str) -> Iterator[str]:
    """Yield the values of a header, the last one first."""
    for value in reversed(",".join(headers.get_all(name)).split(",")):
        if value.strip():
            yield value.strip()


def _parse(text: str) -> Address | None:
    """Return an address without its port; None if the text is not an address."""
    if found := _WITH_PORT.fullmatch(text):
        text = found[1] or found[2] or ""
    try:
        address = ipaddress.ip_address(text)
    except ValueError:
        return None
    mapped = address.ipv4_mapped if isinstance(address, ipaddress.IPv6Address) else None
    return mapped or address
