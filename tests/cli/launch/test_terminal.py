"""``fibws launch`` in a terminal, which its nodes share."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

import pytest
from hub_in_thread import HubThread

from ..terminal import Terminal
from .conftest import write

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such terminals")

# As turtlebot3_teleop_key and teleop_twist_keyboard read keys.
TELEOP = """
import select, sys, termios, tty

def read_key(message):
    tty.setraw(sys.stdin.fileno())  # It discards keys that were pressed before.
    print(message, end="")
    ready, _, _ = select.select([sys.stdin], [], [], 0.1)
    key = sys.stdin.read(1) if ready else ""
    termios.tcsetattr(sys.stdin, termios.TCSADRAIN, settings)
    return key

settings = termios.tcgetattr(sys.stdin)
print("Control Your Robot!")
key = read_key("Press a key\\r\\n")
while key != "\\x03":
    key = read_key(key and f"speed {key}\\r\\n")
print("stopped")
"""
CURSES = """
import curses

def show(screen):
    curses.start_color()
    screen.addstr(5, 5, "size %d %d" % screen.getmaxyx())
    screen.refresh()
    while True:
        screen.addstr(6, 5, "pressed " + chr(screen.getch()))
        screen.refresh()

try:
    curses.wrapper(show)
except KeyboardInterrupt:
    print("left")
"""
CRASHING = """
import os, signal, sys, tty
tty.setraw(0)
os.kill(os.getpid(), signal.SIGKILL)
"""
STREAMS = """
import os, sys
print("terminals", *map(os.isatty, range(3)))
print("an error", file=sys.stderr)
"""

Begin: TypeAlias = Callable[..., Terminal]


@pytest.fixture
def begin(robot: Path, hub: HubThread) -> Iterator[Begin]:
    """Start ``fibws launch`` with one node, a Python script, in a terminal.

    With ``shell``, bash runs this text, in which {} is the command.
    """
    terminals = []

    def begin(script: str, attributes: str, *options: str, shell: str = "") -> Terminal:
        program = robot / "scripts" / "program"
        program.write_text(f"#!{sys.executable}\n{script}")
        program.chmod(0o755)
        file = write(robot, f'<node pkg="robot" type="program" name="n" {attributes}/>')
        words = (sys.executable, "-m", "fibws", "launch", file, "--hub", hub.url, *options)
        if shell:
            words = ("bash", "-c", shell.format(shlex.join(words)))
        environment = {name: os.environ[name] for name in ("ROS_PACKAGE_PATH", "ROS_HOME")}
        terminals.append(Terminal(*words, TERM="xterm", NO_COLOR="", **environment))
        return terminals[-1]

    yield begin
    for terminal in terminals:
        terminal.close()


def test_keys_go_to_a_node_that_reads_them(begin: Begin) -> None:
    terminal = begin(TELEOP, 'output="screen"')
    before = terminal.modes()
    terminal.wait_for("\nControl Your Robot!\r\n")
    terminal.wait_for("Press a key")
    for key in "wx":
        terminal.type_until(key, f"speed {key}\r\n")
    # The node reads it, except in the moment in which its terminal is not raw: then it is a signal.
    terminal.type("\x03")
    assert terminal.ended() == 0
    assert terminal.modes() == before


def test_node_may_use_the_whole_screen(begin: Begin) -> None:
    terminal = begin(CURSES, 'output="screen"')
    before = terminal.modes()
    terminal.wait_for("size 24 80")
    assert terminal.modes() != before
    terminal.type("k")
    terminal.wait_for("k")
    terminal.type("\x03")
    terminal.wait_for("[n-1] killing on exit")
    terminal.wait_for("left")
    terminal.wait_for("done")
    assert terminal.ended() == 0
    assert terminal.modes() == before


@pytest.mark.long
def test_terminal_is_restored_after_a_node_that_crashed(begin: Begin) -> None:
    terminal = begin(CRASHING, 'output="screen"')
    terminal.wait_for("process has died")
    before = terminal.modes()
    assert terminal.ended() == 1
    assert terminal.modes() == before
    assert "\r\n\x1b[31m[n-1] process has died" in terminal.output


@pytest.mark.long
def test_background_job_is_not_stopped_by_the_terminal(begin: Begin) -> None:
    # A change of the terminal's settings would stop it, and `wait` would return 128 + SIGTTOU.
    terminal = begin(CRASHING, 'output="screen"', shell="set -m; {} & wait $!; echo ended: $?.")
    terminal.wait_for("ended: 1.")
    assert terminal.ended() == 0


def test_node_on_the_screen_writes_to_the_terminal_directly(begin: Begin) -> None:
    terminal = begin(STREAMS, 'output="screen"')
    terminal.wait_for("\nterminals True True True\r\n")
    assert terminal.ended() == 0
    assert "\nan error\r\n" in terminal.output


@pytest.mark.parametrize(("attributes", "options"), [("", ()), ('output="screen"', ("--log",))])
def test_other_nodes_only_read_from_the_terminal(
    attributes: str, options: tuple[str, ...], begin: Begin, tmp_path: Path
) -> None:
    terminal = begin(STREAMS, attributes, *options)
    terminal.wait_for("\x1b[36m[n-1]\x1b[0m an error")
    assert terminal.ended() == 0
    assert "terminals" not in terminal.output
    [log] = (tmp_path / "home" / "log").glob("*/n-1.log")
    assert "terminals True False False" in log.read_text()
