"""Programs that are nodes: their common options, and running them until Ctrl-C."""

from __future__ import annotations

import click
import pytest
from click.testing import CliRunner

import fibws
from fibws.cli.node_program import run
from fibws.programs.broadcaster import command


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        (["numbers"], "'numbers'"),
        (["fibonacci:=9"], "'9' is not a legal name"),
        (["--rate", "0"], "got 0"),
        (["--rate", "nan"], "got nan"),
        (["--type", "std_msgs/String"], "a number called data"),
        (["--type", "std_msgs/Bool"], "a number called data"),
        (["--type", "geometry_msgs/Twist"], "a number called data"),
        (["--type", "std_msgs/Int23"], "did you mean std_msgs/Int32?"),
        (["--type", "integer"], "integer is not a valid type string"),
        (["--node-name", "a/b"], "namespaces are not allowed in node names"),
        (["--hub", "http://robot"], "is not the address of a hub"),
    ],
)
def test_wrong_argument_is_an_error(arguments: list[str], fault: str) -> None:
    result = CliRunner().invoke(command, arguments)
    assert result.exit_code == 2
    assert fault in result.stderr


def test_help_has_the_default_name_and_hub() -> None:
    result = CliRunner().invoke(command, ["--help"])
    assert "fibonacci_broadcaster_<pid>_<number>" in result.stdout
    assert "$FIBWS_HUB" in result.stdout


async def fail(error: BaseException) -> None:
    raise error


def test_error_of_a_node_exits_with_1() -> None:
    with pytest.raises(click.ClickException, match="took the name") as caught:
        run(fail(fibws.NodeReplaced("another node took the name /talker")))
    assert caught.value.exit_code == 1


def test_bug_keeps_its_traceback() -> None:
    with pytest.raises(ZeroDivisionError):
        run(fail(ZeroDivisionError()))


def test_keyboard_interrupt_is_a_normal_end() -> None:
    run(fail(KeyboardInterrupt()))
