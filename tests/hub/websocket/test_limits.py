"""Limits of one client, address and principal on real connections: what is refused, and how."""

from __future__ import annotations

import json
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

import cbor2
import pytest
from conftest import StartHub
from hub_reload import reloaded

from fibws.access.token_file import digest_of
from fibws.hub.server import HubServer
from fibws.hub.websocket.connection import Connection
from fibws.protocol.serialized import SUBPROTOCOL
from fibws.protocol.websocket import LIMITED

from ..raw_client import (
    BINARY,
    CLOSE,
    CONT,
    PING,
    TEXT,
    Client,
    connected,
    dialled,
    frame,
    handshake,
    operation,
    publish,
    until,
)

RATE = 100.0
"""Messages per second of a limited client; it has twice as many at once."""
MANY = 1000
TOKENS = f"""\
[tokens.ann]
sha256 = "{digest_of("one")}"
allow = {{publish = ["/**"], subscribe = ["/**"], provide = ["/**"]}}
limits = {{connections = 1, subscriptions = 1, messages_per_second = {RATE}}}

[tokens.bob]
sha256 = "{digest_of("two")}"
"""


@pytest.fixture
def no_sweeps(start_hub: StartHub, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no second pass, so that nobody is closed for what was too much."""
    monkeypatch.setattr("fibws.hub.server.SWEEP_INTERVAL", 3600)


@pytest.fixture
async def limited(no_sweeps: None, start_hub: StartHub) -> HubServer:
    return await start_hub(max_messages_per_second=RATE)


def connection(hub: HubServer, node: str = "/flooder") -> Connection:
    (found,) = [each for each in hub._connections if each.name == node]
    return found


async def closing(client: Client) -> tuple[int, str]:
    """Return the code and the reason with which the hub closes a client."""
    while True:
        opcode, payload = await client.frame()
        if opcode == CLOSE:
            return int.from_bytes(payload[:2], "big"), payload[2:].decode()


async def until_response(client: Client, id_: str) -> dict[str, Any]:
    while True:
        opcode, payload = await client.frame()
        if opcode == TEXT and (received := json.loads(payload)).get("id") == id_:
            if received["op"] != "status":
                assert isinstance(received, dict)
                return received


async def exhaust(client: Client) -> None:
    """Send so many messages that those that follow are dropped."""
    await client.send(publish("/t", 0) * MANY)


def is_processed(flooding: Connection, sent: int) -> bool:
    return flooding._left or flooding.messages_received >= sent


# Rates.


@pytest.mark.parametrize("framing", [True, False])
async def test_messages_beyond_the_rate_are_dropped_and_counted(
    no_sweeps: None, start_hub: StartHub, *, framing: bool
) -> None:
    hub = await start_hub(max_messages_per_second=RATE, fast_framing=framing)
    async with connected(hub.port, "/?node=/flooder") as flooder:
        await flooder.advertises("/t")
        await exhaust(flooder)
        flooding = connection(hub)
        await until(lambda: flooding.messages_received >= MANY + 2)
        source = hub.graph.topics["/t"].sources["/flooder"]
        assert source.messages + flooding.limited == MANY
        assert flooding.limited > MANY / 2
        opcode, payload = await flooder.frame()
        status = json.loads(payload)
        assert (opcode, status["op"], status["level"]) == (TEXT, "status", "error")
        assert "limit 100, --max-messages-per-second" in status["msg"]


async def test_dropped_messages_are_in_the_metrics_and_the_audit(
    limited: HubServer, caplog: pytest.LogCaptureFixture
) -> None:
    async with connected(limited.port, "/?node=/flooder") as flooder:
        await flooder.advertises("/t")
        await exhaust(flooder)
        flooding = connection(limited)
        await until(lambda: flooding.messages_received >= MANY + 2)
        dropped = flooding.limited
        for _ in range(2):
            flooding.sweep(0.0, 0.0)
        assert limited.audit.refusals["limit"] == 1
        (event,) = [each for each in caplog.records if each.name == "fibws.hub.audit"]
        assert "/flooder" in event.message and "--max-messages-per-second" in event.message
        assert limited._clients.limited() == dropped
    await until(lambda: not limited._connections)
    assert limited._clients.limited() == dropped


async def test_client_within_its_limits_loses_nothing(limited: HubServer) -> None:
    async with connected(limited.port) as one, connected(limited.port) as other:
        await one.subscribes("/t")
        await other.advertises("/t")
        await other.send(publish("/t", 1) * 90)
        assert await one.receive_data(90) == [1] * 90


async def test_other_operations_beyond_the_rate_are_refused(limited: HubServer) -> None:
    async with connected(limited.port, "/?node=/flooder", Sec_WebSocket_Protocol="x") as client:
        await client.advertises("/t")
        await exhaust(client)
        await client.send_operation("call_service", service="/rosapi/get_time", id="call")
        response = await until_response(client, "call")
        assert (response["op"], response["result"]) == ("service_response", False)
        assert "--max-messages-per-second" in response["values"]
        await client.send_operation("subscribe", topic="/t", id="subscribe")
        while True:
            status = await client.receive()
            if status.get("id") == "subscribe":
                break
        assert (status["op"], status["level"]) == ("status", "error")
        assert not hub_subscriptions(limited, "/t")


def hub_subscriptions(hub: HubServer, topic: str) -> int:
    return len(hub.graph.topics[topic].sinks())


async def test_refusals_have_a_code(limited: HubServer) -> None:
    path = "/?node=/flooder"
    async with connected(limited.port, path, Sec_WebSocket_Protocol=SUBPROTOCOL) as client:
        await client.send(frame(BINARY, b"?") * MANY)
        while (await client.receive())["code"] != "limit_reached":
            pass


@pytest.mark.parametrize(
    "message",
    [
        frame(BINARY, cbor2.dumps({"op": "publish", "topic": "/t", "msg": {"data": 1}})),
        frame(BINARY, json.dumps({"op": "publish", "topic": "/t", "msg": {"data": 1}}).encode()),
        frame(TEXT, b'{"op":"publish","topic":"/t",', fin=False)
        + frame(CONT, b'"msg":{"data":1}}', fin=True),
        publish("/t", 1),
        frame(TEXT, b" " * 5000 + b'{"op": "publish", "topic": "/t", "msg": {"data": 1}}'),
    ],
    ids=["CBOR", "JSON in a binary frame", "fragments", "text", "long text"],
)
@pytest.mark.long
async def test_every_kind_of_message_counts(limited: HubServer, message: bytes) -> None:
    async with connected(limited.port, "/?node=/flooder") as flooder:
        await flooder.advertises("/t")
        await flooder.send(message * MANY)
        flooding = connection(limited)
        source = limited.graph.topics["/t"].sources["/flooder"]
        await until(lambda: source.messages + flooding.limited == MANY)
        assert flooding.limited


async def test_operations_of_one_text_count_each(limited: HubServer) -> None:
    text = json.dumps({"op": "publish", "topic": "/t", "msg": {"data": 1}}).encode()
    async with connected(limited.port, "/?node=/flooder") as flooder:
        await flooder.advertises("/t")
        await flooder.send(frame(TEXT, text * 500))
        flooding = connection(limited)
        await until(lambda: flooding.messages_received >= 500)
        await flooder.send(publish("/t", 2))
        await until(lambda: flooding.limited)
        assert limited.graph.topics["/t"].sources["/flooder"].messages == 500


async def test_pings_count(limited: HubServer) -> None:
    async with connected(limited.port, "/?node=/flooder") as flooder:
        await flooder.advertises("/t")
        await flooder.send(frame(PING, b"x") * MANY)
        flooding = connection(limited)
        # They may arrive, and be charged, all at once: what follows them is dropped in any case.
        await until(lambda: flooding.messages_received >= MANY + 1)
        dropped = flooding.limited
        await flooder.send(publish("/t", 1))
        await until(lambda: flooding.limited > dropped)


async def test_bytes_beyond_the_rate_are_dropped(no_sweeps: None, start_hub: StartHub) -> None:
    hub = await start_hub(max_bytes_per_second=100_000)
    async with connected(hub.port, "/?node=/flooder") as flooder:
        await flooder.advertises("/t", "std_msgs/String")
        for _ in range(3):
            await flooder.send(publish("/t", "x" * 500_000))
        flooding = connection(hub)
        source = hub.graph.topics["/t"].sources["/flooder"]
        await until(lambda: source.messages + flooding.limited == 3)
        # The first one began within the limit, and is to be paid for.
        assert (source.messages, flooding.limited) == (1, 2)


async def test_client_that_goes_on_beyond_its_rate_is_closed(start_hub: StartHub) -> None:
    hub = await start_hub(max_messages_per_second=RATE)
    async with (
        connected(hub.port) as one,
        connected(hub.port) as other,
        connected(hub.port, "/?node=/flooder") as flooder,
    ):
        await one.subscribes("/quiet")
        await other.advertises("/quiet")
        await flooder.advertises("/t")
        flooding = connection(hub)
        sent = flooding.messages_received
        while not flooding._left:
            await flooder.send(publish("/t", 0) * 50)
            sent += 50
            await until(partial(is_processed, flooding, sent))
        code, reason = await closing(flooder)
        assert code == LIMITED
        assert "limit 100, --max-messages-per-second" in reason
        await other.send(publish("/quiet", 7))
        assert await one.receive_data(1) == [7]


# Connections and registrations.


async def test_too_many_connections_of_an_address_are_closed(start_hub: StartHub) -> None:
    hub = await start_hub(max_address_connections=2)
    async with connected(hub.port), connected(hub.port) as second:
        async with connected(hub.port) as third:
            code, reason = await third.is_closed()
            assert code == LIMITED
            assert "limit 2, --max-address-connections" in reason
        second.leave()
        await until(lambda: hub._limits.clients == 1)
        async with connected(hub.port) as third:
            await third.is_processed()


@pytest.mark.parametrize(
    ("what", "operations"),
    [
        (
            "advertisements",
            [
                operation("advertise", topic="/a", type="std_msgs/Int32"),
                operation("advertise_service", service="/b", type="std_srvs/Empty"),
                operation("advertise_action", action="/c", type="example_interfaces/Fibonacci"),
            ],
        ),
        ("subscriptions", [operation("subscribe", topic=topic) for topic in ("/a", "/b", "/c")]),
    ],
)
async def test_too_many_registrations_of_an_address_are_refused(
    start_hub: StartHub, what: str, operations: list[bytes]
) -> None:
    hub = await start_hub(**{f"max_address_{what}": 2})
    async with connected(hub.port) as one, connected(hub.port) as other:
        for client, each in zip((one, other), operations, strict=False):
            await client.send(each)
            await client.is_processed()
        for client in (one, other):
            await client.send(operations[2])
            status = await client.receive()
            assert status["level"] == "error"
            assert f"limit 2, --max-address-{what}" in status["msg"]
        one.leave()
        await until(lambda: hub._limits.clients == 1)
        await other.send(operations[2])
        await other.is_processed()


async def test_limits_of_a_token(no_sweeps: None, start_hub: StartHub, tmp_path: Path) -> None:
    path = tmp_path / "tokens.toml"
    path.write_text(TOKENS, "utf-8")
    hub = await start_hub(tokens=path)
    async with connected(hub.port, "/?token=one") as ann, connected(hub.port, "/?token=two") as bob:
        async with connected(hub.port, "/?token=one") as second:
            code, reason = await second.is_closed()
            assert code == LIMITED
            assert "one principal (limit 1, limits.connections" in reason
        async with connected(hub.port) as late:
            await late.send_operation("auth", token="one")
            while (received := await late.frame())[0] == TEXT:
                assert "limits.connections" in received[1].decode()
            assert int.from_bytes(received[1][:2], "big") == LIMITED
        await ann.subscribes("/a")
        await ann.send_operation("subscribe", topic="/b")
        assert "limit 1, limits.subscriptions" in (await ann.receive())["msg"]
        await bob.send(frame(PING, b"x") * MANY)
        await exhaust(ann)
        assert "limit 100, limits.messages_per_second" in (await ann.receive())["msg"]


@pytest.mark.parametrize("logged_in", [True, False])
async def test_operations_of_the_text_with_the_login_count_each(
    no_sweeps: None, start_hub: StartHub, tmp_path: Path, *, logged_in: bool
) -> None:
    path = tmp_path / "tokens.toml"
    path.write_text(TOKENS, "utf-8")
    hub = await start_hub(tokens=path)
    async with connected(hub.port, "/?token=one" if logged_in else "") as ann:
        operations = [{"op": "auth", "token": "one"}, *[{"op": "clear_will", "topic": "/t"}] * 900]
        await ann.send(frame(TEXT, "".join(map(json.dumps, operations)).encode()))
        await ann.send_operation("call_service", service="/rosapi/get_time", id="call")
        response = await until_response(ann, "call")
        assert response["result"] is False
        assert "limit 100, limits.messages_per_second" in response["values"]


async def test_limits_are_reloaded(no_sweeps: None, start_hub: StartHub, tmp_path: Path) -> None:
    path = tmp_path / "tokens.toml"
    path.write_text(TOKENS, "utf-8")
    hub = await start_hub(tokens=path)
    async with connected(hub.port, "/?token=two&node=/flooder") as bob:
        assert connection(hub)._quotas.meter is None
        path.write_text(f"{TOKENS}limits = {{messages_per_second = 1}}\n", "utf-8")
        await reloaded(hub)
        await bob.send(frame(PING, b"x") * MANY)
        await until(lambda: connection(hub).limited)
        path.write_text(TOKENS, "utf-8")
        await reloaded(hub)
        dropped = connection(hub).limited
        await bob.send_operation("call_service", service="/rosapi/get_time", id="call")
        assert (await until_response(bob, "call"))["result"]
        assert connection(hub).limited == dropped


async def test_login_amid_a_burst_drops_messages_only_while_there_are_too_many(
    no_sweeps: None, start_hub: StartHub, tmp_path: Path
) -> None:
    path = tmp_path / "tokens.toml"
    path.write_text(TOKENS, "utf-8")
    hub = await start_hub(tokens=path, max_principal_messages_per_second=MANY)
    async with connected(hub.port, "/?token=two&node=/flooder") as bob:
        message = operation("clear_will", topic="/t")
        # The login comes while nothing is dropped yet, and in one read with other messages.
        burst = [message * 60, operation("auth", token="two"), message * 60] * (MANY // 12)
        await bob.send(b"".join(burst))
        flooding = connection(hub)
        await until(lambda: flooding.messages_received == 121 * (MANY // 12))
        assert flooding.limited
        result = False
        for number in count():
            await bob.send_operation("call_service", service="/rosapi/get_time", id=f"{number}")
            result = (await until_response(bob, f"{number}"))["result"]
            if result:
                break
        dropped = flooding.limited
        await bob.send(message * 10)
        await bob.send_operation("call_service", service="/rosapi/get_time", id="last")
        assert (await until_response(bob, "last"))["result"]
        assert flooding.limited == dropped


# Handshakes.


async def test_too_many_handshakes_get_status_429(start_hub: StartHub) -> None:
    hub = await start_hub(max_address_handshakes_per_second=1)
    statuses = []
    for _ in range(110):
        async with dialled(hub.port) as client:
            await client.send(handshake())
            status, headers, body = await client.response()
            statuses.append(status)
            if status == 429:
                assert b"limit 1, --max-address-handshakes-per-second" in body
                assert headers["retry-after"] == "1"
                break
    assert statuses == [101] * (len(statuses) - 1) + [429]
    assert hub.health()["refused"] == 1
    assert hub.audit.refusals["limit"] == 1
