"""``fibws launch`` of rosbridge_websocket, whose place the hub takes."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest
from hub_in_thread import HubThread
from ports import port as port

from fibws import hub_address

from .conftest import Launch, write

INCLUDE = (
    '<include file="$(find rosbridge_server)/launch/rosbridge_websocket.launch">'
    '<arg name="port" value="{}"/></include>'
)
ENDING = '<node pkg="robot" type="failer" name="f" required="true"/>'


nothing = port
"""A second reserved port."""


@pytest.fixture(autouse=True)
def default_url(monkeypatch: pytest.MonkeyPatch, nothing: int) -> None:
    """Let no hub run at the default URL."""
    monkeypatch.setattr(hub_address, "DEFAULT", f"ws://127.0.0.1:{nothing}")


@pytest.fixture
def http_server() -> Iterator[str]:
    """The URL of a server that is not a hub."""
    with HTTPServer(("127.0.0.1", 0), BaseHTTPRequestHandler) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        yield f"ws://127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join(60)


@pytest.mark.long
def test_own_hub_listens_on_the_port_of_the_launch_file(
    launch: Launch, robot: Path, port: int
) -> None:
    result = launch(write(robot, INCLUDE.format(port) + ENDING))
    lines = result.stdout.splitlines()
    assert "auto-starting new hub" in lines
    assert f"FIBWS_HUB=ws://127.0.0.1:{port}" in lines
    assert any(f"export FIBWS_HUB=ws://127.0.0.1:{port}" in line for line in lines)
    assert f" * /rosbridge_websocket/port: {port}" in lines
    assert "    rosbridge_websocket (rosbridge_server/rosbridge_websocket)" in lines
    assert any(line.startswith("[rosbridge_websocket] not started") for line in lines)
    assert "WARNING" not in result.stderr


def test_running_hub_at_the_port_of_the_launch_file_is_used(
    launch: Launch, robot: Path, hub: HubThread
) -> None:
    port = hub.url.rpartition(":")[2]
    result = launch(write(robot, INCLUDE.format(port)))
    assert result.exit_code == 0
    assert f"FIBWS_HUB={hub.url}" in result.stdout.splitlines()
    assert "WARNING" not in result.stderr


def test_other_port_of_a_running_hub_is_a_warning(
    launch: Launch, robot: Path, hub: HubThread, monkeypatch: pytest.MonkeyPatch, port: int
) -> None:
    file = write(robot, INCLUDE.format(port))
    monkeypatch.setattr(hub_address, "DEFAULT", hub.url)
    results = [launch(file), launch(file, "--hub", hub.url)]
    monkeypatch.setenv("FIBWS_HUB", hub.url)
    for result in [*results, launch(file)]:
        assert result.exit_code == 0
        assert f"FIBWS_HUB={hub.url}" in result.stdout.splitlines()
        [warning] = [line for line in result.stderr.splitlines() if "WARNING" in line]
        assert "rosbridge_websocket.launch:" in warning
        assert f"port {port}" in warning and hub.url in warning


def test_port_option_comes_before_the_port_of_the_launch_file(
    launch: Launch, robot: Path, port: int
) -> None:
    result = launch(write(robot, INCLUDE.format(port) + ENDING), "-p", "0")
    assert f"FIBWS_HUB=ws://127.0.0.1:{port}" not in result.stdout.splitlines()
    assert f"port {port} is ignored" in result.stderr


@pytest.mark.long
def test_other_server_at_the_default_port_does_not_matter(
    launch: Launch,
    robot: Path,
    monkeypatch: pytest.MonkeyPatch,
    http_server: str,
    port: int,
) -> None:
    monkeypatch.setattr(hub_address, "DEFAULT", http_server)
    result = launch(write(robot, INCLUDE.format(port) + ENDING))
    assert f"FIBWS_HUB=ws://127.0.0.1:{port}" in result.stdout.splitlines()
    result = launch(write(robot, ENDING))
    assert result.exit_code == 1
    assert http_server in result.stderr


def test_invalid_port_is_found_without_a_hub(launch: Launch, robot: Path) -> None:
    file = write(robot, INCLUDE.format("x"))
    for result in (launch("--check", file), launch(file)):
        assert result.exit_code == 1
        assert "port must be between 0 and 65535, got 'x'" in result.output
