"""``fibws log``: what nodes log, at a real hub."""

from __future__ import annotations

import json
import signal
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

import pytest
from hub_in_thread import HubThread, Run
from running_programs import Start

from fibws.cli.log import log_line
from fibws.client.hub_client import HubClient

DEBUG, INFO, WARN, ERROR, FATAL = 1, 2, 4, 8, 16
PATIENCE = 60
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
    """Log these as soon as a tool listens."""
    deadline = time.monotonic() + PATIENCE
    while not client.call("/rosapi/subscribers", {"topic": "/rosout_agg"})["subscribers"]:
        assert time.monotonic() < deadline, "nobody listens"
    for each in messages:
        client.send({"op": "publish", "topic": "/rosout", "msg": each})


@pytest.fixture
def logged(client: HubClient) -> Iterator[Logged]:
    """Has messages be logged while the tool runs."""
    client.send({"op": "advertise", "topic": "/rosout", "type": "rosgraph_msgs/Log"})
    threads = []

    def logged(*messages: dict[str, Any]) -> None:
        threads.append(threading.Thread(target=publish, args=(client, messages)))
        threads[-1].start()

    yield logged
    for thread in threads:
        thread.join(PATIENCE)


def test_a_line_is_as_rosconsole_prints_it() -> None:
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


def test_further_lines_cannot_be_taken_for_messages() -> None:
    assert log_line(message("Traceback:\n[FATAL] forged")) == (
        "[INFO] [1700000000.001234] [/talker]: Traceback:\n    [FATAL] forged"
    )


def test_no_text_and_no_name_does_anything_to_a_terminal() -> None:
    line = log_line(message("\x1b[2J\r\x9bm\tx", name="/a\n\x1b[0m"))
    assert line == ("[INFO] [1700000000.001234] [/a\\n\\x1b[0m]: \\x1b[2J\\r\\x9bm\tx")


def test_it_shows_what_is_logged(run: Run, logged: Logged) -> None:
    logged(message("one"), message("two", WARN, "/other"))
    result = run("log", "-n", "2")
    assert result.exit_code == 0, result.output
    assert result.output == (
        "[INFO] [1700000000.001234] [/talker]: one\n[WARN] [1700000000.001234] [/other]: two\n"
    )


def test_a_level_is_the_least(run: Run, logged: Logged) -> None:
    logged(message("a", INFO), message("b", ERROR), message("c", WARN))
    result = run("log", "-l", "WARN", "-n", "2")
    assert [line[-1] for line in result.output.splitlines()] == ["b", "c"]


def test_nodes_are_chosen_by_name_and_by_namespace(run: Run, logged: Logged) -> None:
    names = ["/talker", "/talker_2", "/robot/arm", "/listener"]
    logged(*(message("x", name=name) for name in names))
    result = run("log", "--node", "listener", "--node", "/robot/", "-n", "2")
    assert "[/robot/arm]" in result.output.splitlines()[0]
    assert "[/listener]" in result.output.splitlines()[1]


def test_texts_are_chosen_by_what_is_in_them(run: Run, logged: Logged) -> None:
    logged(message("no"), message("a [needle]"))
    assert run("log", "--grep", "[needle]", "-n", "1").output.endswith(": a [needle]\n")


def test_json_is_the_message_as_it_is(run: Run, logged: Logged) -> None:
    logged(message("two\nlines"))
    result = run("log", "--json", "-n", "1")
    assert result.output.count("\n") == 1
    assert json.loads(result.output) == message("two\nlines")


def test_what_is_no_level_is_wrong_usage(run: Run) -> None:
    assert run("log", "-l", "loud").exit_code == 2


async def test_ctrl_c_is_its_end(hub: HubThread, start: Start, logged: Logged) -> None:
    logged(message("one"))
    program = await start("fibws", "log", FIBWS_HUB=hub.url)
    assert await program.line() == "[INFO] [1700000000.001234] [/talker]: one\n"
    program.send(signal.SIGINT)
    assert await program.end() == (0, "", "")


async def test_a_hub_that_goes_is_an_error(hub: HubThread, start: Start, logged: Logged) -> None:
    logged(message("one"))
    program = await start("fibws", "log", FIBWS_HUB=hub.url)
    await program.line()
    hub.stop()
    code, out, err = await program.end()
    assert (code, out) == (1, "")
    assert err.startswith(f"Error: The hub at {hub.url} is gone")
