"""The socket between a node and its hub, which breaks in these tests."""

from __future__ import annotations

import asyncio
import json
import re
import shutil
import socket
import ssl
import subprocess
from collections import Counter
from collections.abc import AsyncIterator
from http import HTTPStatus
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from client.servers import redirecting_server
from patience import PATIENCE
from websockets.exceptions import InvalidMessage
from websockets.utils import accept_key

import fibws
from fibws.errors import InvalidAddress, NoHub
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32, String
from fibws.node import connection
from fibws.node.connection import _reason, _retries, _waits
from fibws.node.outgoing_queue import LIMIT, TURN
from fibws.protocol.websocket import BINARY, KILLED, REPLACED, TEXT, CloseReason, server_frame
from fibws.srv.rospy_tutorials import AddTwoInts

from .conftest import Lines, Peer, ScriptedHub


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nodes come back at once, so that tests need not wait."""
    monkeypatch.setattr(connection, "FIRST_RETRY", 0.001)
    monkeypatch.setattr(connection, "LONGEST_RETRY", 0.01)
    monkeypatch.setattr(connection, "LONGEST_WAIT", 0.01)


@pytest.fixture
async def real_hub() -> AsyncIterator[HubServer]:
    async with HubServer(Settings(port=0, close_timeout=0.1)) as hub:
        yield hub


async def published(peer: Peer) -> list[int]:
    """Return the published numbers up to 99."""
    numbers: list[int] = []
    while not numbers or numbers[-1] != 99:
        numbers.append((await peer.expect("publish"))["msg"]["data"])
    return numbers


def test_retries_slow_down_to_two_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    delays = list(islice(_retries(), 8))
    longest = [0.1, 0.2, 0.4, 0.5, 0.5, 0.5, 0.5, 0.5]
    assert all(
        0.7 * most <= delay <= 0.9 * most for delay, most in zip(delays, longest, strict=True)
    )


def test_waits_for_room_grow_to_ten_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    longest = [0.5, 1, 2, 4, 8, 10, 10]
    assert all(
        0.7 * most <= delay <= 0.9 * most
        for delay, most in zip(islice(_waits(), 7), longest, strict=True)
    )


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (OSError(111, "Connect call failed ('127.0.0.1', 9090)"), "Connection refused"),
        (OSError("Multiple exceptions: [Errno 111] Connect, [Errno 99] x"), "Connection refused"),
        (socket.gaierror(-2, "Name or service not known"), "Name or service not known"),
        (TimeoutError("timed out during opening handshake"), "timed out during opening handshake"),
        (InvalidMessage("did not receive a valid HTTP response"), "did not receive a valid HTTP"),
        (TimeoutError(), "TimeoutError"),
    ],
)
def test_reason_is_given_without_the_address(error: Exception, reason: str) -> None:
    assert _reason(error).startswith(reason)


async def test_node_says_that_another_program_has_the_address_of_its_hub() -> None:
    async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"\r\n\r\n")
        writer.write(b"SSH-2.0-OpenSSH\r\n")
        writer.close()

    server = await asyncio.start_server(answer, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    async with server:
        node = fibws.Node("talker", hub=f"ws://127.0.0.1:{port}")
        lines = Lines(node.log)
        task = asyncio.create_task(node.__aenter__())
        line = await lines.next()
        task.cancel()
        await asyncio.wait([task])
    assert "not a hub" in line and "Check which program listens there" in line
    assert "Start one" not in line


async def test_node_waits_for_its_hub_and_logs_that_once(
    hub: ScriptedHub, capsys: pytest.CaptureFixture[str]
) -> None:
    await hub.stop()
    node = fibws.Node("talker", hub=hub.url)
    lines = Lines(node.log)

    async def open_node() -> None:
        async with node:
            await hub.peer()

    task = asyncio.create_task(open_node())
    line = await lines.next()
    assert hub.url in line and "Connection refused" in line
    assert NoHub(hub.url, "").remedy in line
    await hub.start()
    await task
    assert await lines.next() == f"The hub at {hub.url} is there."
    printed = capsys.readouterr()
    assert printed.err.count("Waiting") == printed.out.count("is there") == 1


async def test_connection_to_a_busy_hub_is_retried(
    hub: ScriptedHub, capsys: pytest.CaptureFixture[str]
) -> None:
    hub.refusal = (HTTPStatus.SERVICE_UNAVAILABLE, "too many clients")

    async def open_node() -> None:
        async with fibws.Node("talker", hub=hub.url):
            await hub.peer()

    task = asyncio.create_task(open_node())
    await hub.attempted(3)
    hub.refusal = None
    await task
    assert capsys.readouterr().err.count("HTTP 503") == 1


async def test_waiting_for_a_hub_can_be_cancelled(hub: ScriptedHub) -> None:
    await hub.stop()
    node = fibws.Node("talker", hub=hub.url)
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.01), node:
            pytest.fail("there is no hub")
    with pytest.raises(fibws.NodeClosed):
        node.subscribe("fibonacci", Int32)
    assert not [task for task in asyncio.all_tasks() if "connection" in task.get_name()]


async def test_reconnection_repeats_registrations_and_sends_waiting_messages(
    hub: ScriptedHub,
) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("fibonacci", Int32, queue_size=3)
        latched = await node.advertise("latched", String, latch=True)
        newer = await node.advertise("newer", String, latch=True)
        gone = await node.advertise("gone", Int32)
        subscription = node.subscribe("heard", Int32)
        left = node.subscribe("left", Int32)
        await numbers.publish(1)
        await latched.publish("kept")
        await newer.publish("old")
        for op in ["advertise"] * 4 + ["subscribe"] * 2 + ["publish"] * 3:
            await peer.expect(op)
        lines = Lines(node.log)
        await hub.stop()
        lost = await lines.next()
        gone.close()
        left.close()
        for number in (2, 3, 4, 5):
            await numbers.publish(number)
        await newer.publish("new")
        assert numbers.dropped == 1
        await hub.start()
        peer = await hub.peer()
        again = [await peer.receive() for _ in range(13)]
        assert [(each["op"], each.get("topic") or each["service"]) for each in again] == [
            ("advertise_service", "/talker/get_loggers"),
            ("advertise_service", "/talker/set_logger_level"),
            ("advertise", "/rosout"),
            ("advertise", "/fibonacci"),
            ("advertise", "/latched"),
            ("advertise", "/newer"),
            ("subscribe", "/heard"),
            ("publish", "/latched"),
            ("publish", "/rosout"),
            ("publish", "/fibonacci"),
            ("publish", "/fibonacci"),
            ("publish", "/fibonacci"),
            ("publish", "/newer"),
        ]
        assert [again[n]["msg"]["data"] for n in (7, 9, 10, 11, 12)] == ["kept", 3, 4, 5, "new"]
        await peer.send("publish", topic="/heard", msg={"data": 6})
        assert await anext(subscription) == Int32(6)
    assert lost == f"Lost the hub at {hub.url} (the hub is shutting down); trying again."
    assert await lines.next() == f"The hub at {hub.url} is back."


async def test_written_messages_are_not_sent_again(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("fibonacci", Int32)
        await numbers.publish(1)
        await peer.expect("advertise")
        await peer.expect("publish")
        peer.websocket.transport.abort()
        peer = await hub.peer()
        await numbers.publish(99)
        await peer.expect("advertise")
        assert await published(peer) == [99]


async def test_waiting_messages_are_held_for_subscribers_unless_the_node_ends(
    hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connection, "LONGEST_RETRY", 60)
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("fibonacci", Int32)
        await peer.expect("advertise")
        lines = Lines(node.log)
        peer.websocket.transport.abort()
        assert "Lost the hub" in await lines.next()
        await numbers.publish(99)
        peer = await hub.peer()
        await peer.expect("advertise")
        assert await peer.has_sent_nothing()
    assert await published(peer) == [99]


@pytest.mark.parametrize("waits", [False, True])
async def test_end_of_a_node_is_no_fault(
    hub: ScriptedHub, caplog: pytest.LogCaptureFixture, waits: bool
) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("fibonacci", Int32)
        if waits:
            await numbers.publish(99)
    if waits:
        await peer.expect("advertise")
        assert await published(peer) == [99]
    assert [each for each in caplog.records if each.name == "asyncio"] == []


async def test_unsent_messages_are_counted_at_the_end(
    hub: ScriptedHub, capsys: pytest.CaptureFixture[str]
) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        await hub.peer()
        numbers = await node.advertise("fibonacci", Int32, queue_size=2)
        lines = Lines(node.log)
        await hub.stop()
        assert "Lost the hub" in await lines.next()
        for number in range(5):
            await numbers.publish(number)
    assert "Messages that were not sent: 2.\n" in capsys.readouterr().err


async def test_refused_advertisement_is_not_repeated(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        await node.advertise("fibonacci", Int32)
        advertise = await peer.expect("advertise")
        await peer.send("status", level="error", id=advertise["id"], msg="not this type")
        await peer.websocket.close(1001)
        peer = await hub.peer()
        await node.advertise("other", Int32)
        assert (await peer.expect("advertise"))["topic"] == "/other"


async def test_refusal_after_a_restart_of_the_hub_ends_the_node(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        hub.refusal = (HTTPStatus.FORBIDDEN, "not you any more")
        await peer.websocket.close(1001)
        with pytest.raises(fibws.HubUnreachable, match="not you any more"):
            await node.spin()


async def test_publishing_waits_for_a_slow_hub(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        texts = await node.advertise("texts", String, queue_size=1)
        # The other end does not read: the sockets' buffers fill up, then the outgoing queue.
        published = await _publish_until_it_waits(node, peer, texts)
        waiting = asyncio.create_task(texts.publish("last"))
        await peer.expect("advertise")
        for _ in range(published):
            assert (await peer.expect("publish"))["msg"]["data"] == LONG
        assert (await peer.expect("publish"))["msg"]["data"] == "last"
        await waiting
        assert texts.dropped == 0


@pytest.mark.long
async def test_hub_that_does_not_read_does_not_delay_the_end(
    hub: ScriptedHub, capsys: pytest.CaptureFixture[str]
) -> None:
    async def publish(texts: fibws.Publisher[String]) -> None:
        while True:
            await texts.publish(LONG)

    async with asyncio.timeout(PATIENCE):
        async with fibws.Node("talker", hub=hub.url) as node:
            peer = await hub.peer()
            texts = await node.advertise("texts", String)
            await _publish_until_it_waits(node, peer, texts)
            publishing = asyncio.create_task(publish(texts))
            await asyncio.sleep(0)
    assert re.search(r"Messages that were not sent: \d+\.", capsys.readouterr().err)
    with pytest.raises(fibws.NodeClosed):
        await publishing
    peer.websocket.transport.abort()


async def test_publisher_waiting_for_room_continues_after_disconnect(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        texts = await node.advertise("texts", String, queue_size=1)
        await _publish_until_it_waits(node, peer, texts)
        publishing = asyncio.create_task(texts.publish("last"))
        await asyncio.sleep(0)
        peer.websocket.transport.abort()
        await publishing
        peer = await hub.peer()
        await peer.expect("advertise")
        assert (await peer.expect("publish"))["msg"]["data"] == "last"
        assert texts.dropped > 0


LONG = "x" * 100_000


async def _publish_until_it_waits(
    node: fibws.Node, peer: Peer, texts: fibws.Publisher[String]
) -> int:
    """Publish until the queue is full and the peer reads no more; return how many messages it took.

    What the sockets may still take then is less than half of the queue.
    """
    writer: Any = node._session.outgoing._writer
    for transport, option in (
        (writer._transport, socket.SO_SNDBUF),
        (peer.websocket.transport, socket.SO_RCVBUF),
    ):
        transport.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, option, LIMIT // 16)
    published = 0

    async def publish() -> None:
        nonlocal published
        while True:
            await texts.publish(LONG)
            published += 1

    task = asyncio.create_task(publish())
    async with asyncio.timeout(PATIENCE):
        while texts._has_room or peer.websocket.transport.is_reading():  # noqa: ASYNC110 - no event.
            await asyncio.sleep(0)
    task.cancel()
    await asyncio.wait({task})
    return published


@pytest.fixture
async def stranger() -> AsyncIterator[str]:
    """A server that does not speak HTTP."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(b"220 mail.example.org ESMTP\r\n")
        writer.close()
        await writer.wait_closed()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    yield f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}"
    server.close()
    await server.wait_closed()


