"""Fragments: splitting the text of an operation into pieces, and putting them together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from fibws.errors import OperationError
from fibws.protocol.operations import Fragment

PIECE_COST = 128
"""Bytes that each piece counts for in addition to its text: empty pieces take memory, too."""

MOST_PIECES = 1000
"""Most pieces of a text; longer texts have longer pieces."""


def split(text: str, size: int, id_: str) -> Iterator[Fragment]:
    """Yield a text in pieces of ``size`` characters; nothing if it is not longer than one piece."""
    if len(text) <= size:
        return
    size = max(size, -(-len(text) // MOST_PIECES))
    total = -(-len(text) // size)
    for number in range(total):
        piece = text[number * size : (number + 1) * size]
        yield Fragment(id=id_, data=piece, num=number, total=total)


@dataclass(slots=True)
class _Message:
    total: int
    since: float
    pieces: dict[int, str] = field(default_factory=dict)
    size: int = 0


class Reassembly:
    """Puts the fragments of one client together.

    Args:
        max_size: most bytes of all unfinished messages together.
        max_messages: most unfinished messages.
        timeout: seconds after which an unfinished message is dropped (rosbridge: 600).
    """

    def __init__(self, *, max_size: int, max_messages: int = 64, timeout: float = 600) -> None:
        self._max_size = max_size
        self._max_messages = max_messages
        self._timeout = timeout
        self._messages: dict[str | int, _Message] = {}
        self.size = 0
        """Bytes of all unfinished messages together."""

    def add(self, fragment: Fragment, now: float) -> str | None:
        """Add a piece; return the whole text if no piece is missing any more.

        A duplicate is ignored. ``now`` is in seconds of any monotonic clock.

        Raises:
            OperationError: the piece does not fit the ones before it, or a limit is reached; its
                message is dropped then, except when there are too many messages.
        """
        self._expire(now)
        if not 0 <= fragment.num < fragment.total:
            raise OperationError(
                f"num must be from 0 to total - 1, "
                f"got num {fragment.num} and total {fragment.total}"
            )
        message = self._messages.get(fragment.id)
        if message is None:
            if len(self._messages) >= self._max_messages:
                raise OperationError(
                    f"too many unfinished messages (limit {self._max_messages}); finish one first"
                )
            size = len(str(fragment.id))
            message = self._messages[fragment.id] = _Message(fragment.total, now, size=size)
            self.size += size
        if fragment.total != message.total:
            self._drop(fragment.id)
            raise OperationError(
                f"total of message {fragment.id} changed from {message.total} to {fragment.total}"
            )
        if fragment.num not in message.pieces:
            message.pieces[fragment.num] = fragment.data
            cost = len(fragment.data.encode()) + PIECE_COST
            message.size += cost
            self.size += cost
        if self.size > self._max_size:
            self._drop(fragment.id)
            raise OperationError(
                f"too many bytes in unfinished messages (limit {self._max_size}, "
                "--max-fragment-bytes of the hub)"
            )
        if len(message.pieces) < message.total:
            return None
        self._drop(fragment.id)
        return "".join(message.pieces[number] for number in range(message.total))

    def _expire(self, now: float) -> None:
        for id_, message in list(self._messages.items()):
            if now - message.since <= self._timeout:
                break  # Messages are in the order in which they began.
            self._drop(id_)

    def _drop(self, id_: str | int) -> None:
        self.size -= self._messages.pop(id_).size
