"""TLS: handshakes, certificates and their reload, slow clients."""

from __future__ import annotations

import asyncio
import json
import re
import socket
import ssl
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from certificates import Authority, add_password
from certificates import authority as authority
from conftest import StartHub
from hub_reload import reloaded
from patience import PATIENCE
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidMessage

import fibws
from fibws.errors import HubError
from fibws.hub.server import HubServer
from fibws.hub.tls.certificate import ServerTls
from fibws.msg.std_msgs import Int32

from ..raw_client import frame, handshake
from ..token_clients import closing

pytestmark = pytest.mark.both_loops


@pytest.fixture
async def hub(start_hub: StartHub, authority: Authority) -> HubServer:
    """A hub with TLS."""
    certificate, key = authority.issue()
    return await start_hub(cert=certificate, key=key)


def operation(op: str, **fields: Any) -> str:
    return json.dumps({"op": op, **fields})


async def processed(client: ClientConnection) -> None:
    """Wait until the hub has processed what a client has sent."""
    async with asyncio.timeout(PATIENCE):
        await (await client.ping())


def hub_name(client: ClientConnection) -> str:
    """Return the common name of the hub's certificate."""
    return common_name(client.transport.get_extra_info("ssl_object").getpeercert())


def common_name(certificate: dict[str, Any]) -> str:
    return str({key: value for part in certificate["subject"] for key, value in part}["commonName"])


async def get(hub: HubServer, head: str, context: ssl.SSLContext | None) -> bytes:
    """Send an HTTP request and return everything up to the end."""
    async with asyncio.timeout(PATIENCE):
        reader, writer = await asyncio.open_connection("127.0.0.1", hub.port, ssl=context)
        writer.write(head.replace("\n", "\r\n").encode() + b"\r\n\r\n")
        if context is not None:
            return await reader.read()
        answer = await reader.readuntil(b"wss://.\n")
        writer.close()
        return answer


async def test_messages_of_any_size_arrive_in_order(hub: HubServer, authority: Authority) -> None:
    assert hub.url.startswith("wss://127.0.0.1:")
    trusted = authority.client()
    async with connect(hub.url, ssl=trusted, max_size=None) as listener:
        await listener.send(operation("subscribe", topic="/t", type="std_msgs/String"))
        await processed(listener)
        async with connect(hub.url, ssl=trusted) as client:
            await client.send(operation("advertise", topic="/t", type="std_msgs/String"))
            sizes = [*range(300), 1_000_000, 5, 9_000_000, 7]
            sending = asyncio.create_task(_publish(client, sizes))
            async with asyncio.timeout(PATIENCE):
                seen = [len(json.loads(await listener.recv())["msg"]["data"]) for _ in sizes]
                await sending
            assert seen == sizes


async def _publish(client: ClientConnection, sizes: list[int]) -> None:
    for size in sizes:
        await client.send(operation("publish", topic="/t", msg={"data": "x" * size}))


@pytest.mark.parametrize(
    ("names", "host"),
    [
        (("robot.example", "127.0.0.1"), "127.0.0.1"),
        (("*.example", "robot.example", "other.example"), "robot.example"),
        (("*.example",), "127.0.0.1"),
    ],
)
async def test_url_has_a_name_of_the_certificate(
    start_hub: StartHub, authority: Authority, names: tuple[str, ...], host: str
) -> None:
    certificate, key = authority.issue(*names)
    hub = await start_hub(cert=certificate, key=key, url_path="/robot")
    assert hub.url == f"wss://{host}:{hub.port}/robot"


async def test_http_response_ends(hub: HubServer, authority: Authority) -> None:
    answer = await get(hub, "GET /healthz HTTP/1.1\nHost: 127.0.0.1", authority.client())
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 200")
    assert json.loads(body)["status"] == "ok"


async def test_close_and_cut_end_a_client(hub: HubServer, authority: Authority) -> None:
    trusted = authority.client()
    async with connect(hub.url, ssl=trusted) as closed, connect(hub.url, ssl=trusted) as cut:
        await closed.close(1000)
        assert closed.close_code == 1000
        cut.transport.abort()
        async with asyncio.timeout(PATIENCE):
            await hub._empty.wait()


