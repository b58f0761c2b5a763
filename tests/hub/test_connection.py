"""One client's connection: from the first byte of its handshake to its end, on a real socket."""

from __future__ import annotations

import json
import logging
import socket
import struct
import time
from typing import Any

import pytest
from conftest import Faults, StartHub
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed
from websockets.extensions.permessage_deflate import ClientPerMessageDeflateFactory

from fibws.hub import Hub
from fibws.hub.session import Session
from fibws.hub.settings import KIB, MIB

from .wire import (
    BINARY,
    CLOSE,
    CONT,
    PING,
    PONG,
    TEXT,
    Client,
    Gone,
    connected,
    dialled,
    frame,
    handshake,
    longest_turn,
    operation,
    publish,
    until,
)

pytestmark = pytest.mark.both_loops


PATIENT = 60.0
"""Seconds: a timeout that must not matter to the test."""


@pytest.fixture(params=[True, False], ids=["fast", "slow"])
async def any_hub(request: pytest.FixtureRequest, start_hub: StartHub) -> Hub:
    """A hub with fast framing, and one without: nobody can tell them apart."""
    return await start_hub(fast_framing=request.param, max_message_size=8 * MIB)


class TestHandshake:
    @pytest.mark.parametrize("path", ["/", "/a/b", "/?token=1&x", "//", "/a?b?c#d", "*", "/%FF"])
    async def test_any_path_and_query_will_do(self, hub: Hub, path: str) -> None:
        async with connected(hub.port, path) as client:
            await client.is_heard()

    async def test_a_path_that_is_no_url_is_refused_or_accepted_but_breaks_nothing(
        self, hub: Hub
    ) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake("//["))
            status, _, _ = await client.response()
        assert status in (101, 400)

    async def test_the_request_may_come_byte_by_byte(self, hub: Hub) -> None:
        async with dialled(hub.port) as client:
            for byte in handshake("/?node=/slow"):
                await client.send(bytes((byte,)))
            assert (await client.response())[0] == 101
            await client.is_heard()
            assert list(hub.graph.nodes) == ["/slow"]

    async def test_frames_behind_the_request_are_answered_after_it(self, hub: Hub) -> None:
        # R7: the library alone would send its PONG before the 101.
        async with dialled(hub.port) as client:
            await client.send(handshake(), frame(PING, b"early"), operation("nope"))
            assert (await client.response())[0] == 101
            assert await client.frame() == (PONG, b"early")
            assert (await client.hears())["op"] == "status"

    async def test_the_cut_between_request_and_frames_may_be_anywhere(self, hub: Hub) -> None:
        everything = handshake() + frame(PING, b"1") + frame(PING, b"2")
        for cut in range(len(handshake()) - 6, len(everything)):
            async with dialled(hub.port) as client:
                await client.send(everything[:cut])
                await client.send(everything[cut:])
                assert (await client.response())[0] == 101
                assert await client.frame() == (PONG, b"1")
                assert await client.frame() == (PONG, b"2")

    async def test_of_two_requests_in_a_row_the_first_is_answered(self, hub: Hub) -> None:
        get = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
        async with dialled(hub.port) as client:
            await client.send(get + get)
            status, _, body = await client.response()
        assert status == 200
        assert body.count(b'"status"') == 1

    async def test_frames_behind_a_refused_request_are_not_read(self, hub: Hub) -> None:
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

    @pytest.mark.parametrize(
        "garbage",
        [
            b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(range(256)) + b"\n",
            b"\r\n\r\n",
            b"\n\n\n\n",
            b"GET\r\n\r\n",
            b"GET / HTTP/2.0\r\n\r\n",
            b"GET /\xff HTTP/1.1\r\n\r\n",
            b"GET / HTTP/1.1\r\nno colon\r\n\r\n",
            b"POST / HTTP/1.1\r\nContent-Length: 2\r\n\r\nhi",
            b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n2\r\nhi\r\n0\r\n\r\n",
        ],
        ids=lambda garbage: repr(garbage[:12]),
    )
    async def test_what_is_no_request_of_ours_ends_the_connection(
        self, hub: Hub, garbage: bytes
    ) -> None:
        async with dialled(hub.port) as client:
            await client.send(garbage)
            assert await client.to_the_end() == b""

    @pytest.mark.parametrize(
        ("request_", "status"),
        [
            (b"GET /" + b"x" * 9000, 414),
            (b"GET / HTTP/1.1\r\nX: " + b"x" * 9000, 431),
            (b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 200, 431),
        ],
    )
    async def test_a_request_without_measure_is_refused_before_its_end(
        self, hub: Hub, request_: bytes, status: int
    ) -> None:
        async with dialled(hub.port) as client:
            await client.send(request_)
            assert (await client.response())[0] == status

    async def test_a_refused_request_without_end_is_not_kept(self, start_hub: StartHub) -> None:
        hub = await start_hub(close_timeout=PATIENT)
        async with dialled(hub.port) as client:
            await client.send(b"GET /" + b"x" * 9000)
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
    async def test_a_wrong_upgrade_is_answered(
        self, hub: Hub, headers: dict[str, str], status: int
    ) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake(**headers))
            assert (await client.response())[0] == status

    async def test_a_strange_pages_origin_is_refused_with_the_remedy(self, hub: Hub) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake(Origin="http://evil.example"))
            status, headers, body = await client.response()
        assert status == 403
        assert b"--allow-origin http://evil.example" in body
        assert headers["content-length"] == str(len(body))
        assert headers["connection"] == "close"

    async def test_an_origin_that_is_not_ascii_is_refused(self, hub: Hub) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake(Origin="http://\xff\xfe"))
            assert (await client.response())[0] == 403

    async def test_a_page_of_this_machine_may_connect(self, hub: Hub) -> None:
        async with connected(hub.port, Origin="http://localhost:3000") as client:
            await client.is_heard()

    async def test_an_allowed_origin_may_connect(self, start_hub: StartHub) -> None:
        hub = await start_hub(allow_origin=("https://lab.example",))
        async with connected(hub.port, Origin="https://lab.example") as client:
            await client.is_heard()

    @pytest.mark.parametrize("header", ["Upgrade: websocket", "Origin: x", "Host: y"])
    async def test_a_header_given_twice_is_refused(self, hub: Hub, header: str) -> None:
        twice = handshake(Origin="http://localhost").replace(
            b"\r\n\r\n", f"\r\n{header}\r\n\r\n".encode()
        )
        async with dialled(hub.port) as client:
            await client.send(twice)
            assert (await client.response())[0] == 400

    @pytest.mark.parametrize("name", ["", "9", "/a//b", "~x", "/a%00", "/%E4", "x" * 2000])
    async def test_a_bad_node_name_is_refused_with_the_reason(self, hub: Hub, name: str) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake(f"/?node={name}"))
            status, _, body = await client.response()
        assert status == 400
        assert b"The query's node: " in body

    async def test_deflate_is_declined(self, hub: Hub) -> None:
        async with dialled(hub.port) as client:
            await client.send(handshake(Sec_WebSocket_Extensions="permessage-deflate"))
            status, headers, _ = await client.response()
        assert status == 101
        assert "sec-websocket-extensions" not in headers

    async def test_a_real_client_does_without_the_deflate_it_offers(self, hub: Hub) -> None:
        async with connect(hub.url, extensions=[ClientPerMessageDeflateFactory()]) as websocket:
            assert websocket.protocol.extensions == []
            await websocket.send("{}")
            assert json.loads(await websocket.recv())["op"] == "status"

    async def test_the_hub_gives_a_name_that_nobody_has(self, hub: Hub) -> None:
        async with (
            connected(hub.port, "/?node=/client_1") as known,
            connected(hub.port) as nameless,
        ):
            await nameless.is_heard()
            await known.is_heard()
            assert len(hub.graph.nodes) == 2


