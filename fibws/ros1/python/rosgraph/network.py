"""Addresses of this machine, and the headers of ROS 1's connections.

Sources: http://wiki.ros.org/ROS/NetworkSetup and http://wiki.ros.org/ROS/Connection%20Header.
"""

from __future__ import annotations

import os
import socket
import struct
import sys
from collections.abc import Mapping
from io import BytesIO
from urllib.parse import urlsplit

from rosgraph.rosenv import ROS_HOSTNAME, ROS_IP, ROS_IPV6

_LENGTH = struct.Struct("<I")
MOST_HEADER = 2**20
"""Bytes of a header; longer ones are refused."""


class ROSHandshakeException(Exception):
    """A connection header is invalid, or incomplete."""


def parse_http_host_and_port(url: str) -> tuple[str, int]:
    """Return the host and the port of a URL, by default 80.

    Raises:
        ValueError: the URL has no scheme or no host.
    """
    parts = urlsplit(url or "")
    if not parts.scheme or not parts.hostname:
        raise ValueError("not a valid URL")
    return parts.hostname, parts.port or 80


def use_ipv6() -> bool:
    """Return whether $ROS_IPV6 is ``on``."""
    return os.environ.get(ROS_IPV6) == "on"


def get_address_override() -> str | None:
    """Return the address in ``__hostname:=``, ``__ip:=``, $ROS_HOSTNAME or $ROS_IP; else None.

    Raises:
        ValueError: the argument has no value, or two.
    """
    for argument in sys.argv:
        if argument.startswith(("__hostname:=", "__ip:=")):
            _, *values = argument.split(":=")
            if len(values) != 1:
                raise ValueError(f"invalid ROS command-line remapping argument '{argument}'")
            return values[0]
    return os.environ.get(ROS_HOSTNAME, os.environ.get(ROS_IP))


def get_local_addresses() -> list[str]:
    """Return the addresses of this machine, IPv6 first if it is used; never empty."""
    families = [socket.AF_INET6, socket.AF_INET] if use_ipv6() else [socket.AF_INET]
    found = [address for family in families for address in _addresses(family)]
    return list(dict.fromkeys(found))


def _addresses(family: socket.AddressFamily) -> list[str]:
    loopback, remote = (
        ("::1", "2001:db8::1")
        if family == socket.AF_INET6
        else (
            "127.0.0.1",
            "192.0.2.1",
        )
    )  # Addresses for documentation: RFC 3849 and RFC 5737.
    found = [loopback]
    try:
        infos = socket.getaddrinfo(socket.gethostname(), 0, family)
        found += [str(info[4][0]).partition("%")[0] for info in infos]
    except OSError:
        pass  # The host's name is unknown to the resolver.
    with socket.socket(family, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((remote, 9))  # This sends nothing, and chooses the address.
            found.append(probe.getsockname()[0])
        except OSError:
            pass  # No route leads there.
    return found


def is_local_address(hostname: str) -> bool:
    """Return whether a host name or an address is this machine's; False for unknown ones."""
    family = socket.AF_UNSPEC if use_ipv6() else socket.AF_INET
    try:
        found = {str(info[4][0]) for info in socket.getaddrinfo(hostname, 0, family)}
    except OSError:
        return False
    return any(map(_is_loopback, found)) or not found.isdisjoint(get_local_addresses())


def get_local_address() -> str:
    """Return the address at which others reach this machine."""
    override = get_address_override()
    if override:
        return override
    addresses = get_local_addresses()
    return next((each for each in addresses if not _is_loopback(each)), addresses[0])


def get_bind_address(address: str | None = None) -> str:
    """Return the address to listen on: all, or the loopback if ``address`` is local.

    Args:
        address: this machine's address; by default `get_address_override`.
    """
    address = get_address_override() if address is None else address
    if address and (address == "localhost" or _is_loopback(address)):
        if use_ipv6():
            return "::1"
        return address if address.startswith("127.") else "127.0.0.1"
    return "::" if use_ipv6() else "0.0.0.0"


def get_host_name() -> str:
    """Return this machine's name for others: the override, the host's name, or an address."""
    name = get_address_override() or socket.gethostname()
    return get_local_address() if not name or name == "localhost" or _is_loopback(name) else name


def create_local_xmlrpc_uri(port: int) -> str:
    """Return the URI of a server on this machine."""
    return f"http://{get_host_name()}:{port}/"


def encode_ros_handshake_header(header: Mapping[str | bytes, str | bytes]) -> bytes:
    """Return a connection header, its fields sorted, with its length before it."""
    fields = sorted(_bytes(key) + b"=" + _bytes(value) for key, value in header.items())
    body = b"".join(_LENGTH.pack(len(field)) + field for field in fields)
    return _LENGTH.pack(len(body)) + body


def decode_ros_handshake_header(header_str: bytes) -> dict[str, str]:
    """Return the fields of a connection header, which has its length before it.

    Raises:
        ROSHandshakeException: it is invalid, or incomplete.
    """
    if len(header_str) < _LENGTH.size:
        raise ROSHandshakeException(f"Incomplete header. Only have {len(header_str)} bytes")
    end = _LENGTH.unpack_from(header_str)[0] + _LENGTH.size
    if end > len(header_str):
        raise ROSHandshakeException(
            f"Incomplete header. Expected {end} bytes but only have {len(header_str)}"
        )
    fields: dict[str, str] = {}
    start = _LENGTH.size
    while start < end:
        begin = start + _LENGTH.size
        size = _LENGTH.unpack_from(header_str, start)[0] if begin <= end else 0
        start = begin + size
        if size == 0:
            raise ROSHandshakeException("Invalid 0-length handshake header field")
        if start > end:
            raise ROSHandshakeException(f"Invalid line length in handshake header: {end}")
        line = header_str[begin:start].decode()
        key, equals, value = line.partition("=")
        if not equals:
            raise ROSHandshakeException(f"Invalid line in handshake header: [{line}]")
        fields[key.strip()] = value
    return fields


def read_ros_handshake_header(sock: socket.socket, b: BytesIO, buff_size: int) -> dict[str, str]:
    """Read a connection header; bytes that follow it are left in the buffer.

    Args:
        sock: a blocking socket.
        b: the buffer, with bytes that were received before.
        buff_size: the most bytes to receive at once.

    Raises:
        ROSHandshakeException: the header is invalid, too long, or the connection ended before it.
    """
    while True:
        received = sock.recv(buff_size)
        if not received:
            raise ROSHandshakeException(
                "connection from sender terminated before handshake header received. "
                f"{b.tell()} bytes were received. Please check sender for additional details."
            )
        b.write(received)
        data = b.getvalue()
        if len(data) < _LENGTH.size:
            continue
        end = _LENGTH.unpack_from(data)[0] + _LENGTH.size
        if end > MOST_HEADER:
            raise ROSHandshakeException(f"Header of {end} bytes, limit is {MOST_HEADER}")
        if len(data) >= end:
            b.seek(0)
            b.truncate()
            b.write(data[end:])
            return decode_ros_handshake_header(data)


def write_ros_handshake_header(
    sock: socket.socket, header: Mapping[str | bytes, str | bytes]
) -> int:
    """Send a connection header; return how many bytes it has."""
    data = encode_ros_handshake_header(header)
    sock.sendall(data)
    return len(data)


def _bytes(text: str | bytes) -> bytes:
    return text.encode() if isinstance(text, str) else text


def _is_loopback(address: str) -> bool:
    return address.startswith("127.") or address == "::1"
