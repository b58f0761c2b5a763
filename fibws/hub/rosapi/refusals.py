"""Refused operations of clients, published on ``/rosout`` for everybody who watches the graph.

A client is told itself when an operation fails, but many ignore it: roslib drops the statuses, and
a page has no log. As with ROS 1's rosbridge_websocket, which logs such errors, they are on
``/rosout`` in the name of that node.
"""

from __future__ import annotations

import logging
from collections import Counter, OrderedDict
from dataclasses import dataclass

from fibws.hub.delivery.clock import Clock
from fibws.hub.graph.graph import ROSBRIDGE
from fibws.hub.graph.topic import Source
from fibws.hub.log_text import printable
from fibws.protocol.levels import severity

logger = logging.getLogger("fibws.hub")

REPEAT_AFTER = 10.0
"""Seconds for which the same text about the same client is not repeated."""
MAX_LINES = 20
"""Lines a second for all clients together."""
MAX_CLIENT_LINES = 5
"""Lines a second for one client."""
MAX_TEXTS = 1000
"""Texts that are remembered, to recognize repetitions."""


@dataclass(slots=True)
class _Repetition:
    """When a text was last published, and how often it has come since."""

    published: float
    hidden: int = 0


class Refusals:
    """Publishes which client was refused what, at a bounded rate.

    Args:
        rosout: the source of ``/rosout``.
    """

    def __init__(self, rosout: Source, clock: Clock) -> None:
        self._rosout = rosout
        self._clock = clock
        self._texts: OrderedDict[tuple[str, str], _Repetition] = OrderedDict()
        self._second = 0
        self._lines: Counter[str] = Counter()
        """By the clients' nodes: lines in this second."""

    def report(self, node: str, text: str) -> None:
        """Publish that an operation of a node failed, unless that has just been published.

        Args:
            text: the reason, as the client gets it.
        """
        now = self._clock.time()
        if int(now) != self._second:
            self._second = int(now)
            self._lines.clear()
        known = self._texts.get((node, text))
        is_repeated = known is not None and now - known.published < REPEAT_AFTER
        is_too_much = self._lines[node] >= MAX_CLIENT_LINES or self._lines.total() >= MAX_LINES
        if is_repeated or is_too_much:
            if known is not None:
                known.hidden += 1
            return
        self._lines[node] += 1
        self._texts[node, text] = _Repetition(now)
        self._texts.move_to_end((node, text))
        if len(self._texts) > MAX_TEXTS:
            self._texts.popitem(last=False)
        hidden = f" ({known.hidden} more since the last line)" if known and known.hidden else ""
        line = {
            "level": severity(logging.WARNING).ros,
            "name": ROSBRIDGE,
            "msg": f"{node}: {printable(text)}{hidden}",
        }
        try:
            self._rosout.publish(line)
        except Exception:
            # A fault here must not become one of the client, whose operation it is about.
            logger.exception("Cannot publish on /rosout that %s was refused something.", node)
