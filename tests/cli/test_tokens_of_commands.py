"""Commands on a hub that wants a token."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from click.testing import CliRunner
from client.servers import websocket_server
from websockets.sync.server import ServerConnection

from fibws import hub_address
from fibws.cli.commands import command


class TokenHub:
    """A server that lets in clients with the token ``secret``, and has the services of a hub."""

    def __init__(self) -> None:
        self.tokens: list[str | None] = []

    def handle(self, connection: ServerConnection) -> None:
        assert connection.request is not None
        token = connection.request.headers.get("Authorization")
        self.tokens.append(token)
        connection.close(4401, "missing token" if token is None else "unknown token")


@pytest.fixture(autouse=True)
def variables(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("FIBWS_HUB", "FIBWS_TOKEN", "FIBWS_TOKEN_FILE"):
        monkeypatch.setenv(name, "")  # Restored afterwards, even if a command sets it.


@pytest.mark.parametrize(
    "words", [["topic", "list"], ["param", "get", "/a"], ["msg", "show", "a/B"]]
)
def test_missing_token_is_one_line_and_exit_code_77(words: list[str]) -> None:
    hub = TokenHub()
    with websocket_server(hub.handle) as url:
        result = CliRunner().invoke(command, [*words, "--hub", url])
    assert result.exit_code == 77
    assert len(result.output.splitlines()) == 1
    assert "missing token" in result.output and "FIBWS_TOKEN" in result.output
    assert hub.tokens == [None]


@pytest.mark.parametrize(
    ("close_code", "exit_code"), [(1001, 1), (1013, 1), (4401, 77), (4403, 77), (4429, 75)]
)
def test_exit_code_says_whether_to_try_again(close_code: int, exit_code: int) -> None:
    def handle(connection: ServerConnection) -> None:
        connection.close(close_code, "why")

    with websocket_server(handle) as url:
        result = CliRunner().invoke(command, ["topic", "list", "--hub", url])
    assert result.exit_code == exit_code
    assert len(result.output.splitlines()) == 1 and "why" in result.output


def test_token_file_is_sent_and_named_when_it_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "token"
    file.write_text("secret\n")
    hub = TokenHub()
    with websocket_server(hub.handle) as url:
        result = CliRunner().invoke(
            command, ["topic", "list", "--hub", url, "--token-file", str(file)]
        )
    assert hub.tokens == ["Bearer secret"]
    assert result.exit_code == 77 and str(file) in result.output
    assert "secret" not in result.output


def test_token_file_changes_the_environment_only_while_the_command_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FIBWS_TOKEN", "other")
    monkeypatch.setenv("FIBWS_HUB", "ws://127.0.0.1:1/?token=other")
    file = tmp_path / "token"
    file.write_text("secret")
    before = dict(os.environ)
    CliRunner().invoke(command, ["topic", "list", "--token-file", str(file)])
    assert dict(os.environ) == before


def test_missing_token_file_is_a_usage_error(tmp_path: Path) -> None:
    file = tmp_path / "missing"
    result = CliRunner().invoke(command, ["topic", "list", "--token-file", str(file)])
    assert result.exit_code == 2 and str(file) in result.output


def test_launch_passes_on_the_token_of_its_url(tmp_path: Path) -> None:
    file = tmp_path / "a.launch"
    file.write_text('<launch><node name="a" pkg="fibws" type="listener"/></launch>')
    words = ["launch", str(file), "--args", "a", "--hub", "ws://robot:9090/?token=secret"]
    result = CliRunner().invoke(command, words)
    assert result.exit_code == 0, result.output
    assert "FIBWS_HUB=ws://robot:9090/ " in result.output and "secret" not in result.output
    assert os.environ["FIBWS_TOKEN"] == "secret"


def test_token_without_encryption_is_warned_about(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_TOKEN", "secret")
    monkeypatch.setattr(hub_address, "is_loopback", lambda host: False)

    def handle(connection: ServerConnection) -> None:
        for _ in connection:
            connection.close(4401, "unknown token")

    with websocket_server(handle) as url:
        result = CliRunner().invoke(command, ["topic", "list", "--hub", url])
    assert result.output.count("without encryption") == 1
    assert "secret" not in result.output
