"""What one thread waits for, and an event loop finds out."""

from __future__ import annotations

import asyncio
from typing import Any, NoReturn

import pytest
from rospy.answer import Answer
from rospy.exceptions import ROSInterruptException

from fibws import NodeClosed


def lives() -> bool:
    return True


def died() -> bool:
    return False


async def error_of(answer: Answer[Any]) -> BaseException:
    """What is raised to a thread; a KeyboardInterrupt would end the loop of a test as well."""

    def wait() -> BaseException:
        try:
            answer.result(lives)
        except BaseException as error:
            return error
        raise AssertionError("there was no error")

    return await asyncio.to_thread(wait)


async def test_it_is_the_result_of_a_coroutine() -> None:
    answer: Answer[int] = Answer()

    async def count() -> int:
        return 3

    answer.pursue(count())
    assert await asyncio.to_thread(answer.result, lives) == 3


async def test_it_raises_what_the_coroutine_raised() -> None:
    answer: Answer[int] = Answer()

    async def fail() -> NoReturn:
        raise ZeroDivisionError("on purpose")

    answer.pursue(fail())
    assert repr(await error_of(answer)) == "ZeroDivisionError('on purpose')"


@pytest.mark.parametrize(
    "error",
    [
        NodeClosed("the node has ended"),
        asyncio.CancelledError(),
        ROSInterruptException("rospy shutdown"),
    ],
)
async def test_the_end_of_the_node_interrupts(error: BaseException) -> None:
    answer: Answer[int] = Answer()

    async def fail() -> NoReturn:
        raise error

    answer.pursue(fail())
    assert repr(await error_of(answer)) == "ROSInterruptException('rospy shutdown')"


async def test_it_can_be_given_up() -> None:
    answer: Answer[None] = Answer()
    answer.cancel()  # Nothing is begun yet.
    answer.pursue(asyncio.Event().wait())  # type: ignore[arg-type]
    answer.cancel()
    assert isinstance(await error_of(answer), ROSInterruptException)


def test_time_ends_the_waiting() -> None:
    with pytest.raises(TimeoutError):
        Answer().result(lives, timeout=0.01)


def test_without_a_loop_there_will_be_none() -> None:
    with pytest.raises(ROSInterruptException, match="rospy shutdown"):
        Answer().result(died)
    answer: Answer[str] = Answer()
    answer.succeed("in time")
    assert answer.result(died) == "in time"
