"""``fibws top`` at a real hub, in a pipe and on a terminal."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Callable, Iterator
from typing import TypeAlias

import pytest
from hub_in_thread import HubThread, Publish, Run
from running_programs import Start

from .terminal import Terminal

Take: TypeAlias = Callable[..., Terminal]


@pytest.fixture
def terminal(hub: HubThread, publish: Publish) -> Iterator[Take]:
    """Run ``fibws top`` on a terminal, at a hub with the topic /chatter."""
    publish("/chatter", "std_msgs/String", {"data": "hello"})
    taken: list[Terminal] = []

    def terminal(*words: str, **environment: str) -> Terminal:
        command = (sys.executable, "-W", "error", "-m", "fibws", "top", *words)
        taken.append(Terminal(*command, FIBWS_HUB=hub.url, **environment))
        return taken[-1]

    yield terminal
    for each in taken:
        each.close()


on_terminals = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pty")
RESTORED = "\x1b[?1049l"
"""The sequence that restores the screen."""


def test_measurements_are_plain_text_in_a_pipe(run: Run, publish: Publish) -> None:
    client = publish("/chatter", "std_msgs/String", {"data": "hello"})
    result = run("top", "-n", "1", "-d", "0.1")
    assert result.exit_code == 0, result.output
    topics, clients = result.output.split("\n\n")[:2]
    assert "/chatter" in topics
    assert [line.split()[0] for line in clients.splitlines()] == ["NODE", client.node]


def test_json_is_an_object_for_each_measurement(run: Run, publish: Publish) -> None:
    publish("/chatter", "std_msgs/String", {"data": "hello"})
    result = run("top", "--json", "-n", "2", "-d", "0.1", "-s", "name")
    first, second = map(json.loads, result.output.splitlines())
    assert second["stamp"] > first["stamp"]
    assert [each["topic"] for each in first["topics"]][:2] == ["/chatter", "/client_count"]


@pytest.mark.parametrize("words", [("-d", "0"), ("-n", "0"), ("-s", "size")])
def test_invalid_options_are_wrong_usage(run: Run, words: tuple[str, str]) -> None:
    assert run("top", *words).exit_code == 2


async def test_ctrl_c_ends_it_in_a_pipe(hub: HubThread, start: Start) -> None:
    program = await start("fibws", "top", "-d", "0.1", FIBWS_HUB=hub.url)
    assert (await program.line()).startswith("TOPIC ")
    program.send(signal.SIGINT)
    code, _, err = await program.end()
    assert (code, err) == (0, "")


@on_terminals
def test_q_restores_the_terminal(terminal: Take) -> None:
    top = terminal(TERM="xterm")
    before = top.modes()
    top.wait_for("\x1b[?1049h")
    top.wait_for("/chatter")
    top.type("q")
    top.wait_for(RESTORED)
    assert top.ended() == 0
    assert top.modes() == before


@on_terminals
def test_rates_are_shown_from_the_second_measurement(terminal: Take) -> None:
    top = terminal("-d", "0.1", TERM="xterm")
    top.wait_for("/chatter")
    assert "Hz" not in top.output.partition("/chatter")[2].partition("\n")[0]
    top.wait_for("0.00Hz")
    top.type("q")
    assert top.ended() == 0


@on_terminals
def test_lost_hub_restores_the_terminal(hub: HubThread, terminal: Take) -> None:
    top = terminal("-d", "0.1", TERM="xterm")
    top.wait_for("/chatter")
    hub.stop()
    top.wait_for(RESTORED)
    top.wait_for(hub.url)
    assert top.ended() == 1


@on_terminals
def test_key_sorts(terminal: Take) -> None:
    top = terminal(TERM="xterm")
    top.wait_for("by rate  q: quit, r: rate, b: bw, n: name")
    top.type("n")
    top.wait_for("by name")
    top.type("b")
    top.wait_for("by bw")
    top.type("q")
    assert top.ended() == 0


@on_terminals
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_signals_restore_the_terminal(terminal: Take, end: signal.Signals) -> None:
    top = terminal(TERM="xterm")
    before = top.modes()
    top.wait_for("/chatter")
    top.process.send_signal(end)
    top.wait_for(RESTORED)
    assert top.ended() == 0
    assert top.modes() == before


@on_terminals
def test_dumb_terminal_gets_plain_text(terminal: Take) -> None:
    top = terminal("-d", "0.1", TERM="dumb")
    top.wait_for("/chatter")
    top.wait_for("/chatter")
    top.process.send_signal(signal.SIGINT)
    assert top.ended() == 0


@on_terminals
@pytest.mark.long
def test_colours_can_be_disabled(terminal: Take) -> None:
    top = terminal(TERM="xterm", NO_COLOR="1")
    top.wait_for("/chatter")
    assert "\x1b[3" not in top.output
    top.type("q")
    assert top.ended() == 0
