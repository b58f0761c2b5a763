"""Whether there is a hub, and what it is."""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from typing import TypeAlias

import pytest
from hub_in_thread import HubThread

from fibws.cli.doctor import hub as doctor
from fibws.cli.doctor.finding import Finding
from fibws.client.hub_client import HubClient

Serve: TypeAlias = Callable[..., str]


@pytest.fixture(autouse=True)
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("FIBWS_HUB", raising=False)
    monkeypatch.delenv("ROS_NAMESPACE", raising=False)


@pytest.fixture
def serve() -> Iterator[Serve]:
    """Starts an HTTP server that gives one answer to all; returns where, as of a hub."""
    servers: list[HTTPServer] = []

    def serve(status: int = 200, body: bytes = b"") -> str:
        class Answer(BaseHTTPRequestHandler):
            server_version = "Other/1.0"

            def do_GET(self) -> None:
                self.send_response(status)
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, format: str, *words: object) -> None:
                pass

        servers.append(HTTPServer(("127.0.0.1", 0), Answer))
        threading.Thread(target=servers[-1].serve_forever, args=(0.05,)).start()
        return f"ws://127.0.0.1:{servers[-1].server_port}"

    yield serve
    for server in servers:
        server.shutdown()
        server.server_close()


def why_not(url: str | None) -> Finding:
    finding = doctor.reach(url)
    assert isinstance(finding, Finding)
    return finding


def test_a_hub_is_reached(hub: HubThread) -> None:
    client = doctor.reach(hub.url)
    assert isinstance(client, HubClient)
    client.close()


def test_where_nothing_answers_it_tells_how_to_start_one() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        url = f"ws://127.0.0.1:{taken.getsockname()[1]}"
    finding = why_not(url)
    assert finding.verdict == "wrong"
    assert finding.text.startswith(f"Nothing answers at {url} (--hub tells of it; ")
    assert finding.advice.startswith("Start one: fibws hub.")


@pytest.mark.parametrize("is_set", [True, False])
def test_it_tells_where_the_address_is_from(is_set: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        url = f"ws://127.0.0.1:{taken.getsockname()[1]}"
    if is_set:
        monkeypatch.setenv("FIBWS_HUB", url)
    monkeypatch.setattr("fibws.hub_address.DEFAULT", url)
    expected = "FIBWS_HUB tells of it" if is_set else "FIBWS_HUB is not set"
    assert f"({expected}; " in why_not(None).text


def test_what_is_no_hub_is_named(serve: Serve) -> None:
    finding = why_not(serve(404))
    assert finding.verdict == "wrong"
    assert "the server is not a hub" in finding.text
    assert "It answers HTTP with 404, as Other/1.0" in finding.text


def test_what_speaks_no_http_is_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fibws.client.websocket.PATIENCE", 0.2)
    monkeypatch.setattr(doctor, "PATIENCE", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        finding = why_not(f"ws://127.0.0.1:{silent.getsockname()[1]}")
    assert "no handshake within 0.2 s. It does not answer HTTP either" in finding.text


def test_what_is_no_address_is_not_looked_for() -> None:
    assert why_not("http://robot").text == "Not looked for"


def test_the_hubs_version_is_compared(hub: HubThread, monkeypatch: pytest.MonkeyPatch) -> None:
    assert doctor.version(hub.url).verdict == "ok"
    monkeypatch.setattr(doctor, "__version__", "99.0.1")
    finding = doctor.version(hub.url)
    assert finding.verdict == "warning"
    assert "this is 99.0.1" in finding.text


def test_a_hub_tells_its_version_by_a_name_of_its_machine_that_it_does_not_know(
    hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    find = socket.getaddrinfo

    def find_robot(host: str, *others: object) -> object:
        return find("127.0.0.1" if host == "robot" else host, *others)  # type: ignore[arg-type]

    monkeypatch.setattr(socket, "getaddrinfo", find_robot)
    assert doctor.version(hub.url.replace("127.0.0.1", "robot")).verdict == "ok"


@pytest.mark.parametrize("body", [b"", b"[]", b"{}", b"<html>\n", b"\xff"])
def test_another_server_has_no_version(body: bytes, serve: Serve) -> None:
    finding = doctor.version(serve(200, body))
    assert finding.verdict == "warning"
    assert "/healthz there answers 200, without a version" in finding.text


def test_a_hub_that_is_gone_has_no_version(hub: HubThread) -> None:
    hub.stop()
    assert "does not answer a plain HTTP request" in doctor.version(hub.url).text


def test_distance_is_measured(client: HubClient) -> None:
    trip, clock = doctor.distance(client)
    assert [trip.check, clock.check] == ["round trip", "clock"]
    assert "ms" in trip.text
    assert clock.verdict == "ok", "one machine has one clock"


def test_a_slow_answer_is_odd(client: HubClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "SLOW_TRIP", 0.0)
    assert next(doctor.distance(client)).verdict == "warning"


@pytest.mark.parametrize(
    ("ahead", "within", "verdict", "text"),
    [
        (0.01, 0.02, "ok", "The clocks agree within 20.0 ms"),
        (0.3, 0.02, "ok", "The hub's clock is 0.300 s ahead of this machine's"),
        (-0.3, 0.02, "ok", "The hub's clock is 0.300 s behind this machine's"),
        (5.0, 0.02, "warning", "The hub's clock is 5.000 s ahead of this machine's"),
        (5.0, 5.1, "ok", "The clocks agree within 5100.0 ms"),
    ],
)
def test_clocks_agree_as_far_as_can_be_told(
    ahead: float, within: float, verdict: str, text: str
) -> None:
    finding = doctor.clocks(ahead, within)
    assert (finding.verdict, finding.text) == (verdict, text)