async def test_hub_closes_clients_with_its_reason(
    start_hub: StartHub, authority: Authority
) -> None:
    certificate, key = authority.issue()
    hub = await start_hub(cert=certificate, key=key)
    async with connect(hub.url, ssl=authority.client()) as client:
        await hub.close()
        with pytest.raises(ConnectionClosed):
            await client.recv()
        assert client.close_code == 1001


async def test_unfinished_handshake_does_not_delay_the_end(
    start_hub: StartHub, authority: Authority
) -> None:
    certificate, key = authority.issue()
    hub = await start_hub(cert=certificate, key=key, close_timeout=0.05)
    _, writer = await asyncio.open_connection("127.0.0.1", hub.port)
    writer.write(b"\x16\x03\x01")
    await writer.drain()
    async with asyncio.timeout(PATIENCE):
        await hub.close()
    writer.close()


async def test_slow_client_loses_old_messages_and_delays_nobody(
    start_hub: StartHub, authority: Authority
) -> None:
    certificate, key = authority.issue()
    hub = await start_hub(cert=certificate, key=key, max_queued_bytes=2**20)
    trusted = authority.client()
    # The library reads no more than one message ahead.
    async with (
        connect(hub.url, ssl=trusted, max_queue=1) as slow,
        connect(hub.url, ssl=trusted) as quick,
        connect(hub.url, ssl=trusted) as client,
    ):
        for listener in (slow, quick):
            await listener.send(operation("subscribe", topic="/t", type="std_msgs/String"))
            await processed(listener)
        slow.transport.pause_reading()
        await client.send(operation("advertise", topic="/t", type="std_msgs/String"))
        text = "x" * 100_000
        for number in range(200):
            await client.send(operation("publish", topic="/t", msg={"data": f"{number} {text}"}))
            async with asyncio.timeout(PATIENCE):
                assert json.loads(await quick.recv())["msg"]["data"].startswith(f"{number} ")
        dropped = sum(each.queue.dropped for each in hub._connections)
        assert dropped > 50
        slow.transport.resume_reading()
        async with asyncio.timeout(PATIENCE):
            seen = [json.loads(await slow.recv())["msg"]["data"].split()[0]]
            while seen[-1] != "199":
                seen.append(json.loads(await slow.recv())["msg"]["data"].split()[0])
        assert len(seen) == 200 - dropped
        assert seen == sorted(seen, key=int)


async def test_client_that_reads_slowly_is_not_taken_for_one_that_stands_still(
    start_hub: StartHub, authority: Authority
) -> None:
    certificate, key = authority.issue()
    hub = await start_hub(cert=certificate, key=key, stall_timeout=0.3)
    trusted = authority.client()
    async with (
        slow_network(hub.port) as port,
        connect(f"wss://127.0.0.1:{port}", ssl=trusted) as slow,
        connect(hub.url, ssl=trusted) as client,
    ):
        await slow.send(operation("subscribe", topic="/t", type="std_msgs/String"))
        await processed(slow)
        await client.send(operation("advertise", topic="/t", type="std_msgs/String"))
        await _publish(client, [100_000] * 5)
        async with asyncio.timeout(PATIENCE):
            assert [len(json.loads(await slow.recv())["msg"]["data"]) for _ in range(5)] == [
                100_000
            ] * 5


@asynccontextmanager
async def slow_network(port: int) -> AsyncIterator[int]:
    """Forward one connection, 4 kB from the hub at a time; yield the port to connect to."""
    loop = asyncio.get_running_loop()
    with socket.create_server(("127.0.0.1", 0)) as listening, socket.socket() as hub:
        hub.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        listening.setblocking(False)
        hub.setblocking(False)
        await loop.sock_connect(hub, ("127.0.0.1", port))

        async def forward() -> None:
            client, _ = await loop.sock_accept(listening)
            with client:
                client.setblocking(False)
                back = asyncio.create_task(forward_back(client))
                try:
                    while data := await loop.sock_recv(hub, 4096):
                        await loop.sock_sendall(client, data)
                        await asyncio.sleep(0.01)
                finally:
                    back.cancel()

        async def forward_back(client: socket.socket) -> None:
            while data := await loop.sock_recv(client, 65536):
                await loop.sock_sendall(hub, data)

        forwarding = asyncio.create_task(forward())
        yield listening.getsockname()[1]
        forwarding.cancel()
        await asyncio.wait({forwarding})


