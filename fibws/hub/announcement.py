"""What the hub prints when clients can connect: the addresses by which to reach it."""

from __future__ import annotations

import ipaddress
import socket
from collections.abc import Iterable

import ifaddr

from fibws.hub.settings import Settings
from fibws.hub.websocket.origins import AllowedOrigins

ALL_IPV4 = "0.0.0.0"
ALL_IPV6 = "::"


def announcement(settings: Settings, url: str) -> str:
    """Return the lines to print, without a newline at the end.

    Args:
        url: the hub's URL on this machine.
    """
    page = url.replace("ws", "http", 1)
    lines = [f"The hub listens at {url}; open {page}/ in a browser. Press Ctrl-C to stop."]
    port = url.rpartition(":")[2]
    addresses = addresses_for_others(settings.host)
    if addresses:
        lines.append("Other machines reach it at:")
        lines += (
            f"  ws://{address}:{port}, and its page at http://{address}:{port}/"
            for address in addresses
        )
        origin = f"http://{socket.gethostname().lower()}:{port}"
        allowed = AllowedOrigins(settings.allow_origin, settings.host)
        if allowed.refusal_of(origin, origin.removeprefix("http://")) is not None:
            lines.append(
                "The page opened by a name instead of an address needs an option, such as "
                f"--allow-origin {origin}"
            )
    return "\n".join(lines)


def addresses_for_others(host: str) -> list[str]:
    """Return the addresses by which other machines reach a hub that listens on a host.

    They are as URLs spell them, and empty if it listens on this machine only. IPv6 addresses that
    are valid on one link only are left out, since browsers do not take them.
    """
    if host in (ALL_IPV4, ALL_IPV6, ""):
        versions = {ALL_IPV4: {4}, ALL_IPV6: {6}}.get(host, {4, 6})
        return [_in_url(each) for each in _of_interfaces() if each.version in versions]
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return [] if host.lower() == "localhost" else [host]
    return [] if address.is_loopback else [_in_url(address)]


def _of_interfaces() -> Iterable[ipaddress.IPv4Address | ipaddress.IPv6Address]:
    """Yield the addresses of all network interfaces, those of IPv4 first."""
    found = set()
    for adapter in ifaddr.get_adapters():
        for each in adapter.ips:
            # IPv6 addresses have their flow and their scope with them.
            text = each.ip if isinstance(each.ip, str) else each.ip[0]
            address = ipaddress.ip_address(text)
            is_local = address.version == 6 and address.is_link_local
            if not (address.is_loopback or is_local):
                found.add(address)
    return sorted(found, key=lambda address: (address.version, int(address)))


def _in_url(address: ipaddress.IPv4Address | ipaddress.IPv6Address) -> str:
    return f"[{address}]" if address.version == 6 else str(address)
