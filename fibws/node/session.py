"""A node's exchange with its hub: operations and messages, and the handler of each."""

from __future__ import annotations

import asyncio
import logging
import math
import os
import re
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Coroutine, Iterable
from typing import Any, NoReturn, TypeAlias, assert_never

from pydantic_core import from_json

from fibws.errors import (
    AuthenticationError,
    InvalidUtf8,
    MessageTooLarge,
    NodeClosed,
    NodeError,
    OperationError,
    OperationRejected,
)
from fibws.node.outgoing_queue import OutgoingQueue, PublisherLane, Writer
from fibws.protocol.decoding import decode_json, decode_operation, parse_reply
from fibws.protocol.fragments import Reassembly
from fibws.protocol.operations import (
    ActionFeedback,
    ActionResult,
    Auth,
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
    Subscribed,
    encode,
    encode_serialized,
)
from fibws.protocol.serialized import is_operation
from fibws.protocol.websocket import BINARY, TEXT, UNLIMITED, Payload, client_frame
from fibws.public_classes import AsyncContext

MAX_SIZE = 64 << 20
"""Default of the bytes that one message of the hub may have: images and point clouds pass."""
SIZE_VARIABLE = "FIBWS_MAX_MESSAGE_SIZE"
"""The environment variable for another limit."""
UNKNOWN_PUBLISHER = "unknown_publisher"
"""The code of a status about a message whose advertisement the hub has refused."""
AUTHENTICATION = "auth:"
"""How the ids of operations begin that give the hub a token."""

_OnMessage: TypeAlias = Callable[[str, Any, dict[str, str] | None], bool]
_ID = re.compile(rb'"id":("(?:[^"\\]|\\.)*")')
_LEVELS = {"error": logging.ERROR, "warning": logging.WARNING, "info": logging.INFO}


def choose_message_size(size: int | None) -> int:
    """Return how many bytes a message for the node may have.

    Args:
        size: as given to `fibws.Node`; None for that of the environment, or the default.

    Raises:
        ValueError: it is not a positive number.
    """
    given: object = os.environ.get(SIZE_VARIABLE) or MAX_SIZE if size is None else size
    try:
        found = int(str(given))
    except ValueError:
        found = 0
    if found < 1:
        source = "max_message_size" if size is not None else SIZE_VARIABLE
        raise ValueError(f"{source} must be a positive number of bytes, got {given!r}")
    return found


def throw(error: Exception) -> NoReturn:
    """Raise an error that may be raised again, without the traceback of the last time."""
    raise error.with_traceback(None)


class Tasks:
    """Tasks that run until they are done, or until their owner cancels them.

    Args:
        within: the tasks of the owner's owner, which cancels these, too.
    """

    def __init__(self, within: Tasks | None = None) -> None:
        self._within = within
        self._tasks: set[asyncio.Task[None]] = set()

    def __len__(self) -> int:
        return len(self._tasks)

    def start(self, coroutine: Coroutine[Any, Any, None], name: str) -> asyncio.Task[None]:
        """Start a task; the coroutine handles its own errors."""
        task = asyncio.create_task(coroutine, name=name)
        self._add(task)
        return task

    def cancel(self) -> None:
        """Cancel all tasks except the current one, which ends by itself."""
        for task in self._others():
            task.cancel()

    async def finished(self, until: float = math.inf) -> list[str]:
        """Wait until no task is left except the current one.

        Args:
            until: when to stop waiting, by the event loop's time.

        Returns:
            The names of the tasks that are left.
        """
        loop = asyncio.get_running_loop()
        while (others := self._others()) and (left := until - loop.time()) > 0:
            await asyncio.wait(others, timeout=left if left < math.inf else None)
        return sorted(each.get_name() for each in others)

    def _add(self, task: asyncio.Task[None]) -> None:
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        if self._within is not None:
            self._within._add(task)

    def _others(self) -> set[asyncio.Task[None]]:
        return self._tasks - {asyncio.current_task()} if self._tasks else set()


class Registration(AsyncContext, ABC):
    """A publisher, a service or an action server, which the hub registers or refuses."""

    _is_awaited = False
    """Whether `Node` waits for the hub's answer: it raises a refusal, which is logged otherwise."""

    @property
    @abstractmethod
    def fault(self) -> Exception | None:
        """The error that ended it, such as the hub's refusal; usually None."""

    @abstractmethod
    def close(self) -> None:
        """Take it back. Does nothing when called again."""


