"""Handshakes and plain HTTP over a real socket."""

from __future__ import annotations

import json
import socket
from http import HTTPStatus

import pytest
from conftest import StartHub

from fibws.hub.http.requests import response
from fibws.hub.server import HubServer
from fibws.hub.settings import KIB, MIB
from fibws.hub.websocket.connection import Connection

from ..raw_client import (
    PATIENT,
    PING,
    PONG,
    Client,
    Gone,
    connected,
    dialled,
    frame,
    handshake,
    nodes,
    operation,
    until,
)

pytestmark = pytest.mark.both_loops


class TestHandshake:
    @pytest.mark.parametrize("path", ["/", "/a/b", "/?token=1&x", "//", "/a?b?c#d", "*", "/%FF"])
    async def test_any_path_and_query_are_accepted(self, hub: HubServer, path: str) -> None:
        async with connected(hub.port, path) as client:
            await client.is_processed()

    async def test_path_that_is_not_a_url_breaks_nothing(self, hub: HubServer) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake("//["))
            status, _, _ = await client.response()
        assert status in (101, 400)

    async def test_request_may_arrive_byte_by_byte(self, hub: HubServer) -> None:
        async with dialled(hub.port) as client:
            for byte in handshake("/?node=/slow"):
                await client.send(bytes((byte,)))
            assert (await client.response())[0] == 101
            await client.is_processed()
            assert nodes(hub) == ["/slow"]

    async def test_frames_behind_the_request_are_answered_after_it(self, hub: HubServer) -> None:
        # R7: the library alone would send its PONG before the 101.
        async with dialled(hub.port) as client:
            await client.send(handshake(), frame(PING, b"early"), operation("nope"))
            assert (await client.response())[0] == 101
            assert await client.frame() == (PONG, b"early")
            assert (await client.receive())["op"] == "status"

    async def test_socket_may_cut_request_and_frames_anywhere(self, hub: HubServer) -> None:
        everything = handshake() + frame(PING, b"1") + frame(PING, b"2")
        for cut in range(len(handshake()) - 6, len(everything)):
            async with dialled(hub.port) as client:
                await client.send(everything[:cut])
                await client.send(everything[cut:])
                assert (await client.response())[0] == 101
                assert await client.frame() == (PONG, b"1")
                assert await client.frame() == (PONG, b"2")

    async def test_only_the_first_of_two_requests_is_answered(self, hub: HubServer) -> None:
        get = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
        async with dialled(hub.port) as client:
            await client.send(get + get)
            status, _, body = await client.response()
        assert status == 200
        assert body.count(b'"status"') == 1

    async def test_frames_behind_a_refused_request_are_not_read(self, hub: HubServer) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake(Origin="http://evil.example"), frame(PING, b"early"))
            status, _, body = await client.response()
            await client.send(frame(PING, b"late"))
        assert status == 403
        assert b"early" not in body

    async def test_half_a_request_times_out(self, start_hub: StartHub) -> None:
        hub = await start_hub(open_timeout=0.1)
        async with dialled(hub.port) as silent, dialled(hub.port) as slow:
            await slow.send(handshake()[:-1])
            assert await _fate(silent) == b""
            assert await _fate(slow) == b""

    async def test_client_with_tls_is_told_that_there_is_none(self, hub: HubServer) -> None:
        async with dialled(hub.port) as client:
            await client.send(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(range(256)))
            status, _, body = await client.response()
            assert status == 400 and b"ws://" in body

    @pytest.mark.parametrize(
        "garbage",
        [
            b"\r\n\r\n",
            b"GET\r\n\r\n",
            b"GET / HTTP/2.0\r\n\r\n",
            b"GET /\xff HTTP/1.1\r\n\r\n",
            b"GET / HTTP/1.1\r\nno colon\r\n\r\n",
        ],
        ids=lambda garbage: repr(garbage[:12]),
    )
    async def test_invalid_request_is_answered(self, hub: HubServer, garbage: bytes) -> None:
        async with dialled(hub.port) as client:
            await client.send(garbage)
            status, headers, body = await client.response()
        assert (status, headers["connection"]) == (400, "close")
        assert body.startswith(b"Invalid HTTP request")

    @pytest.mark.parametrize(
        "garbage",
        [
            b"\x16\x02\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(range(256)) + b"\n",
            b"\n\n\n\n",
        ],
        ids=["TLS of another version", "lines without returns"],
    )
    async def test_other_protocols_end_the_connection(self, hub: HubServer, garbage: bytes) -> None:
        async with dialled(hub.port) as client:
            await client.send(garbage)
            assert await client.to_the_end() == b""

    @pytest.mark.parametrize(
        "request_",
        [
            b"POST / HTTP/1.1\r\nContent-Length: 2\r\n\r\nhi",
            b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n2\r\nhi\r\n0\r\n\r\n",
        ],
    )
    async def test_request_with_a_body_is_refused_with_the_reason(
        self, hub: HubServer, request_: bytes
    ) -> None:
        async with dialled(hub.port) as client:
            await client.send(request_)
            status, _, body = await client.response()
        assert status == 400
        assert b"without a body" in body

    async def test_client_that_leaves_before_its_request_gets_no_response(
        self, hub: HubServer
    ) -> None:
        async with dialled(hub.port) as client:
            await client.send(b"GET / HTTP/1.1\r\nX: ")
            client.socket.shutdown(socket.SHUT_WR)
            assert await client.to_the_end() == b""

    @pytest.mark.parametrize(
        ("request_", "status"),
        [
            (b"GET /" + b"x" * 9000, 414),
            (b"GET / HTTP/1.1\r\nX: " + b"x" * 9000, 431),
            (b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 200, 431),
        ],
    )
    async def test_oversized_request_is_refused_before_its_end(
        self,
        start_hub: StartHub,
        request_: bytes,
        status: int,
        caplog: pytest.LogCaptureFixture,
    ) -> None:
        hub = await start_hub(max_request_head=8 * KIB)
        async with dialled(hub.port) as client:
            await client.send(request_)
            assert (await client.response())[0] == status
        assert "Refused 127.0.0.1: " in caplog.text

    async def test_oversized_request_names_the_setting(self, start_hub: StartHub) -> None:
        hub = await start_hub(max_request_head=8 * KIB)
        for request_ in (b"GET / HTTP/1.1\r\nX: " + b"x" * 9000, handshake("/?" + "x" * 9000)):
            async with dialled(hub.port) as client:
                await client.send(request_)
                body = (await client.response())[2]
            assert b"--max-request-head" in body

    async def test_many_cookies_of_other_servers_do_no_harm(self, hub: HubServer) -> None:
        cookies = "; ".join(f"session{each}={'x' * 3500}" for each in range(16))
        async with connected(hub.port, f"/?token={'t' * 4000}", Cookie=cookies) as client:
            await client.is_processed()
        status, _, _ = await _http(hub, "GET", "/healthz", Cookie=cookies)
        assert status == 200

    async def test_endless_refused_request_is_not_kept(self, start_hub: StartHub) -> None:
        hub = await start_hub(close_timeout=PATIENT)
        async with dialled(hub.port) as client:
            await client.send(b"GET /" + b"x" * 70_000)
            await client.response()
            for _ in range(64):
                await client.send(bytes(MIB // 4))
            (connection,) = hub._connections
            assert len(connection._head or b"") < MIB
            client.reset()
            await until(lambda: not hub._connections)

    @pytest.mark.parametrize(
        ("headers", "status"),
        [
            ({"Sec_WebSocket_Key": "short"}, 400),
            ({"Sec_WebSocket_Version": "8"}, 400),
            ({"Connection": "close"}, 426),
            ({"Upgrade": "h2c"}, 200),  # as curl asks for HTTP/2, to be left out
        ],
    )
    async def test_invalid_upgrade_is_answered(
        self, hub: HubServer, headers: dict[str, str], status: int
    ) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake("/healthz", **headers))
            assert (await client.response())[0] == status

    @pytest.mark.parametrize("name", ["", " ", "\t"])
    async def test_empty_subprotocol_is_none(self, hub: HubServer, name: str) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake(Sec_WebSocket_Protocol=name))
            status, headers, _ = await client.response()
        assert status == 101
        assert "sec-websocket-protocol" not in headers

    async def test_proxy_that_drops_upgrade_is_named(self, hub: HubServer) -> None:
        request_ = handshake().replace(b"Upgrade: websocket\r\n", b"")
        async with dialled(hub.port) as client:
            await client.send(request_.replace(b"Connection: Upgrade", b"Connection: close"))
            status, headers, body = await client.response()
        assert (status, headers["upgrade"]) == (426, "websocket")
        assert b"proxy" in body

    async def test_unknown_origin_is_refused_with_the_remedy(self, hub: HubServer) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake(Origin="http://evil.example"))
            status, headers, body = await client.response()
        assert status == 403
        assert b"--allow-origin http://evil.example" in body
        assert headers["content-length"] == str(len(body))
        assert headers["connection"] == "close"

    async def test_origin_that_is_not_ascii_is_refused(self, hub: HubServer) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake(Origin="http://\xff\xfe"))
            assert (await client.response())[0] == 403

    async def test_page_of_this_machine_may_connect(self, hub: HubServer) -> None:
        async with connected(hub.port, Origin="http://localhost:3000") as client:
            await client.is_processed()

    async def test_allowed_origin_may_connect(self, start_hub: StartHub) -> None:
        hub = await start_hub(allow_origin=("https://lab.example",))
        async with connected(hub.port, Origin="https://lab.example") as client:
            await client.is_processed()

    @pytest.mark.parametrize("header", ["Upgrade: websocket", "Origin: x", "Host: y"])
    async def test_header_given_twice_is_refused(self, hub: HubServer, header: str) -> None:
        twice = handshake(Origin="http://localhost").replace(
            b"\r\n\r\n", f"\r\n{header}\r\n\r\n".encode()
        )
        async with dialled(hub.port) as client:
            await client.send(twice)
            assert (await client.response())[0] == 400

    @pytest.mark.parametrize("name", ["", "/", "~x", "/a%00", "/%E4", "x" * 2000])
    async def test_bad_node_name_is_refused_with_the_reason(
        self, hub: HubServer, name: str
    ) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake(f"/?node={name}"))
            status, _, body = await client.response()
        assert status == 400
        assert b"The query's node: " in body

    async def test_hub_gives_an_unused_name(self, hub: HubServer) -> None:
        async with (
            connected(hub.port, "/?node=/client_2") as known,
            connected(hub.port) as nameless,
            connected(hub.port, "/?node=/client_1") as late,
        ):
            for client in (nameless, known, late):
                await client.is_processed()
            assert len(nodes(hub)) == 3


