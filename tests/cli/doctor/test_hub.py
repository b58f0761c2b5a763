"""Checks of the hub."""

from __future__ import annotations

import json
import re
import socket
import threading
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import TypeAlias

import pytest
from certificates import Authority
from certificates import authority as authority
from hub_in_thread import HubThread

from fibws import tls
from fibws.access.rights import Rights
from fibws.access.token_file import TokenFile
from fibws.cli.doctor import hub as doctor
from fibws.cli.doctor import machine
from fibws.cli.doctor.finding import Finding
from fibws.client import hub_pages
from fibws.client.hub_client import HubClient
from fibws.hub import Settings

Serve: TypeAlias = Callable[..., str]


@pytest.fixture(autouse=True)
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("FIBWS_HUB", raising=False)
    monkeypatch.delenv("ROS_NAMESPACE", raising=False)


@pytest.fixture
def serve() -> Iterator[Serve]:
    """Return a function that starts an HTTP server and returns its address as a hub's."""
    servers: list[HTTPServer] = []

    def serve(status: int = 200, body: bytes = b"") -> str:
        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"
            server_version = "Other/1.0"

            def do_GET(self) -> None:
                self.send_response(status)
                self.send_header("Content-Length", str(len(body)))
                self.send_header("Connection", "close")
                if body.startswith(b"<"):
                    self.send_header("Content-Type", "text/html")
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, format: str, *words: object) -> None:
                pass

        servers.append(HTTPServer(("127.0.0.1", 0), Handler))
        threading.Thread(target=servers[-1].serve_forever, args=(0.05,)).start()
        return f"ws://127.0.0.1:{servers[-1].server_port}"

    yield serve
    for server in servers:
        server.shutdown()
        server.server_close()


def failure(url: str | None) -> Finding:
    finding = doctor.reach(url)
    assert isinstance(finding, Finding)
    return finding


def test_running_hub_is_reached(hub: HubThread) -> None:
    client = doctor.reach(hub.url)
    assert isinstance(client, HubClient)
    client.close()


def test_missing_hub_gives_the_command_to_start_one() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        url = f"ws://127.0.0.1:{taken.getsockname()[1]}"
    finding = failure(url)
    assert finding.verdict == "wrong"
    assert url in finding.text and "--hub" in finding.text
    assert "fibws hub" in finding.advice