@pytest.mark.parametrize("path", ["", "x?y=1"])
async def test_browser_without_tls_is_redirected(hub: HubServer, path: str) -> None:
    answer = await get(hub, f"GET /{path} HTTP/1.1\nHost: lab.example:9090", None)
    assert answer.startswith(b"HTTP/1.1 307")
    assert f"\r\nLocation: https://lab.example:9090/{path}\r\n".encode() in answer


@pytest.mark.parametrize(
    "head",
    [
        handshake().decode().replace("\r", "").strip(),
        "POST / HTTP/1.1\nHost: lab",
        "GET / HTTP/1.1\nHost: <script>",
        "GET / HTTP/1.1\nHost: lab\x01Set-Cookie: x",
    ],
)
async def test_other_clients_without_tls_are_refused(hub: HubServer, head: str) -> None:
    answer = await get(hub, head, None)
    assert answer.startswith(b"HTTP/1.1 400")
    assert b"Location" not in answer


async def test_node_without_tls_says_what_to_do(hub: HubServer) -> None:
    with pytest.raises(fibws.HubUnreachable, match="wss://"):
        async with fibws.Node("node", hub=hub.url.replace("wss:", "ws:")):
            pytest.fail("the hub expects TLS")


async def test_old_versions_of_tls_are_refused_with_a_reason(
    hub: HubServer, authority: Authority
) -> None:
    context = authority.client()
    context.set_ciphers("ALL:@SECLEVEL=0")
    with pytest.warns(DeprecationWarning):
        context.minimum_version = ssl.TLSVersion.TLSv1
        context.maximum_version = ssl.TLSVersion.TLSv1_1
    with pytest.raises(ssl.SSLError, match="ALERT_PROTOCOL_VERSION"):
        await connect(hub.url, ssl=context)
    context.maximum_version = ssl.TLSVersion.TLSv1_2
    async with connect(hub.url, ssl=context) as client:
        assert client.transport.get_extra_info("ssl_object").version() == "TLSv1.2"


class Accepted:
    """A connection in memory that the hub has accepted, and whose client has sent nothing yet."""

    def __init__(self, tls: ServerTls, context: ssl.SSLContext) -> None:
        to_client, to_server = ssl.MemoryBIO(), ssl.MemoryBIO()
        self.client = context.wrap_bio(to_client, to_server, server_hostname="127.0.0.1")
        self.server = tls.context.wrap_bio(to_server, to_client, server_side=True)

    def shake_hands(self) -> str:
        """Return the common name of the hub's certificate, or raise why there was no handshake."""
        for side in (self.client, self.server) * 3:
            with suppress(ssl.SSLWantReadError):
                side.do_handshake()
        certificate = self.client.getpeercert()
        assert certificate
        return common_name(certificate)


