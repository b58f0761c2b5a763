"""The statistics of a subscriber, for rospy and for fibws.Node alike."""

import json
import time

from messages import content, stamp


class Arrivals:
    """Counts messages, times them and checks their order and content.

    Args:
        variants: the messages that the publisher sends in turn, to compare the last one with.
        warm: the number of first messages whose times are left out.
        total: the number of messages to expect.
    """

    def __init__(self, variants, warm, total):
        self.received = 0
        self._variants = variants
        self._warm, self._total = warm, total
        self._took = []
        self._newest = 0
        self._disorder = 0
        self._last = None

    def add(self, message):
        """Count a message; return whether it is the last one."""
        now = time.time_ns()
        sent = stamp(message)
        self._disorder += sent <= self._newest
        self._newest = sent
        self.received += 1
        if self.received > self._warm:
            self._took.append((now - sent) / 1000)
        self._last = message
        return self.received == self._total

    def report(self):
        """Print the statistics as JSON."""
        expected = self._variants[(self.received - 1) % len(self._variants)]
        wrong = self._last is not None and content(self._last) != content(expected)
        facts = {
            "received": self.received,
            "disorder": self._disorder,
            "wrong": wrong and self.received == self._total,
            "took_us": [round(each, 1) for each in self._took],
        }
        print(json.dumps(facts), flush=True)
