"""``fibws core``: a hub as roscore is one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import TypeAlias

import pytest
from hub_in_thread import HubThread

from fibws.client.hub_client import HubClient

Core: TypeAlias = "Callable[..., subprocess.Popen[str]]"
PATIENCE = 60


@pytest.fixture
def core() -> Iterator[Core]:
    """Starts ``fibws core``, which is ended after the test."""
    with ExitStack() as stack:

        def start(*words: str, **environ: str) -> subprocess.Popen[str]:
            inherited = {
                name: value for name, value in os.environ.items() if not name.startswith("FIBWS")
            }
            process = subprocess.Popen(
                [sys.executable, "-m", "fibws", "core", *words],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                env={**inherited, **environ},
            )
            stack.callback(process.communicate)
            stack.callback(process.terminate)
            return process

        yield start


def line_of(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    return process.stdout.readline()


def said(process: subprocess.Popen[str]) -> tuple[int, str, str]:
    out, err = process.communicate(timeout=PATIENCE)
    return process.returncode, out, err


def free_port() -> int:
    import socket

    with socket.create_server(("127.0.0.1", 0)) as server:
        port: int = server.getsockname()[1]
    return port


def test_it_is_a_hub_until_ctrl_c(core: Core) -> None:
    process = core("-p", "0")
    line = line_of(process)
    assert line.startswith("The hub listens at ws://127.0.0.1:")
    with HubClient("test", line.split()[4].rstrip(";")) as client:
        assert "/rosout" in client.call("/rosapi/topics")["topics"]
    process.send_signal(signal.SIGINT)
    assert process.wait(PATIENCE) == 0


def test_it_takes_the_port_at_which_nodes_look_for_it(core: Core) -> None:
    url = f"ws://127.0.0.1:{free_port()}"
    assert line_of(core(FIBWS_HUB=url)).startswith(f"The hub listens at {url};")


def test_a_port_at_which_nobody_looks_for_it_is_to_be_told(core: Core) -> None:
    port = free_port()
    process = core("--port", str(port))
    assert line_of(process) == (
        f"Tell the other terminals: export FIBWS_HUB=ws://127.0.0.1:{port}\n"
    )
    assert line_of(process).startswith("The hub listens at")


def test_a_proxy_that_speaks_tls_is_no_place_for_it(core: Core) -> None:
    port = free_port()
    process = core("--port", str(port), FIBWS_HUB=f"wss://127.0.0.1:{port}")
    assert line_of(process) == (
        f"Tell the other terminals: export FIBWS_HUB=ws://127.0.0.1:{port}\n"
    )


def test_a_second_one_says_that_one_is_running(core: Core, hub: HubThread) -> None:
    for process in (core("-p", str(hub.port)), core(FIBWS_HUB=hub.url)):
        assert said(process) == (
            1,
            "",
            "Error: fibws core cannot run as another roscore/master is already running: the hub at "
            f"{hub.url}. One is enough for all nodes. To end it, press Ctrl-C where it was "
            "started.\n",
        )


def test_what_ros_has_is_read_past(core: Core) -> None:
    process = core("-v", "-w", "3", "-t", "2", "-p", "0")
    assert line_of(process).startswith("The hub listens at")


def test_nodes_that_look_for_it_on_another_machine_are_told_of(core: Core) -> None:
    process = core(FIBWS_HUB=f"ws://robot.example:{free_port()}")
    assert process.stderr is not None
    assert process.stderr.readline() == (
        "WARNING: FIBWS_HUB has nodes look for the hub at robot.example, and this one is for "
        "this machine alone\n"
    )
    assert line_of(process).startswith("The hub listens at ws://127.0.0.1:")


def test_an_address_that_is_none_is_an_error(core: Core) -> None:
    code, _, err = said(core(FIBWS_HUB="http://robot"))
    assert code == 1
    assert err.startswith("Error: 'http://robot' is not the address of a hub")
