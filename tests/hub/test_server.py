"""The hub as a server: many clients that communicate."""

from __future__ import annotations

import asyncio
import json
import resource
import socket
from contextlib import AsyncExitStack
from pathlib import Path

import pytest
from conftest import StartHub
from websockets.asyncio.client import connect

import fibws
from fibws.errors import HubError, SettingError
from fibws.hub import Settings, listening
from fibws.hub.server import HubServer

from .raw_client import (
    CLOSE,
    Client,
    connected,
    dialled,
    frame,
    handshake,
    nodes,
    operation,
    publish,
    timers,
    topics,
    until,
)

pytestmark = pytest.mark.both_loops


class TestListening:
    async def test_port_0_takes_a_free_port(self, hub: HubServer) -> None:
        assert hub.port > 0
        assert hub.url == f"ws://127.0.0.1:{hub.port}"

    @pytest.mark.parametrize(
        ("host", "shown"),
        [
            ("0.0.0.0", "127.0.0.1"),
            ("::1", "[::1]"),
            ("[::1]", "[::1]"),
            ("::", "127.0.0.1"),
            ("[::]", "127.0.0.1"),
            ("", "127.0.0.1"),
        ],
    )
    async def test_url_is_reachable_from_this_machine(
        self, start_hub: StartHub, host: str, shown: str
    ) -> None:
        hub = await start_hub(host=host)
        assert hub.url == f"ws://{shown}:{hub.port}"
        async with connect(hub.url):
            pass

    @pytest.mark.parametrize("host", ["::", "[::]", ""])
    async def test_both_families_have_one_port(self, start_hub: StartHub, host: str) -> None:
        hub = await start_hub(host=host, port=0)
        for address in ("127.0.0.1", "[::1]", "localhost"):
            async with connect(f"ws://{address}:{hub.port}"):
                pass
        names = [client.address for client in hub._connections]
        assert not any("ffff" in name for name in names)

    async def test_port_that_one_family_lacks_is_not_chosen(
        self, start_hub: StartHub, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        with socket.socket(socket.AF_INET6) as taken:
            taken.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
            taken.bind(("::", 0))
            taken.listen()
            port = taken.getsockname()[1]
            free = listening._free_port
            ports = iter([port, port])
            monkeypatch.setattr(listening, "_free_port", lambda: next(ports, None) or free())
            hub = await start_hub(host="::", port=0)
            assert hub.port != port
            with pytest.raises(HubError, match=f"Port {port} on :: is in use"):
                async with HubServer(Settings(host="::", port=port)):
                    pass

    @pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0", "::1"])
    async def test_parameters_contain_the_address_of_the_hub(
        self, start_hub: StartHub, host: str
    ) -> None:
        hub = await start_hub(host=host)
        actual = hub.graph.parameters.get("/rosbridge_websocket")
        assert actual == {"actual_port": hub.port, "actual_host": host}

    @pytest.mark.parametrize(("host", "warned"), [("0.0.0.0", 1), ("127.0.0.1", 0), ("::1", 0)])
    async def test_listening_on_a_public_address_is_logged_as_a_warning(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture, host: str, warned: int
    ) -> None:
        hub = await start_hub(host=host, port=0)
        warning = (
            f"Other machines can reach this hub at {host}, port {hub.port}; "
            "no authentication is enabled."
        )
        assert [record.message for record in caplog.records].count(warning) == warned
        assert ("Other machines" in caplog.text) == bool(warned)

    async def test_port_in_use_names_the_remedy(self, hub: HubServer) -> None:
        text = f"Port {hub.port} on 127.0.0.1 is in use by another hub.*port="
        with pytest.raises(HubError, match=text):
            async with HubServer(Settings(port=hub.port)):
                pass

    async def test_address_of_another_machine_cannot_be_listened_on(self) -> None:
        with pytest.raises(HubError, match=r"192\.0\.2\.1 is not an address of this machine"):
            async with HubServer(Settings(host="192.0.2.1", port=0)):
                pass

    async def test_unknown_host_cannot_be_listened_on(self) -> None:
        with pytest.raises(HubError, match=r"host=.*: cannot listen on no\.such\.invalid:0: "):
            async with HubServer(Settings(host="no.such.invalid", port=0)):
                pass

    @pytest.mark.parametrize("port", [-1, 65536, 99999])
    async def test_invalid_port_is_refused(self, port: int) -> None:
        with pytest.raises(HubError, match=str(port)):
            async with HubServer(Settings(port=port)):
                pass

    async def test_missing_interfaces_folder_is_an_error(self) -> None:
        with pytest.raises(SettingError):
            HubServer(Settings(interfaces=(Path("/no/such/folder"),)))

    async def test_two_hubs_share_nothing(self, start_hub: StartHub) -> None:
        one, other = await start_hub(), await start_hub()
        async with connected(one.port) as here, connected(other.port) as there:
            await there.subscribes("/t")
            await here.advertises("/t")
            await here.send(publish("/t", 1))
            await here.is_processed()
            await there.is_processed()


class TestDelivery:
    async def test_one_subscriber_gets_all_messages_in_order(self, hub: HubServer) -> None:
        numbers = list(range(5000))
        async with connected(hub.port) as talker, connected(hub.port) as listener:
            await listener.subscribes("/t")
            await talker.advertises("/t")
            _, received = await asyncio.gather(
                talker.send(*(publish("/t", number) for number in numbers)),
                listener.receive_data(len(numbers)),
            )
            await listener.is_processed()
        assert received == numbers

    async def test_ten_subscribers_get_the_messages_of_ten_publishers_in_order(
        self, hub: HubServer
    ) -> None:
        count = 300
        async with AsyncExitStack() as stack:
            talkers = [await stack.enter_async_context(connected(hub.port)) for _ in range(10)]
            listeners = [await stack.enter_async_context(connected(hub.port)) for _ in range(10)]
            for listener in listeners:
                await listener.subscribes("/t")
            for talker in talkers:
                await talker.advertises("/t")

            async def talk(which: int) -> None:
                for start in range(0, count, 30):
                    await talkers[which].send(
                        *(publish("/t", 1000 * which + n) for n in range(start, start + 30))
                    )

            *received, _ = await asyncio.gather(
                *(listener.receive_data(10 * count) for listener in listeners),
                asyncio.gather(*map(talk, range(10))),
            )
            for listener in listeners:
                await listener.is_processed()
        for each in received:
            for which in range(10):
                assert [n % 1000 for n in each if n // 1000 == which] == list(range(count))
        assert all(each == received[0] for each in received)

    async def test_messages_of_several_topics_keep_their_order(self, hub: HubServer) -> None:
        async with connected(hub.port) as client:
            for topic in ("/a", "/b", "/c"):
                await client.subscribes(topic)
            sent = [("/a", 1), ("/c", 2), ("/b", 3), ("/a", 4), ("/b", 5)]
            await client.send(*(publish(topic, data) for topic, data in sent))
            received = [await client.receive() for _ in sent]
        assert [(each["topic"], each["msg"]["data"]) for each in received] == sent

    async def test_replies_and_messages_keep_their_order(self, hub: HubServer) -> None:
        async with connected(hub.port) as client:
            await client.subscribes("/t")
            await client.send(publish("/t", 1), operation("nope", id=7), publish("/t", 2))
            received = [await client.receive() for _ in range(3)]
        assert [each["op"] for each in received] == ["publish", "status", "publish"]
        assert received[1]["id"] == 7

    @pytest.mark.parametrize("id_", ["x", 5, 1.5, True, [1], {"a": 1}, None])
    async def test_errors_are_answered_for_any_id(self, hub: HubServer, id_: object) -> None:
        async with connected(hub.port) as client:
            await client.send_operation("nope", id=id_)
            received = await client.receive()
        assert received["op"] == "status"
        assert received.get("id") == (id_ if isinstance(id_, str | int | float) else None)

    async def test_message_is_sent_at_once(self, hub: HubServer) -> None:
        # R9: coalescing must not add delay at low load: each message arrives before the next.
        async with connected(hub.port) as talker, connected(hub.port) as listener:
            await listener.subscribes("/t")
            await talker.advertises("/t")
            for number in range(50):
                await talker.send(publish("/t", number))
                assert await listener.receive_data(1) == [number]

    async def test_latched_message_reaches_late_subscribers(self, hub: HubServer) -> None:
        async with connected(hub.port) as talker, connected(hub.port) as listener:
            await talker.advertises("/t", latch=True)
            await talker.send(publish("/t", 1), publish("/t", 2))
            await talker.is_processed()
            await listener.send_operation("subscribe", topic="/t")
            assert await listener.receive_data(1) == [2]

    async def test_throttled_message_is_not_sent_after_the_client_left(
        self, hub: HubServer
    ) -> None:
        async with connected(hub.port) as talker, connected(hub.port) as listener:
            await listener.subscribes("/t", throttle_rate=50, queue_length=5)
            await talker.advertises("/t")
            await talker.send(*(publish("/t", number) for number in range(4)))
            assert await listener.receive_data(1) == [0]
            listener.reset()
            await until(lambda: len(nodes(hub)) == 1)
            assert [timer for timer in timers() if "_drain" in repr(timer)] == []


class TestNames:
    async def test_older_client_of_a_name_is_closed(self, hub: HubServer) -> None:
        async with connected(hub.port, "/?node=/a") as older:
            await older.subscribes("/t")
            async with connected(hub.port, "/?node=/a") as newer:
                assert await older.is_closed() == (4001, "new node registered with same name")
                await older.send(frame(CLOSE, b"\x0f\xa1"))
                assert await older.to_the_end() == b""
                await newer.is_processed()
                assert nodes(hub) == ["/a"]
                assert topics(hub) == []

    async def test_operations_of_a_replaced_client_are_ignored(self, hub: HubServer) -> None:
        async with connected(hub.port, "/?node=/a") as older:
            async with connected(hub.port, "/?node=/a") as newer:
                await newer.subscribes("/t")
                await older.send(publish("/t", 1), operation("subscribe", topic="/t"))
                assert (await older.is_closed())[0] == 4001
                older.leave()
                await until(lambda: len(hub._connections) == 1)
                await newer.is_processed()

    async def test_replaced_client_gets_its_messages_before_the_close(self, hub: HubServer) -> None:
        async with connected(hub.port, "/?node=/a") as older, connected(hub.port) as talker:
            await older.subscribes("/t")
            await talker.advertises("/t")
            await talker.send(publish("/t", 1))
            async with connected(hub.port, "/?node=/a"):
                assert await older.receive_all() == (
                    [1],
                    4001,
                    "new node registered with same name",
                )

    async def test_name_taken_many_times_leaves_one_client(self, hub: HubServer) -> None:
        async with AsyncExitStack() as stack:
            for _ in range(50):
                newest = await stack.enter_async_context(connected(hub.port, "/?node=a"))
                await newest.subscribes("/t")
            assert nodes(hub) == ["/a"]
            assert len(hub.graph.topics["/t"].sinks()) == 1
            await newest.is_processed()

    async def test_replaced_client_that_does_not_answer_is_cut_off(
        self, start_hub: StartHub
    ) -> None:
        hub = await start_hub(close_timeout=0.1)
        async with connected(hub.port, "/?node=/a"), connected(hub.port, "/?node=/a") as newer:
            await until(lambda: len(hub._connections) == 1)
            await newer.is_processed()


class TestCrowd:
    @pytest.mark.long
    async def test_thousand_clients_come_subscribe_and_leave(self, hub: HubServer) -> None:
        _allow_files(4096)
        async with AsyncExitStack() as stack:
            crowd = [await stack.enter_async_context(dialled(hub.port)) for _ in range(1000)]
            await asyncio.gather(*(_enter(client) for client in crowd))
            assert (len(nodes(hub)), len(topics(hub))) == (1000, 1)
            for number, client in enumerate(crowd):
                if number % 3:
                    client.leave()
                else:
                    client.reset()
            await until(lambda: not hub._connections and not topics(hub))
        assert nodes(hub) == []

    async def test_silent_connections_are_forgotten(self, hub: HubServer) -> None:
        async with AsyncExitStack() as stack:
            crowd = [await stack.enter_async_context(dialled(hub.port)) for _ in range(100)]
            await until(lambda: len(hub._connections) == 100)
            for client in crowd:
                client.reset()
            await until(lambda: not hub._connections)

    @pytest.mark.parametrize("op", ["subscribe", "advertise"])
    async def test_refused_operations_leave_nothing_in_the_graph(
        self, hub: HubServer, op: str
    ) -> None:
        async with connected(hub.port) as client:
            for number in range(10):
                await client.send_operation(op, topic=f"/t{number}", type="std_msgs/NoSuchType")
                assert (await client.receive())["level"] == "error"
            assert topics(hub) == []


class TestHealth:
    async def test_counts_are_right(self, hub: HubServer) -> None:
        async with connected(hub.port) as client, connected(hub.port):
            await client.subscribes("/t")
            health = await _health(hub)
        # The topics are /t, the log, the aggregated log, and two about the clients.
        assert (health["status"], health["clients"], health["topics"]) == (
            "ok",
            2,
            5,
        )
        assert (health["dropped"], health["slow_clients"]) == (0, [])
        assert isinstance(health["uptime_seconds"], float)


async def _enter(client: Client) -> None:
    await client.send(handshake())
    assert (await client.response())[0] == 101
    await client.subscribes("/t")


async def _health(hub: HubServer) -> dict[str, object]:
    async with dialled(hub.port) as client:
        await client.send(b"GET /healthz HTTP/1.1\r\n\r\n")
        health: dict[str, object] = json.loads((await client.response())[2])
        return health


def _allow_files(count: int) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft < count:
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(count, hard), hard))


async def test_hub_may_be_started_and_closed_without_a_block() -> None:
    hub = HubServer(Settings(port=0))
    assert await hub.start() is hub
    async with fibws.Node("guest", hub=hub.url) as node:
        assert "/guest" in await node.graph.nodes()
    await hub.close()
    await hub.close()
