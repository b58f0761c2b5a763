"""What scripts ask about topics: which there are, of which types; and how often messages come."""

from __future__ import annotations

from rostopic.field import msgevalgen
from rostopic.rate import ROSTopicHz
from rostopic.topics import (
    ROSTopicException,
    ROSTopicIOException,
    find_by_type,
    get_topic_class,
    get_topic_list,
    get_topic_type,
)

__all__ = [
    "ROSTopicException",
    "ROSTopicHz",
    "ROSTopicIOException",
    "find_by_type",
    "get_topic_class",
    "get_topic_list",
    "get_topic_type",
    "msgevalgen",
]
