"""How commands end: Ctrl-C, readers who leave, errors; each is a line at most."""

from __future__ import annotations

import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from fibws.cli.commands import command
from fibws.cli.exit_handling import INTERRUPTED, ending
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
    ids=["while it is imported", "while it runs", "at a question"],
)
def test_ctrl_c_is_quiet_with_the_code_of_shells(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = run_module(text, tmp_path, monkeypatch)
    assert (result.exit_code, result.output) == (INTERRUPTED, "")
    assert INTERRUPTED == 130


def test_ctrl_c_is_how_what_is_endless_ends() -> None:
    with pytest.raises(SystemExit) as caught, ending(endless=True):
        raise KeyboardInterrupt
    assert caught.value.code == 0


def test_an_error_in_somebody_elses_words_does_nothing_to_a_terminal() -> None:
    with pytest.raises(click.ClickException) as caught, ending():
        raise ServiceError("/service", "\x1b[2Jgone")
    assert caught.value.message == r"/service: \x1b[2Jgone"


def leave() -> None:
    raise BrokenPipeError


def test_a_reader_who_leaves_ends_a_tool_quietly(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "out"
    with path.open("w") as stream:
        monkeypatch.setattr(sys, "stdout", stream)
        with ending():
            leave()
        print("lost")
    assert path.read_text() == "", "what Python flushes at its end goes nowhere"


def test_what_is_printed_to_a_full_disk_is_an_error_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with (tmp_path / "out").open("w") as stream:
        monkeypatch.setattr(sys, "stdout", stream)
        with pytest.raises(click.ClickException) as caught, ending():
            raise OSError(28, "No space left on device")
    assert caught.value.message == "No space left on device"


def test_a_file_that_cannot_be_read_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    with pytest.raises(click.ClickException) as caught, ending():
        raise PermissionError(13, "Permission denied", "robot.yaml")
    assert caught.value.message == "robot.yaml: Permission denied"
