"""Control of a bag that a node plays: `fibws bag play` serves ``~control_playback``.

The applications show such a hub like a file: with a time line, a speed, and a button to pause.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from typing import Any, NamedTuple, Self

from fibws.errors import FibwsError, OperationError
from fibws.hub.foxglove.client import FoxgloveClient
from fibws.hub.foxglove.messages import PlaybackRequest, playback_frame
from fibws.hub.graph.body import Body
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.service import Call
from fibws.hub.graph.topic import SinkReport, Topic
from fibws.hub.websocket.endpoint import Work

CONTROL, STATE = "fibws_msgs/ControlPlayback", "fibws_msgs/PlaybackState"
"""The types of the service and the topic of a player."""
SERVICE, TOPIC = "/control_playback", "/playback"
"""The ends of their names, behind that of the player's node."""
NANOSECONDS = 10**9

MOST_RATE = 3e38
"""The protocol has a float of 32 bits for it."""

_STATUSES = {1: 0, 2: 1, 3: 2, 4: 3}
"""By the player's: playing, paused, waiting, ended."""


class PlayerState(NamedTuple):
    """A player's state; times are in nanoseconds."""

    status: int
    start: int
    end: int
    position: int
    rate: float

    @classmethod
    def read(cls, values: Any) -> Self | None:
        """Return the state in a message; None if that has other fields than a player's."""
        try:
            start, end, position = (
                values[field]["secs"] * NANOSECONDS + values[field]["nsecs"]
                for field in ("start", "end", "position")
            )
            status = _STATUSES.get(values["status"], 2)
            rate = float(values["rate"])
        except (KeyError, TypeError, ValueError):
            return None
        return cls(status, start, end, position, min(max(rate, 0.0), MOST_RATE))


