"""``fibws demo``."""

from __future__ import annotations

import asyncio
import re
import signal
from collections.abc import AsyncIterator
from pathlib import Path
from typing import NoReturn

import pytest
from click.testing import CliRunner
from running_programs import Start

from fibws.errors import HubError
from fibws.hub import Hub
from fibws.hub.server import HubServer
from fibws.programs import demo

DEMO = ("fibws", "demo", "--rate", "100")


async def test_demo_runs_a_hub_and_both_nodes(start: Start) -> None:
    program = await start(*DEMO, "--port", "0")
    found = re.search(r"(ws://127\.0\.0\.1:\d+)", await program.line())
    assert found is not None
    assert found[1].replace("ws", "http") in await program.line()
    await program.line()
    lines = [await program.line() for _ in range(10)]
    said = [line.split()[-1] for line in lines if line.startswith("broadcaster [INFO] [")]
    heard = [line.split()[-1] for line in lines if line.startswith("listener    [INFO] [")]
    assert said[:4] == heard[:4] == ["0", "1", "1", "2"]
    assert all(": I heard " in line for line in lines if line.startswith("listener"))
    program.send(signal.SIGINT)
    code, _, err = await program.end()
    assert (code, err) == (0, "")


async def test_port_is_that_of_the_environment(hub: HubServer, start: Start) -> None:
    program = await start(*DEMO, FIBWS_PORT=str(hub.port))
    assert hub.url in await program.line()
    program.send(signal.SIGTERM)
    assert (await program.end())[0] == 0


async def test_hub_has_the_settings_of_the_environment(start: Start, tmp_path: Path) -> None:
    (tmp_path / "hub.toml").write_text("port = 0\n")
    program = await start(*DEMO, FIBWS_CONFIG=str(tmp_path / "hub.toml"), FIBWS_HOST="localhost")
    assert re.search(r"ws://localhost:[1-9]\d*", await program.line())
    program.send(signal.SIGTERM)
    assert (await program.end())[0] == 0


async def test_invalid_setting_of_the_environment_is_an_error(start: Start) -> None:
    program = await start(*DEMO, FIBWS_PORT="70000")
    code, out, err = await program.end()
    assert (code, out) == (2, "")
    assert "FIBWS_PORT must be between 0 and 65535, got 70000" in err


async def test_address_of_another_hub_is_said_to_have_no_effect(
    hub: HubServer, start: Start
) -> None:
    program = await start(*DEMO, "--port", str(hub.port), FIBWS_HUB="ws://robot:9090")
    assert "does not use FIBWS_HUB" in await program.error_line()


async def test_demo_uses_a_running_hub(hub: HubServer, start: Start) -> None:
    program = await start(*DEMO, "--port", str(hub.port))
    assert hub.url in await program.line()
    for _ in range(6):
        last = await program.line()
    assert "[INFO]" in last
    program.send(signal.SIGTERM)
    code, _, err = await program.end()
    assert (code, err) == (0, "")


@pytest.fixture
async def web_server() -> AsyncIterator[int]:
    """The port of a web server that is not a hub."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"\r\n\r\n")
        writer.write(b"HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n")
        writer.close()
        await writer.wait_closed()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    yield server.sockets[0].getsockname()[1]
    server.close()
    await server.wait_closed()


async def test_port_in_use_by_another_program_is_an_error(web_server: int, start: Start) -> None:
    program = await start(*DEMO, "--port", str(web_server))
    code, out, err = await program.end()
    assert (code, out) == (1, "")
    assert str(web_server) in err and "--port" in err
    assert err.count("\n") == 1


async def test_demo_ends_quietly_when_its_output_is_closed(start: Start) -> None:
    program = await start(*DEMO, "--port", "0")
    await program.line()
    program.stop_reading()
    code, _, err = await program.end()
    assert (code, err) == (0, "")


def test_error_of_the_hub_is_reported(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class NoHub(Hub):
        async def __aenter__(self) -> NoReturn:
            raise HubError("Cannot listen on 127.0.0.1:80: Permission denied")

    monkeypatch.setattr(demo, "Hub", NoHub)
    result = CliRunner().invoke(demo.command, ["--port", "80"])
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr == "Error: Cannot listen on 127.0.0.1:80: Permission denied\n"


async def test_demo_of_turtlesim_shows_where_the_turtle_is(start: Start) -> None:
    program = await start("fibws", "demo", "turtlesim", "--port", "0")
    await program.line()
    assert "/#/turtlesim in a browser" in await program.line()
    while "Spawning turtle [turtle1]" not in (line := await program.line()):
        assert line, "the demo has ended"
    program.send(signal.SIGINT)
    code, _, err = await program.end()
    assert (code, err) == (0, "")
