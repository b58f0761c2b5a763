"""Which web pages may use an HTTP port: origins and host names, compared strictly.

A browser sends requests of any site to any port of this machine, and does so without asking the
port: a page cannot read a response of another origin, but its request has been carried out. Two
headers tell such requests apart, since no page can change them. ``Origin`` names the page's site;
programs other than browsers do not send it. ``Host`` names the server as the page addresses it: a
stranger's page can give its own name this machine's address (DNS rebinding), so that both headers
agree, and yet name the stranger. An address as ``Host`` proves that no name was rebound. With TLS,
that of the hub or of a trusted proxy, the browser has verified a certificate of the name, which
strangers do not have.

Every HTTP port of fibws asks `AllowedOrigins` or `OwnHosts`, and refuses with status 403:

- the hub's port: pages of allowed origins may open WebSockets,
- the port of the ROS 1 master: no page may call it,
- web_video_server: pages of its own origin may read images.

An origin is written as browsers write it (RFC 6454, section 6.1): a scheme, a host and a port,
without user, path or query. Scheme and host are compared without regard to case, and a scheme's
default port is the same as none. A name that ends in a dot is another name than that without it.
"""

from __future__ import annotations

import ipaddress
import re
from collections.abc import Iterable
from typing import NamedTuple, Self

DEFAULT_PORTS = {"http": 80, "https": 443}
NULL = "null"
"""The origin of pages that have none, such as those opened as files."""
ANY = "*"

_HOST = r"(?P<host>\[[0-9a-f:.]+(?:%[\w.~-]+)?\]|[a-z0-9_.-]+)(?::(?P<port>\d{1,5}))?"
_ORIGIN = re.compile(rf"(?P<scheme>[a-z][a-z0-9+.-]*)://{_HOST}", re.ASCII | re.IGNORECASE)
_AUTHORITY = re.compile(_HOST, re.ASCII | re.IGNORECASE)
_FILES = "file://"
"""The origin of files in browsers that are part of another program."""


class WebOrigin(NamedTuple):
    """A web page's origin: ``("https", "lab.example", 443)``.

    The host is in lower case, an IPv6 address without brackets in its shortest spelling. Schemes
    without a default port have the port None.
    """

    scheme: str
    host: str
    port: int | None

    @classmethod
    def parse(cls, text: str) -> Self | None:
        """Return the origin that a text is; None if it is not exactly one."""
        if text.lower() == _FILES:
            return cls("file", "", None)
        found = _ORIGIN.fullmatch(text)
        if found is None:
            return None
        scheme = found["scheme"].lower()
        return cls._checked(scheme, found["host"], found["port"])

    @classmethod
    def of_host(cls, scheme: str, header: str) -> Self | None:
        """Return the origin of pages under a ``Host`` header; None if the header is invalid."""
        found = _AUTHORITY.fullmatch(header)
        return None if found is None else cls._checked(scheme, found["host"], found["port"])

    @classmethod
    def _checked(cls, scheme: str, host: str, port: str | None) -> Self | None:
        host = host.lower()
        if host.startswith("["):
            try:
                host = str(ipaddress.IPv6Address(host[1:-1]))
            except ValueError:
                return None
        number = DEFAULT_PORTS.get(scheme) if port is None else int(port)
        if number is not None and not 0 < number < 65536:
            return None
        return cls(scheme, host, number)


class OwnHosts:
    """The host names and addresses by which a port may be addressed.

    These are ``localhost``, all IP addresses, which cannot be rebound, and the given names.

    Args:
        names: of the machine; see `machine_names`.
        short: whether all names without a dot count, too, such as those of a local network's or of
            Docker's DNS: public websites have none.
    """

    def __init__(self, names: Iterable[str], *, short: bool = False) -> None:
        self._names = frozenset(name.strip("[]").lower() for name in names if name)
        self._short = short

    def has(self, header: str) -> bool:
        """Return whether a ``Host`` header has one of them."""
        here = WebOrigin.of_host("http", header)
        return here is not None and self.is_own(here.host, here)

    def is_own(self, host: str, dialled: WebOrigin | None) -> bool:
        """Return whether a host is the port's; an address that was dialled cannot be rebound."""
        if host == "localhost" or host.endswith(".localhost") or host in self._names:
            return True
        try:
            address = ipaddress.ip_address(host)
        except ValueError:
            return self._short and bool(host) and "." not in host
        return address.is_loopback or (dialled is not None and host == dialled.host)


class AllowedOrigins:
    """Decides which pages may connect.

    Args:
        allowed: origins, ``null`` or ``*``, from ``--allow-origin``.
        hosts: by which the port may be addressed.
    """

    def __init__(self, allowed: Iterable[str], hosts: OwnHosts) -> None:
        texts = [text.strip().rstrip("/").lower() for text in allowed]
        self._any = ANY in texts
        self._null = NULL in texts
        parsed = (WebOrigin.parse(_FILES if text == "file:" else text) for text in texts)
        self._allowed = frozenset(origin for origin in parsed if origin is not None)
        self._hosts = hosts

    def refusal_of(self, origin: str, host: str, secure: bool = False) -> str | None:
        """Return why a page of an origin may not connect by a host; None if it may.

        Args:
            origin: the request's ``Origin`` header.
            host: the request's ``Host`` header.
            secure: whether the browser's connection has TLS.
        """
        page = WebOrigin.parse(origin)
        if self._any or page in self._allowed or (self._null and origin == NULL):
            return None
        here = WebOrigin.of_host("http", host)
        if secure and page is not None and here is not None:
            if (page.scheme, page.host) == ("https", here.host):
                return None
        if page is None or not self._hosts.is_own(page.host, here):
            return f"Pages of origin {origin} may not connect"
        if here is None or not self._hosts.is_own(here.host, here):
            name = here.host if here is not None else host or "without a Host header"
            return (
                f"Pages may not connect by the name {name}, which is not known to be this machine's"
            )
        return None

    def knows_host(self, host: str, *, secure: bool = False) -> bool:
        """Return whether a ``Host`` header names the port, or the host of an allowed origin.

        Args:
            secure: whether the browser's connection has TLS.
        """
        if self._any or secure or self._hosts.has(host):
            return True
        return any(WebOrigin.of_host(scheme, host) in self._allowed for scheme in DEFAULT_PORTS)


def machine_names(hostname: str) -> set[str]:
    """Return the names of a machine that has a host name: it, its first label, and mDNS's name."""
    name = hostname.lower()
    first = name.partition(".")[0]
    return {name, first, f"{first}.local"} - {"", ".local"}


def origin_of_url(url: str) -> str | None:
    """Return the origin at the beginning of a URL, such as a ``Referer``; None without one."""
    found = re.match(r"[^:/?#]+://[^/?#]*", url)
    return found[0] if found is not None and WebOrigin.parse(found[0]) is not None else None


def is_allowable(text: str) -> bool:
    """Return whether a text may stand after ``--allow-origin``."""
    return text in (ANY, NULL, _FILES) or WebOrigin.parse(text.removesuffix("/")) is not None