class PlaybackControl:
    """One client's control of the first player that it may use; a `Sink` of the player's state.

    Args:
        changed: called when there is another range of time to play, or none any more.
    """

    def __init__(self, client: FoxgloveClient, changed: Callable[[], object]) -> None:
        self._client = client
        self._changed = changed
        self._known: set[str] = set()
        """The players' services."""
        self._service = ""
        """The service of the player that is controlled; empty without any."""
        self._topic: Topic | None = None
        self._state: PlayerState | None = None
        self._messages = 0
        self._calls: dict[Call, None] = {}

    @property
    def node(self) -> str:
        """The name of the client's node."""
        return self._client.node

    @property
    def range(self) -> tuple[int, int] | None:
        """The times of the first and the last message in nanoseconds; None without a player."""
        return None if self._state is None else (self._state.start, self._state.end)

    def names(self) -> Iterable[str]:
        """Return the name of the topic that it subscribes to."""
        return () if self._topic is None else (self._topic.name,)

    def changed(self, *names: str) -> None:
        """Called when topics or services may have changed."""
        ours = {
            name.removesuffix(TOPIC) + SERVICE if name.endswith(TOPIC) else name
            for name in names
            if name.endswith((TOPIC, SERVICE))
        }
        if not ours:
            return
        view = self._client.view
        for name in ours:
            if view.service(name) is not None:
                self._known.add(name)
            else:
                self._known.discard(name)
        chosen = self._service if self._find(self._service) is not None else ""
        for name in sorted(self._known):
            if not chosen and self._find(name) is not None:
                chosen = name
        if chosen != self._service or self._find(chosen) is not self._topic:
            self._use(chosen)

    def control(self, request: PlaybackRequest) -> None:
        """Have the player do what the client wants; its state is the answer.

        Raises:
            OperationError: there is no player, or it is asked for something impossible.
        """
        client, state = self._client, self._state
        if client.queue.overfull:
            return
        if state is None:
            raise OperationError("playback: no bag is played")
        if len(self._calls) >= client.settings.max_calls:
            raise OperationError("playback: too many requests wait for the player")
        commands: list[dict[str, Any]] = []
        if not math.isclose(request.speed, state.rate, rel_tol=1e-6):
            if not (math.isfinite(request.speed) and request.speed > 0):
                raise OperationError(f"playback: speed must be > 0, got {request.speed:g}")
            # As it was meant: 0.1 has become 0.10000000149.
            commands.append({"command": "rate", "rate": float(f"{request.speed:.7g}")})
        if request.seek is not None:
            secs, nsecs = divmod(min(request.seek, (2**32 - 1) * NANOSECONDS), NANOSECONDS)
            commands.append({"command": "seek", "position": {"secs": secs, "nsecs": nsecs}})
        commands.append({"command": "pause" if request.is_pause else "play"})
        for command in commands:
            is_last = command is commands[-1]
            self._call(command, partial(self._answered, request if is_last else None))

    def leave(self) -> None:
        """Control nothing any more."""
        for call in list(self._calls):
            call.abandon()
        self._calls.clear()
        self._unsubscribe()

    def withdraw_forbidden(self) -> Work:
        """End, one by one, the calls that the client's rights do not allow any more."""
        for call in list(self._calls):
            if call in self._calls and not self._client.is_allowed("call", call.service.name):
                call.withdraw()
            yield

    # As a sink.

    def receive(self, publication: Publication) -> None:
        """Take the player's state."""
        self._messages += 1
        if publication.type.name == STATE and publication.type.checked:
            with suppress(FibwsError):  # A message with millions of bags is not decoded.
                state = PlayerState.read(publication.values())
                if state is not None:
                    self._take(state)

    def replay(self, publication: Publication) -> None:
        """Take the state that the player had published before."""
        self.receive(publication)

    def report(self) -> SinkReport:
        """Return the totals."""
        return SinkReport(messages=self._messages)

    # The player.

    def _find(self, name: str) -> Topic | None:
        """Return the topic of a player's state, if the client may use that player."""
        client, view = self._client, self._client.view
        service, topic = view.service(name), view.topic(name.removesuffix(SERVICE) + TOPIC)
        if service is None or topic is None or topic.type is None:
            return None
        is_player = service.type.name == CONTROL and topic.type.name == STATE
        is_allowed = client.is_allowed("call", name) and client.is_allowed("subscribe", topic.name)
        is_its_own = service.node in view.publishers(topic)
        return topic if is_player and is_allowed and is_its_own else None

    def _use(self, service: str) -> None:
        had_range = self.range is not None
        self._unsubscribe()
        topic = self._find(service)
        if topic is not None:
            self._service, self._topic = service, topic
            self._client.graph.subscribe(topic, self, STATE)
            topic.replay(self)
        if had_range and self._state is None:
            self._changed()

    def _unsubscribe(self) -> None:
        topic, self._topic, self._state, self._service = self._topic, None, None, ""
        if topic is not None:
            self._client.graph.unsubscribe(topic, self)

    def _take(self, state: PlayerState) -> None:
        older, self._state = self.range, state
        if self.range != older:
            self._changed()
        self._client.queue.reply_fresh(self._frame)

    def _frame(self, request: str = "", *, did_seek: bool = False) -> bytes:
        state = self._state
        if state is None:
            return b""
        return playback_frame(state.status, state.position, state.rate, request, did_seek=did_seek)

    def _call(self, command: dict[str, Any], done: Callable[[str], object]) -> None:
        client = self._client

        def succeeded(call: Call, body: Body) -> None:
            self._calls.pop(call, None)
            response = body.values()
            state = PlayerState.read(response.get("state"))
            if self._state is not None and state is not None:
                self._state = state
            done("" if response.get("success") else str(response.get("message")))

        def failed(call: Call, text: str, code: str) -> None:
            self._calls.pop(call, None)
            done(text)

        call = client.graph.call(self._service, command, client.node, succeeded, failed)
        self._calls[call] = None
        try:
            call.start(client.settings.service_timeout, client.clock.call_later)
        except FibwsError:
            self._calls.pop(call, None)
            raise

    def _answered(self, request: PlaybackRequest | None, fault: str) -> None:
        """Report a fault, and answer the client's request once all is done."""
        if fault:
            self._client.statuses.error(f"playback: {fault}")
        if request is not None:
            frame = self._frame(request.id, did_seek=request.seek is not None)
            if frame:
                self._client.queue.reply(frame)
