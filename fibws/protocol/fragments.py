"""Fragments: the pieces in which the text of one operation may travel, either way."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from fibws.errors import OperationError
from fibws.protocol.operations import Fragment

PIECE_COST = 128
"""What keeping a piece costs beside its text, in bytes; it bounds floods of empty pieces."""

MOST_PIECES = 1000
"""Into how many a text is split at most: they are longer rather than more."""


def split(text: str, size: int, id_: str) -> Iterator[Fragment]:
    """The text in pieces of at most ``size`` characters; in none at all if it is no longer."""
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
    """Puts one client's fragments together, within bounds.

    Args:
        max_size: bytes that all unfinished messages together may take.
        max_messages: how many messages may be unfinished at once.
        timeout: seconds after which an unfinished message is given up (rosbridge: 600).
    """

    def __init__(self, *, max_size: int, max_messages: int = 64, timeout: float = 600) -> None:
        self._max_size = max_size
        self._max_messages = max_messages
        self._timeout = timeout
        self._messages: dict[str | int, _Message] = {}
        self._size = 0

    def add(self, fragment: Fragment, now: float) -> str | None:
        """Take one piece; return the whole text once no piece is missing.

        A piece that came before is ignored. ``now`` is in seconds of any steady clock.

        Raises:
            OperationError: the piece does not fit what came before, or a bound is reached, upon
                which the message that it belongs to is given up.
        """
        self._expire(now)
        if not 0 <= fragment.num < fragment.total:
            raise OperationError(
                f"num must be from 0 to total - 1, "
                f"but num is {fragment.num} and total is {fragment.total}"
            )
        message = self._messages.get(fragment.id)
        if message is None:
            if len(self._messages) >= self._max_messages:
                raise OperationError(
                    f"{self._max_messages} messages are unfinished already; finish one first"
                )
            size = len(str(fragment.id))
            message = self._messages[fragment.id] = _Message(fragment.total, now, size=size)
            self._size += size
        if fragment.total != message.total:
            self._drop(fragment.id)
            raise OperationError(
                f"total of message {fragment.id} was {message.total}, now it is {fragment.total}"
            )
        if fragment.num not in message.pieces:
            message.pieces[fragment.num] = fragment.data
            cost = len(fragment.data.encode()) + PIECE_COST
            message.size += cost
            self._size += cost
        if self._size > self._max_size:
            self._drop(fragment.id)
            raise OperationError(
                f"unfinished messages may take {self._max_size} bytes together "
                "(--max-fragment-bytes of the hub)"
            )
        if len(message.pieces) < message.total:
            return None
        self._drop(fragment.id)
        return "".join(message.pieces[number] for number in range(message.total))

    def _expire(self, now: float) -> None:
        for id_, message in list(self._messages.items()):
            if now - message.since <= self._timeout:
                break  # The oldest come first.
            self._drop(id_)

    def _drop(self, id_: str | int) -> None:
        self._size -= self._messages.pop(id_).size
