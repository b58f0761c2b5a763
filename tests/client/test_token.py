"""Tokens of tools: how they are sent and refused."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from select import select

import pytest
from unsigned_token import unsigned
from websockets.sync.server import ServerConnection

from client.servers import redirecting_server, websocket_server
from fibws.client.hub_client import HubClient, is_hub_running
from fibws.errors import AccessDenied, AccessError, HubLimitReached, MissingRight, NotAuthorized


@pytest.fixture(autouse=True)
def no_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("FIBWS_TOKEN", "FIBWS_TOKEN_FILE", "FIBWS_HUB"):
        monkeypatch.delenv(name, raising=False)


@contextmanager
def hub_that_closes(
    code: int = 4401, reason: str = "missing token"
) -> Iterator[tuple[str, list[str | None]]]:
    """A hub that refuses each client; the second value has the tokens that were sent."""
    tokens: list[str | None] = []

    def handle(connection: ServerConnection) -> None:
        assert connection.request is not None
        assert "secret" not in connection.request.path
        tokens.append(connection.request.headers.get("Authorization"))
        connection.close(code, reason)

    with websocket_server(handle, "fibws.v1") as url:
        yield url, tokens


@pytest.mark.parametrize("source", ["variable", "file", "url", "environment url"])
def test_token_is_sent_in_the_header(
    source: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    file = tmp_path / "token"
    file.write_text("secret\n")
    with hub_that_closes() as (url, tokens):
        address: str | None = url
        if source == "variable":
            monkeypatch.setenv("FIBWS_TOKEN", "secret")
        elif source == "file":
            monkeypatch.setenv("FIBWS_TOKEN_FILE", str(file))
        elif source == "url":
            address = f"{url}/?token=secret"
        else:
            monkeypatch.setenv("FIBWS_HUB", f"{url}/?token=secret")
            address = None
        with pytest.raises(NotAuthorized) as caught, HubClient("test", address) as client:
            assert "secret" not in client.url
            client.receive()
        assert "secret" not in str(caught.value)
        assert tokens == ["Bearer secret"]


@pytest.mark.parametrize(
    ("code", "error"), [(4401, NotAuthorized), (4403, MissingRight), (4429, HubLimitReached)]
)
def test_refusal_is_an_error_of_its_kind(code: int, error: type[AccessDenied]) -> None:
    with hub_that_closes(code, "the hub's reason") as (url, _):
        with pytest.raises(error, match="the hub's reason"), HubClient("test", url) as client:
            client.call("/rosapi/topics")


def test_refusal_is_an_error_even_if_the_tool_only_sends() -> None:
    with hub_that_closes() as (url, _):
        with pytest.raises(NotAuthorized), HubClient("test", url) as client:
            select([client], [], [], 60)
            client.send({"op": "publish", "topic": "/a", "msg": {}})


def test_refusal_is_raised_once() -> None:
    def handle(connection: ServerConnection) -> None:
        connection.recv()
        connection.close(4401, "the token was revoked")

    with websocket_server(handle) as url:
        client = HubClient("test", url)
        client.subscribe("/a")
        with pytest.raises(NotAuthorized):
            client.receive()
        client.close()


def test_refusal_shows_that_a_hub_is_running() -> None:
    with hub_that_closes() as (url, _):
        assert is_hub_running(url)


def test_invalid_token_is_reported_before_connecting(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_TOKEN", "two words")
    with pytest.raises(AccessError, match="FIBWS_TOKEN"):
        HubClient("test", "ws://127.0.0.1:1")


def test_token_is_not_in_debug_logs(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    monkeypatch.setenv("FIBWS_TOKEN", "secret")
    with hub_that_closes() as (url, _):
        with pytest.raises(NotAuthorized), HubClient("test", url) as client:
            client.receive()
    sent = [record.getMessage() for record in caplog.records if "client" in record.name]
    assert any("Authorization" in line for line in sent)
    assert not any("secret" in line for line in sent)


def test_token_is_not_sent_to_where_another_server_redirects(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("FIBWS_TOKEN", "secret")
    with hub_that_closes() as (url, tokens), redirecting_server(url) as first:
        with pytest.raises(NotAuthorized, match="redirects"), HubClient("test", first) as client:
            client.receive()
    assert tokens == [None]


def test_token_is_renewed_before_it_expires(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tool may wait for hours, such as `fibws topic echo`."""
    file = tmp_path / "token"
    file.write_text(unsigned("first", 1))
    monkeypatch.setenv("FIBWS_TOKEN_FILE", str(file))

    def handle(connection: ServerConnection) -> None:
        connection.send(connection.recv())

    with websocket_server(handle, "fibws.v1") as url, HubClient("test", url) as client:
        second = unsigned("second", 1000)
        file.write_text(second)
        assert client.receive() == {"op": "auth", "token": second}
