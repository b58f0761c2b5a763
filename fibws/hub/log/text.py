"""Helpers that keep texts from clients in the hub's log readable, short and few."""

from __future__ import annotations

import logging
from collections import Counter, OrderedDict
from dataclasses import dataclass
from typing import Literal

from fibws.hub.errors import NotAllowed

logger = logging.getLogger("fibws.hub")

INTERNAL_ERROR = "this failed in the hub; see its log"
"""The text for clients about exceptions that are not their fault."""
LONGEST_TEXT = 1000
"""Most characters of a text about an operation, which may repeat names that a client chose."""
MOST_DIFFERENT = 10
"""Different errors of one client that are logged."""
ALL_ERRORS = "`fibws log` and the Console of the hub's page"
"""Where the errors are that the log leaves out."""
REPEAT_AFTER = 10.0
"""Seconds for which the same text about the same client is not repeated."""
MAX_LINES = 20
"""Lines a second for all clients together."""
MAX_CLIENT_LINES = 5
"""Lines a second for one client."""
MAX_TEXTS = 1000
"""Texts that are remembered, to recognize repetitions."""


def is_power_of_ten(count: int) -> bool:
    """Return whether to log the ``count``-th of events that may come thousands a second."""
    return str(count).strip("0") == "1"


def printable(text: str) -> str:
    """Return a text with line ends and terminal codes escaped."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in shortened(text.strip()))


def shortened(text: str) -> str:
    """Return a text, cut to a readable length."""
    return text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}..."


class ErrorLog:
    """Logs what one client does wrong: each different error once, and then how many there are.

    The first one that comes again, or is one too many, says so; after it, the 10th, the 100th and
    so on of all errors of the client are logged.

    Args:
        node: the client's name.
    """

    __slots__ = ("_faults", "_is_counting", "_known", "_node", "count")

    def __init__(self, node: str) -> None:
        self._node = node
        self._faults = 0
        self._is_counting = False
        self._known: set[int] | None = None
        """The hashes of the texts that were logged; most clients have none."""
        self.count = 0
        """Errors so far, with those that were not logged."""

    def add(
        self,
        text: str,
        *,
        code: str | None = None,
        fault: Exception | None = None,
        kind: Literal["error", "warning"] = "error",
    ) -> None:
        """Log an error, if it is a new one or its number is due.

        Args:
            code: the error's; refusals of the policy are not logged, but recorded as audit events.
            fault: an error within the hub, whose traceback is logged; these are counted apart.
            kind: what the line calls it.
        """
        self.count += 1
        self._faults += fault is not None
        if code == NotAllowed.code:
            return
        note = f"{kind} {self.count} of this client"
        if fault is not None:
            is_due = is_power_of_ten(self._faults)
        elif self._is_new(text):
            is_due = True
        elif not self._is_counting:
            self._is_counting = is_due = True
            note += f"; more are counted here, and errors are shown by {ALL_ERRORS}"
        else:
            is_due = is_power_of_ten(self.count)
        if is_due:
            level = logging.WARNING if fault is None else logging.ERROR
            logger.log(level, "%s: %s (%s)", self._node, printable(text), note, exc_info=fault)

    def _is_new(self, text: str) -> bool:
        """Return whether an error is new, and one of the first `MOST_DIFFERENT`."""
        if self._known is None:
            self._known = set()
        digest = hash(text)
        if digest in self._known or len(self._known) == MOST_DIFFERENT:
            return False
        self._known.add(digest)
        return True


@dataclass(slots=True)
class _Repetition:
    """When a text was last logged, and how often it has come since."""

    logged: float
    hidden: int = 0


class LineLimit:
    """Limits how many lines clients can cause in a log.

    Args:
        per_client: lines a second for one client.
        in_all: lines a second for all clients together.
    """

    def __init__(self, per_client: int = MAX_CLIENT_LINES, in_all: int = MAX_LINES) -> None:
        self._per_client = per_client
        self._in_all = in_all
        self._texts: OrderedDict[tuple[str, str], _Repetition] = OrderedDict()
        self._second = 0
        self._lines: Counter[str] = Counter()
        """By client: lines in this second."""

    def admit(self, client: str, text: str, now: float) -> int | None:
        """Decide whether a line may be logged.

        Args:
            client: its node or its address.
            now: seconds since some moment in the past.

        Returns:
            How many equal lines were not logged since the last one that was; None if this one must
            not be logged.
        """
        if int(now) != self._second:
            self._second = int(now)
            self._lines.clear()
        known = self._texts.get((client, text))
        is_repeated = known is not None and now - known.logged < REPEAT_AFTER
        is_too_much = self._lines[client] >= self._per_client or self._lines.total() >= self._in_all
        if is_repeated or is_too_much:
            if known is not None:
                known.hidden += 1
            return None
        self._lines[client] += 1
        self._texts[client, text] = _Repetition(now)
        self._texts.move_to_end((client, text))
        if len(self._texts) > MAX_TEXTS:
            self._texts.popitem(last=False)
        return known.hidden if known is not None else 0
