"""A goal in its server's hands."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from typing import Any, Generic

from fibws.interfaces.message import F, G, R
from fibws.node.actions.record import Record
from fibws.node.actions.status import GoalStatus, Transition
from fibws.node.limits import check_timeout


class ServerGoal(Generic[G, R, F]):
    """A goal to be pursued: what an action's function is given.

    The function returns the result, and so the goal has succeeded, unless it was `canceled` or
    `aborted`.
    """

    def __init__(
        self,
        record: Record,
        request: G,
        result: type[R],
        publish: Callable[[ServerGoal[G, R, F], F | Mapping[str, Any]], Awaitable[None]],
    ) -> None:
        self.record = record
        """What the graph may know of it."""
        self._request = request
        self._result = result
        self._publish = publish
        self._cancel = asyncio.Event()
        self._ending = (Transition.SUCCEED, "")

    def __repr__(self) -> str:
        return f"<ServerGoal {self.id} {self.status.name}>"

    @property
    def id(self) -> str:
        """What the graph calls it."""
        return self.record.id

    @property
    def request(self) -> G:
        """What is wanted."""
        return self._request

    @property
    def status(self) -> GoalStatus:
        """Its state, as its client is told."""
        return self.record.status

    @property
    def cancel_requested(self) -> bool:
        """Whether it is wanted no more: its client says so, or has gone, or sent another goal."""
        return self._cancel.is_set()

    async def cancellation(self, *, timeout: float | None = None) -> bool:
        """Wait until it is wanted no more, for ``timeout`` seconds at most; tell whether it is.

        It is what a function does instead of sleeping.
        """
        check_timeout(timeout)
        with suppress(TimeoutError):
            async with asyncio.timeout(timeout):
                await self._cancel.wait()
        return self.cancel_requested

    async def publish_feedback(self, feedback: F | Mapping[str, Any]) -> None:
        """Tell the client how far this has come; waits while the connection is slower than that.

        Args:
            feedback: a message, or a dict of its fields.

        Raises:
            InvalidMessage: a field does not fit the type.
            TypeError: it is no feedback of this action.
            RuntimeError: the goal has ended.
        """
        await self._publish(self, feedback)

    def canceled(self, result: R | None = None, text: str = "") -> R:
        """Have the goal end as canceled: ``return goal.canceled(partial_result)``.

        Args:
            result: what was reached so far; else an empty result.
            text: the reason. Operations have room for this or for a result: the text goes first.
        """
        return self._end(Transition.CANCEL, result, text)

    def aborted(self, result: R | None = None, text: str = "") -> R:
        """Have the goal end as given up: ``return goal.aborted(text="the door is shut")``.

        Args:
            result: what was reached so far; else an empty result.
            text: the reason. Operations have room for this or for a result: the text goes first.
        """
        return self._end(Transition.ABORT, result, text)

    # What its server does

    def want_no_more(self) -> None:
        """Let the function know that it should come to an end."""
        self._cancel.set()

    @property
    def ending(self) -> tuple[Transition, str]:
        """How it ends once the function returns, and why."""
        return self._ending

    def _end(self, transition: Transition, result: R | None, text: str) -> R:
        self._ending = (transition, text)
        return self._result() if result is None else result