class TestPlainHttp:
    async def test_get_returns_the_resource(self, hub: HubServer) -> None:
        status, headers, body = await _http(hub, "GET", "/healthz")
        assert status == 200
        assert headers["content-type"].startswith("application/json")
        assert json.loads(body)["status"] == "ok"

    async def test_head_returns_the_headers_without_a_body(self, hub: HubServer) -> None:
        _, got, text = await _http(hub, "GET", "/livez")
        status, head, body = await _http(hub, "HEAD", "/livez")
        assert (status, body) == (200, b"")
        assert head["content-length"] == got["content-length"] == str(len(text))

    async def test_unknown_path_is_404(self, hub: HubServer) -> None:
        status, _, body = await _http(hub, "GET", "/nothing?x")
        assert (status, body) == (404, b"Nothing is at /nothing; see /.\n")

    @pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "BREW"])
    async def test_other_methods_are_405(self, hub: HubServer, method: str) -> None:
        status, headers, _ = await _http(hub, method, "/")
        assert (status, headers["allow"]) == (405, "GET, HEAD")

    async def test_http_1_0_is_answered_too(self, hub: HubServer) -> None:
        async with dialled(hub.port) as client:
            await client.send(b"GET /healthz HTTP/1.0\r\n\r\n")
            assert (await client.response())[0] == 200

    async def test_client_that_stays_after_the_response_is_cut_off(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(close_timeout=0.1)
        async with dialled(hub.port) as client:
            await client.send(b"GET /healthz HTTP/1.1\r\n\r\n")
            assert (await client.response())[0] == 200
            await until(lambda: not hub._connections)


async def _http(
    hub: HubServer, method: str, path: str, **headers: str
) -> tuple[int, dict[str, str], bytes]:
    lines = [f"{name}: {value}" for name, value in {"Host": "localhost", **headers}.items()]
    request_ = "\r\n".join([f"{method} {path} HTTP/1.1", *lines, "", ""])
    async with dialled(hub.port) as client:
        await client.send(request_.encode())
        return await client.response()


async def _fate(client: Client) -> bytes:
    """Return the bytes that a client gets until the hub disconnects it."""
    try:
        return await client.to_the_end()
    except (ConnectionError, Gone):
        return b""


async def test_response_takes_little_memory_while_its_client_does_not_read(
    start_hub: StartHub,
) -> None:
    """Whoever reaches the port may ask for the page's files, without a token."""
    hub, size = await start_hub(), 16 * MIB
    body = bytes(size)
    hub._requests.add_route("/large", lambda get: response(HTTPStatus.OK, "text/plain", body))
    async with dialled(hub.port, receive_buffer=4 * KIB) as client:
        await client.send(handshake("/large", Upgrade="none"))
        await until(lambda: any(map(waiting, hub._connections)))
        assert sum(map(waiting, hub._connections)) < MIB
        assert len((await client.response())[2]) == size


def waiting(connection: Connection) -> int:
    return connection._transport.get_write_buffer_size()
