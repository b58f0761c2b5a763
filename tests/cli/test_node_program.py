"""The programs of nodes: their common options, and how they run and end."""

from __future__ import annotations

import click
import pytest
from click.testing import CliRunner

import fibws
from fibws.broadcaster import command
from fibws.cli.node_program import run


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        (["numbers"], "'numbers': it is neither an option nor a remapping"),
        (["fibonacci:=9"], "'9' is not a legal name"),
        (["--rate", "0"], "0 is no finite number above 0"),
        (["--rate", "nan"], "nan is no finite number above 0"),
        (["--type", "std_msgs/String"], "does not hold one number"),
        (["--type", "std_msgs/Bool"], "does not hold one number"),
        (["--type", "geometry_msgs/Twist"], "does not hold one number"),
        (["--type", "std_msgs/Int23"], "did you mean std_msgs/Int32?"),
        (["--type", "integer"], "integer is not a valid type string"),
        (["--node-name", "a/b"], "namespaces are not allowed in node names"),
        (["--hub", "http://robot"], "is not the address of a hub"),
    ],
)
def test_wrong_arguments_are_explained(arguments: list[str], fault: str) -> None:
    result = CliRunner().invoke(command, arguments)
    assert result.exit_code == 2
    assert fault in result.stderr


def test_what_was_not_chosen_is_told_in_the_help() -> None:
    result = CliRunner().invoke(command, ["--help"])
    assert "fibonacci_broadcaster_<pid>_<number>" in result.stdout
    assert "$FIBWS_HUB" in result.stdout


async def fail(error: BaseException) -> None:
    raise error


def test_a_node_that_cannot_go_on_is_said_in_a_line() -> None:
    with pytest.raises(click.ClickException, match="took the name") as caught:
        run(fail(fibws.NodeReplaced("another node took the name /talker")))
    assert caught.value.exit_code == 1


def test_a_mistake_of_ours_keeps_its_traceback() -> None:
    with pytest.raises(ZeroDivisionError):
        run(fail(ZeroDivisionError()))


def test_a_keyboard_interrupt_is_an_end_like_others() -> None:
    with pytest.raises(SystemExit) as caught:
        run(fail(KeyboardInterrupt()))
    assert caught.value.code == 0
