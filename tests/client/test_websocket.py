"""A blocking WebSocket connection to a hub."""

from __future__ import annotations

import socket
import ssl
import threading
from typing import Any

import pytest
from certificates import Authority
from certificates import authority as authority
from hub_in_thread import HubThread, Publish
from websockets.sync.server import ServerConnection

from client.servers import redirecting_server, websocket_server
from fibws.client.hub_client import HubClient
from fibws.client.websocket import ReceivedMessage, WebSocket
from fibws.errors import (
    HubLost,
    HubUnreachable,
    NoHub,
)
from fibws.hub import Settings


def test_hub_selects_fibws_v1(hub: HubThread) -> None:
    websocket = WebSocket(hub.url, "/test")
    assert websocket.serialized
    websocket.close()


@pytest.mark.parametrize("subprotocol", ["fibws.v1", None])
def test_text_and_binary_messages_are_distinguished(subprotocol: str | None) -> None:
    def send(connection: ServerConnection) -> None:
        connection.send("text")
        connection.send(b"binary")
        connection.send(["frag", "ments"])
        connection.send([b"binary ", b"fragments"])

    with websocket_server(send, subprotocol) as url:
        websocket = WebSocket(url, "/test")
        assert websocket.serialized == (subprotocol is not None)
        while len(websocket.messages) < 4:
            assert websocket.read(60)
        assert list(websocket.messages) == [
            ReceivedMessage(b"text", False),
            ReceivedMessage(b"binary", True),
            ReceivedMessage(b"fragments", False),
            ReceivedMessage(b"binary fragments", True),
        ]
        websocket.close()


def test_large_message_is_received(client: HubClient, publish: Publish) -> None:
    publish("/text", "std_msgs/String", {"data": "ü" * 1_000_000})
    client.subscribe("/text")
    assert next(client.messages("/text", 20)) == {"data": "ü" * 1_000_000}


def test_missing_hub_error_says_how_to_start_one() -> None:
    with pytest.raises(NoHub, match=r"ws://127\.0\.0\.1:1\b.* fibws hub"):
        HubClient("test", "ws://127.0.0.1:1")


@pytest.mark.parametrize(
    ("response", "text"),
    [
        (b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n", "the server is not a hub"),
        (b"HTTP/1.1 403 Forbidden\r\nContent-Length: 8\r\n\r\nGo away.", "reached: Go away$"),
        (b"HTTP/1.1 403 No\r\nContent-Length: 7\r\n\r\nGo\naway", "reached: Go away$"),
        (
            b"HTTP/1.1 400 Bad Request\r\nContent-Type: text/html\r\n"
            b"Content-Length: 81\r\n\r\n<html>\r\n<head><title>400 The plain HTTP request was "
            b"sent to HTTPS port</title></head>\r\n",
            r"not a hub \(HTTP 400: The plain HTTP request was sent to HTTPS port\); use wss://$",
        ),
        (
            b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: 31\r\n\r\n"
            b"<html><title>Robots</title>\n<p>",
            r"not a hub \(HTTP 200: Robots\); check the address's path, .*slash.* Upgrade$",
        ),
        (b"SSH-2.0-OpenSSH\r\n", "the server is not a hub"),
        (b"\x15\x03\x03\x00\x02\x02\x46", r"expects TLS\); use wss://"),
        (
            b"HTTP/1.0 400 Bad Request\r\n\r\nClient sent an HTTP request to an HTTPS server.\n",
            r"expects TLS\); use wss://",
        ),
        *(
            (
                b"HTTP/1.1 %b\r\nContent-Type: text/html\r\nContent-Length: 31\r\n\r\n"
                b"<html><title>Broken</title></ht>" % status.encode(),
                r"not a hub \(HTTP 50[234]: .*\); a proxy answers, .* start ",
            )
            for status in ("502 Bad Gateway", "503 Service Unavailable", "504 Gateway Timeout")
        ),
        (b"HTTP/1.1 502 Bad Gateway\r\nContent-Length: 0\r\n\r\n", r"502: Bad Gateway\); a proxy"),
        (b"", "cannot be reached"),
    ],
)
def test_failed_handshake_is_an_error(response: bytes, text: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer() -> None:
            connection, _ = server.accept()
            with connection:
                connection.recv(2**16)
                connection.sendall(response)

        thread = threading.Thread(target=answer)
        thread.start()
        with pytest.raises(HubUnreachable, match=text):
            HubClient("test", f"ws://127.0.0.1:{server.getsockname()[1]}")
        thread.join(60)


def test_redirect_is_followed(hub: HubThread) -> None:
    with redirecting_server(f"http://127.0.0.1:{hub.port}/robot/?node=/other") as url:
        with HubClient("test", url) as client:
            assert client.url == f"{hub.url}/robot/"
            assert client.node in client.call("/rosapi/nodes")["nodes"]


def test_redirects_are_limited() -> None:
    with redirecting_server("/robot/", times=6) as url:
        with pytest.raises(HubUnreachable, match=r"redirects \(limit 5\)"):
            HubClient("test", url)


def test_redirect_to_another_protocol_is_refused() -> None:
    with redirecting_server("ftp://127.0.0.1/") as url:
        with pytest.raises(HubUnreachable, match="ftp://"):
            HubClient("test", url)


def test_unknown_host_is_not_offered_a_hub_of_this_machine() -> None:
    with pytest.raises(NoHub) as caught:
        HubClient("test", "ws://robot.invalid:9090")
    assert "Check the address" in str(caught.value) and "fibws hub" not in str(caught.value)


def test_tls(authority: Authority, monkeypatch: pytest.MonkeyPatch) -> None:
    certificate, key = authority.issue()
    with HubThread(Settings(port=0, cert=certificate, key=key)) as hub:
        with pytest.raises(HubUnreachable, match=r"certificate.* FIBWS_CA"):
            HubClient("test", hub.url)
        monkeypatch.setenv("SSL_CERT_FILE", str(authority.file))
        with HubClient("test", hub.url) as client:
            assert client.receive(0) is None
            assert "time" in client.call("/rosapi/get_time")


def test_error_of_tls_to_a_hub_without_it_says_what_to_do(hub: HubThread) -> None:
    with pytest.raises(HubUnreachable, match=r"TLS.* ws://"):
        HubClient("test", f"wss://127.0.0.1:{hub.port}")


def test_failed_tls_closes_the_socket(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[socket.socket] = []
    connect = socket.create_connection

    def open_socket(*arguments: Any) -> socket.socket:
        opened.append(connect(*arguments))
        return opened[-1]

    def fail() -> ssl.SSLContext:
        raise ssl.SSLError("no certificates")

    monkeypatch.setattr(socket, "create_connection", open_socket)
    monkeypatch.setattr(ssl, "create_default_context", fail)
    with socket.create_server(("127.0.0.1", 0)) as server, pytest.raises(HubUnreachable):
        HubClient("test", f"wss://127.0.0.1:{server.getsockname()[1]}")
    assert [each.fileno() for each in opened] == [-1]


def test_lost_hub_is_an_error(hub: HubThread) -> None:
    client = HubClient("test", hub.url)
    hub.stop()
    with pytest.raises(HubLost, match=hub.url):
        while True:
            client.receive(20)
    client.close()


def test_ctrl_c_closes_at_once(hub: HubThread, client: HubClient) -> None:
    with pytest.raises(KeyboardInterrupt), HubClient("other", hub.url) as other:
        raise KeyboardInterrupt
    while other.node in client.call("/rosapi/nodes")["nodes"]:
        pass


def test_client_can_be_passed_to_select(client: HubClient) -> None:
    assert client.fileno() > 0
