"""The socket between a node and its hub, which breaks in these tests."""

from __future__ import annotations

import asyncio
import json
import re
import socket
from collections import Counter
from collections.abc import AsyncIterator
from http import HTTPStatus
from itertools import islice

import pytest
from websockets.exceptions import InvalidMessage
from websockets.frames import Frame, Opcode

import fibws
from fibws.msg.std_msgs import Int32, String
from fibws.node import connection
from fibws.node.connection import _delays, _reason
from fibws.protocol.closing import KILLED, REPLACED, Closing
from fibws.srv.rospy_tutorials import AddTwoInts

from .conftest import Lines, Peer, ScriptedHub


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nodes come back at once, so that tests need not wait."""
    monkeypatch.setattr(connection, "FIRST_RETRY", 0.001)
    monkeypatch.setattr(connection, "LONGEST_RETRY", 0.01)


async def published(peer: Peer) -> list[int]:
    """What the node published, up to a 99."""
    numbers: list[int] = []
    while not numbers or numbers[-1] != 99:
        numbers.append((await peer.hears("publish"))["msg"]["data"])
    return numbers


def test_retries_slow_down_to_two_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    delays = list(islice(_delays(), 8))
    longest = [0.1, 0.2, 0.4, 0.5, 0.5, 0.5, 0.5, 0.5]
    assert all(
        0.7 * most <= delay <= 0.9 * most for delay, most in zip(delays, longest, strict=True)
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
def test_the_reason_is_said_without_the_address(error: Exception, reason: str) -> None:
    assert _reason(error).startswith(reason)


async def test_a_node_waits_for_its_hub_and_says_so_once(
    hub: ScriptedHub, capsys: pytest.CaptureFixture[str]
) -> None:
    await hub.stop()
    node = fibws.Node("talker", hub=hub.url)
    lines = Lines(node.log)

    async def open_node() -> None:
        async with node:
            await hub.peer()

    task = asyncio.create_task(open_node())
    assert await lines.next() == (
        f"Waiting for a hub at {hub.url} (Connection refused). Start one with: python -m fibws.hub"
    )
    await hub.start()
    await task
    assert await lines.next() == f"The hub at {hub.url} is there."
    printed = capsys.readouterr()
    assert printed.err.count("Waiting") == printed.out.count("is there") == 1


async def test_a_hub_that_is_busy_is_asked_again(
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


async def test_waiting_for_a_hub_can_be_given_up(hub: ScriptedHub) -> None:
    await hub.stop()
    node = fibws.Node("talker", hub=hub.url)
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.01), node:
            pytest.fail("there is no hub")
    with pytest.raises(fibws.NodeClosed):
        node.subscribe("fibonacci", Int32)
    assert not [task for task in asyncio.all_tasks() if "connection" in task.get_name()]


async def test_a_lost_hub_is_told_again_what_the_node_is_and_what_waits(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("fibonacci", Int32, queue_size=3)
        latched = await node.advertise("latched", String, latch=True)
        newer = await node.advertise("newer", String, latch=True)
        gone = await node.advertise("gone", Int32)
        heard = node.subscribe("heard", Int32)
        left = node.subscribe("left", Int32)
        await numbers.publish(1)
        await latched.publish("kept")
        await newer.publish("old")
        for op in ["advertise"] * 4 + ["subscribe"] * 2 + ["publish"] * 3:
            await peer.hears(op)
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
        again = [json.loads(await peer.websocket.recv()) for _ in range(13)]
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
        await peer.says("publish", topic="/heard", msg={"data": 6})
        assert await anext(heard) == Int32(6)
    assert lost == f"Lost the hub at {hub.url} (the hub is shutting down); trying again."
    assert await lines.next() == f"The hub at {hub.url} is back."


async def test_what_the_socket_took_is_not_sent_again(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("fibonacci", Int32)
        await numbers.publish(1)
        await peer.hears("advertise")
        await peer.hears("publish")
        peer.websocket.transport.abort()
        peer = await hub.peer()
        await numbers.publish(99)
        await peer.hears("advertise")
        assert await published(peer) == [99]


async def test_what_was_kept_waits_for_the_listeners_but_not_for_the_nodes_end(
    hub: ScriptedHub, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connection, "LONGEST_RETRY", 60)
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("fibonacci", Int32)
        await peer.hears("advertise")
        lines = Lines(node.log)
        peer.websocket.transport.abort()
        assert "Lost the hub" in await lines.next()
        await numbers.publish(99)
        peer = await hub.peer()
        await peer.hears("advertise")
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.1):
                await peer.websocket.recv()
    assert await published(peer) == [99]


async def test_what_was_kept_and_not_sent_is_counted_at_the_end(
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


async def test_a_refused_advertisement_is_not_repeated(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        await node.advertise("fibonacci", Int32)
        advertise = await peer.hears("advertise")
        await peer.says("status", level="error", id=advertise["id"], msg="not this type")
        await peer.websocket.close(1001)
        peer = await hub.peer()
        await node.advertise("other", Int32)
        assert (await peer.hears("advertise"))["topic"] == "/other"


async def test_a_hub_that_comes_back_and_refuses_ends_the_node(hub: ScriptedHub) -> None:
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
        # Nobody reads at the other end: the sockets' buffers fill up, and then the outbox.
        published = await _publish_until_it_waits(texts)
        waiting = asyncio.create_task(texts.publish("last"))
        await peer.hears("advertise")
        for _ in range(published):
            assert (await peer.hears("publish"))["msg"]["data"] == LONG
        assert (await peer.hears("publish"))["msg"]["data"] == "last"
        await waiting
        assert texts.dropped == 0


async def test_a_hub_that_reads_nothing_does_not_keep_the_node(
    hub: ScriptedHub, capsys: pytest.CaptureFixture[str]
) -> None:
    loop = asyncio.get_running_loop()
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        texts = await node.advertise("texts", String)
        await _publish_until_it_waits(texts)
        publishing = asyncio.create_task(texts.publish("last"))
        await asyncio.sleep(0)
        began = loop.time()
    assert loop.time() - began < 10
    assert re.search(r"Messages that were not sent: \d+\.", capsys.readouterr().err)
    with pytest.raises(fibws.NodeClosed):
        await publishing
    peer.websocket.transport.abort()


async def test_who_waits_for_a_hub_that_goes_away_waits_no_more(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        texts = await node.advertise("texts", String, queue_size=1)
        await _publish_until_it_waits(texts)
        publishing = asyncio.create_task(texts.publish("last"))
        await asyncio.sleep(0)
        peer.websocket.transport.abort()
        await publishing
        peer = await hub.peer()
        await peer.hears("advertise")
        assert (await peer.hears("publish"))["msg"]["data"] == "last"
        assert texts.dropped > 0


LONG = "x" * 100_000


async def _publish_until_it_waits(texts: fibws.Publisher[String]) -> int:
    published = waits = 0
    while waits < 2:  # One alone may be this machine's.
        try:
            async with asyncio.timeout(0.1):
                await texts.publish(LONG)
        except TimeoutError:
            waits += 1
        else:
            published += 1
            waits = 0
    return published


@pytest.fixture
async def stranger() -> AsyncIterator[str]:
    """A server that is no hub, and speaks no HTTP."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(b"220 mail.example.org ESMTP\r\n")
        writer.close()
        await writer.wait_closed()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    yield f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}"
    server.close()
    await server.wait_closed()


