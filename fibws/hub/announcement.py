"""The text that the hub prints when clients can connect: its addresses."""

from __future__ import annotations

import ipaddress
import socket
from urllib.parse import urlsplit

import ifaddr

from fibws.hub.settings import Settings
from fibws.hub.tls import self_signed
from fibws.origins import AllowedOrigins, OwnHosts

ALL_IPV4 = "0.0.0.0"
ALL = ("::", "")
"""Hosts that stand for all addresses of IPv4 and IPv6."""


def announcement(settings: Settings, url: str, master_uri: str = "") -> str:
    """Return the lines to print, without a newline at the end.

    Args:
        url: the hub's URL on this machine.
        master_uri: the URI of its ROS 1 master, if it has one.
    """
    page = url.replace("ws", "http", 1)
    lines = [f"The hub listens at {url}; open {page}/ in a browser. Press Ctrl-C to stop."]
    if master_uri:
        lines.append(f"ROS 1 nodes join it with: export ROS_MASTER_URI={master_uri}")
        if settings.ros1_allow and not settings.ros1_host:
            port = urlsplit(master_uri).port
            uris = [f"http://{address}:{port}/" for address in addresses_for_others(ALL_IPV4)]
            if uris:
                lines.append(f"On machines of --ros1-allow: ROS_MASTER_URI={' or '.join(uris)}")
    parts = urlsplit(url)
    addresses = [
        parts._replace(netloc=f"{address}:{parts.port}").geturl()
        for address in addresses_for_others(settings.host)
    ]
    pages = [each.replace("ws", "http", 1) for each in addresses]
    if addresses:
        lines.append("Other machines reach it at:")
        lines += (
            f"  {address}, and its page at {page}/"
            for address, page in zip(addresses, pages, strict=True)
        )
        origin = f"http://{socket.gethostname().lower()}:{parts.port}"
        allowed = AllowedOrigins(settings.allow_origin, OwnHosts([settings.host]))
        refusal = allowed.refusal_of(origin, origin.removeprefix("http://"))
        if not settings.has_tls and refusal is not None:
            lines.append(
                "The page opened by a name instead of an address needs an option, such as "
                f"--allow-origin {origin}"
            )
    if settings.self_signed:
        lines.append(
            f"On a phone, open {pages[0]}/ and accept its certificate, made by this machine."
            if pages
            else "Phones can reach it with --host 0.0.0.0"
        )
        trusted = self_signed.files().authority
        lines.append(f"Nodes trust it with FIBWS_CA={trusted}; other machines need a copy.")
    return "\n".join(lines)


def addresses_for_others(host: str) -> list[str]:
    """Return the addresses by which other machines reach a hub that listens on a host.

    They are as URLs spell them, and empty if it listens on this machine only. IPv6 addresses that
    are valid on one link only are left out, since browsers do not take them.
    """
    if host in (ALL_IPV4, *ALL):
        found = map(ipaddress.ip_address, machine_addresses())
        return [_in_url(each) for each in found if each.version == 4 or host in ALL]
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return [] if host.lower() == "localhost" else [host]
    return [] if address.is_loopback else [_in_url(address)]


def machine_addresses() -> list[str]:
    """Return the addresses of all network interfaces but the loopback one, those of IPv4 first."""
    found = set()
    for adapter in ifaddr.get_adapters():
        for each in adapter.ips:
            # IPv6 addresses have their flow and their scope with them.
            text = each.ip if isinstance(each.ip, str) else each.ip[0]
            address = ipaddress.ip_address(text)
            is_local = address.version == 6 and address.is_link_local
            if not (address.is_loopback or is_local):
                found.add(address)
    return [str(each) for each in sorted(found, key=lambda each: (each.version, int(each)))]


def _in_url(address: ipaddress.IPv4Address | ipaddress.IPv6Address) -> str:
    return f"[{address}]" if address.version == 6 else str(address)