async def test_connection_is_retried_while_the_server_is_no_hub(stranger: str) -> None:
    node = fibws.Node("talker", hub=stranger)
    lines = Lines(node.log)
    opening = asyncio.create_task(node.__aenter__())
    assert "did not receive a valid HTTP response" in await lines.next()
    assert not opening.done()
    opening.cancel()
    await asyncio.wait({opening})


async def test_broken_pipe_in_the_log_ends_the_node_with_the_reason(
    hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()

        def broken(*arguments: object) -> None:
            raise BrokenPipeError

        monkeypatch.setattr(node.log, "warning", broken)
        await peer.websocket.close(1001)
        with pytest.raises(BrokenPipeError):
            await node.spin()


@pytest.mark.parametrize("address", ["ws://user@robot", "ws://robot..example"])
async def test_unusable_address_is_final(address: str) -> None:
    with pytest.raises(InvalidAddress):
        async with fibws.Node("talker", hub=address):
            pytest.fail("there is no hub")


async def test_broken_pipe_in_the_log_is_noticed_on_connection(
    hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    hub.refusal = (HTTPStatus.SERVICE_UNAVAILABLE, "too many clients")
    node = fibws.Node("talker", hub=hub.url)

    def broken(*arguments: object) -> None:
        raise BrokenPipeError

    monkeypatch.setattr(node.log, "info", broken)

    async def open_node() -> None:
        async with node:
            pytest.fail("nobody reads")

    task = asyncio.create_task(open_node())
    await hub.attempted(2)
    hub.refusal = None
    with pytest.raises(BrokenPipeError):
        await task


async def sends_a_burst(peer: Peer, length: int = 1000) -> None:
    """The hub sends the numbers from 0 on in one go."""
    await peer.expect("subscribe")
    burst = [peer.encoded("publish", topic="/numbers", msg={"data": n}) for n in range(length)]
    frames = [
        server_frame(BINARY, data) if isinstance(data, bytes) else server_frame(TEXT, data.encode())
        for data in burst
    ]
    peer.websocket.transport.write(b"".join(frames))


async def test_other_tasks_run_during_a_burst(hub: ScriptedHub) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        turns = 0
        received: Counter[int] = Counter()
        node.subscribe("numbers", Int32)._hand_to(lambda number: received.update([turns]))
        await sends_a_burst(peer)
        async with asyncio.timeout(60):
            while received.total() < 1000:
                turns += 1
                await asyncio.sleep(0)
        assert max(received.values()) <= 100


async def test_messages_that_were_read_before_a_loss_are_delivered(
    hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    transports: list[asyncio.Transport] = []

    class WebSocket(connection.NodeWebSocket):
        def start(self, *, hold: bool) -> None:
            transports.append(self._transport)
            super().start(hold=hold)

    monkeypatch.setattr(connection, "NodeWebSocket", WebSocket)
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        received: list[int] = []

        def take(number: Int32) -> None:
            if not received:
                transports[0].abort()  # As when a write fails.
            received.append(number.data)

        node.subscribe("numbers", Int32)._hand_to(take)
        lines = Lines(node.log)
        await sends_a_burst(peer, 4 * TURN)
        assert "Lost the hub" in await lines.next()
        assert received == list(range(4 * TURN))


async def test_fast_reader_gets_all_messages_of_a_burst(hub: ScriptedHub) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = node.subscribe("numbers", Int32, queue_size=10)
        await sends_a_burst(peer)
        async with asyncio.timeout(60):
            received = [(await anext(numbers)).data for _ in range(1000)]
        assert received == list(range(1000))
        assert numbers.dropped == 0


@pytest.mark.parametrize(
    ("closing", "fault"), [(REPLACED, fibws.NodeReplaced), (KILLED, fibws.NodeKilled)]
)
async def test_pending_operations_end_with_the_reason_of_the_node(
    hub: ScriptedHub, closing: CloseReason, fault: type[fibws.NodeError]
) -> None:
    async with fibws.Node("asker", hub=hub.url) as node:
        peer = await hub.peer()
        answer = asyncio.create_task(node.call("add", AddTwoInts))
        await peer.expect("call_service")
        await peer.websocket.close(closing.code, closing.reason)
        with pytest.raises(fault, match="/asker"):
            await answer
        with pytest.raises(fault, match="/asker"):
            await node.spin()


@pytest.mark.parametrize("size", [10, 70_000, 5_000_000])
async def test_large_messages_arrive_whole_both_ways(hub: ScriptedHub, size: int) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        peer = await hub.peer()
        out = await node.advertise("out", String)
        back = node.subscribe("back", String)
        numbers = node.subscribe("numbers", Int32)
        for op in ("advertise", "subscribe", "subscribe"):
            await peer.expect(op)
        text = ("0123456789" * (size // 10 + 1))[:size]
        await out.publish(text)
        received = await peer.expect("publish")
        await peer.send("publish", topic="/back", msg=received["msg"])
        await peer.send("publish", topic="/numbers", msg={"data": 1})
        assert (await anext(back)).data == text
        assert (await anext(numbers)).data == 1


async def test_fragmented_messages_arrive_whole(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = node.subscribe("numbers", Int32)
        await peer.expect("subscribe")
        data = peer.encoded("publish", topic="/numbers", msg={"data": 1})
        await peer.websocket.send([data[:5], data[5:10], data[10:]])
        await (await peer.websocket.ping())
        await peer.send("publish", topic="/numbers", msg={"data": 2})
        assert [(await anext(numbers)).data for _ in range(2)] == [1, 2]


async def test_pings_are_answered_within_a_flood(hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=hub.url) as node, asyncio.timeout(60):
        peer = await hub.peer()
        numbers = node.subscribe("numbers", Int32, queue_size=1)
        await sends_a_burst(peer)
        await (await peer.websocket.ping())
        await peer.send("publish", topic="/numbers", msg={"data": -1})
        while (await anext(numbers)).data != -1:
            pass


@pytest.mark.long
async def test_frames_behind_the_handshake_are_read() -> None:
    """A hub may send at once: the first frame then comes with the handshake's response."""
    status = json.dumps({"op": "status", "level": "warning", "msg": "hello"}).encode()

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        head = await reader.readuntil(b"\r\n\r\n")
        (key,) = re.findall(rb"Sec-WebSocket-Key: (\S+)", head)
        response = (
            "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Accept: {accept_key(key.decode())}\r\n\r\n"
        )
        data = response.encode() + server_frame(TEXT, status)
        writer.write(data[:20])
        await writer.drain()
        writer.write(data[20:])
        await reader.read()
        writer.close()

    async with await asyncio.start_server(serve, "127.0.0.1", 0) as server:
        node = fibws.Node("node", hub=f"127.0.0.1:{server.sockets[0].getsockname()[1]}")
        lines = Lines(node.log)
        async with node:
            assert await lines.next() == "The hub: hello"


async def test_redirect_is_followed(real_hub: HubServer) -> None:
    with redirecting_server(f"http://127.0.0.1:{real_hub.port}/robot/") as url:
        async with fibws.Node("node", hub=url) as node:
            assert "/node" in await node.graph.nodes()


@pytest.mark.parametrize(("location", "times"), [("ftp://127.0.0.1/", 1), ("/robot/", 10)])
async def test_redirect_to_no_hub_is_final(location: str, times: int) -> None:
    with redirecting_server(location, times) as url:
        with pytest.raises(fibws.HubUnreachable, match=r"redirect|ftp://"):
            async with fibws.Node("node", hub=url):
                pytest.fail("there is no hub")


@pytest.fixture
def tls(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ssl.SSLContext:
    certificate, key = str(tmp_path / "certificate.pem"), str(tmp_path / "key.pem")
    make = ("openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=hub")
    where = ("-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out", certificate)
    subprocess.run((*make, *where), check=True, capture_output=True)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    monkeypatch.setenv("SSL_CERT_FILE", certificate)
    return context


@pytest.fixture
async def tls_hub(tls: ssl.SSLContext) -> AsyncIterator[ScriptedHub]:
    hub = ScriptedHub(serialized=True, tls=tls)
    await hub.start()
    yield hub
    await hub.stop()


@pytest.mark.skipif(not shutil.which("openssl"), reason="openssl makes the certificate")
async def test_unknown_certificate_is_explained(
    tls_hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SSL_CERT_FILE")
    with pytest.raises(fibws.HubUnreachable, match=r"self.signed.* FIBWS_CA"):
        async with fibws.Node("node", hub=tls_hub.url):
            pytest.fail("the certificate is not trusted")


@pytest.mark.skipif(not shutil.which("openssl"), reason="openssl makes the certificate")
async def test_messages_go_over_tls(tls_hub: ScriptedHub) -> None:
    async with fibws.Node("node", hub=tls_hub.url) as node:
        peer = await tls_hub.peer()
        numbers = await node.advertise("numbers", Int32)
        back = node.subscribe("back", String)
        await peer.expect("advertise")
        await peer.expect("subscribe")
        for number in [*range(300), 99]:
            await numbers.publish(number)
        for number in [*range(300), 99]:
            assert (await peer.expect("publish"))["msg"]["data"] == number
        for size in (3, 500_000):
            await peer.send("publish", topic="/back", msg={"data": "x" * size})
            assert len((await anext(back)).data) == size
        # Messages wait for a slow hub and arrive later.
        texts = await node.advertise("texts", String)
        await peer.expect("advertise")
        publishing = asyncio.create_task(_publish(texts, 100))
        for _ in range(100):
            assert (await peer.expect("publish"))["msg"]["data"] == LONG
        await publishing


async def _publish(texts: fibws.Publisher[String], count: int) -> None:
    for _ in range(count):
        await texts.publish(LONG)
