"""Services of ROS 1 nodes, called by clients of the hub."""

from __future__ import annotations

import asyncio
import json
import socket
import struct
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

from fibws.hub.errors import CallFailed
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.service import Call
from fibws.hub.ros1 import rosrpc
from fibws.hub.ros1 import services as module
from fibws.hub.ros1.definition_search import DefinitionSearch
from fibws.hub.ros1.services import RemoteService, ServiceLinks
from fibws.hub.settings import Settings

from ..fakes import ADD, NANOSECONDS, STANDARD
from ..raw_client import until
from .service_peers import FakeService, failed, new_node, new_nodes, ok

ADD_MD5 = "6a2e34150c00229791cc89ff309fff21"
ADD_HEADER = {"callerid": "/server", "md5sum": ADD_MD5, "type": ADD}


def add(request: bytes) -> bytes:
    return ok(struct.pack("<q", sum(struct.unpack("<qq", request))))


class Links:
    """A graph with the services of ROS 1 nodes, and its clients' calls."""

    def __init__(self, folder: Path, **settings: Any) -> None:
        self.graph = Graph(STANDARD, lambda: NANOSECONDS)
        self.search = DefinitionSearch([folder], {})
        self.nodes = new_nodes(self.graph)
        self.services = ServiceLinks(self.graph, self.nodes, Settings(**settings), self.search)
        self.node = new_node(self.nodes, "/server")

    def register(self, uri: str, name: str = "/add") -> None:
        self.services.register(self.node, name, uri)

    def start(
        self, args: object, name: str = "/add", headers: dict[str, str] | None = None
    ) -> tuple[Call, asyncio.Future[Any]]:
        """Begin a call; return it with its response, or its error."""
        done = asyncio.get_running_loop().create_future()

        def failed(call: Call, text: str, code: str) -> None:
            done.set_exception(CallFailed(text, code))

        call = self.graph.call(
            name,
            args,
            "/caller",
            lambda _, response: done.set_result(json.loads(response.json())),
            failed,
            headers,
        )
        call.start(0.0, asyncio.get_running_loop().call_later)
        return call, done

    async def call(self, args: object, name: str = "/add", **others: Any) -> Any:
        async with asyncio.timeout(60):
            return await self.start(args, name, **others)[1]

    async def is_tried(self) -> bool:
        """Wait until it is known whether /add keeps connections, and return that."""
        server = self.graph.services["/add"].server
        assert isinstance(server, RemoteService)
        await until(lambda: server._connections._keeps is not None)
        return bool(server._connections._keeps)

    async def failure(self, args: object = (), name: str = "/add") -> CallFailed:
        """Return the error of a call."""
        with pytest.raises(CallFailed) as error:
            await self.call(args, name)
        return error.value


@pytest.fixture
async def links(tmp_path: Path) -> AsyncIterator[Links]:
    links = Links(tmp_path)
    yield links
    await links.services.close()


async def test_call_before_the_type_is_known_waits_for_it(links: Links) -> None:
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        assert links.graph.services["/add"].type.name == "*"
        assert links.graph.services["/add"].node == "/server"
        assert await links.call([2**53, 1]) == {"sum": 2**53 + 1}
        assert links.graph.services["/add"].type.name == ADD


async def test_service_is_asked_for_its_type_by_a_probe_only(links: Links) -> None:
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        await links.call([1, 2])
        probe, call = service.headers
        assert (probe["probe"], probe["md5sum"], probe["service"]) == ("1", "*", "/add")
        assert (call["md5sum"], call["callerid"], call["service"]) == (ADD_MD5, "/caller", "/add")
        assert len(service.requests) == 1


async def test_header_of_the_caller_reaches_the_service(links: Links) -> None:
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        await links.call([1, 2], headers={"session": "7", "service": "/other"})
        assert service.headers[-1]["session"] == "7"
        assert service.headers[-1]["service"] == "/add"


async def test_request_that_does_not_fit_is_not_sent(links: Links) -> None:
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        error = await links.failure({"a": "one"})
        assert (error.code, service.requests) == ("invalid_message", [])
        assert "a" in str(error)


async def test_error_of_the_service_reaches_the_caller(links: Links) -> None:
    async with FakeService(ADD_HEADER, lambda _: failed("too large")) as service:
        links.register(service.uri)
        error = await links.failure()
        assert (error.code, str(error)) == ("server_failed", "too large")


