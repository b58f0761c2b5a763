"""ROS's names for commands of fibws, as programs on the PATH."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from hub_in_thread import HubThread

from fibws.command_names import ALIASES, SETUP
from fibws.ros1.shell.environment import BIN_FOLDER

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such shells")
NO_HUB = "ws://127.0.0.1:1"


def enter(alias: str, *words: str, hub: str = NO_HUB) -> subprocess.CompletedProcess[str]:
    """Run an alias in a shell with ``fibws setup``."""
    own = {"PATH": f"{BIN_FOLDER}{os.pathsep}{os.environ['PATH']}", "FIBWS_PYTHON": sys.executable}
    own[SETUP] = "{}"
    shell = {
        name: value for name, value in os.environ.items() if name not in ("DISPLAY", "BROWSER")
    }
    return subprocess.run(
        [alias, *words],
        capture_output=True,
        text=True,
        env={**shell, **own, "FIBWS_HUB": hub},
        timeout=60,
    )


@contextmanager
def started(alias: str, *words: str, hub: str) -> Iterator[subprocess.Popen[str]]:
    """Run an alias until the end of the block."""
    line = [sys.executable, "-P", "-m", "fibws.cli", alias, *words]
    environment = {**os.environ, "FIBWS_HUB": hub}
    with subprocess.Popen(line, stdout=subprocess.PIPE, text=True, env=environment) as process:
        try:
            yield process
        finally:
            process.terminate()


HELPS = """
import json
from click.testing import CliRunner
from fibws.cli.aliases import aliases
from fibws.command_names import ALIASES
runner = CliRunner()
helps = {each: runner.invoke(aliases, [each, "--help"], prog_name="").stdout for each in ALIASES}
print(json.dumps(helps))
"""


def test_help_uses_the_name_of_the_alias() -> None:
    # Help texts are built when modules are imported, so that this needs a process.
    words = [sys.executable, "-c", HELPS]
    done = subprocess.run(words, capture_output=True, text=True, env={**os.environ, SETUP: "{}"})
    for alias, text in json.loads(done.stdout).items():
        assert text.startswith(f"Usage: {alias} [OPTIONS]")
        assert f"fibws {ALIASES[alias]}" not in text


@pytest.mark.parametrize(
    ("alias", "usage", "example"),
    [
        ("rqt_plot", "[OPTIONS] [NAME]...", "rqt_plot /fibonacci/data"),
        ("rqt_console", "[OPTIONS]", "rqt_console"),
    ],
)
def test_help_for_a_part_of_the_page_has_only_its_example(
    alias: str, usage: str, example: str
) -> None:
    text = enter(alias, "--help").stdout
    assert text.splitlines()[0] == f"Usage: {alias} {usage}"
    assert re.findall(r"^    (\S.*?)   ", text, re.MULTILINE) == [example]


def test_help_for_a_subcommand_uses_the_name_of_the_alias() -> None:
    text = enter("rostopic", "pub", "-h").stdout
    assert text.startswith("Usage: rostopic pub [OPTIONS] TOPIC TYPE [ARGS]...\n")
    assert "\n    rostopic pub -r 10 /chatter std_msgs/String" in text
    assert "fibws topic" not in text


@pytest.mark.parametrize(
    ("words", "usage", "fact"),
    [
        (["rostopic", "ecko"], "rostopic", "did you mean echo?"),
        (["rostopic", "echo"], "rostopic echo", "TOPIC[/FIELD]"),
        (["catkin_make", "--foo"], "catkin_make", "--foo"),
        (["catkin_create_pkg"], "catkin_create_pkg", "NAME"),
    ],
)
def test_usage_error_names_the_alias_and_its_help(words: list[str], usage: str, fact: str) -> None:
    done = enter(*words)
    assert done.returncode == 2
    first, help_, _, error = done.stderr.splitlines()
    assert first.startswith(f"Usage: {usage} [OPTIONS]")
    assert help_ == f"Try '{usage} --help' for help."
    assert fact in error


def test_unknown_alias_is_an_error_with_a_suggestion() -> None:
    words = [sys.executable, "-m", "fibws.cli", "rostopik", "list"]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 2
    assert "did you mean rostopic?" in done.stderr


def test_error_without_a_hub_names_roscore() -> None:
    done = enter("rostopic", "list")
    assert (done.returncode, done.stdout) == (1, "")
    assert NO_HUB in done.stderr
    assert done.stderr.endswith(" roscore --port 1\n")


def test_rostopic_accepts_the_arguments_of_a_node(hub: HubThread) -> None:
    words = ["pub", "-r", "100", "count", "std_msgs/Int32", "5", "__name:=counter"]
    words += ["__ns:=/robot", "count:=number"]
    with started("rostopic", *words, hub=hub.url):
        heard = enter("rostopic", "echo", "-n1", "/here", "/here:=/robot/number", hub=hub.url)
        assert heard.stdout.startswith("data: 5\n"), heard.stderr
        info = enter("rostopic", "info", "/robot/number", hub=hub.url)
        assert " * /robot/counter " in info.stdout


def test_rosparam_and_rosservice_accept_the_arguments_of_a_node(hub: HubThread) -> None:
    assert enter("rosparam", "set", "/robot/a", "5", "__name:=setter", hub=hub.url).returncode == 0
    assert enter("rosparam", "get", "a", "__ns:=/robot", hub=hub.url).stdout == "5\n"
    listed = enter("rosservice", "type", "/s", "/s:=/rosapi/topics", hub=hub.url)
    assert listed.stdout == "rosapi/Topics\n"


def test_invalid_remapping_is_a_usage_error() -> None:
    done = enter("rostopic", "list", "__name:=a/b")
    assert done.returncode == 2
    assert "a/b" in done.stderr


def test_rqt_aliases_open_parts_of_the_page(hub: HubThread) -> None:
    page = f"http://{hub.url.removeprefix('ws://')}/#"
    assert enter("rqt_console", hub=hub.url).stdout == f"{page}/console\n"
    assert enter("rqt", hub=hub.url).stdout == f"{page}/graph\n"
    assert (
        enter("rqt_plot", "/rosout/level", hub=hub.url).stdout == f"{page}/topics/%2Frosout/plot\n"
    )
