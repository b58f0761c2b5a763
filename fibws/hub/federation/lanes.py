"""Records of a link that wait for the network: a lane for each publisher, and one for calls.

Lanes take turns, a part of a large record each, so that a camera delays no other topic. What waits
is bounded, whatever it is and however slow the network: messages give way to newer ones of their
publisher, and calls that do not fit are refused by the link.
"""

from __future__ import annotations

import heapq
from collections import OrderedDict, deque
from collections.abc import Callable
from itertools import count
from typing import Any, NamedTuple

CHUNK = 16 * 1024
"""Bytes of a record from which on it is sent in parts, and most bytes that are written at once.

Together with `link.UNSENT` it sets for how long a message waits behind those of other topics: 30 ms
at 10 Mbit/s.
"""
LANE_BYTES = 2 * 1024 * 1024
"""Bytes that may wait in a lane; its newest message always may."""
OVERHEAD = 128
"""Bytes of memory that a waiting record takes beside its own."""
CALLS = 2**64 - 1
"""The lane of requests, replies and cancels, which are never dropped."""
ROOM = 7 / 8
"""The share of all bytes that still wait when messages have been dropped for lack of room."""


class LinkRecord(NamedTuple):
    """A record that waits.

    Attributes:
        arrival: a number that grows from record to record.
    """

    arrival: int
    head: bytes
    body: Any

    @property
    def size(self) -> int:
        """Its bytes."""
        return len(self.head) + len(self.body)

    def piece(self, begin: int) -> bytes:
        """Return the bytes of the part that begins at an offset."""
        head, end = self.head, begin + CHUNK
        body = memoryview(self.body)[max(0, begin - len(head)) : max(0, end - len(head))]
        return head[begin:end] + bytes(body)


class Taken(NamedTuple):
    """The next record to write, or a part of one.

    Attributes:
        is_last: whether it is the record's last part.
    """

    lane: int
    pieces: tuple[Any, ...]
    size: int
    is_part: bool
    is_last: bool


class _Lane:
    """Records that wait in order.

    Attributes:
        weight: the bytes of `records`, with their overhead.
        begun: a large record of which some parts were sent; it is not among `records`.
        at: how many of its bytes were sent.
    """

    __slots__ = ("at", "begun", "records", "weight")

    def __init__(self) -> None:
        self.records: deque[LinkRecord] = deque()
        self.weight = 0
        self.begun: LinkRecord | None = None
        self.at = 0