class OperationHandler:
    """Handles one kind of operations: those of topics, calls, services, or of one action.

    `Session.add_handler` registers it. A handler overrides the methods that concern it.
    """

    def _registrations(self) -> Iterable[Operation]:
        """Return what to send first on a new connection: all that is registered."""
        return ()

    def _retained(self) -> Iterable[tuple[bytes, PublisherLane]]:
        """Return the frames to send after all registrations: latched messages."""
        return ()

    def _on_reply(self, reply: Reply) -> bool:
        """Handle an operation if it is for this handler; return whether it was."""
        return False

    def _on_refusal(self, id_: str, error: OperationRejected) -> bool:
        """Handle the hub's refusal of the operation ``id_``; return whether it was this one's."""
        return False

    def _on_skipped(self, beginning: bytes, size: int, fault: str) -> bool:
        """Handle a binary frame that was too long to be read; return whether it was this one's.

        Args:
            beginning: the first bytes of its payload.
            size: bytes of the payload.
            fault: what is wrong, for the log.
        """
        return False

    def _on_disconnect(self) -> None:
        """Handle the loss of the connection, and with it of all pending responses."""

    def _on_end(self, error: Exception | None) -> None:
        """Handle the node's end, caused by ``error`` unless that is None. Called once, and last."""


HANDLER_TIMEOUT = 0.6
"""Seconds in which the handlers of a node, or of a server, must end once they are cancelled."""
MOST_NAMED = 3
"""Handlers that one line of the log names."""


