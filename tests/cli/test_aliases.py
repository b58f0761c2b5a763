"""The doors, entered as they are typed."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest
from hub_in_thread import HubThread

from fibws.command_names import ALIASES
from fibws.ros1.shell.environment import BIN_FOLDER

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such shells")
NO_HUB = "ws://127.0.0.1:1"


def enter(door: str, *words: str, hub: str = NO_HUB) -> subprocess.CompletedProcess[str]:
    """What a door says in a shell that was set up."""
    own = {"PATH": f"{BIN_FOLDER}{os.pathsep}{os.environ['PATH']}", "FIBWS_PYTHON": sys.executable}
    shell = {
        name: value for name, value in os.environ.items() if name not in ("DISPLAY", "BROWSER")
    }
    return subprocess.run(
        [door, *words],
        capture_output=True,
        text=True,
        env={**shell, **own, "FIBWS_HUB": hub},
        timeout=60,
    )


@pytest.mark.parametrize("door", ALIASES)
def test_help_calls_the_command_as_the_person_did(door: str) -> None:
    told = enter(door, "--help")
    assert (told.returncode, told.stderr) == (0, "")
    assert told.stdout.startswith(f"Usage: {door} [OPTIONS]")
    assert f"fibws {ALIASES[door]}" not in told.stdout


@pytest.mark.parametrize(
    ("door", "usage", "example"),
    [
        ("rqt_plot", "[OPTIONS] [NAME]...", "rqt_plot /fibonacci/data"),
        ("rqt_topic", "[OPTIONS] [NAME]...", "rqt_topic /fibonacci"),
        ("rqt_graph", "[OPTIONS]", "rqt_graph"),
        ("rqt_console", "[OPTIONS]", "rqt_console"),
    ],
)
def test_the_help_of_a_part_of_the_page_is_of_that_alone(
    door: str, usage: str, example: str
) -> None:
    told = enter(door, "--help").stdout
    assert told.splitlines()[0] == f"Usage: {door} {usage}"
    assert re.findall(r"^    (\S.*?)   ", told, re.MULTILINE) == [example]


def test_the_help_of_a_command_behind_it_does_so_too() -> None:
    told = enter("rostopic", "pub", "-h").stdout
    assert told.startswith("Usage: rostopic pub [OPTIONS] TOPIC TYPE [ARGS]...\n")
    assert "\n    rostopic pub -r 10 /chatter std_msgs/String" in told
    assert "fibws topic" not in told


@pytest.mark.parametrize(
    ("words", "usage", "error"),
    [
        (["rostopic", "ecko"], "rostopic", "No such command 'ecko'; did you mean echo?"),
        (["rostopic", "echo"], "rostopic echo", "Missing argument 'TOPIC[/FIELD]'."),
        (["catkin_make", "--foo"], "catkin_make", "No such option '--foo'."),
        (["catkin_create_pkg"], "catkin_create_pkg", "Missing argument 'NAME'."),
        (["rosrun"], "rosrun", "Write PACKAGE PROGRAM, or the path of a script."),
    ],
)
def test_an_error_leads_to_its_help(words: list[str], usage: str, error: str) -> None:
    told = enter(*words)
    assert told.returncode == 2
    first, hint, _, last = told.stderr.splitlines()
    assert first.startswith(f"Usage: {usage} [OPTIONS]")
    assert hint == f"Try '{usage} --help' for help."
    assert last == f"Error: {error}"


def test_what_is_no_door_is_told() -> None:
    words = [sys.executable, "-m", "fibws.cli", "rostopik", "list"]
    told = subprocess.run(words, capture_output=True, text=True)
    assert told.returncode == 2
    assert told.stderr == "Error: There is no 'rostopik' here; did you mean rostopic?\n"


def test_without_a_hub_it_names_roscore() -> None:
    told = enter("rostopic", "list")
    assert (told.returncode, told.stdout) == (1, "")
    assert told.stderr == f"Error: No hub at {NO_HUB}. Start one with: roscore\n"


def test_a_window_of_its_own_is_a_part_of_the_page(hub: HubThread) -> None:
    page = f"http://{hub.url.removeprefix('ws://')}/#"
    assert enter("rqt_console", hub=hub.url).stdout == f"{page}/console\n"
    assert enter("rqt", hub=hub.url).stdout == f"{page}/graph\n"
    assert (
        enter("rqt_plot", "/rosout/level", hub=hub.url).stdout == f"{page}/topics/%2Frosout/plot\n"
    )
