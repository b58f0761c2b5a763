"""Connection headers that are cut, invalid or too long; the values are compared side by side."""

from __future__ import annotations

import io
import socket

import pytest
from rosgraph import network

HEADER = network.encode_ros_handshake_header({"type": "*", "topic": "/a"})


def test_bytes_after_a_header_are_left_in_the_buffer() -> None:
    one, other = socket.socketpair()
    with one, other:
        one.sendall(HEADER + b"more")
        buffer = io.BytesIO()
        fields = network.read_ros_handshake_header(other, buffer, 4096)
    assert fields == {"type": "*", "topic": "/a"}
    assert buffer.getvalue() == b"more"


@pytest.mark.parametrize("data", [b"", b"\0", HEADER[:3], HEADER[:-1]])
def test_connection_that_ends_before_its_header_is_an_error(data: bytes) -> None:
    one, other = socket.socketpair()
    with other:
        with one:
            one.sendall(data)
        with pytest.raises(network.ROSHandshakeException, match=str(len(data))):
            network.read_ros_handshake_header(other, io.BytesIO(), 4096)
    with pytest.raises(network.ROSHandshakeException):
        network.decode_ros_handshake_header(data)


def test_long_header_is_refused_before_it_is_read() -> None:
    one, other = socket.socketpair()
    with one, other:
        one.sendall((network.MOST_HEADER + 1).to_bytes(4, "little"))
        with pytest.raises(network.ROSHandshakeException, match="limit"):
            network.read_ros_handshake_header(other, io.BytesIO(), 4096)


def test_this_machine_has_addresses_of_both_families(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_IPV6", raising=False)
    assert "127.0.0.1" in network.get_local_addresses()
    monkeypatch.setenv("ROS_IPV6", "on")
    assert network.get_bind_address("127.0.0.1") == "::1"
    assert network.get_bind_address("192.0.2.7") == "::"