class Session:
    """The state that a node's handlers share. It outlives connections and registers with each.

    Args:
        log: the node's logger.
        max_message_size: bytes that one message of the hub may have.
    """

    def __init__(self, log: logging.Logger, max_message_size: int = MAX_SIZE) -> None:
        self.outgoing = OutgoingQueue()
        self.log = log
        self.max_message_size = max_message_size
        """Bytes that one message of the hub may have; larger ones are dropped."""
        self.tasks = Tasks()
        """The handlers' tasks; the node's end cancels them."""
        self.serialized = False
        """Whether messages go as bytes on the current connection (`fibws.v1`), not as JSON."""
        self.serialized_values = False
        """Whether calls and goals do, too; not to older hubs of `fibws.v1`."""
        self.over = False
        """Whether the node has ended."""
        self.begun = False
        """Whether the node has been entered."""
        self.is_simulated = False
        """Whether the hub's time was simulated when this connection was made."""
        self.has_token = False
        """Whether the hub was given a token on this connection."""
        self.on_not_authenticated: Callable[[], None] = _do_nothing
        """Called when the hub refuses an operation of a client that has not shown a token."""
        self._receive_message: _OnMessage = lambda topic, message, header: False
        self._receive_serialized: Callable[[Payload], None] = lambda data: None
        self._handlers: dict[OperationHandler, None] = {}
        self._end_turn: Callable[[], None] = _do_nothing
        self._fragments = Reassembly(max_size=self.max_message_size)
        self._operations = 0
        self._waiters: set[asyncio.Future[None]] = set()
        self._error: Exception | None = None

    # Called by handlers

    def add_handler(self, handler: OperationHandler) -> None:
        """Register a handler, until it is removed or the node ends."""
        self.check()
        self._handlers[handler] = None

    def remove_handler(self, handler: OperationHandler) -> None:
        """Remove a handler. Does nothing when called again."""
        self._handlers.pop(handler, None)

    async def end_of(self, tasks: Tasks, began: float | None = None) -> None:
        """Wait until cancelled tasks have ended, and log those that do not in `HANDLER_TIMEOUT`.

        Args:
            began: when they were cancelled, by the event loop's time; None for now.
        """
        began = asyncio.get_running_loop().time() if began is None else began
        left = await tasks.finished(began + HANDLER_TIMEOUT)
        if left:
            names = ", ".join(left[:MOST_NAMED])
            more = f" and {len(left) - MOST_NAMED} more" if len(left) > MOST_NAMED else ""
            text = "Cancelled, but still running after %g s: %s%s."
            self.log.warning(text, HANDLER_TIMEOUT, names, more)

    def handlers(self) -> list[OperationHandler]:
        """Return a copy of the list of handlers: a handler may be removed while it is called."""
        return list(self._handlers)

    def set_message_handlers(
        self,
        on_json: _OnMessage,
        on_binary: Callable[[Payload], None],
    ) -> None:
        """Set what receives the messages of topics.

        Args:
            on_json: takes the topic, the message, and its connection header if it has one; returns
                whether the topic has a reader.
            on_binary: takes the payload of a message's binary frame (see `protocol.serialized`).
        """
        self._receive_message = on_json
        self._receive_serialized = on_binary

    def id(self, verb: str, name: str) -> str:
        """Return a new id for an operation."""
        self._operations += 1
        return f"{verb}:{name}:{self._operations}"

    def send(self, operation: Operation) -> None:
        """Send an operation if there is a hub; registrations are sent again on reconnection.

        Raises:
            MessageTooLarge: the hub does not take it.
        """
        frame = operation_frame(operation)
        self.outgoing.check_size(frame, subject(operation))
        if self.outgoing.connected:
            self.outgoing.put(frame)

    def authenticate(self, token: str) -> None:
        """Give the hub another token for this connection, before the current one expires."""
        self.send(Auth(id=f"{AUTHENTICATION}{time.time():.0f}", token=token))

    def give_readers_a_turn(self) -> None:
        """Stop reading the socket until the tasks that are ready have run: a queue is full."""
        self._end_turn()

    async def wait_for_hub(self) -> None:
        """Wait until there is a hub, and room for an operation.

        Raises:
            NodeClosed: the node has ended; or the error that ended it.
            RuntimeError: the node has not been entered, so that there will never be a hub.
        """
        self.check_entered()
        while True:
            await self.outgoing.wait_for_hub()
            await self.outgoing.room()
            self.check()
            if self.outgoing.connected:
                return

    def check_entered(self) -> None:
        """Raise RuntimeError if the node has not been entered."""
        if not self.begun and not self.over:
            raise RuntimeError("enter the node first: async with node, or await node.start()")

    # Called by the node and its connection

    def begin(self) -> None:
        """Note that the node has been entered: from now on it looks for a hub."""
        self.begun = True

    def connect(
        self,
        writer: Writer,
        *,
        serialized: bool,
        serialized_values: bool = False,
        largest: int = UNLIMITED,
        end_turn: Callable[[], None] = lambda: None,
        hold: bool = False,
    ) -> None:
        """Register everything with a hub.

        Args:
            serialized: whether messages go as bytes, as on a connection of `fibws.v1`.
            serialized_values: whether calls and goals do, too.
            largest: bytes that the hub takes in one message; what is larger is dropped.
            end_turn: stops reading until the loop's next turn.
            hold: keep messages until `OutgoingQueue.release`; registrations are sent at once.
        """
        self.serialized = serialized
        self.serialized_values = serialized and serialized_values
        self._end_turn = end_turn
        self.outgoing.largest = largest
        faults = []
        first: list[tuple[bytes, PublisherLane | None]] = []
        for handler in self._handlers:
            for operation in handler._registrations():
                frame = operation_frame(operation)
                try:
                    self.outgoing.check_size(frame, subject(operation))
                    first.append((frame, None))
                except MessageTooLarge as error:
                    faults.append(error)
        for handler in self._handlers:
            first += handler._retained()
        faults += self.outgoing.connect(writer, first, hold=hold)
        for fault in faults:
            self.log.error("Dropped: %s", fault)

    def receive_text(self, text: Payload) -> None:
        """Handle a text frame of the hub: one or several operations."""
        try:
            for fields in decode_json(bytes(text)):
                if not self._deliver(fields):
                    self._dispatch(parse_reply(fields))
        except (OperationError, InvalidUtf8) as error:
            self.log.warning("The hub sent an invalid operation: %s", error)

    def receive_binary(self, data: Payload) -> None:
        """Handle a binary frame of the hub: a topic's message, or a call or a goal."""
        if not is_operation(data):
            self._receive_serialized(data)
            return
        try:
            self._dispatch(parse_reply(decode_operation(data)))
        except (OperationError, InvalidUtf8) as error:
            self.log.warning("The hub sent an invalid operation: %s", error)

    def skipped(self, size: int, beginning: bytes, is_text: bool) -> None:
        """Handle a message of the hub that was too long to be read (`max_message_size`).

        Args:
            size: its bytes.
            beginning: the first of them.
            is_text: whether it was a text frame: an operation.
        """
        fault = f"a message of {size} bytes is larger than this node takes " + (
            f"(limit {self.max_message_size}, Node(max_message_size=...))"
        )
        if is_text or is_operation(beginning):
            id_ = _ID.search(beginning)
            error = OperationRejected(fault)
            error.code = MessageTooLarge.code
            if id_ and any(
                each._on_refusal(str(from_json(id_[1])), error) for each in self.handlers()
            ):
                return
        elif any(each._on_skipped(beginning, size, fault) for each in self.handlers()):
            return
        self.log.error("Dropped: %s", fault)

    def on_disconnect(self) -> None:
        """Handle the loss of the connection."""
        self.outgoing.disconnect()
        self._end_turn = _do_nothing
        self._fragments = Reassembly(max_size=self.max_message_size)
        for handler in self.handlers():
            handler._on_disconnect()

    def end(self, error: Exception | None = None) -> None:
        """End the node, because of ``error`` unless that is None; later calls do nothing.

        A later error that can only be a bug is reported to the event loop: nobody else sees it.
        """
        if self.over:
            if error is not None and not isinstance(error, NodeError | OSError):
                context = {"message": "Error after the end of a node", "exception": error}
                asyncio.get_running_loop().call_exception_handler(context)
            return
        self._error = error
        self.over = True
        for waiter in self._waiters:
            _release(waiter)
        for handler in self.handlers():
            handler._on_end(error)
        self.tasks.cancel()
        self.outgoing.close()

    async def ended(
        self, within: float | None = None, *, waiter: asyncio.Future[None] | None = None
    ) -> bool:
        """Wait for the node's end, or for ``within`` seconds; return whether it has ended.

        Args:
            waiter: ends the wait when it is done, besides.

        A timer ends the wait rather than a cancellation, which would go through the caller's
        frames: debuggers lose them then.

        Raises:
            Exception: what ended the node, if it was an error.
            RuntimeError: the node has not been entered.
        """
        if not self.over:
            self.check_entered()
            loop = asyncio.get_running_loop()
            waiter = waiter or loop.create_future()
            timer = loop.call_later(within, _release, waiter) if within is not None else None
            self._waiters.add(waiter)
            try:
                await waiter
            finally:
                self._waiters.discard(waiter)
                if timer is not None:
                    timer.cancel()
        if self._error is not None:
            throw(self._error)
        return self.over

    def check(self) -> None:
        """Raise NodeClosed, or the error that ended the node, if it has ended."""
        if self._error is not None:
            throw(self._error)
        if self.over:
            raise NodeClosed("the node has ended")

    def _deliver(self, fields: dict[str, Any]) -> bool:
        """Deliver a message to its readers; return False if it has none, or is something else.

        On a connection without `fibws.v1` nearly every operation is a message, and building a
        model of it would cost more than everything else.
        """
        if fields.get("op") != "publish":
            return False
        topic, header = fields.get("topic"), fields.get("header")
        if header is not None and not (
            isinstance(header, dict) and all(isinstance(each, str) for each in header.values())
        ):
            return False
        return isinstance(topic, str) and self._receive_message(topic, fields.get("msg"), header)

    def _dispatch(self, reply: Reply) -> None:
        match reply:
            case (
                Publish()
                | Subscribed()
                | Peers()
                | CallService()
                | ServiceResponse()
                | SendActionGoal()
                | CancelActionGoal()
                | ActionFeedback()
                | ActionResult()
            ):
                # It may arrive after the request was given up.
                any(handler._on_reply(reply) for handler in self.handlers())
            case Status():
                self._on_status(reply)
            case Fragment():
                text = self._fragments.add(reply, time.monotonic())
                if text is not None:
                    self.receive_text(text.encode())
            case Png():
                raise OperationError("a PNG image, which this node never asks for")
            case _:
                assert_never(reply)

    def _on_status(self, status: Status) -> None:
        """Report a refused operation to its handler, and log everything else."""
        if status.code == AuthenticationError.code and not self.has_token:
            self.on_not_authenticated()
            return
        if status.level == "error" and status.id is not None:
            error = OperationRejected(status.msg)
            error.code = status.code or error.code
            if any(handler._on_refusal(str(status.id), error) for handler in self.handlers()):
                return
        level = _LEVELS.get(status.level, logging.INFO)
        if status.level == "info" and str(status.id).startswith(AUTHENTICATION):
            level = logging.DEBUG
        if status.code == UNKNOWN_PUBLISHER and status.id is None:
            level = logging.DEBUG  # The refusal of its advertisement was reported already.
        self.log.log(level, "The hub: %s", status.msg)


def operation_frame(operation: Operation) -> bytes:
    """Return an operation as a WebSocket frame with the zero key."""
    serialized = encode_serialized(operation)
    if serialized is not None:
        return client_frame(BINARY, serialized)
    return client_frame(TEXT, encode(operation, exact=True))


def subject(operation: Operation) -> str:
    """Return what an operation is about, for errors: its topic, service or action, or its kind."""
    names = (getattr(operation, field, "") for field in ("topic", "service", "action", "op"))
    return next(filter(None, names), "operation")


def _do_nothing() -> None:
    """Stand for a callback while there is no connection."""


def _release(waiter: asyncio.Future[None]) -> None:
    if not waiter.done():
        waiter.set_result(None)
