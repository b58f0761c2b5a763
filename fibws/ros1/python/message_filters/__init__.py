"""What lies between a subscription and a callback: http://wiki.ros.org/message_filters.

Subscriber ─┬─ Cache                     the latest messages, by time
            └─ TimeSynchronizer          those of several topics that are of the same time
               └─ ApproximateTimeSynchronizer ... or of about the same time
"""

from __future__ import annotations

from message_filters.cache import Cache
from message_filters.simple_filter import SimpleFilter
from message_filters.subscriber import Subscriber
from message_filters.synchronizer import ApproximateTimeSynchronizer, TimeSynchronizer

__all__ = [
    "ApproximateTimeSynchronizer",
    "Cache",
    "SimpleFilter",
    "Subscriber",
    "TimeSynchronizer",
]
