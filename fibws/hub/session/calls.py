"""The calls that one client waits for."""

from __future__ import annotations

from math import inf
from typing import Any, NamedTuple

from fibws.errors import FibwsError, OperationError
from fibws.hub.clock import Timer
from fibws.hub.graph.service import Call, Service
from fibws.hub.session.client import Client, check_room
from fibws.protocol.operations import CallService, Id, encode_fields, json_of, legal_id

LONGEST_TIMEOUT = 86400.0
"""Seconds that a call may ask for: a day."""

ANY_MD5SUM = "*"
"""What a caller says that leaves open which type it means."""


class Waiting(NamedTuple):
    """What is kept of a call while it is waited for: not its arguments, which may be large."""

    id: Id
    service: str
    fragment_size: int | None
    patience: float


class Calls:
    """One client's calls, until they are answered; whatever becomes of one, there is a response."""

    __slots__ = ("_alarm", "_calls", "_client", "_rings")

    def __init__(self, client: Client) -> None:
        self._client = client
        self._calls: dict[Call, Waiting] = {}
        self._alarm: Timer | None = None
        self._rings = 0.0
        """When the alarm will go off: it is one for all calls, no later than the first is due."""

    def call(self, request: CallService) -> None:
        """Call a service."""
        if self._client.outbox.overfull:
            # No answer would be kept, and an answer may be much work: the client is to be closed.
            return
        spelling, hash_, suffix = request.service.partition("#")
        # There may be an id behind the name, as the real server's call_service.py takes it.
        id_ = suffix if hash_ and request.id is None else request.id
        waiting = Waiting(id_, request.service, request.fragment_size, self._patience(request))
        try:
            self._call(waiting, self._client.resolve(spelling), request.args, request.headers)
        except FibwsError as error:
            self._fail(waiting, str(error))

    def refuse(self, fields: dict[str, Any], text: str) -> None:
        """What should have been a call is none: its caller may wait for a response all the same."""
        service, id_ = fields.get("service"), legal_id(fields.get("id"))
        if isinstance(service, str) and id_ is not None:
            self._fail(Waiting(id_, service, None, inf), text)

    def leave(self) -> None:
        """The client needs no answer any more."""
        for call in list(self._calls):
            call.abandon()
        self._calls.clear()
        if self._alarm is not None:
            self._alarm.cancel()
            self._alarm = None

    def _call(
        self, waiting: Waiting, name: str, args: object, headers: dict[str, str] | None
    ) -> None:
        service = self._client.graph.services.get(name)
        if service is None:
            raise OperationError(f"Service {name} does not exist")
        check_room(len(self._calls), self._client.settings.max_calls, "calls")
        self._check_md5sum(service, headers)
        valid = service.type.ask(args)
        call = Call(service, valid, self._client.node, self._succeeded, self._failed, headers)
        call.due = self._client.clock.time() + waiting.patience
        self._calls[call] = waiting
        self._watch(call.due)
        try:
            call.start()
        except Exception:
            self._calls.pop(call, None)
            raise

    def _check_md5sum(self, service: Service, headers: dict[str, str] | None) -> None:
        """Refuse who means another type, as ROS 1 does where two nodes connect, with its text."""
        known, given = service.type.md5sum, (headers or {}).get("md5sum", ANY_MD5SUM)
        if known is not None and given not in (known, ANY_MD5SUM):
            node = self._client.node
            raise OperationError(
                f"request from [{node}]: md5sums do not match: [{given}] vs. [{known}]"
            )

    def _succeeded(self, call: Call, values: bytes) -> None:
        self._respond(self._calls.pop(call), values, result=True)

    def _failed(self, call: Call, text: str) -> None:
        self._fail(self._calls.pop(call), text)

    def _fail(self, waiting: Waiting, text: str) -> None:
        self._respond(waiting, json_of(text), result=False)

    def _respond(self, waiting: Waiting, values: bytes, *, result: bool) -> None:
        fields = {
            "op": "service_response",
            "service": waiting.service,
            "id": waiting.id,
            "result": result,
        }
        self._client.reply(encode_fields(fields, values=values), waiting.fragment_size)

    def _patience(self, request: CallService) -> float:
        """Seconds for which a call is waited for; no time of its own, or 0, is the hub's."""
        if request.timeout is None or request.timeout <= 0:
            return self._client.settings.service_timeout or inf
        return min(request.timeout, LONGEST_TIMEOUT)

    def _watch(self, due: float) -> None:
        """See to it that the alarm goes off when a call is due."""
        if self._alarm is not None:
            if self._rings <= due:
                return
            self._alarm.cancel()
            self._alarm = None
        if due < inf:
            clock = self._client.clock
            self._rings = due
            self._alarm = clock.call_later(due - clock.time(), self._give_up)

    def _give_up(self) -> None:
        """Fail the calls that are overdue."""
        self._alarm = None
        overdue = [call for call in self._calls if call.due <= self._rings]
        self._watch(min((call.due for call in self._calls if call not in overdue), default=inf))
        for call in overdue:
            call.give_up(self._calls[call].patience)