async def test_what_is_no_hub_is_waited_for_to_become_one(
    stranger: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.2), fibws.Node("talker", hub=stranger):
            pytest.fail("there is no hub")
    assert "did not receive a valid HTTP response" in capsys.readouterr().err


async def test_a_log_that_nobody_reads_ends_the_node_with_the_reason(
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
async def test_an_address_that_cannot_be_used_is_final(address: str) -> None:
    with pytest.raises(fibws.HubUnreachable):
        async with fibws.Node("talker", hub=address):
            pytest.fail("there is no hub")


async def test_a_log_that_nobody_reads_is_noticed_when_the_hub_is_found(
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


async def sends_a_burst(peer: Peer) -> None:
    """The hub sends the numbers from 0 to 999 in one go."""
    burst = "".join(
        json.dumps({"op": "publish", "topic": "/numbers", "msg": {"data": number}}) + "\n"
        for number in range(1000)
    ).splitlines()
    frames = [Frame(Opcode.TEXT, text.encode()).serialize(mask=False) for text in burst]
    await peer.hears("subscribe")
    peer.websocket.transport.write(b"".join(frames))


async def test_within_a_burst_everything_else_has_its_turns(hub: ScriptedHub) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        turns = 0
        heard: Counter[int] = Counter()
        node.subscribe("numbers", Int32).hand_to(lambda number: heard.update([turns]))
        await sends_a_burst(peer)
        async with asyncio.timeout(60):
            while heard.total() < 1000:
                turns += 1
                await asyncio.sleep(0)
        assert max(heard.values()) <= 100


async def test_a_prompt_reader_gets_all_of_a_burst(hub: ScriptedHub) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = node.subscribe("numbers", Int32, queue_size=10)
        await sends_a_burst(peer)
        async with asyncio.timeout(60):
            heard = [(await anext(numbers)).data for _ in range(1000)]
        assert heard == list(range(1000))
        assert numbers.dropped == 0


@pytest.mark.parametrize(
    ("closing", "fault"), [(REPLACED, fibws.NodeReplaced), (KILLED, fibws.NodeKilled)]
)
async def test_what_a_node_waits_for_ends_with_the_reason_for_which_it_ends(
    hub: ScriptedHub, closing: Closing, fault: type[fibws.NodeError]
) -> None:
    async with fibws.Node("asker", hub=hub.url) as node:
        peer = await hub.peer()
        answer = asyncio.create_task(node.call("add", AddTwoInts))
        await peer.hears("call_service")
        await peer.websocket.close(closing.code, closing.reason)
        with pytest.raises(fault, match="/asker"):
            await answer
        with pytest.raises(fault, match="/asker"):
            await node.spin()
