"""What a hub on a zenoh network has announced, and how much of it is known."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import from_json, to_json

from fibws.hub.errors import FederationError
from fibws.hub.federation.records import (
    Announcement,
    HubInfo,
    Number,
    Skipped,
    decode_announcement,
    fault,
)

FIRST_RETRY = 0.02
"""Seconds until a hub that did not tell is asked again; they double up to `RETRY`."""
MOST_AHEAD = 1024 * 1024
"""Bytes of a hub's announcements that are kept until it has told what was missed before them."""


class ZenohState(BaseModel):
    """The answer to a query for everything that a hub announces."""

    model_config = ConfigDict(frozen=True, extra="ignore")

    hub: HubInfo
    time: int
    counter: Number
    announcement: Announcement
    since: Number = 0
    """The counter after which all changes are in it; 0 if all that there is."""
    more: bool = False
    """Whether the hub has more to tell."""


class KnownHub:
    """What is known of the announcements of another hub.

    Attributes:
        counter: of the last one that was taken.
        promised: the counter that the hub has told with the last ping.
        is_asked: whether the hub was asked for what was missed.
        delay: the seconds until it is asked again if it does not answer.
    """

    __slots__ = ("_ahead", "_ahead_bytes", "counter", "delay", "is_asked", "promised")

    def __init__(self) -> None:
        self.counter = 0
        self.promised = 0
        self.is_asked = False
        self.delay = FIRST_RETRY / 2
        self._ahead: dict[int, bytes] = {}
        self._ahead_bytes = 0

    def keep(self, counter: int, data: bytes) -> None:
        """Keep an announcement until those before it are known, if there is room."""
        if self._ahead_bytes + len(data) <= MOST_AHEAD:
            self._ahead[counter] = data
            self._ahead_bytes += len(data)

    def take_next(self) -> bytes | None:
        """Return the announcement that follows, if it was kept; forget earlier ones."""
        for counter in [each for each in self._ahead if each <= self.counter]:
            self._ahead_bytes -= len(self._ahead.pop(counter))
        data = self._ahead.pop(self.counter + 1, None)
        if data is not None:
            self._ahead_bytes -= len(data)
            self.counter += 1
        return data

    @property
    def has_gap(self) -> bool:
        """Whether announcements are missing before those that are kept."""
        return bool(self._ahead)


def decode_state(data: bytes, skipped: Skipped) -> ZenohState:
    """Return everything that a hub announces, without what is invalid in it.

    Raises:
        FederationError: it is no state, or too much of it is invalid.
    """
    try:
        return ZenohState.model_validate_json(data)
    except ValidationError:
        pass  # A record may be at fault alone.
    try:
        found = from_json(data)
        if not isinstance(found, dict):
            raise FederationError("invalid state: expected an object")
        announced = to_json(found.get("announcement"))
        state = ZenohState.model_validate_json(to_json({**found, "announcement": {}}))
    except ValidationError as error:
        raise FederationError(f"invalid state: {fault(error)}") from None
    except ValueError as error:
        raise FederationError(f"invalid state: {error}") from None
    announcement = decode_announcement(announced, skipped)
    return state.model_copy(update={"announcement": announcement})
