"""Groups of commands that import a command when it is called."""

from __future__ import annotations

import click
import pytest
from click.testing import CliRunner

from fibws.cli.lazy import Command, LazyGroup

MODULES = {
    "completion": Command("fibws.cli.completion", "Complete by TAB."),
    "broken": Command("fibws.cli.no_such_module", "Cannot be imported."),
}


@pytest.fixture
def group() -> LazyGroup:
    return LazyGroup("tools", modules=MODULES)


def test_help_lists_all_commands_and_imports_none(group: LazyGroup) -> None:
    result = CliRunner().invoke(group, ["--help"])
    assert result.exit_code == 0
    assert result.output.split("Commands:\n")[1] == (
        "  completion  Complete by TAB.\n  broken      Cannot be imported.\n"
    )


def test_help_has_sections_in_order() -> None:
    modules = {
        "echo": Command("echo", "Print them.", "Look"),
        "publish": Command("publish", "Say it.", "Act"),
        "hz": Command("hz", "Count them.", "Look"),
    }
    result = CliRunner().invoke(LazyGroup("tools", modules=modules), ["--help"])
    assert result.output.partition("Look:\n")[2] == (
        "  echo     Print them.\n  hz       Count them.\n\nAct:\n  publish  Say it.\n"
    )


def test_command_is_imported_when_it_is_called(group: LazyGroup) -> None:
    result = CliRunner().invoke(group, ["completion", "--help"])
    assert result.output.startswith("Usage: tools completion [OPTIONS] {bash|fish|zsh}\n")
    assert isinstance(CliRunner().invoke(group, ["broken"]).exception, ModuleNotFoundError)


def test_unknown_command_is_an_error(group: LazyGroup) -> None:
    result = CliRunner().invoke(group, ["complete"])
    assert result.exit_code == 2
    assert "did you mean completion?" in result.output
    assert "did you mean" not in CliRunner().invoke(group, ["x"]).output


def test_unknown_option_of_a_group_may_belong_to_a_command(group: LazyGroup) -> None:
    result = CliRunner().invoke(group, ["--json", "completion"])
    assert result.exit_code == 2
    assert "tools COMMAND --json" in result.output
    result = CliRunner().invoke(group, ["--hlp"])
    assert "Did you mean" in result.output


def test_completion_of_commands_imports_none(
    group: LazyGroup,
) -> None:
    items = group.shell_complete(click.Context(group), "")
    assert [(item.value, item.help) for item in items if not item.value.startswith("-")] == [
        ("completion", "Complete by TAB."),
        ("broken", "Cannot be imported."),
    ]
    assert [item.value for item in group.shell_complete(click.Context(group), "c")] == [
        "completion"
    ]


def test_completion_includes_options(group: LazyGroup) -> None:
    items = group.shell_complete(click.Context(group), "--")
    assert [item.value for item in items] == ["--help"]