async def test_service_that_fails_without_a_text_is_named(links: Links) -> None:
    async with FakeService(ADD_HEADER, lambda _: failed("")) as service:
        links.register(service.uri)
        assert "/add" in str(await links.failure())


async def test_refusal_of_the_service_reaches_the_caller(links: Links) -> None:
    async with FakeService({"error": "not a provider"}) as service:
        links.register(service.uri)
        error = await links.failure()
        assert error.code == "server_failed"
        assert "not a provider" in str(error)


async def test_service_that_cannot_be_reached_is_named_with_host_and_port(links: Links) -> None:
    with socket.create_server(("127.0.0.1", 0)) as unused:
        port = unused.getsockname()[1]
    links.register(f"rosrpc://127.0.0.1:{port}")
    error = await links.failure()
    assert error.code == "server_lost"
    assert f"127.0.0.1:{port}" in str(error)


async def test_service_that_is_lost_during_a_call_fails_it(links: Links) -> None:
    async with FakeService(ADD_HEADER, lambda _: b"", closes=True) as service:
        links.register(service.uri)
        assert (await links.failure()).code == "server_lost"


@pytest.mark.parametrize("response", [ok(b"1234"), ok(b"123456789")])
async def test_response_that_is_not_of_the_type_fails_the_call(
    links: Links, response: bytes
) -> None:
    async with FakeService(ADD_HEADER, lambda _: response) as service:
        links.register(service.uri)
        assert (await links.failure()).code == "invalid_message"


async def test_size_of_responses_is_limited(tmp_path: Path) -> None:
    links = Links(tmp_path, max_message_size=1000)
    async with FakeService(ADD_HEADER, lambda _: struct.pack("<BI", 1, 2**32 - 1)) as service:
        links.register(service.uri)
        error = await links.failure()
        assert error.code == "limit_reached"
    await links.services.close()


async def test_large_response_is_exact(links: Links) -> None:
    header = {"md5sum": "bce3d9a3a6eca5d1ff2bb3b9d0a3b7d4", "type": "maths/Echo"}
    write_definition(links, "maths/srv/Echo.srv", "---\nint64[] numbers\nfloat64 x\nuint8[] raw\n")
    header["md5sum"] = links.search.find("srv", "maths/Echo").md5sum
    numbers = [2**63 - 1, -(2**63)] * 10_000
    body = struct.pack("<I20000qdI3s", 20_000, *numbers, float("nan"), 3, b"\x00\xff\x01")
    async with FakeService(header, lambda _: ok(body)) as service:
        links.register(service.uri, "/echo")
        response = await links.call({}, "/echo")
        assert response == {"numbers": numbers, "x": None, "raw": "AP8B"}


def write_definition(links: Links, name: str, text: str) -> Path:
    (folder,) = links.search._folders
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


async def test_definition_is_found_in_the_search_path(
    links: Links, caplog: pytest.LogCaptureFixture
) -> None:
    path = write_definition(links, "maths/srv/Double.srv", "int32 number\n---\nint32 twice\n")
    md5sum = links.search.find("srv", "maths/Double").md5sum
    header = {"md5sum": md5sum, "type": "maths/Double"}
    caplog.set_level("INFO", "fibws.hub")
    async with FakeService(header, lambda request: ok(request)) as service:
        links.register(service.uri, "/double")
        assert await links.call([4], "/double") == {"twice": 4}
        assert links.graph.definitions.service("maths/Double").type == "maths/Double"
        assert str(path) in caplog.text