class TestReload:
    async def test_new_connections_get_the_new_certificate_and_nothing_is_lost(
        self, hub: HubServer, authority: Authority
    ) -> None:
        trusted = authority.client()
        async with connect(hub.url, ssl=trusted) as listener, connect(hub.url, ssl=trusted) as old:
            await listener.send(operation("subscribe", topic="/t", type="std_msgs/Int32"))
            await processed(listener)
            await old.send(operation("advertise", topic="/t", type="std_msgs/Int32"))
            names = []
            for number in range(100):
                await old.send(operation("publish", topic="/t", msg={"data": number}))
                if number % 20 == 10:
                    authority.issue(common_name=f"hub {number}")
                    await reloaded(hub)
                    async with connect(hub.url, ssl=trusted) as new:
                        names.append(hub_name(new))
            async with asyncio.timeout(PATIENCE):
                seen = [json.loads(await listener.recv())["msg"]["data"] for _ in range(100)]
            assert seen == [*range(100)]
            assert names == ["hub 10", "hub 30", "hub 50", "hub 70", "hub 90"]
            assert hub_name(old) == "hub"

    async def test_old_certificate_stays_if_the_new_file_is_broken(
        self, hub: HubServer, authority: Authority, tmp_path: Path
    ) -> None:
        (tmp_path / "hub.key").write_text("nonsense")
        with pytest.raises(HubError, match=r"hub\.key"):
            await reloaded(hub)
        async with connect(hub.url, ssl=authority.client()) as client:
            assert hub_name(client) == "hub"

    async def test_reload_names_the_last_day_of_a_new_certificate(
        self, hub: HubServer, authority: Authority
    ) -> None:
        assert hub.reload() == []
        authority.issue(expires=datetime.now(UTC) + timedelta(days=100))
        last = (datetime.now(UTC) + timedelta(days=100)).date()
        assert hub.reload() == [f"certificate replaced, valid until {last}"]

    async def test_expired_certificate_is_logged(
        self, hub: HubServer, authority: Authority, caplog: pytest.LogCaptureFixture
    ) -> None:
        authority.issue(expires=datetime.now(UTC) - timedelta(days=1))
        await reloaded(hub)
        assert "expired" in caplog.text and "hub.pem" in caplog.text

    async def test_metrics_have_the_end_of_the_newest_certificate(
        self, hub: HubServer, authority: Authority
    ) -> None:
        for days in (100, -1):
            end = datetime.now(UTC) + timedelta(days)
            authority.issue(expires=end)
            await reloaded(hub)
            trusting = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
            trusting.check_hostname, trusting.verify_mode = False, ssl.CERT_NONE
            text = (await get(hub, "GET /metrics HTTP/1.1\nHost: 127.0.0.1", trusting)).decode()
            found = re.search(r"^fibws_certificate_expiry_timestamp_seconds (\S+)$", text, re.M)
            assert found and float(found[1]) == int(end.timestamp())

    async def test_removed_authority_of_clients_is_no_longer_accepted(
        self, start_hub: StartHub, authority: Authority, tmp_path: Path
    ) -> None:
        certificate, key = authority.issue()
        known = tmp_path / "clients.pem"
        known.write_bytes(authority.file.read_bytes())
        hub = await start_hub(cert=certificate, key=key, client_ca=known)
        context = authority.client(authority.issue(common_name="robot", file="client"))
        async with connect(hub.url, ssl=context) as old:
            (tmp_path / "other").mkdir()
            known.write_bytes(Authority(tmp_path / "other").file.read_bytes())
            changed = "authorities of client certificates changed"
            assert await reloaded(hub) == [changed, "1 client closed"]
            with pytest.raises((OSError, InvalidMessage)):
                await connect(hub.url, ssl=context)
            # Others of the new authority's, too, are to connect again: 1012 says so.
            assert (await closing(old))[0] == 1012

    @pytest.mark.parametrize("version", [ssl.TLSVersion.TLSv1_2, ssl.TLSVersion.TLSv1_3])
    async def test_list_of_revoked_certificates_can_come_and_go(
        self, start_hub: StartHub, authority: Authority, tmp_path: Path, version: ssl.TLSVersion
    ) -> None:
        certificate, key = authority.issue()
        good = authority.client(authority.issue(common_name="robot1", file="good"))
        stolen = authority.issue(common_name="robot2", file="stolen")
        clients = tmp_path / "clients.pem"
        clients.write_bytes(authority.file.read_bytes())
        hub = await start_hub(cert=certificate, key=key, client_ca=clients)
        context = authority.client(stolen)
        context.maximum_version = version
        async with connect(hub.url, ssl=context) as client:
            clients.write_bytes(authority.file.read_bytes() + authority.revocations(stolen[0]))
            await reloaded(hub)
            assert (await closing(client))[0] == 1012
        with pytest.raises((OSError, InvalidMessage)):
            await connect(hub.url, ssl=context)
        async with connect(hub.url, ssl=good) as client:
            await processed(client)
        clients.write_bytes(authority.file.read_bytes())
        await reloaded(hub)
        for each in (good, context):
            async with connect(hub.url, ssl=each) as client:
                await processed(client)

    async def test_connection_that_began_before_a_reload_gets_no_former_files(
        self, authority: Authority, tmp_path: Path
    ) -> None:
        clients = tmp_path / "clients.pem"
        clients.write_bytes(authority.file.read_bytes())
        tls = ServerTls(*authority.issue(), clients)
        stolen = authority.issue(common_name="robot2", file="stolen")
        begun = [Accepted(tls, authority.client()), Accepted(tls, authority.client(stolen))]
        authority.issue(common_name="new")
        tls.read()()
        assert begun[0].shake_hands() == "new"
        clients.write_bytes(authority.file.read_bytes() + authority.revocations(stolen[0]))
        tls.read()()
        with pytest.raises(ssl.SSLError):
            begun[1].shake_hands()


