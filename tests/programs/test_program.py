"""How a program runs, apart from what its signals and pipes do, which the programs' tests try."""

from __future__ import annotations

import click
import pytest

import fibws
from fibws.cli.program import run


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
