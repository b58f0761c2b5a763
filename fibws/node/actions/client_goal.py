"""A goal in its client's hands."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Callable
from typing import Generic

from fibws.errors import WaitTimeout
from fibws.interfaces.message import F, R
from fibws.node.actions.status import GoalStatus
from fibws.node.fault import throw
from fibws.node.limits import check_timeout


class ClientGoal(Generic[R, F]):
    """A goal that was sent: what is heard of it, and what becomes of it.

    Args:
        id_: what the graph calls it.
        queue_size: how much feedback waits for a slow reader; then the newest stays.
        cancel: tells the server that it is wanted no more.
    """

    def __init__(self, id_: str, queue_size: int, cancel: Callable[[str], None]) -> None:
        self._id = id_
        self._cancel = cancel
        self._status = GoalStatus.PENDING
        self._feedback: deque[F] = deque(maxlen=queue_size)
        self._dropped = 0
        self._news = asyncio.Event()
        self._over = asyncio.Event()
        self._result: R | None = None
        self._fault: Exception | None = None

    def __repr__(self) -> str:
        return f"<ClientGoal {self.id} {self.status.name}>"

    @property
    def id(self) -> str:
        """What the graph calls it."""
        return self._id

    @property
    def status(self) -> GoalStatus:
        """Its state, as far as it is known here. Operations tell of few states but the last."""
        return self._status

    @property
    def dropped(self) -> int:
        """How much feedback made way for newer before it was read."""
        return self._dropped

    async def feedback(self) -> AsyncIterator[F]:
        """How far the server has come, until the goal ends: ``async for ... in goal.feedback()``.

        It ends whatever becomes of the goal, which `result` then tells at once.
        """
        while True:
            while self._feedback:
                yield self._feedback.popleft()
            if self._over.is_set():
                return
            self._news.clear()
            await self._news.wait()

    async def result(self, *, timeout: float | None = None) -> R:
        """Wait until the goal ends, and return its result.

        Args:
            timeout: the seconds that this may take. The goal goes on after that, as it does if this
                is canceled: `cancel` is what ends it.

        Raises:
            ActionError: it did not succeed.
            WaitTimeout: it did not end in time. It is a TimeoutError, too.
            NodeClosed, or what was the matter: the node has ended.
        """
        check_timeout(timeout)
        try:
            async with asyncio.timeout(timeout):
                await self._over.wait()
        except TimeoutError:
            text = f"timeout exceeded while waiting for the result of goal {self.id}"
            raise WaitTimeout(text) from None
        if self._fault is not None:
            throw(self._fault)
        assert self._result is not None
        return self._result

    async def cancel(self) -> None:
        """Ask the server to stop; `result` tells when it has. Does nothing after the end."""
        if not self._over.is_set():
            self._cancel(self.id)

    # What its client does

    def told(self, status: GoalStatus) -> None:
        """Note what the server says."""
        self._status = status

    def offer(self, feedback: F) -> None:
        """Take feedback off the wire."""
        self._dropped += len(self._feedback) == self._feedback.maxlen
        self._feedback.append(feedback)
        self._news.set()

    def succeed(self, result: R) -> None:
        """The goal was reached."""
        self._result = result
        self._end(GoalStatus.SUCCEEDED)

    def fail(self, status: GoalStatus, fault: Exception) -> None:
        """The goal was not reached."""
        self._fault = fault
        self._end(status)

    def _end(self, status: GoalStatus) -> None:
        self._status = status
        self._over.set()
        self._news.set()