async def test_definition_that_is_nowhere_is_named_with_what_to_do(
    links: Links, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with FakeService({"md5sum": "0" * 32, "type": "maths/Double"}) as service:
        links.register(service.uri, "/double")
        error = await links.failure({}, "/double")
        assert error.code == "unknown_definition"
        for fact in ("maths/Double", "0" * 32, "--interfaces"):
            assert fact in str(error)
        assert links.graph.services["/double"].type.name == "maths/Double"
        assert service.requests == []
        await links.failure({}, "/double")
        assert len(service.headers) == 1, "it need not be asked again"


async def test_definition_that_comes_later_is_found_by_a_later_call(
    links: Links, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "SEARCH_INTERVAL", 0.0)
    write_definition(links, "other/srv/Double.srv", "int32 number\n---\nint32 twice\n")
    md5sum = links.search.find("srv", "other/Double").md5sum
    header = {"md5sum": md5sum, "type": "maths/Double"}
    async with FakeService(header, ok) as service:
        links.register(service.uri, "/double")
        await links.failure({}, "/double")
        write_definition(links, "maths/srv/Double.srv", "int32 number\n---\nint32 twice\n")
        assert await links.call([4], "/double") == {"twice": 4}


async def test_definition_with_another_md5_is_not_used(links: Links) -> None:
    async with FakeService({"md5sum": "0" * 32, "type": ADD}) as service:
        links.register(service.uri)
        error = await links.failure()
        assert error.code == "unknown_definition"
        assert ADD_MD5 in str(error) and "0" * 32 in str(error)


@pytest.mark.parametrize(
    "header", [{}, {"type": "*", "md5sum": "*"}, {"type": "../../x", "md5sum": "0" * 32}]
)
async def test_service_that_tells_no_type_cannot_be_called(
    links: Links, header: dict[str, str]
) -> None:
    async with FakeService(header) as service:
        links.register(service.uri)
        assert (await links.failure()).code == "unknown_definition"


async def test_probe_is_repeated_until_the_service_answers(
    links: Links, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "FIRST_RETRY", 0.0)
    learned = asyncio.Event()
    learn = links.graph.learn_service_type

    def report(*args: Any) -> None:
        learn(*args)
        learned.set()

    monkeypatch.setattr(links.graph, "learn_service_type", report)
    async with FakeService({"error": "not yet"}) as service:
        links.register(service.uri)
        async with asyncio.timeout(60):
            await service.probed.wait()
            service.header = ADD_HEADER
            await learned.wait()
    assert links.graph.services["/add"].type.name == ADD


async def test_abandoned_call_closes_its_connection(links: Links) -> None:
    async with FakeService(ADD_HEADER) as service:
        links.register(service.uri)
        call, _ = links.start([1, 2])
        async with asyncio.timeout(60):
            await service.asked.wait()
            call.abandon()
            await service.left.wait()


async def test_call_that_times_out_closes_its_connection(links: Links) -> None:
    async with FakeService(ADD_HEADER) as service:
        links.register(service.uri)
        call, done = links.start([1, 2])
        async with asyncio.timeout(60):
            await service.asked.wait()
            call.time_out(3.0)
            await service.left.wait()
        with pytest.raises(CallFailed) as error:
            await done
        assert error.value.code == "timeout"


async def test_service_is_taken_over_by_another_node(links: Links) -> None:
    async with FakeService(ADD_HEADER) as older, FakeService(ADD_HEADER, add) as newer:
        links.register(older.uri)
        _, waiting = links.start([1, 2])
        await older.asked.wait()
        other = new_node(links.nodes, "/newer")
        links.services.register(other, "/add", newer.uri)
        assert links.graph.services["/add"].node == "/newer"
        assert await links.call([1, 2]) == {"sum": 3}
        links.services.unregister(links.node, "/add")
        assert await links.call([2, 2]) == {"sum": 4}
        assert not waiting.done()
        links.services.unregister(other, "/add")
        assert "/add" not in links.graph.services


async def test_unregistered_service_is_gone(links: Links) -> None:
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        await links.call([1, 2])
        links.services.unregister(links.node, "/add")
        with pytest.raises(CallFailed) as error:
            await links.call([1, 2])
        assert error.value.code == "unknown_service"


@pytest.mark.parametrize("uri", ["http://127.0.0.1:1", "rosrpc://nowhere", "rosrpc://:1", "x"])
async def test_service_with_an_invalid_uri_is_left_out(
    links: Links, uri: str, caplog: pytest.LogCaptureFixture
) -> None:
    links.register(uri)
    assert links.graph.services == {}
    assert "/add" in caplog.text


async def test_service_of_the_hub_is_not_taken_over(
    links: Links, caplog: pytest.LogCaptureFixture
) -> None:
    links.graph.serve_internally("/add", ADD, "/rosapi", lambda request, caller: {"sum": 5})
    links.register("rosrpc://127.0.0.1:1")
    assert await links.call([]) == {"sum": 5}
    assert "/add" in caplog.text


async def test_many_calls_at_once_are_answered(links: Links) -> None:
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        sums = await asyncio.gather(*(links.call([n, 1]) for n in range(200)))
        assert sums == [{"sum": n + 1} for n in range(200)]


@pytest.fixture
def short_trial(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let services that keep connections show that at once."""
    monkeypatch.setattr(rosrpc, "TRIAL", 0.0)


async def test_calls_of_one_caller_share_a_connection(short_trial: None, links: Links) -> None:
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        await links.call([0, 1])
        assert await links.is_tried()
        for n in range(3):
            assert await links.call([n, 1]) == {"sum": n + 1}
        await links.call([1, 2], headers={"session": "7"})
        assert [each.get("session") for each in service.headers] == [None, None, "7"]


async def test_connection_is_used_again_after_an_error_of_the_service(
    short_trial: None, links: Links
) -> None:
    async with FakeService(ADD_HEADER, lambda _: failed("no")) as service:
        links.register(service.uri)
        assert str(await links.failure()) == "no"
        assert await links.is_tried()
        assert str(await links.failure()) == "no"
        assert len(service.headers) == 2  # The first is the probe's.


async def test_idle_connection_is_closed_after_a_while(
    short_trial: None, links: Links, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rosrpc, "LINGER", 0.0)
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        await links.call([1, 2])
        async with asyncio.timeout(60):
            await service.left.wait()


async def test_idle_connection_is_closed_when_the_service_is_unregistered(links: Links) -> None:
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        await links.call([1, 2])
        links.services.unregister(links.node, "/add")
        async with asyncio.timeout(60):
            await service.left.wait()


async def test_server_without_persistent_connections_answers_every_call(links: Links) -> None:
    async with FakeService(ADD_HEADER, add, closes=True) as service:
        links.register(service.uri)
        for n in range(5):
            assert await links.call([n, 1]) == {"sum": n + 1}
        assert await links.is_tried() is False
        assert await links.call([5, 1]) == {"sum": 6}
        assert len(service.requests) == 6
        assert [each.get("persistent") for each in service.headers] == [None, "1", *[None] * 5]


async def test_calls_before_a_service_has_kept_a_connection_have_their_own(links: Links) -> None:
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        for n in range(3):
            assert await links.call([n, 1]) == {"sum": n + 1}
        assert [each.get("persistent") for each in service.headers] == [None, "1", None, None]


@pytest.mark.parametrize("is_proven", [True, False])
async def test_request_is_not_sent_again_when_the_service_is_lost(
    short_trial: None, links: Links, *, is_proven: bool
) -> None:
    def respond(request: bytes) -> bytes:
        return b"" if len(service.requests) == 2 else add(request)

    async with FakeService(ADD_HEADER, respond) as service:
        links.register(service.uri)
        await links.call([1, 2])
        if is_proven:
            assert await links.is_tried()
        service.closes = True
        error = await links.failure([3, 4])
        assert error.code == "server_lost"
        assert len(service.requests) == 2
        assert await links.call([5, 6]) == {"sum": 11}
        assert len(service.requests) == 3


async def test_connection_that_the_service_has_closed_is_not_used(
    short_trial: None, links: Links
) -> None:
    async with FakeService(ADD_HEADER, add) as service:
        links.register(service.uri)
        await links.call([1, 2])
        assert await links.is_tried()
        server = links.graph.services["/add"].server
        assert isinstance(server, RemoteService)
        ((connection, _),) = [each for idle in server._connections._idle.values() for each in idle]
        service.disconnect()
        await until(lambda: not connection.is_reusable)
        assert await links.call([3, 4]) == {"sum": 7}
        assert len(service.requests) == 2


async def test_trial_that_a_caller_ends_is_repeated(short_trial: None, links: Links) -> None:
    async with FakeService(ADD_HEADER, lambda _: None) as service:
        links.register(service.uri)
        call, done = links.start([1, 2])
        async with asyncio.timeout(60):
            await service.asked.wait()
        call.abandon()
        async with asyncio.timeout(60):
            await service.left.wait()
        service.respond = add
        await links.call([1, 2])
        assert await links.is_tried()
        done.cancel()
