"""``fibws setup``, run by the shells of this machine."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from hub_in_thread import HubThread, Publish

from fibws.cli import output
from fibws.cli.commands import command
from fibws.command_names import SETUP
from fibws.ros1.shell.environment import BIN_FOLDER

from .terminal import Terminal

ROOT = Path(__file__).parents[2]
SHELLS = [
    pytest.param(
        name, marks=pytest.mark.skipif(shutil.which(name) is None, reason=f"{name} is not here")
    )
    for name in ("bash", "zsh")
]


@pytest.fixture(autouse=True)
def no_ros(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """An environment without ROS and without setup."""
    monkeypatch.setenv("PATH", str(tmp_path))
    for name in [name for name in os.environ if name.startswith(("ROS_", "FIBWS_"))]:
        monkeypatch.delenv(name)


def setup(*words: str) -> Result:
    return CliRunner().invoke(command, ["setup", *words], prog_name="fibws")


def test_setup_prints_a_script_and_a_summary() -> None:
    result = setup()
    assert result.exit_code == 0, result.output
    assert f"export PATH={BIN_FOLDER}" in result.stdout
    assert "rosrun" in result.stderr
    assert "source <(fibws setup --undo)" in result.stderr


def test_quiet_setup_prints_only_the_script() -> None:
    for words in (["--quiet"], ["bash", "-q"], ["--undo", "--quiet"]):
        result = setup(*words)
        assert (result.exit_code, result.stderr) == (0, "")
        assert result.stdout


def test_at_a_terminal_it_explains_its_use(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output, "is_terminal", lambda: True)
    for words in ([], ["--undo"]):
        result = setup(*words)
        assert result.exit_code == 0
        assert "source <(fibws setup)" in result.stdout
        assert 'eval "$(fibws setup)"' in result.stdout
        assert "export" not in result.stdout


@pytest.mark.parametrize("shell", ["fish", "tcsh", "powershell"])
def test_unsupported_shell_is_an_error_with_alternatives(shell: str) -> None:
    result = setup(shell)
    assert (result.exit_code, result.stdout) == (1, "false\n")
    assert shell in result.stderr
    assert "fibws run" in result.stderr


@pytest.fixture
def roscore(tmp_path: Path) -> Path:
    """The roscore of an installed ROS."""
    program = tmp_path / ("roscore.bat" if os.name == "nt" else "roscore")
    program.touch(mode=0o755)
    return program


def test_installed_ros_is_not_hidden_by_default(roscore: Path) -> None:
    result = setup()
    assert (result.exit_code, result.stdout) == (1, "false\n")
    assert str(roscore) in result.stderr
    assert "--shadow-ros" in result.stderr


def test_installed_ros_is_hidden_with_shadow_ros(
    roscore: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = setup("--shadow-ros")
    assert result.exit_code == 0
    assert f"export PATH={BIN_FOLDER}{os.pathsep}{roscore.parent}\n" in result.stdout
    # The setup file of a workspace, sourced later, does not need the option.
    monkeypatch.setenv(SETUP, "{}")
    assert setup("--quiet").exit_code == 0


def test_shadow_ros_lists_the_commands_that_remain(roscore: Path) -> None:
    (roscore.parent / "rosclean").touch(mode=0o755)
    assert setup("--shadow-ros").stderr.endswith(": rosclean\n")
    assert setup("--shadow-ros", "--quiet").stderr == ""


def test_quiet_setup_with_an_installed_ros_prints_one_line(roscore: Path) -> None:
    result = setup("--quiet")
    assert (result.exit_code, result.stdout) == (1, "false\n")
    [line] = result.stderr.splitlines()
    assert str(roscore) in line
    assert "--shadow-ros" in line


def test_undo_removes_workspaces(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    devel = tmp_path / "devel"
    devel.mkdir()
    (devel / ".fibws").touch()
    monkeypatch.setenv("CMAKE_PREFIX_PATH", os.pathsep.join([str(devel), "/opt/other"]))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src"))
    monkeypatch.setenv("FIBWS_INTERFACES", os.pathsep.join(["/own", str(devel / "share")]))
    lines = setup("--undo").stdout.splitlines()
    assert "export CMAKE_PREFIX_PATH=/opt/other" in lines
    assert "unset ROS_PACKAGE_PATH" in lines
    assert "export FIBWS_INTERFACES=/own" in lines


@pytest.fixture
def environment(tmp_path: Path, hub: HubThread) -> dict[str, str]:
    """An environment with fibws and a hub, without ROS."""
    tools = tmp_path / "tools"
    tools.mkdir()
    program = tools / "fibws"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m fibws "$@"\n')
    program.chmod(0o755)
    for tool in ("sh", "env", "bash", "zsh", "ls", "dirname", "sleep"):
        if where := shutil.which(tool, path=os.defpath):
            (tools / tool).symlink_to(where)
    return {
        "PATH": str(tools),
        "PYTHONPATH": str(ROOT),
        "FIBWS_HUB": hub.url,
        "HOME": str(tmp_path),
        "TERM": "dumb",
        "PS1": "ready> ",
    }


@pytest.fixture
def terminal(request: pytest.FixtureRequest, environment: dict[str, str]) -> Iterator[Terminal]:
    options = {"bash": ["--norc", "--noprofile", "-i"], "zsh": ["-f", "-i"]}[request.param]
    where = shutil.which(request.param, path=os.defpath)
    assert where is not None
    shell = Terminal(where, *options, **environment)
    yield shell
    shell.close()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such shells")
@pytest.mark.parametrize("shell", SHELLS)
@pytest.mark.long
def test_shell_has_commands_of_ros_until_undo(shell: str, environment: dict[str, str]) -> None:
    text = """
source <(fibws setup) && echo "done: $?"
command -v rostopic; echo $ROS_DISTRO
source <(fibws setup --undo)
command -v rostopic || echo gone
echo "$PATH ${PYTHONPATH-none} ${ROS_DISTRO-none} ${FIBWS_PYTHON-none}"
"""
    done = subprocess.run(
        [shutil.which(shell, path=os.defpath) or shell, "-c", text],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.stdout.splitlines() == [
        "done: 0",
        str(BIN_FOLDER / "rostopic"),
        "noetic",
        "gone",
        f"{environment['PATH']} {ROOT} none none",
    ]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such shells")
@pytest.mark.parametrize("terminal", SHELLS, indirect=True)
def test_commands_complete_by_tab(terminal: Terminal, publish: Publish) -> None:
    publish("/fibonacci", "std_msgs/Int32", {"data": 8})
    terminal.wait_for("ready> ")
    if "zsh" in terminal.process.args[0]:  # type: ignore[index, operator]
        terminal.type("autoload -U compinit; compinit -D\n")
        terminal.wait_for("ready> ")
    terminal.type("source <(fibws setup)\n")
    terminal.wait_for("--undo)")
    terminal.wait_for("ready> ")
    terminal.type_until("\x15rostopic echo -n 1 /fib\t", "onacci")
    terminal.type("\n")
    terminal.wait_for("data: 8")
    terminal.wait_for("ready> ")
    terminal.type("fibws compl\t")
    terminal.wait_for("etion")
