"""A thread waits for the result of a coroutine in an event loop."""

from __future__ import annotations

import asyncio
from typing import Any, NoReturn

import pytest
from rospy.exceptions import ROSInterruptException
from rospy.response import Response

from fibws import NodeClosed


def lives() -> bool:
    return True


def died() -> bool:
    return False


async def error_of(response: Response[Any]) -> BaseException:
    """What is raised to a thread; a KeyboardInterrupt would end the loop of a test as well."""

    def wait() -> BaseException:
        try:
            response.result(lives)
        except BaseException as error:
            return error
        raise AssertionError("there was no error")

    return await asyncio.to_thread(wait)


async def test_result_of_a_coroutine() -> None:
    response: Response[int] = Response()

    async def count() -> int:
        return 3

    response.execute(count())
    assert await asyncio.to_thread(response.result, lives) == 3


async def test_error_of_a_coroutine_is_raised() -> None:
    response: Response[int] = Response()

    async def fail() -> NoReturn:
        raise ZeroDivisionError("on purpose")

    response.execute(fail())
    assert repr(await error_of(response)) == "ZeroDivisionError('on purpose')"


@pytest.mark.parametrize(
    "error",
    [
        NodeClosed("the node has ended"),
        asyncio.CancelledError(),
        ROSInterruptException("rospy shutdown"),
    ],
)
async def test_end_of_the_node_interrupts_the_wait(error: BaseException) -> None:
    response: Response[int] = Response()

    async def fail() -> NoReturn:
        raise error

    response.execute(fail())
    assert repr(await error_of(response)) == "ROSInterruptException('rospy shutdown')"


async def test_coroutine_is_cancelled() -> None:
    response: Response[None] = Response()
    response.cancel()  # Nothing is begun yet.
    response.execute(asyncio.Event().wait())  # type: ignore[arg-type]
    response.cancel()
    assert isinstance(await error_of(response), ROSInterruptException)


def test_wait_ends_after_its_timeout() -> None:
    with pytest.raises(TimeoutError):
        Response().result(lives, timeout=0.01)


def test_wait_ends_with_the_loop() -> None:
    with pytest.raises(ROSInterruptException, match="rospy shutdown"):
        Response().result(died)
    response: Response[str] = Response()
    response.succeed("in time")
    assert response.result(died) == "in time"
