"""``fibws log`` at a real hub."""

from __future__ import annotations

import json
import signal
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

import pytest
from hub_in_thread import HubThread, Run
from patience import PATIENCE
from running_programs import Start

from fibws.cli.log import log_line
from fibws.client.hub_client import HubClient

DEBUG, INFO, WARN, ERROR, FATAL = 1, 2, 4, 8, 16
Logged: TypeAlias = Callable[..., None]


def message(msg: str, level: int = INFO, name: str = "/talker") -> dict[str, Any]:
    return {
        "header": {"seq": 1, "stamp": {"secs": 1700000000, "nsecs": 1234567}, "frame_id": ""},
        "level": level,
        "name": name,
        "msg": msg,
        "file": "talker.py",
        "function": "main",
        "line": 1,
        "topics": [],
    }


def publish(client: HubClient, messages: tuple[dict[str, Any], ...]) -> None:
    """Log messages as soon as a tool subscribes."""
    deadline = time.monotonic() + PATIENCE
    while not client.call("/rosapi/subscribers", {"topic": "/rosout_agg"})["subscribers"]:
        assert time.monotonic() < deadline, "no subscriber"
    for each in messages:
        client.send({"op": "publish", "topic": "/rosout", "msg": each})


@pytest.fixture
def logged(client: HubClient) -> Iterator[Logged]:
    """Return a function that logs messages while the tool runs."""
    client.send({"op": "advertise", "topic": "/rosout", "type": "rosgraph_msgs/Log"})
    threads = []

    def logged(*messages: dict[str, Any]) -> None:
        threads.append(threading.Thread(target=publish, args=(client, messages)))
        threads[-1].start()

    yield logged
    for thread in threads:
        thread.join(PATIENCE)


def test_line_has_the_format_of_rosconsole() -> None:
    assert log_line(message("I heard 8")) == "[INFO] [1700000000.001234] [/talker]: I heard 8"


@pytest.mark.parametrize(
    ("level", "name"),
    [
        (DEBUG, "DEBUG"),
        (WARN, "WARN"),
        (ERROR, "ERROR"),
        (FATAL, "FATAL"),
        (3, "INFO"),
        (0, "DEBUG"),
    ],
)
def test_levels_have_names(level: int, name: str) -> None:
    assert log_line(message("x", level)).startswith(f"[{name}] ")


def test_further_lines_are_indented() -> None:
    assert log_line(message("Traceback:\n[FATAL] forged")) == (
        "[INFO] [1700000000.001234] [/talker]: Traceback:\n    [FATAL] forged"
    )


def test_control_characters_are_escaped() -> None:
    line = log_line(message("\x1b[2J\r\x9bm\tx", name="/a\n\x1b[0m"))
    assert line == ("[INFO] [1700000000.001234] [/a\\n\\x1b[0m]: \\x1b[2J\\r\\x9bm\tx")


def test_log_messages_are_printed(run: Run, logged: Logged) -> None:
    logged(message("one"), message("two", WARN, "/other"))
    result = run("log", "-n", "2")
    assert result.exit_code == 0, result.output
    assert result.output == (
        "[INFO] [1700000000.001234] [/talker]: one\n[WARN] [1700000000.001234] [/other]: two\n"
    )


def test_lower_levels_are_omitted(run: Run, logged: Logged) -> None:
    logged(message("a", INFO), message("b", ERROR), message("c", WARN))
    result = run("log", "-l", "WARN", "-n", "2")
    assert [line[-1] for line in result.output.splitlines()] == ["b", "c"]


def test_messages_of_nodes_and_namespaces(run: Run, logged: Logged) -> None:
    names = ["/talker", "/talker_2", "/robot/arm", "/listener"]
    logged(*(message("x", name=name) for name in names))
    result = run("log", "--node", "listener", "--node", "/robot/", "-n", "2")
    assert "[/robot/arm]" in result.output.splitlines()[0]
    assert "[/listener]" in result.output.splitlines()[1]


def test_messages_containing_a_text(run: Run, logged: Logged) -> None:
    logged(message("no"), message("a [needle]"))
    assert run("log", "--grep", "[needle]", "-n", "1").output.endswith(": a [needle]\n")


def test_json_is_the_whole_message(run: Run, logged: Logged) -> None:
    logged(message("two\nlines"))
    result = run("log", "--json", "-n", "1")
    assert result.output.count("\n") == 1
    assert json.loads(result.output) == message("two\nlines")


def test_unknown_level_is_an_error(run: Run) -> None:
    assert run("log", "-l", "loud").exit_code == 2


async def test_ctrl_c_ends_it_without_failure(hub: HubThread, start: Start, logged: Logged) -> None:
    logged(message("one"))
    program = await start("fibws", "log", FIBWS_HUB=hub.url)
    assert await program.line() == "[INFO] [1700000000.001234] [/talker]: one\n"
    program.send(signal.SIGINT)
    assert await program.end() == (0, "", "")


async def test_lost_hub_is_an_error(hub: HubThread, start: Start, logged: Logged) -> None:
    logged(message("one"))
    program = await start("fibws", "log", FIBWS_HUB=hub.url)
    await program.line()
    hub.stop()
    code, out, err = await program.end()
    assert (code, out) == (1, "")
    assert err.startswith("Error: ") and hub.url in err
