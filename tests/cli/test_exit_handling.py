"""Exit codes and errors of commands: Ctrl-C, closed pipes, errors of fibws."""

from __future__ import annotations

import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from fibws.cli.commands import command
from fibws.cli.exit_handling import INTERRUPTED, clean_exit
from fibws.cli.lazy import Command
from fibws.errors import ServiceError


def run_module(text: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Result:
    """Run a command of ``fibws`` whose module has this text."""
    (folder / "module_of_a_command.py").write_text(text)
    monkeypatch.syspath_prepend(folder)
    monkeypatch.delitem(sys.modules, "module_of_a_command", raising=False)
    monkeypatch.setitem(command.modules, "it", Command("module_of_a_command", "Run it."))
    return CliRunner().invoke(command, ["it"])


@pytest.mark.parametrize(
    "text",
    [
        "raise KeyboardInterrupt",
        "import click\n@click.command()\ndef command():\n    raise KeyboardInterrupt",
        "import click\n@click.command()\ndef command():\n    raise click.Abort",
    ],
    ids=["while it is imported", "while it runs", "at a prompt"],
)
def test_ctrl_c_prints_nothing_and_exits_with_130(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = run_module(text, tmp_path, monkeypatch)
    assert (result.exit_code, result.output) == (INTERRUPTED, "")
    assert INTERRUPTED == 130


def test_ctrl_c_ends_an_endless_command_without_failure() -> None:
    with pytest.raises(SystemExit) as caught, clean_exit(endless=True):
        raise KeyboardInterrupt
    assert caught.value.code == 0


def test_control_characters_in_errors_are_escaped() -> None:
    with pytest.raises(click.ClickException) as caught, clean_exit():
        raise ServiceError("/service", "\x1b[2Jgone")
    assert caught.value.message == r"/service: \x1b[2Jgone"


def fail_to_write() -> None:
    raise BrokenPipeError


def test_closed_pipe_ends_a_command_quietly(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "out"
    with path.open("w") as stream:
        monkeypatch.setattr(sys, "stdout", stream)
        with clean_exit():
            fail_to_write()
        print("lost")
    assert path.read_text() == "", "Python's flush at exit must not fail"


def test_full_disk_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with (tmp_path / "out").open("w") as stream:
        monkeypatch.setattr(sys, "stdout", stream)
        with pytest.raises(click.ClickException) as caught, clean_exit():
            raise OSError(28, "No space left on device")
    assert caught.value.message == "No space left on device"


def test_error_names_the_file(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    with pytest.raises(click.ClickException) as caught, clean_exit():
        raise PermissionError(13, "Permission denied", "robot.yaml")
    assert caught.value.message == "robot.yaml: Permission denied"