class LinkLanes:
    """The lanes of a link.

    Args:
        max_bytes: bytes of messages that wait, from which on a lane keeps only its newest message;
            and most bytes of large records that are sent in part at one time.
        most_bytes: bytes of messages, from which on the fullest lanes lose theirs, too.
        sent: called with the number of messages that were taken.
        dropped: called for each message that was dropped.
    """

    def __init__(
        self,
        max_bytes: int,
        most_bytes: int,
        sent: Callable[[int], None],
        dropped: Callable[[], None],
    ) -> None:
        self._max_bytes = max_bytes
        self._most_bytes = most_bytes
        self._sent = sent
        self._dropped = dropped
        self._lanes: OrderedDict[int, _Lane] = OrderedDict()
        self._arrivals = count()
        self._bytes = 0
        self._weight = 0
        self._begun_bytes = 0

    def __len__(self) -> int:
        """Return the number of lanes in which records wait."""
        return len(self._lanes)

    @property
    def calls_weight(self) -> int:
        """Bytes of requests and replies that wait, with their overhead."""
        calls = self._lanes.get(CALLS)
        return calls.weight if calls is not None else 0

    @property
    def _messages_weight(self) -> int:
        return self._weight - self.calls_weight

    @property
    def memory(self) -> int:
        """All bytes that are kept."""
        return self._weight + self._begun_bytes

    def put_call(self, head: bytes, body: Any) -> None:
        """Add a request, a reply or a cancel."""
        self._put(CALLS, head, body)

    def put_message(
        self, number: int, head: bytes, body: Any, *, limit: int, is_behind: bool
    ) -> None:
        """Add a message, for which the oldest ones of its lane are dropped.

        Args:
            number: of its publisher.
            limit: most messages of the publisher that wait while the network is behind.
        """
        lane, size = self._lanes.get(number), len(head) + len(body) + OVERHEAD
        while (
            lane is not None
            and lane.records
            and (
                (is_behind and len(lane.records) >= limit)
                or lane.weight + size > LANE_BYTES
                or self._messages_weight + size > self._max_bytes
            )
        ):
            self._drop(number, lane)
        if self._messages_weight > self._most_bytes:
            self.shorten(int(self._most_bytes * ROOM))
        self._put(number, head, body)

    def take_all(self) -> list[LinkRecord]:
        """Take all records, in the order in which they came, if there is room for them."""
        if self._begun_bytes or self._bytes > CHUNK:
            return []
        records = sorted(each for lane in self._lanes.values() for each in lane.records)
        calls = self._lanes.get(CALLS)
        self._sent(len(records) - (len(calls.records) if calls is not None else 0))
        self.clear()
        return records

    def take(self) -> Taken:
        """Take a record, or a part of a large one, of the lane whose turn it is."""
        key, lane = self._next()
        if lane.begun is None:
            record = self._pop(lane)
            if record.size <= CHUNK:
                self._ended(key, lane)
                return Taken(key, (record.head, record.body), record.size, False, True)
            lane.begun, lane.at = record, 0
            self._begun_bytes += record.size
        piece = lane.begun.piece(lane.at)
        lane.at += len(piece)
        is_last = lane.at >= lane.begun.size
        if is_last:
            self._begun_bytes -= lane.begun.size
            lane.begun = None
            self._ended(key, lane)
        else:
            self._lanes.move_to_end(key)
        return Taken(key, (piece,), len(piece), True, is_last)

    def clear(self) -> None:
        """Forget everything."""
        self._lanes.clear()
        self._bytes = self._weight = self._begun_bytes = 0

    def _next(self) -> tuple[int, _Lane]:
        """Return the lane whose turn it is.

        A large record waits until those that were begun leave room for it, as they can neither be
        dropped here nor used at the other hub; those behind it wait, too.
        """
        may_begin = True
        for key, lane in self._lanes.items():
            if lane.begun is not None or lane.records[0].size <= CHUNK:
                return key, lane
            if may_begin:
                needed = self._begun_bytes + lane.records[0].size
                if not self._begun_bytes or needed <= self._max_bytes:
                    return key, lane
                may_begin = False
        raise LookupError("nothing waits")

    def _put(self, key: int, head: bytes, body: Any) -> None:
        record = LinkRecord(next(self._arrivals), head, body)
        lane = self._lanes.get(key)
        if lane is None:
            lane = self._lanes[key] = _Lane()
        lane.records.append(record)
        lane.weight += record.size + OVERHEAD
        self._bytes += record.size
        self._weight += record.size + OVERHEAD

    def _pop(self, lane: _Lane) -> LinkRecord:
        record = lane.records.popleft()
        lane.weight -= record.size + OVERHEAD
        self._bytes -= record.size
        self._weight -= record.size + OVERHEAD
        return record

    def _drop(self, number: int, lane: _Lane) -> None:
        """Drop the oldest message of a lane."""
        self._pop(lane)
        self._dropped()
        if not lane.records and lane.begun is None:
            del self._lanes[number]

    def shorten(self, size: int) -> None:
        """Drop the oldest messages of the fullest lanes until so many bytes of messages wait.

        Lanes of one message lose theirs last.
        """
        heap = [_fullness(*each) for each in self._lanes.items() if each[0] != CALLS]
        heapq.heapify(heap)
        while heap and self._messages_weight > size:
            *_, number = heapq.heappop(heap)
            lane = self._lanes[number]
            if lane.records:
                self._drop(number, lane)
            if lane.records:
                heapq.heappush(heap, _fullness(number, lane))

    def _ended(self, key: int, lane: _Lane) -> None:
        """Pass the turn on, now that a record of a lane has been taken."""
        if key != CALLS:
            self._sent(1)
        if lane.records:
            self._lanes.move_to_end(key)
        else:
            del self._lanes[key]


def _fullness(number: int, lane: _Lane) -> tuple[bool, int, int]:
    """Return the sort key of a lane: the fullest comes first, among lanes with older messages."""
    return len(lane.records) <= 1, -lane.weight, number