class TestPlainHttp:
    async def test_get_answers_with_what_is_there(self, hub: Hub) -> None:
        status, headers, body = await _http(hub, "GET", "/healthz")
        assert status == 200
        assert headers["content-type"].startswith("application/json")
        assert json.loads(body)["status"] == "ok"

    async def test_head_answers_the_same_without_a_body(self, hub: Hub) -> None:
        _, got, page = await _http(hub, "GET", "/")
        status, head, body = await _http(hub, "HEAD", "/")
        assert (status, body) == (200, b"")
        assert head["content-length"] == got["content-length"] == str(len(page))

    async def test_what_is_not_there_is_404(self, hub: Hub) -> None:
        status, _, body = await _http(hub, "GET", "/nothing?x")
        assert (status, body) == (404, b"Nothing is at /nothing; see /.\n")

    @pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "BREW"])
    async def test_other_methods_are_405(self, hub: Hub, method: str) -> None:
        status, headers, _ = await _http(hub, method, "/")
        assert (status, headers["allow"]) == (405, "GET, HEAD")

    async def test_http_1_0_is_answered_too(self, hub: Hub) -> None:
        async with dialled(hub.port) as client:
            await client.send(b"GET /healthz HTTP/1.0\r\n\r\n")
            assert (await client.response())[0] == 200

    async def test_whoever_does_not_hang_up_after_the_answer_is_cut_off(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(close_timeout=0.1)
        async with dialled(hub.port) as client:
            await client.send(b"GET / HTTP/1.1\r\n\r\n")
            assert (await client.response())[0] == 200
            await until(lambda: not hub._connections)


class TestMessages:
    @pytest.mark.parametrize("size", [0, 1, 125, 126, 65535, 65536, MIB, 4 * MIB])
    async def test_a_text_of_any_size_passes(self, any_hub: Hub, size: int) -> None:
        text = "x" * size
        async with connected(any_hub.port) as client:
            await client.subscribes("/t", "std_msgs/String")
            await client.advertises("/t", "std_msgs/String")
            await client.send(publish("/t", text))
            assert await client.hears_data(1) == [text]

    @pytest.mark.parametrize(
        "payload", [b"", b" ", b"null", b"[]", b"1", b'"x"', b"{", b"\xef\xbb\xbf{}"]
    )
    async def test_what_is_no_operation_is_answered_by_an_error(
        self, any_hub: Hub, payload: bytes
    ) -> None:
        async with connected(any_hub.port) as client:
            await client.send(frame(TEXT, payload))
            heard = await client.hears() if payload.strip() else None
            await client.is_heard()
        assert heard is None or (heard["op"], heard["level"]) == ("status", "error")

    async def test_a_message_as_large_as_may_be_is_soon_read(self, hub: Hub) -> None:
        # R6: half a minute if the tail grew by copying; see test_splitter_fuzz.py, too.
        async with connected(hub.port) as client:
            await client.advertises("/t", "std_msgs/String")
            message = publish("/t", "x" * 60 * MIB)
            began = time.perf_counter()
            await client.send(message)
            await client.is_heard()
            assert time.perf_counter() - began < 3

    async def test_an_announced_length_costs_nothing_before_the_bytes_come(self, hub: Hub) -> None:
        # R6: never allocate what is only announced.
        async with connected(hub.port) as client:
            await client.send(frame(TEXT)[:1] + b"\xff" + struct.pack("!Q", 60 * MIB) + bytes(8))
            await until(lambda: hub._connections)
            (connection,) = [
                each for each in hub._connections if each.peer.endswith(f":{client.port}")
            ]
            assert len(connection._splitter._tail) < KIB

    @pytest.mark.parametrize("size", [1, 7, 1000, 16 * KIB, 300 * KIB])
    async def test_the_socket_may_cut_the_bytes_anywhere(self, any_hub: Hub, size: int) -> None:
        texts = ["", "a" * 130, "b" * (2000 if size < 1000 else 400_000), "c"]
        sent = b"".join(
            [
                publish("/t", texts[0]),
                frame(PING),
                publish("/t", texts[1]),
                publish("/t", texts[2]),
                *_fragmented(publish("/t", texts[3]), 9),
            ]
        )
        async with connected(any_hub.port) as client, connected(any_hub.port) as listener:
            await listener.subscribes("/t", "std_msgs/String")
            await client.advertises("/t", "std_msgs/String")
            for start in range(0, len(sent), size):
                await client.send(sent[start : start + size])
            assert await listener.hears_data(4) == texts

    async def test_fragments_are_put_together_with_pings_between_them(self, any_hub: Hub) -> None:
        async with connected(any_hub.port) as client:
            await client.subscribes("/t")
            for number in range(3):
                pieces = _fragmented(publish("/t", number), 5)
                await client.send(*(piece + frame(PING, b"p") for piece in pieces))
                for _ in pieces[:-1]:
                    assert await client.frame() == (PONG, b"p")
                assert {await client.frame(), await client.frame()} == {
                    (PONG, b"p"),
                    (TEXT, b'{"op":"publish","topic":"/t","msg":{"data":%d}}' % number),
                }

    async def test_json_in_binary_frames_is_accepted(self, any_hub: Hub) -> None:
        async with connected(any_hub.port) as client:
            await client.subscribes("/t")
            message = json.dumps({"op": "publish", "topic": "/t", "msg": {"data": 5}}).encode()
            await client.send(frame(BINARY, message))
            await client.send(frame(BINARY, message[:9], fin=False), frame(CONT, message[9:]))
            assert await client.hears_data(2) == [5, 5]

    async def test_binary_that_is_no_text_is_answered_by_an_error(self, any_hub: Hub) -> None:
        async with connected(any_hub.port) as client:
            await client.send(frame(BINARY, b"\xff\xfe"))
            assert (await client.hears())["level"] == "error"
            await client.is_heard()

    async def test_4096_fragments_are_accepted(self, any_hub: Hub) -> None:
        async with connected(any_hub.port) as client:
            await client.subscribes("/t")
            (whole,) = _fragmented(publish("/t", 1), 1000)
            empty = frame(CONT, fin=False) * 4094
            await client.send(frame(TEXT, fin=False), empty, frame(CONT, whole[6:]))
            assert await client.hears_data(1) == [1]

    async def test_one_fragment_more_is_too_many(self, any_hub: Hub) -> None:
        # R5: empty fragments do not count towards the size, and the library does not count them.
        async with connected(any_hub.port) as client:
            await client.send(frame(TEXT, fin=False), frame(CONT, fin=False) * 4096)
            assert await client.is_closed() == (1009, "too many fragments in one message")
            assert await client.to_the_end() == b""

    async def test_operations_may_stand_one_behind_another_in_one_frame(self, any_hub: Hub) -> None:
        async with connected(any_hub.port) as client:
            await client.subscribes("/t")
            one, other = publish("/t", 1)[6:], publish("/t", 2)[6:]
            await client.send(frame(TEXT, one + b" " + other))
            assert await client.hears_data(2) == [1, 2]

    async def test_one_frame_of_many_objects_does_not_stop_the_hub(
        self, hub: Hub, caplog: pytest.LogCaptureFixture
    ) -> None:
        """Two bytes for which the hub writes three hundred, half a million times."""
        async with connected(hub.port) as flooder:
            async with longest_turn() as longest:
                await flooder.send(frame(TEXT, b"{}" * (MIB // 2)))
                await until(lambda: "Received a message without an op" in caplog.text)
            flooder.reset()
        assert longest() < 0.5


class TestViolations:
    @pytest.mark.parametrize(
        ("sent", "code"),
        [
            (b"\x81\x01x", 1002),
            (frame(TEXT, b"{}", rsv=4), 1002),
            (frame(TEXT, b"{}", rsv=1), 1002),
            (frame(0x3), 1002),
            (frame(0xB), 1002),
            (frame(CONT, b"{}"), 1002),
            (frame(TEXT, b"{", fin=False) + frame(TEXT, b"}"), 1002),
            (frame(TEXT, b"{", fin=False) + frame(BINARY, b"}"), 1002),
            (frame(PING, fin=False), 1002),
            (frame(PING, bytes(126)), 1002),
            (frame(CLOSE, b"x"), 1002),
            (frame(CLOSE, struct.pack("!H", 1005)), 1002),
            (frame(CLOSE, struct.pack("!H", 1000) + b"\xff"), 1007),
            (frame(TEXT, b"\xff"), 1007),
            (frame(TEXT, b'{"op":"\xff"}'), 1007),
            (frame(TEXT, b"{}", fin=False) + frame(CONT, b"\xff"), 1007),
            (frame(TEXT, bytes(8 * MIB + 1))[:14], 1009),
            (frame(BINARY, bytes(8 * MIB + 1))[:14], 1009),
            (frame(TEXT)[:1] + b"\xff" + bytes([255] * 8) + bytes(4), 1009),
            (frame(TEXT, bytes(MIB), fin=False) + frame(CONT, bytes(8 * MIB))[:14], 1009),
        ],
        ids=repr,
    )
    async def test_the_connection_is_closed_with_the_right_code(
        self, any_hub: Hub, sent: bytes, code: int
    ) -> None:
        async with connected(any_hub.port) as client:
            await client.send(sent)
            closed, _ = await client.is_closed()
            assert closed == code
            assert await client.to_the_end() == b""

    async def test_what_came_before_is_done_in_the_same_turn(self, any_hub: Hub) -> None:
        async with connected(any_hub.port) as listener, connected(any_hub.port) as client:
            await listener.subscribes("/t")
            await client.advertises("/t")
            await client.send(publish("/t", 1), frame(0x3))
            assert await listener.hears_data(1) == [1]
            assert (await client.is_closed())[0] == 1002

    async def test_nothing_is_sent_after_the_close_frame(self, any_hub: Hub) -> None:
        """Though others go on publishing, the client can read why it was closed."""
        async with connected(any_hub.port) as client, connected(any_hub.port) as publisher:
            await client.subscribes("/t")
            await publisher.advertises("/t")
            await client.send(frame(0x3))
            await publisher.send(*(publish("/t", number) for number in range(100)))
            await publisher.is_heard()
            await publisher.send(publish("/t", 100))
            await publisher.is_heard()
            _, code, _ = await client.hears_all()
            assert code == 1002
            assert await client.to_the_end() == b""

    async def test_an_operation_that_fails_is_logged_and_the_connection_stays(
        self, any_hub: Hub, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        # R4: an exception in the callback would be fatal to the connection.
        def fail(*_: Any) -> None:
            raise RuntimeError("injected")

        monkeypatch.setattr(Session, "receive", fail)
        async with connected(any_hub.port) as client:
            await client.send(publish("/t", 1), *_fragmented(publish("/t", 1), 9))
            await client.is_heard()
        faults.expect("an operation failed")
        faults.expect("an operation failed")


class TestClosing:
    @pytest.mark.parametrize(
        "payload",
        [b"", struct.pack("!H", 1000), struct.pack("!H", 1001) + b"bye", struct.pack("!H", 4321)],
    )
    async def test_a_close_is_echoed_and_the_hub_hangs_up(
        self, any_hub: Hub, payload: bytes
    ) -> None:
        async with connected(any_hub.port) as client:
            await client.send(frame(CLOSE, payload))
            assert await client.frame() == (CLOSE, payload)
            assert await client.to_the_end() == b""

    async def test_what_was_published_before_the_close_is_delivered(self, any_hub: Hub) -> None:
        async with connected(any_hub.port) as listener, connected(any_hub.port) as client:
            await listener.subscribes("/t")
            await client.advertises("/t")
            numbers = list(range(10))
            await client.send(*(publish("/t", n) for n in numbers), frame(CLOSE))
            assert await listener.hears_data(10) == numbers

    async def test_what_comes_after_the_close_is_not_read(self, any_hub: Hub) -> None:
        async with connected(any_hub.port) as listener, connected(any_hub.port) as client:
            await listener.subscribes("/t")
            await client.advertises("/t")
            await client.send(frame(CLOSE), publish("/t", 1), frame(PING))
            assert await client.frame() == (CLOSE, b"")
            assert await client.to_the_end() == b""
            await listener.is_heard()

    async def test_a_client_that_closes_is_forgotten_though_it_does_not_hang_up(
        self, any_hub: Hub
    ) -> None:
        async with connected(any_hub.port, "/?node=/a") as client:
            await client.subscribes("/t")
            await client.send(frame(CLOSE))
            await client.to_the_end()
            assert (any_hub.graph.nodes, any_hub.graph.topics) == ({}, {})

    async def test_a_client_that_is_failed_is_forgotten_though_it_does_not_hang_up(
        self, any_hub: Hub
    ) -> None:
        async with connected(any_hub.port, "/?node=/a") as client:
            await client.subscribes("/t")
            await client.send(frame(0x3))
            await client.to_the_end()
            assert (any_hub.graph.nodes, any_hub.graph.topics) == ({}, {})

    @pytest.mark.parametrize("rest", [b"", b"\x81", publish("/t", 1)[:9], frame(TEXT, fin=False)])
    async def test_a_client_that_half_closes_in_mid_frame_is_let_go(
        self, any_hub: Hub, rest: bytes
    ) -> None:
        async with connected(any_hub.port) as client:
            await client.send(publish("/t", 1), rest)
            client.socket.shutdown(socket.SHUT_WR)
            await client.to_the_end()
            await until(lambda: not any_hub._connections)

    @pytest.mark.parametrize("sent", [b"", b"GET / HT", handshake()[:-2]])
    async def test_a_client_that_leaves_in_the_handshake_is_let_go(
        self, hub: Hub, sent: bytes
    ) -> None:
        async with dialled(hub.port) as client:
            await client.send(sent)
            client.socket.shutdown(socket.SHUT_WR)
            assert await client.to_the_end() == b""
            await until(lambda: not hub._connections)

    async def test_a_client_that_never_hangs_up_is_cut_off(self, start_hub: StartHub) -> None:
        hub = await start_hub(close_timeout=0.1)
        async with connected(hub.port) as client:
            await client.send(frame(CLOSE))
            await until(lambda: not hub._connections)


class TestPings:
    async def test_a_ping_is_answered_with_its_text(self, any_hub: Hub) -> None:
        async with connected(any_hub.port) as client:
            await client.send(frame(PING, b"x" * 125))
            assert await client.frame() == (PONG, b"x" * 125)

    async def test_the_hub_pings_and_is_content_with_a_pong(self, start_hub: StartHub) -> None:
        hub = await start_hub(ping_interval=0.05, ping_timeout=PATIENT)
        async with connected(hub.port) as client:
            for _ in range(3):
                assert (await client.frame())[0] == PING
                await client.send(frame(PONG))

    async def test_a_client_that_does_not_answer_is_closed(self, start_hub: StartHub) -> None:
        hub = await start_hub(ping_interval=0.05, ping_timeout=0.1)
        async with connected(hub.port) as client:
            assert (await client.frame())[0] == PING
            assert await client.is_closed() == (1011, "no answer to a ping")
            assert await client.to_the_end() == b""
            assert hub.graph.nodes == {}

    async def test_no_second_ping_is_sent_before_the_pong(self, start_hub: StartHub) -> None:
        hub = await start_hub(ping_interval=0.02, ping_timeout=0.3)
        async with connected(hub.port) as client:
            assert (await client.frame())[0] == PING
            assert (await client.is_closed())[0] == 1011

    async def test_no_pings_are_sent_if_nobody_wants_them(self, start_hub: StartHub) -> None:
        hub = await start_hub(ping_interval=0.0)
        async with connected(hub.port) as client, connected(hub.port) as other:
            for _ in range(20):
                await other.is_heard()
            await client.is_heard()

    async def test_a_pong_that_nobody_asked_for_is_ignored(self, any_hub: Hub) -> None:
        async with connected(any_hub.port) as client:
            await client.send(frame(PONG, b"hi"))
            await client.is_heard()

    async def test_the_sweep_goes_on_though_it_failed_for_one_client(
        self, start_hub: StartHub, faults: Faults, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        hub = await start_hub(ping_interval=0.05)
        async with connected(hub.port) as one, connected(hub.port) as other:
            await until(lambda: len(hub.graph.nodes) == 2)
            broken = next(each for each in hub._connections if each.peer.endswith(f":{one.port}"))
            kind = type(broken)
            sweep = kind.sweep

            def fail(self: Any, now: float) -> None:
                if self is broken:
                    raise RuntimeError("injected")
                sweep(self, now)

            monkeypatch.setattr(kind, "sweep", fail)
            assert (await other.frame())[0] == PING
            monkeypatch.setattr(kind, "sweep", sweep)
        faults.seen.clear()


class TestRealClient:
    @pytest.mark.parametrize("size", [0, 125, 126, 65535, 65536, MIB])
    async def test_texts_of_any_size_go_both_ways(self, hub: Hub, size: int) -> None:
        text = "ü" * (size // 2)
        async with connect(hub.url, max_size=None) as websocket:
            for fields in (
                {"op": "subscribe", "topic": "/t", "type": "std_msgs/String"},
                {"op": "publish", "topic": "/t", "msg": {"data": text}},
            ):
                await websocket.send(json.dumps(fields, ensure_ascii=False))
            heard = json.loads(await websocket.recv())
            assert heard["msg"]["data"] == text

    async def test_fragments_and_pings_go_both_ways(self, start_hub: StartHub) -> None:
        hub = await start_hub(ping_interval=0.05)
        async with connect(hub.url, ping_interval=0.05) as websocket:
            await websocket.send(
                json.dumps({"op": "subscribe", "topic": "/t", "type": "std_msgs/Int32"})
            )
            pieces = ['{"op":"publish","topic":"/t",', '"msg":{"data"', ":7}}"]
            await websocket.send(pieces)
            assert json.loads(await websocket.recv())["msg"] == {"data": 7}
            await (await websocket.ping())

    async def test_a_close_is_clean(self, hub: Hub) -> None:
        async with connect(hub.url) as websocket:
            await websocket.close(4000, "enough")
            with pytest.raises(ConnectionClosed) as closed:
                await websocket.recv()
        assert closed.value.rcvd is not None
        assert (closed.value.rcvd.code, closed.value.rcvd.reason) == (4000, "enough")


class TestLogging:
    async def test_a_connection_is_logged_with_its_name_and_address(
        self, hub: Hub, caplog: pytest.LogCaptureFixture
    ) -> None:
        caplog.set_level(logging.INFO)
        async with connected(hub.port, "/?node=/talker") as client:
            await client.is_heard()
            assert f"/talker has connected from 127.0.0.1:{client.port}." in caplog.text

    @pytest.mark.parametrize(
        "fields",
        [
            {"op": "{}"},
            {"op": "subscribe", "topic": "/t", "type": "{}"},
            {"op": "subscribe", "topic": "/t", "type": "a/{}"},
            {"op": "subscribe", "topic": "/t", "type": "std_msgs/{}"},
            {"op": "advertise", "topic": "{}", "type": "std_msgs/Int32"},
            {"op": "publish", "topic": "{}"},
            {"op": "set_level", "level": "{}"},
            {"op": "fragment", "id": "{}", "num": 5, "total": 1, "data": ""},
        ],
        ids=lambda fields: " ".join(fields.values()) if "num" not in fields else "fragment",
    )
    async def test_a_client_cannot_write_the_log_as_it_likes(
        self, hub: Hub, caplog: pytest.LogCaptureFixture, fields: dict[str, Any]
    ) -> None:
        """Neither lines of its own, nor codes for the operator's terminal, nor megabytes."""
        bad = "\n\x1b[2J" + "x" * 5000
        fields = {
            name: value.replace("{}", bad) if isinstance(value, str) else value
            for name, value in fields.items()
        }
        async with connected(hub.port) as client:
            await client.send(frame(TEXT, json.dumps(fields).encode()))
            await client.hears()
        for record in caplog.records:
            text = record.getMessage()
            assert (len(text) < 2000, text.isprintable()) == (True, True)


async def _http(hub: Hub, method: str, path: str) -> tuple[int, dict[str, str], bytes]:
    async with dialled(hub.port) as client:
        await client.send(f"{method} {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        return await client.response()


async def _fate(client: Client) -> bytes:
    """What a client hears until the hub hangs up or cuts it off."""
    try:
        return await client.to_the_end()
    except (ConnectionError, Gone):
        return b""


def _fragmented(message: bytes, size: int) -> list[bytes]:
    """The frame of a short text message as fragments of some size."""
    start = {126: 8, 127: 14}.get(message[1] & 127, 6)
    payload = message[start:]
    cuts = list(range(0, len(payload), size))
    return [
        frame(CONT if cut else TEXT, payload[cut : cut + size], fin=cut == cuts[-1]) for cut in cuts
    ]