class TestClientCertificates:
    @pytest.fixture
    async def hub(self, start_hub: StartHub, authority: Authority) -> HubServer:
        """A hub that accepts the certificates of an authority."""
        certificate, key = authority.issue()
        return await start_hub(cert=certificate, key=key, client_ca=authority.file)

    @pytest.mark.parametrize("version", [ssl.TLSVersion.TLSv1_2, ssl.TLSVersion.TLSv1_3])
    async def test_connection_knows_the_common_name(
        self, hub: HubServer, authority: Authority, version: ssl.TLSVersion
    ) -> None:
        context = authority.client(authority.issue(common_name="robot", file="client"))
        context.maximum_version = version
        async with connect(hub.url, ssl=context), connect(hub.url, ssl=authority.client()):
            names = {each.certificate and each.certificate.name for each in hub._connections}
            assert names == {"robot", None}

    @pytest.mark.parametrize("version", [ssl.TLSVersion.TLSv1_2, ssl.TLSVersion.TLSv1_3])
    async def test_certificate_of_another_authority_is_refused(
        self,
        hub: HubServer,
        authority: Authority,
        tmp_path: Path,
        version: ssl.TLSVersion,
        caplog: pytest.LogCaptureFixture,
    ) -> None:
        (tmp_path / "other").mkdir()
        other = Authority(tmp_path / "other")
        context = authority.client(other.issue(common_name="robot"))
        context.maximum_version = version
        with pytest.raises((OSError, InvalidMessage)):
            await connect(hub.url, ssl=context)
        assert "invalid client certificate: unable to get local issuer certificate" in caplog.text
        assert hub.audit.refusals["authentication"] == 1

    async def test_certificate_is_not_asked_for_without_the_option(
        self, start_hub: StartHub, authority: Authority
    ) -> None:
        certificate, key = authority.issue()
        hub = await start_hub(cert=certificate, key=key)
        context = authority.client(authority.issue(common_name="robot", file="client"))
        async with connect(hub.url, ssl=context):
            assert [each.certificate and each.certificate.name for each in hub._connections] == [
                None
            ]

    @pytest.mark.parametrize("version", [ssl.TLSVersion.TLSv1_2, ssl.TLSVersion.TLSv1_3])
    async def test_revoked_certificate_is_refused(
        self, start_hub: StartHub, authority: Authority, tmp_path: Path, version: ssl.TLSVersion
    ) -> None:
        certificate, key = authority.issue()
        good = authority.client(authority.issue(common_name="robot1", file="good"))
        stolen = authority.issue(common_name="robot2", file="stolen")
        clients = tmp_path / "clients.pem"
        clients.write_bytes(authority.file.read_bytes() + authority.revocations(stolen[0]))
        hub = await start_hub(cert=certificate, key=key, client_ca=clients)
        context = authority.client(stolen)
        context.maximum_version = version
        with pytest.raises((OSError, InvalidMessage)):
            await connect(hub.url, ssl=context)
        async with connect(hub.url, ssl=good) as client:
            await processed(client)

    async def test_certificate_that_ends_closes_its_connection(
        self, hub: HubServer, authority: Authority
    ) -> None:
        end = datetime.now(UTC) + timedelta(days=30)
        certificate = authority.issue(common_name="robot", file="client", expires=end)
        async with connect(hub.url, ssl=authority.client(certificate)) as client:
            await processed(client)
            (connection,) = hub._connections
            object.__setattr__(connection._shared, "now", lambda: end.timestamp() + 1)
            assert await closing(client) == (4401, "the certificate expired")


