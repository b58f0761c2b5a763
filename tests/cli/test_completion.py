"""``fibws completion``, in the shells themselves where they are installed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner
from hub_in_thread import HubThread, Publish
from patience import PATIENCE

from fibws.cli.commands import command

from .terminal import Terminal

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such shells")


@pytest.fixture
def environment(tmp_path: Path, hub: HubThread) -> dict[str, str]:
    """The environment of one who has installed fibws and started a hub."""
    program = tmp_path / "fibws"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m fibws "$@"\n')
    program.chmod(0o755)
    return {
        "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(Path(__file__).parents[2]),
        "FIBWS_HUB": hub.url,
        "HOME": str(tmp_path),
        "TERM": "dumb",
    }


@pytest.fixture
def bash(environment: dict[str, str]) -> Iterator[Terminal]:
    if shutil.which("bash") is None:
        pytest.skip("bash is not installed")
    shell = Terminal("bash", "--norc", "--noprofile", "-i", PS1="> ", **environment)
    yield shell
    shell.close()


@pytest.mark.parametrize(
    ("shell", "is_in_it"),
    [("bash", "complete -o nosort"), ("zsh", "#compdef fibws"), ("fish", "complete --no-files")],
)
def test_script_of_each_shell(shell: str, is_in_it: str) -> None:
    result = CliRunner().invoke(command, ["completion", shell])
    assert result.exit_code == 0, result.output
    assert is_in_it in result.output
    assert f"_FIBWS_COMPLETE={shell}_complete" in result.output


def test_help_says_how_to_install_it() -> None:
    result = CliRunner().invoke(command, ["completion", "--help"])
    assert 'eval "$(fibws completion bash)"' in result.output


def test_unknown_shell_is_an_error() -> None:
    assert CliRunner().invoke(command, ["completion", "tcsh"]).exit_code == 2


def test_bash_completes_commands_and_topics(bash: Terminal, publish: Publish) -> None:
    publish("/fibonacci", "std_msgs/Int32", {"data": 8})
    bash.wait_for("> ")
    bash.type('eval "$(fibws completion bash)"; echo rea""dy\n')
    bash.wait_for("ready")
    bash.type("fibws compl\t")
    bash.wait_for("completion")
    bash.type_until("\x15fibws topic echo /fib\t", "/fibonacci")


TWIST = "{linear: {x: 0.0, y: 0.0, z: 0.0}, angular: {x: 0.0, y: 0.0, z: 0.0}}"


@pytest.mark.long
def test_bash_inserts_a_message_to_be_edited(bash: Terminal) -> None:
    bash.wait_for("> ")
    bash.type('eval "$(fibws completion bash)"; echo rea""dy\n')
    bash.wait_for("ready")
    bash.type_until("\x15fibws topic pub -1 /cmd_vel geometry_msgs/Twist \t", 'z: 0.0}}"')
    bash.type("\x01printf '<%s>' \n")  # Before it all: the command's words are printed.
    bash.wait_for(f"<geometry_msgs/Twist><{TWIST}>")


@pytest.mark.parametrize("option", ["nullglob", "failglob"])
def test_bash_takes_brackets_as_they_are(environment: dict[str, str], option: str) -> None:
    script = f"""
        eval "$(fibws completion bash)"
        shopt -s {option}
        COMP_WORDS=(fibws topic pub /joy sensor_msgs/Joy "")
        COMP_CWORD=5
        for _ in {{1..20}}; do  # A completion does not wait long for its hub.
            COMPREPLY=()
            _fibws_completion fibws
            [ ${{#COMPREPLY[@]}} -gt 0 ] && break
        done
        echo "${{COMPREPLY[0]}}"
        echo *none*
    """
    command = ["bash", "--norc", "-c", script]
    ran = subprocess.run(
        command, env={**os.environ, **environment}, capture_output=True, text=True, timeout=PATIENCE
    )
    first, *others = ran.stdout.splitlines()
    assert first.endswith('axes: [], buttons: []}"')
    assert "*none*" not in others  # The shell's own options are as before.


@pytest.mark.skipif(shutil.which("zsh") is None, reason="zsh is not installed")
@pytest.mark.long
def test_zsh_inserts_a_message_to_be_edited(environment: dict[str, str]) -> None:
    shell = Terminal("zsh", "-f", "-i", PS1="> ", **environment)
    try:
        shell.wait_for("> ")
        shell.type('autoload -U compinit && compinit -u -D; eval "$(fibws completion zsh)"\n')
        shell.type('echo rea""dy\n')
        shell.wait_for("ready")
        shell.type_until("\x15fibws topic pub -1 /cmd_vel geometry_msgs/Twist \t", "z: 0.0}}")
    finally:
        shell.close()


@pytest.mark.parametrize(
    ("shell", "changed"),
    [("zsh", "compadd -Q -U"), ("fish", 'string split -m 1 ","')],
)
def test_script_can_insert_a_message(shell: str, changed: str) -> None:
    assert changed in CliRunner().invoke(command, ["completion", shell]).output


@pytest.mark.skipif(shutil.which("zsh") is None, reason="zsh is not installed")
def test_zsh_shows_types_beside_the_names(environment: dict[str, str], publish: Publish) -> None:
    publish("/fibonacci", "std_msgs/Int32", {"data": 8})
    asked = {
        "_FIBWS_COMPLETE": "zsh_complete",
        "COMP_WORDS": "fibws topic echo /fib",
        "COMP_CWORD": "3",
    }
    for _ in range(20):  # A completion soon gives its hub up.
        told = subprocess.run(
            ["fibws"],
            env={**os.environ, **environment, **asked},
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=True,
        )
        if told.stdout:
            break
    assert told.stdout == "plain\n/fibonacci\nstd_msgs/Int32\n"
