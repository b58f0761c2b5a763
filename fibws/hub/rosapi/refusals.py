"""Refused operations of clients, published on ``/rosout`` for everybody who watches the graph.

A client is told itself when an operation fails, but many ignore it: roslib drops the statuses, and
a page has no log. As with ROS 1's rosbridge_websocket, which logs such errors, they are on
``/rosout`` in the name of that node.
"""

from __future__ import annotations

import logging

from fibws.hub.delivery.clock import Clock
from fibws.hub.graph.graph import ROSBRIDGE
from fibws.hub.graph.topic import Source
from fibws.hub.log.text import LineLimit, printable
from fibws.protocol.levels import severity

logger = logging.getLogger("fibws.hub")


class Refusals:
    """Publishes which client was refused what, at a bounded rate.

    Args:
        rosout: the source of ``/rosout``.
    """

    def __init__(self, rosout: Source, clock: Clock) -> None:
        self._rosout = rosout
        self._clock = clock
        self._limit = LineLimit()

    def report(self, node: str, text: str) -> None:
        """Publish that an operation of a node failed, unless that has just been published.

        Args:
            text: the reason, as the client gets it.
        """
        count = self._limit.admit(node, text, self._clock.time())
        if count is None:
            return
        hidden = f" ({count} more since the last line)" if count else ""
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