class TestFiles:
    @pytest.mark.parametrize("missing", ["cert", "key", "client_ca"])
    async def test_missing_file_is_named(
        self, start_hub: StartHub, authority: Authority, tmp_path: Path, missing: str
    ) -> None:
        certificate, key = authority.issue()
        files = {"cert": certificate, "key": key, missing: tmp_path / "missing.pem"}
        with pytest.raises(HubError, match=rf"{missing}=.*missing\.pem"):
            await start_hub(**files)

    @pytest.mark.parametrize("wrong", ["cert", "key", "client_ca"])
    async def test_file_of_another_kind_is_named(
        self, start_hub: StartHub, authority: Authority, tmp_path: Path, wrong: str
    ) -> None:
        certificate, key = authority.issue()
        (tmp_path / "wrong.pem").write_text("nonsense")
        files = {"cert": certificate, "key": key, wrong: tmp_path / "wrong.pem"}
        with pytest.raises(HubError, match=rf"{wrong}=.*wrong\.pem"):
            await start_hub(**files)

    async def test_key_of_another_certificate_is_refused(
        self, start_hub: StartHub, authority: Authority
    ) -> None:
        certificate, _ = authority.issue()
        _, other = authority.issue(file="other")
        with pytest.raises(HubError, match=r"key=.*: .*other\.key is not the key"):
            await start_hub(cert=certificate, key=other)

    async def test_key_with_a_password_is_refused_without_a_question(
        self, start_hub: StartHub, authority: Authority
    ) -> None:
        certificate, key = authority.issue()
        add_password(key)
        with pytest.raises(HubError, match=r"key=.*: .*password"):
            await start_hub(cert=certificate, key=key)


async def test_client_that_sends_the_request_with_its_handshake_is_answered(
    hub: HubServer, authority: Authority
) -> None:
    """With TLS 1.3 the request may arrive together with the end of the handshake."""
    incoming, outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
    tls = authority.client().wrap_bio(incoming, outgoing, server_hostname="127.0.0.1")
    async with asyncio.timeout(PATIENCE):
        reader, writer = await asyncio.open_connection("127.0.0.1", hub.port)
        while True:
            try:
                tls.do_handshake()
                break
            except ssl.SSLWantReadError:
                writer.write(outgoing.read())
                incoming.write(await reader.read(2**16))
        tls.write(handshake() + frame(0x9, b"hello"))
        writer.write(outgoing.read())
        seen = b""
        while not seen.endswith(b"\x8a\x05hello"):
            try:
                seen += tls.read(2**16)
            except ssl.SSLWantReadError:
                data = await reader.read(2**16)
                assert data
                incoming.write(data)
        assert seen.startswith(b"HTTP/1.1 101")
        writer.close()


async def test_node_publishes_over_tls(
    hub: HubServer, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SSL_CERT_FILE", str(authority.file))
    async with fibws.Node("a", hub=hub.url) as a, fibws.Node("b", hub=hub.url) as b:
        numbers = b.subscribe("numbers", Int32, queue_size=100)
        publisher = await a.advertise("numbers", Int32)
        await b.graph.nodes()
        for number in range(100):
            await publisher.publish(number)
        async with asyncio.timeout(PATIENCE):
            assert [(await anext(numbers)).data for _ in range(100)] == [*range(100)]
