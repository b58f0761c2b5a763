"""A service: who provides it, and what becomes of each call.

A call gets exactly one answer: its provider's, or the hub's own when the provider is lost, does not
answer in time, or answers what does not fit the type.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

from fibws.errors import FibwsError
from fibws.hub.graph.types import ServiceType
from fibws.protocol.operations import json_of

logger = logging.getLogger("fibws.hub")

Answer: TypeAlias = dict[str, Any] | bytes
"""A response, or its JSON text where that is at hand already."""


class Later:
    """An answer of the hub's own that is still to come.

    Args:
        forget: is called once nobody waits for it any more.
    """

    __slots__ = ("answer", "forget")

    def __init__(self, forget: Callable[[], None]) -> None:
        self.forget = forget
        self.answer: Callable[[dict[str, Any]], None] = _unasked
        """Gives the response, once."""


def _unasked(values: dict[str, Any]) -> None:
    raise AssertionError("what is known at once is not answered later")


Function: TypeAlias = Callable[[dict[str, Any], str], Answer | Later]
"""Answers a call in the hub itself; it is given the request and the caller's node.

It raises `FibwsError` with what went wrong.
"""


class Provider(Protocol):
    """Whoever answers the calls of a service."""

    @property
    def node(self) -> str:
        """The name of its node."""

    def take(self, call: Call) -> None:
        """Answer a call, now or later."""

    def forget(self, call: Call) -> None:
        """A call needs no answer any more."""

    def displaced(self, service: Service) -> None:
        """Another provider has taken the service over."""


@dataclass(slots=True, eq=False)
class Service:
    """One service of the graph."""

    name: str
    type: ServiceType
    provider: Provider

    @property
    def node(self) -> str:
        """The node that provides it."""
        return self.provider.node


class Call:
    """One call, from its asking to its answer.

    Args:
        request: valid, with every field filled.
        caller: the calling node.
        headers: what it says beside the request.
        succeeded: is given the response as JSON text.
        failed: is given the text of what went wrong.
    """

    __slots__ = (
        "_failed",
        "_open",
        "_succeeded",
        "caller",
        "due",
        "headers",
        "id",
        "request",
        "service",
    )

    def __init__(
        self,
        service: Service,
        request: dict[str, Any],
        caller: str,
        succeeded: Callable[[Call, bytes], None],
        failed: Callable[[Call, str], None],
        headers: dict[str, str] | None = None,
    ) -> None:
        self.service = service
        self.request = request
        self.caller = caller
        self.headers = headers
        self.due = math.inf
        """When the caller waits no more, by the clock of its session."""
        self.id = ""
        """What its provider knows it by."""
        self._succeeded = succeeded
        self._failed = failed
        self._open = True

    def start(self) -> None:
        """Ask the provider."""
        self.service.provider.take(self)
        # It has been told; what may be large need not be kept until it answers.
        self.request = {}
        self.headers = None

    def answer(self, values: object) -> None:
        """Take the provider's response.

        Raises:
            InvalidMessage: it does not fit the type; the call is still to be answered.
        """
        self.answer_text(json_of(self.service.type.response(values)))

    def answer_text(self, text: bytes) -> None:
        """Take the response as JSON text."""
        if self._close():
            self._succeeded(self, text)

    def fail(self, text: str) -> None:
        """Tell the caller that there will be no response, and why."""
        if self._close():
            self._failed(self, text)

    def abandon(self) -> None:
        """The caller has left: nobody needs an answer."""
        if self._close():
            self.service.provider.forget(self)

    def give_up(self, timeout: float) -> None:
        """The provider has not answered within ``timeout`` seconds."""
        self.service.provider.forget(self)
        self.fail(f"Service {self.service.name} did not answer within {timeout:g} s")

    def _close(self) -> bool:
        """Whether this was the answer, of which there is only one."""
        was_open, self._open = self._open, False
        return was_open


class OwnProvider:
    """A provider that is part of the hub.

    Args:
        node: the hub's own node that it belongs to.
    """

    def __init__(self, node: str, function: Function) -> None:
        self.node = node
        self._function = function
        self._later: dict[Call, Later] = {}
        """The answers that are still to come."""

    def take(self, call: Call) -> None:
        """Answer a call, now or later."""
        try:
            answer = self._function(call.request, call.caller)
            if isinstance(answer, Later):
                self._later[call] = answer
                answer.answer = lambda values: self._answer(call, values)
            elif isinstance(answer, bytes):
                call.answer_text(answer)
            else:
                call.answer(answer)
        except FibwsError as error:
            call.fail(str(error))
        except Exception:
            logger.exception("%s failed.", call.service.name)
            call.fail(f"{call.service.name} failed in the hub, whose log says why")

    def forget(self, call: Call) -> None:
        """A call needs no answer any more."""
        later = self._later.pop(call, None)
        if later is not None:
            later.forget()

    def displaced(self, service: Service) -> None:
        """The graph does not let that happen."""
        raise AssertionError(f"{service.name} is the hub's own")

    def _answer(self, call: Call, values: dict[str, Any]) -> None:
        del self._later[call]
        call.answer(values)
