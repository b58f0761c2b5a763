"""``fibws core``: a hub as a replacement for roscore."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Sequence
from typing import TypeAlias

import pytest
from click.testing import CliRunner, Result
from hub_in_thread import HubThread
from patience import PATIENCE
from ports import port as port

from fibws.cli import core as module
from fibws.cli.commands import command
from fibws.client.hub_client import HubClient

PORT = 65001
"""A port without a hub."""

Core: TypeAlias = Callable[..., Result]


class Started(Exception):
    """Raised instead of starting a hub."""


@pytest.fixture
def core(monkeypatch: pytest.MonkeyPatch) -> Core:
    """Run ``fibws core`` up to the start of the hub, whose command it prints."""

    def exec_command(words: Sequence[str]) -> None:
        print(*words[words.index("-m") :])
        raise Started

    monkeypatch.setattr(module, "exec_command", exec_command)
    for name in [name for name in os.environ if name.startswith(("FIBWS", "ROS_"))]:
        monkeypatch.delenv(name)

    def core(*words: str, ros1: bool = False, **environ: str) -> Result:
        words = words if ros1 else ("--no-ros1", *words)
        return CliRunner().invoke(command, ["core", *words], env=environ, prog_name="fibws")

    return core


def hub_command(result: Result) -> str:
    assert isinstance(result.exception, Started), result.output
    return result.stdout.splitlines()[-1]


def test_core_runs_a_hub_until_ctrl_c() -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "fibws", "core", "-p", "0", "--no-ros1"],
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        url = re.search(r"ws://[\d.]+:\d+", process.stdout.readline())
        assert url is not None
        with HubClient("test", url[0]) as client:
            assert "/rosout" in client.call("/rosapi/topics")["topics"]
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 0


def test_default_port_is_that_of_fibws_hub(core: Core) -> None:
    result = core(FIBWS_HUB=f"ws://127.0.0.1:{PORT}")
    assert hub_command(result) == result.stdout.strip() == f"-m fibws.hub --port {PORT}"


@pytest.mark.parametrize("url", [None, f"wss://127.0.0.1:{PORT}"])
def test_other_port_is_printed_for_other_terminals(core: Core, url: str | None) -> None:
    result = core("--port", str(PORT), **({} if url is None else {"FIBWS_HUB": url}))
    assert hub_command(result) == f"-m fibws.hub --port {PORT}"
    assert f"export FIBWS_HUB=ws://127.0.0.1:{PORT}\n" in result.stdout


def test_second_hub_does_not_start(core: Core, hub: HubThread) -> None:
    for result in (core("-p", str(hub.port)), core(FIBWS_HUB=hub.url)):
        assert (result.exit_code, result.stdout) == (1, "")
        assert "already running" in result.stderr and hub.url in result.stderr


def test_options_of_roscore_are_accepted(core: Core) -> None:
    assert hub_command(core("-v", "-w", "3", "-t", "2", "-p", "0")) == "-m fibws.hub --port 0"


def test_hub_is_the_master_of_ros_1_nodes(core: Core, port: int) -> None:
    result = core("-p", "0", ros1=True, ROS_MASTER_URI=f"http://localhost:{port}")
    assert hub_command(result) == f"-m fibws.hub --port 0 --ros1 {port}"


def test_hub_starts_without_a_master_if_its_port_is_taken(core: Core) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        taken.listen()
        result = core("-p", "0", ros1=True, ROS_MASTER_URI=f"http://localhost:{port}")
    assert hub_command(result) == "-m fibws.hub --port 0"
    assert str(port) in result.stderr and "roscore" in result.stderr


@pytest.mark.parametrize("uri", ["", "http://robot.example:1234", "http://localhost:x"])
def test_master_is_at_its_usual_port_unless_it_is_of_this_machine(
    core: Core, monkeypatch: pytest.MonkeyPatch, uri: str
) -> None:
    monkeypatch.setattr(socket.socket, "bind", lambda *arguments: None)
    result = core("-p", "0", ros1=True, ROS_MASTER_URI=uri)
    assert hub_command(result) == "-m fibws.hub --port 0 --ros1 11311"


def test_fibws_hub_on_another_machine_is_a_warning(core: Core) -> None:
    result = core(FIBWS_HUB=f"ws://robot.example:{PORT}")
    assert result.stderr.startswith("WARNING: ") and "robot.example" in result.stderr
    assert hub_command(result) == f"-m fibws.hub --port {PORT}"


def test_invalid_address_is_an_error(core: Core) -> None:
    result = core(FIBWS_HUB="http://robot")
    assert result.exit_code == 1
    assert "http://robot" in result.stderr
