"""``fibws core``: a hub as a replacement for roscore."""

from __future__ import annotations

import os
import re
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


def url_of(process: subprocess.Popen[str]) -> str:
    """Wait until the hub listens; return its URL."""
    found = re.search(r"ws://[\d.]+:\d+", line_of(process))
    assert found is not None
    return found[0]


def end_of(process: subprocess.Popen[str]) -> tuple[int, str, str]:
    out, err = process.communicate(timeout=PATIENCE)
    return process.returncode, out, err


def free_port() -> int:
    import socket

    with socket.create_server(("127.0.0.1", 0)) as server:
        port: int = server.getsockname()[1]
    return port


def test_core_runs_a_hub_until_ctrl_c(core: Core) -> None:
    process = core("-p", "0")
    with HubClient("test", url_of(process)) as client:
        assert "/rosout" in client.call("/rosapi/topics")["topics"]
    process.send_signal(signal.SIGINT)
    assert process.wait(PATIENCE) == 0


def test_default_port_is_that_of_fibws_hub(core: Core) -> None:
    url = f"ws://127.0.0.1:{free_port()}"
    assert url_of(core(FIBWS_HUB=url)) == url


def test_other_port_is_printed_for_other_terminals(core: Core) -> None:
    port = free_port()
    process = core("--port", str(port))
    assert f"export FIBWS_HUB=ws://127.0.0.1:{port}\n" in line_of(process)
    assert url_of(process)


def test_address_of_a_proxy_with_tls_is_not_used(core: Core) -> None:
    port = free_port()
    process = core("--port", str(port), FIBWS_HUB=f"wss://127.0.0.1:{port}")
    assert f"export FIBWS_HUB=ws://127.0.0.1:{port}\n" in line_of(process)


def test_second_hub_does_not_start(core: Core, hub: HubThread) -> None:
    for process in (core("-p", str(hub.port)), core(FIBWS_HUB=hub.url)):
        code, out, err = end_of(process)
        assert (code, out) == (1, "")
        assert "already running" in err and hub.url in err


def test_options_of_roscore_are_accepted(core: Core) -> None:
    process = core("-v", "-w", "3", "-t", "2", "-p", "0")
    assert url_of(process)


def test_fibws_hub_on_another_machine_is_a_warning(core: Core) -> None:
    process = core(FIBWS_HUB=f"ws://robot.example:{free_port()}")
    assert process.stderr is not None
    warning = process.stderr.readline()
    assert warning.startswith("WARNING: ") and "robot.example" in warning
    assert url_of(process).startswith("ws://127.0.0.1:")


def test_invalid_address_is_an_error(core: Core) -> None:
    code, _, err = end_of(core(FIBWS_HUB="http://robot"))
    assert code == 1
    assert err.startswith("Error: 'http://robot' is not the address of a hub")
