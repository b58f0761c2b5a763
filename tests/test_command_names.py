"""The names of commands in a shell with and without ``fibws setup``."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from fibws import command_names
from fibws.command_names import command_name


@pytest.fixture(autouse=True)
def shell(monkeypatch: pytest.MonkeyPatch) -> Iterator[pytest.MonkeyPatch]:
    monkeypatch.delenv(command_names.SETUP, raising=False)
    yield monkeypatch
    command_names.set_called_alias(None)


@pytest.mark.parametrize("command", ["run", "workspace make", "topic list", "hub", "open plot"])
def test_without_setup_all_are_commands_of_fibws(command: str) -> None:
    assert command_name(command) == f"fibws {command}"


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("run", "rosrun"),
        ("run robot move.py", "rosrun robot move.py"),
        ("workspace make", "catkin_make"),
        ("pkg create", "catkin_create_pkg"),
        ("pkg find", "rospack find"),
        ("open", "rqt"),
        ("open plot", "rqt_plot"),
        ("open services", "rqt services"),
        ("workspace clean", "fibws workspace clean"),
        ("hub", "fibws hub"),
        ("runner", "fibws runner"),
    ],
)
def test_with_setup_aliases_come_first(command: str, name: str, shell: pytest.MonkeyPatch) -> None:
    shell.setenv(command_names.SETUP, "{}")
    assert command_name(command) == name


def test_without_setup_the_called_alias_is_used_alone() -> None:
    command_names.set_called_alias("rospack")
    assert command_name("pkg find x") == "rospack find x"
    assert command_name("run x") == "fibws run x"