@pytest.mark.parametrize("is_set", [True, False])
def test_finding_names_the_source_of_the_address(
    is_set: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        url = f"ws://127.0.0.1:{taken.getsockname()[1]}"
    if is_set:
        monkeypatch.setenv("FIBWS_HUB", url)
    monkeypatch.setattr("fibws.hub_address.DEFAULT", url)
    expected = "from FIBWS_HUB" if is_set else "FIBWS_HUB is not set"
    assert f"({expected}; " in failure(None).text


def test_other_http_server_is_described(serve: Serve) -> None:
    finding = failure(serve(404))
    assert finding.verdict == "wrong"
    assert "the server is not a hub" in finding.text
    assert "404" in finding.text and "Other/1.0" in finding.text


def test_proxy_without_its_hub_is_named(serve: Serve) -> None:
    finding = failure(serve(502, b"<html><title>502 Bad Gateway</title>"))
    assert finding.text.count("502") == 1
    assert "proxy" in finding.advice and "fibws hub" not in finding.advice


def test_path_that_the_hub_does_not_know_names_its_setting(hub: HubThread) -> None:
    finding = doctor.version(f"{hub.url}/robot/")
    assert finding.verdict == "warning" and "--url-path /robot" in finding.advice


def test_proxy_that_passes_on_no_upgrade_is_named(hub: HubThread) -> None:
    with socket.create_server(("127.0.0.1", 0)) as proxy:
        thread = threading.Thread(target=pass_on_without_upgrade, args=(proxy, hub.port))
        thread.start()
        finding = failure(f"ws://127.0.0.1:{proxy.getsockname()[1]}")
        thread.join(60)
    assert finding.verdict == "wrong"
    assert "no header Upgrade" in finding.text and "not a hub" not in finding.text
    assert "proxy" in finding.advice and "Upgrade and Connection" in finding.advice


def pass_on_without_upgrade(proxy: socket.socket, port: int) -> None:
    """Pass on one request as a proxy does that knows no WebSockets."""
    client, _ = proxy.accept()
    with client, socket.create_connection(("127.0.0.1", port)) as hub:
        head = client.recv(2**16)
        lines = [each for each in head.split(b"\r\n") if not each.startswith((b"Upgrade", b"Conn"))]
        hub.sendall(b"\r\n".join(lines))
        while data := hub.recv(2**16):
            client.sendall(data)


PLAIN_TO_TLS = b"<html><title>400 The plain HTTP request was sent to HTTPS port</title>"


@pytest.mark.parametrize(
    ("status", "body", "advice"),
    [(400, PLAIN_TO_TLS, "Use wss://."), (200, b"", "path, .* slash .* proxy passes on Upgrade")],
)
def test_advice_is_that_of_the_fault(serve: Serve, status: int, body: bytes, advice: str) -> None:
    finding = failure(serve(status, body))
    assert re.search(advice, finding.advice)
    assert finding.text.count("(") == finding.text.count(")")


def test_hub_with_tls_is_named(authority: Authority) -> None:
    certificate, key = authority.issue("127.0.0.1")
    with HubThread(Settings(port=0, cert=certificate, key=key)) as hub:
        finding = failure(f"ws://127.0.0.1:{hub.port}")
    assert "TLS" in finding.text and "wss://" in finding.advice


def test_address_that_nothing_answers_is_not_said_to_be_a_program() -> None:
    finding = failure("ws://nowhere.invalid:9090")
    assert "program" not in finding.advice and "address" in finding.advice


def test_server_without_http_is_described(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fibws.client.websocket.PATIENCE", 0.2)
    monkeypatch.setattr("fibws.client.hub_pages.PATIENCE", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        finding = failure(f"ws://127.0.0.1:{silent.getsockname()[1]}")
    assert "0.2 s" in finding.text and "network" in finding.advice


def test_hub_is_not_checked_at_an_invalid_address() -> None:
    assert failure("http://robot").verdict == "wrong"


@pytest.mark.parametrize(
    ("theirs", "ours", "verdict"),
    [
        ("1.2.0", "1.2.3", "ok"),
        ("1.2.0", "1.2.0.dev7+gabcdef", "ok"),
        ("1.2.0", "1.3.0.dev7+gabcdef", "warning"),
        ("1.2.0", "2.2.0", "warning"),
        ("1.2.0", "0.1.0.dev0", "ok"),
        ("0.0", "1.2.0", "ok"),
        ("0.1.0.dev7+gabcdef", "1.2.0", "warning"),
    ],
)
def test_version_of_the_hub_is_compared(
    serve: Serve, monkeypatch: pytest.MonkeyPatch, theirs: str, ours: str, verdict: str
) -> None:
    monkeypatch.setattr(doctor, "__version__", ours)
    finding = doctor.version(serve(200, json.dumps({"version": theirs}).encode()))
    assert finding.verdict == verdict
    assert theirs in finding.text and ours in finding.text


def test_version_of_a_real_hub_is_its_own(hub: HubThread) -> None:
    assert doctor.version(hub.url).verdict == "ok"


def test_version_of_a_hub_that_does_not_accept_its_host_name(
    hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    find = socket.getaddrinfo

    def find_robot(host: str, *others: object) -> object:
        return find("127.0.0.1" if host == "robot" else host, *others)  # type: ignore[arg-type]

    monkeypatch.setattr(socket, "getaddrinfo", find_robot)
    assert doctor.version(hub.url.replace("127.0.0.1", "robot")).verdict == "ok"


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (b'{"warnings": ["nothing is recorded: the disk is full"]}', ["the disk is full"]),
        (b'{"warnings": []}', []),
        (b'{"status": "ok"}', []),
        (b"<html>", []),
    ],
)
def test_warnings_of_the_hub_are_shown(serve: Serve, body: bytes, expected: list[str]) -> None:
    findings = list(doctor.warnings(serve(200, body), {}))
    assert [each.verdict for each in findings] == ["warning"] * len(expected)
    assert all(fact in str(each) for fact, each in zip(expected, findings, strict=True))


def test_hub_may_hide_its_version(serve: Serve) -> None:
    finding = doctor.version(serve(200, b'{"status":"ok"}'))
    assert finding.verdict == "ok" and "admin" in finding.text


@pytest.mark.parametrize("body", [b"", b"[]", b"{}", b"<html>\n", b"\xff"])
def test_other_server_has_no_version(body: bytes, serve: Serve) -> None:
    finding = doctor.version(serve(200, body))
    assert finding.verdict == "warning"
    assert "/healthz" in finding.text and "200" in finding.text


def test_stopped_hub_has_no_version(hub: HubThread) -> None:
    hub.stop()
    assert doctor.version(hub.url).verdict == "warning"


def test_round_trip_and_clocks_are_measured(client: HubClient) -> None:
    trip, clock = doctor.round_trip(client)
    assert [trip.check, clock.check] == ["round trip", "clock"]
    assert "ms" in trip.text
    assert clock.verdict == "ok", "both are on this machine"


def test_slow_round_trip_is_a_warning(client: HubClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "SLOW_ROUND_TRIP", 0.0)
    assert next(doctor.round_trip(client)).verdict == "warning"


@pytest.mark.parametrize(
    ("ahead", "error", "verdict", "text"),
    [
        (0.01, 0.02, "ok", "within 20.0 ms"),
        (0.3, 0.02, "ok", "0.300 s ahead"),
        (-0.3, 0.02, "ok", "0.300 s behind"),
        (5.0, 0.02, "warning", "5.000 s ahead"),
        (5.0, 5.1, "ok", "within 5100.0 ms"),
    ],
)
def test_difference_of_clocks(ahead: float, error: float, verdict: str, text: str) -> None:
    finding = doctor.clock(ahead, error)
    assert finding.verdict == verdict and text in finding.text


@pytest.mark.parametrize(("days", "verdict"), [(30, "ok"), (2, "warning"), (-1, "warning")])
def test_certificate_that_ends_soon_is_named(days: int, verdict: str) -> None:
    now = datetime(2026, 1, 31, tzinfo=UTC)
    end = now + timedelta(days)
    [finding] = doctor.certificate(end.timestamp(), now.timestamp())
    assert finding.verdict == verdict
    assert f"{end:%Y-%m-%d %H:%M} UTC" in finding.text
    assert not [*doctor.certificate(None, now.timestamp())]


def test_certificate_of_the_server_is_looked_at(
    tls_hub: str, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_files(monkeypatch, authority.file)
    with HubClient("doctor", tls_hub) as client:
        end = client.certificate_end()
    assert end is not None and end > datetime(2026, 1, 1, tzinfo=UTC).timestamp()


def test_client_without_tls_has_no_certificate(client: HubClient) -> None:
    assert client.certificate_end() is None


def test_token_of_an_admin_sees_the_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tokens = TokenFile(tmp_path / "tokens.toml")
    token = tokens.add("operator", Rights(admin=True))
    params = tmp_path / "params.yaml"
    settings = Settings(port=0, tokens=tmp_path / "tokens.toml", params=params, keep_params=True)
    monkeypatch.setenv("FIBWS_TOKEN", token)
    with HubThread(settings) as hub, HubClient("doctor", hub.url) as client:
        assert "The hub is fibws" in doctor.version(client.url, client.headers).text
        health = json.loads(hub_pages.get(client.url, "healthz", client.headers)[2])
        assert health["warnings"] == []


@pytest.fixture
def tls_hub(authority: Authority, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A hub with TLS that lets in clients with certificates; its address."""
    for name in (*tls.VARIABLES, "FIBWS_TOKEN", "FIBWS_TOKEN_FILE"):
        monkeypatch.delenv(name, raising=False)
    certificate, key = authority.issue()
    settings = Settings(port=0, cert=certificate, key=key, client_ca=authority.file)
    with HubThread(settings) as hub:
        yield hub.url


def use_files(monkeypatch: pytest.MonkeyPatch, *files: Path) -> None:
    for name, file in zip(tls.VARIABLES, files, strict=False):
        monkeypatch.setenv(name, str(file))


def test_unknown_certificate_is_explained(tls_hub: str) -> None:
    finding = failure(tls_hub)
    assert finding.verdict == "wrong" and "certificate" in finding.text
    assert "FIBWS_CA=" in finding.advice and "ws://" not in finding.advice


def test_certificate_of_another_name_is_explained(
    tls_hub: str, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_files(monkeypatch, authority.file)
    finding = failure(tls_hub.replace("127.0.0.1", "localhost"))
    assert "not valid for 'localhost'" in finding.text
    assert finding.advice == "Connect by a name that is in it."


@pytest.mark.parametrize("file", ["missing", "of another authority"])
def test_certificate_of_this_client_that_is_of_no_use_is_explained(
    file: str,
    tls_hub: str,
    authority: Authority,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (tmp_path / "other").mkdir()
    own = Authority(tmp_path / "other").issue(common_name="arm")
    if file == "missing":
        own = (tmp_path / "missing.pem", own[1])
    use_files(monkeypatch, authority.file, *own)
    finding = failure(tls_hub)
    assert finding.verdict == "wrong"
    assert tls.CLIENT_CERT in finding.text + finding.advice
    assert not re.search(r"\bws://", finding.text + finding.advice)


def test_authority_that_cannot_be_read_is_named(
    tls_hub: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    use_files(monkeypatch, tmp_path / "missing.pem")
    finding = failure(tls_hub)
    assert "missing.pem" in finding.text
    assert tls.CA in finding.advice and "network" not in finding.advice


def test_accepted_certificate_is_named(
    tls_hub: str, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    certificate, key = authority.issue(common_name="arm", file="arm")
    use_files(monkeypatch, authority.file, certificate, key)
    client = doctor.reach(tls_hub)
    assert isinstance(client, HubClient)
    with client:
        [finding] = doctor.token(client)
    assert finding.verdict == "ok"
    assert finding.text == "The hub accepts the certificate in FIBWS_CLIENT_CERT, as arm"
    [finding] = machine.environment(tls_hub)
    assert all(f"{name}=" in finding.text for name in tls.VARIABLES)


@pytest.fixture
def token_hub(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[str, str]]:
    """A hub that wants a token, and one that it accepts."""
    for name in ("FIBWS_TOKEN", "FIBWS_TOKEN_FILE"):
        monkeypatch.delenv(name, raising=False)
    file = TokenFile(tmp_path / "tokens.toml")
    token = file.add("robot1", Rights({"subscribe": ("/**",)}))
    settings = Settings(port=0, close_timeout=0.1, tokens=tmp_path / "tokens.toml")
    with HubThread(settings) as hub:
        yield hub.url, token


@pytest.mark.parametrize("token", [None, "fibws_wrong"])
def test_refused_token_is_explained(
    token_hub: tuple[str, str], token: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    url, _ = token_hub
    if token is not None:
        monkeypatch.setenv("FIBWS_TOKEN", token)
    finding = failure(url)
    assert finding.verdict == "wrong" and "token" in finding.text
    assert "FIBWS_TOKEN" in finding.advice and "fibws token" in finding.advice
    assert token is None or token not in finding.text + finding.advice


def test_accepted_token_is_named_by_its_source(
    token_hub: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    url, token = token_hub
    monkeypatch.setenv("FIBWS_TOKEN", token)
    client = doctor.reach(url)
    assert isinstance(client, HubClient)
    with client:
        [finding] = doctor.token(client)
    assert finding.verdict == "ok" and "FIBWS_TOKEN" in finding.text
    assert token not in finding.text


def test_open_hub_is_mentioned(
    client: HubClient, hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    [finding] = doctor.token(client)
    assert finding.verdict == "ok" and "everybody" in finding.text
    monkeypatch.setenv("FIBWS_TOKEN", "secret")
    with HubClient("test", hub.url) as with_token:
        [finding] = doctor.token(with_token)
    assert finding.verdict == "warning" and "secret" not in finding.text


def test_server_without_a_login_is_not_judged(client: HubClient, serve: Serve) -> None:
    for status, body in ((404, b"nothing"), (200, b"[]"), (200, b'{"required"')):
        client.url = serve(status, body)
        assert list(doctor.token(client)) == []
