"""A node's side of the conversation with its hub: what it says, and to whom goes what it hears."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable
from typing import Any, assert_never

from fibws.errors import InvalidUtf8, NodeClosed, OperationError, OperationRejected
from fibws.node.fault import throw
from fibws.node.outbox import Outbox
from fibws.node.part import Part
from fibws.node.tasks import Tasks
from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import (
    ActionFeedback,
    ActionResult,
    CallService,
    CancelActionGoal,
    Fragment,
    Operation,
    Peers,
    Png,
    Publish,
    Reply,
    SendActionGoal,
    ServiceResponse,
    Status,
    encode,
)
from fibws.protocol.parsing import parse_reply
from fibws.protocol.text import objects

MAX_SIZE = 64 << 20
"""Bytes that a message may have: images and point clouds pass."""

_LEVELS = {"error": logging.ERROR, "warning": logging.WARNING, "info": logging.INFO}


class Session:
    """What a node's parts have in common. It outlives the connection, and greets the next one."""

    def __init__(self, log: logging.Logger) -> None:
        self.outbox = Outbox()
        self.log = log
        self.tasks = Tasks()
        """What the parts have under way; the node's end cancels it."""
        self.crowded = False
        """Whether a reader has no place for another message: it needs a turn before one comes."""
        self._parts: dict[Part, None] = {}
        self._hear: Callable[[str, Any, dict[str, str] | None], bool] = lambda *message: False
        self._fragments = Reassembly(max_size=MAX_SIZE)
        self._operations = 0
        self.begun = False
        """Whether the node has been entered."""
        self._over = False
        self._waiters: set[asyncio.Future[None]] = set()
        self._fault: Exception | None = None

    # What its parts do

    def join(self, part: Part) -> None:
        """Let a part take part, from now on until it leaves or the node ends."""
        self.check()
        self._parts[part] = None

    def leave(self, part: Part) -> None:
        """Let it take part no more. Does nothing when called again."""
        self._parts.pop(part, None)

    def parts(self) -> list[Part]:
        """Those that take part, of whom any may leave while they are told something."""
        return list(self._parts)

    def hand_messages_to(self, hear: Callable[[str, Any, dict[str, str] | None], bool]) -> None:
        """Have messages heard by the part that listens to topics.

        Args:
            hear: is given the topic, the message, and its header if it has one; it tells whether
                anybody listens.
        """
        self._hear = hear

    def id(self, verb: str, name: str) -> str:
        """A new id for an operation."""
        self._operations += 1
        return f"{verb}:{name}:{self._operations}"

    def say(self, operation: Operation) -> None:
        """Send an operation, if there is somebody to hear it: the next hub gets the greeting."""
        if self.outbox.connected:
            self.outbox.put(encode(operation))

    async def wait_for_hub(self) -> None:
        """Wait until there is a hub, and room for what is to be said to it.

        Raises:
            NodeClosed, or what was the matter: the node has ended.
            RuntimeError: nobody has entered the node yet, so that no hub will ever come.
        """
        self._check_begun()
        while True:
            await self.outbox.wait_for_hub()
            await self.outbox.room()
            self.check()
            if self.outbox.connected:
                return

    # What happens to the node

    def begin(self) -> None:
        """The node has been entered: from now on it looks for a hub."""
        self.begun = True

    def greeting(self) -> list[bytes]:
        """What a new connection is told first, before the outbox's frames."""
        return [text for part in self._parts for text in part.greeting()]

    def receive(self, text: bytes) -> None:
        """Hand on what the hub sent."""
        try:
            for fields in objects(text):
                if not self._deliver(fields):
                    self._take(parse_reply(fields))
        except (OperationError, InvalidUtf8) as error:
            self.log.warning("The hub sent what this node does not understand: %s", error)

    def lose(self) -> None:
        """There is no hub any more."""
        self.outbox.lose()
        self._fragments = Reassembly(max_size=MAX_SIZE)
        for part in self.parts():
            part.lose()

    def end(self, fault: Exception | None = None) -> None:
        """The node is over, because of ``fault`` if there is one; later calls change nothing."""
        if self._over:
            return
        self._fault = fault
        self._over = True
        for waiter in self._waiters:
            _release(waiter)
        for part in self.parts():
            part.end(fault)
        self.tasks.cancel()
        self.outbox.close()

    @property
    def over(self) -> bool:
        """Whether the node has ended."""
        return self._over

    async def ended(self, within: float | None = None) -> bool:
        """Wait for the node's end, for ``within`` seconds at most; tell whether it came.

        It raises what was the matter if anything was, and RuntimeError if nobody has entered the
        node yet. A timer does for the wait what a cancellation would do as well, but that goes
        through the caller's frames, which debuggers then lose.
        """
        if not self.over:
            self._check_begun()
            loop = asyncio.get_running_loop()
            waiter = loop.create_future()
            timer = loop.call_later(within, _release, waiter) if within is not None else None
            self._waiters.add(waiter)
            try:
                await waiter
            finally:
                self._waiters.discard(waiter)
                if timer is not None:
                    timer.cancel()
        if self._fault is not None:
            throw(self._fault)
        return self.over

    def check(self) -> None:
        """Raise if the node is over."""
        if self._fault is not None:
            throw(self._fault)
        if self._over:
            raise NodeClosed("the node has ended")

    def _check_begun(self) -> None:
        if not self.begun and not self._over:
            raise RuntimeError("enter the node first: async with node")

    def _deliver(self, fields: dict[str, Any]) -> bool:
        """Give a message to those who listen; false if nobody does, or it is none as it should be.

        Nearly all that comes is one, and a model of it would cost more than all the rest.
        """
        if fields.get("op") != "publish":
            return False
        topic, header = fields.get("topic"), fields.get("header")
        if header is not None and not (
            isinstance(header, dict) and all(isinstance(each, str) for each in header.values())
        ):
            return False
        return isinstance(topic, str) and self._hear(topic, fields.get("msg"), header)

    def _take(self, reply: Reply) -> None:
        match reply:
            case (
                Publish()
                | Peers()
                | CallService()
                | ServiceResponse()
                | SendActionGoal()
                | CancelActionGoal()
                | ActionFeedback()
                | ActionResult()
            ):
                # It may come late, when nobody waits for it any more.
                any(part.receive(reply) for part in self.parts())
            case Status():
                self._told(reply)
            case Fragment():
                text = self._fragments.add(reply, time.monotonic())
                if text is not None:
                    self.receive(text.encode())
            case Png():
                raise OperationError("an image of an operation, which it never asks for")
            case _:
                assert_never(reply)

    def _told(self, status: Status) -> None:
        """A refused registration is its owner's to hear of; anything else goes to the log."""
        if status.level == "error" and status.id is not None:
            fault = OperationRejected(status.msg)
            if any(part.refuse(str(status.id), fault) for part in self.parts()):
                return
        self.log.log(_LEVELS.get(status.level, logging.INFO), "The hub: %s", status.msg)


def _release(waiter: asyncio.Future[None]) -> None:
    if not waiter.done():
        waiter.set_result(None)
