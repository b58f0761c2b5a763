"""Which topics there are, and of which types."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import sleep
from typing import Any

import rosgraph
from rosgraph.names import script_resolve_name

from rostopic.field import has_field, msgevalgen

INTERVAL = 0.1
"""Seconds between two looks at whether a topic is there now."""

Evaluate = Callable[[Any], Any]


class ROSTopicException(Exception):
    """The base of what goes wrong here."""


class ROSTopicIOException(ROSTopicException):
    """There is no hub."""


def get_topic_type(
    topic: str, blocking: bool = False
) -> tuple[str, str, Evaluate | None] | tuple[None, None, None]:
    """The type of a topic, or of the topic that a field is in.

    Args:
        topic: the topic; the way to a field may follow, as in ``/rosout/msg``.
        blocking: whether to wait until there is such a topic, or the node ends.

    Returns:
        The type, the topic's global name, and what takes the field out of a message, or None if
        none is named. Three times None if there is no such topic, or nobody knows its type.

    Raises:
        ROSTopicIOException: there is no hub.
    """
    name = script_resolve_name("rostopic", topic)
    found = _find(name)
    if found is None and blocking:
        import rospy

        sys.stderr.write(f"WARNING: topic [{name}] does not appear to be published yet\n")
        while found is None and not rospy.is_shutdown():
            sleep(INTERVAL)
            found = _find(name)
    if found is None:
        return None, None, None
    real_name, type_ = found
    return type_, real_name, msgevalgen(name[len(real_name) :])


def get_topic_class(
    topic: str, blocking: bool = False
) -> tuple[Any, str, Evaluate | None] | tuple[None, None, None]:
    """The class of a topic's messages; else as `get_topic_type`.

    Raises:
        ROSTopicException: nobody has defined the type here.
        ROSTopicIOException: there is no hub.
    """
    type_, name, evaluate = get_topic_type(topic, blocking)
    if type_ is None or name is None:
        return None, None, None
    message_class = _message_class(type_)
    if message_class is None:
        raise ROSTopicException(
            f"Cannot load message class for [{type_}]. Are your messages built?"
        )
    return message_class, name, evaluate


def get_topic_list(
    master: rosgraph.Master | None = None,
) -> tuple[list[tuple[str, str, list[str]]], list[tuple[str, str, list[str]]]]:
    """The topics that somebody publishes, and those that somebody subscribes to.

    Each is in a tuple with its type and a list of the nodes.

    Raises:
        ROSTopicIOException: there is no hub.
    """
    asked = _master() if master is None else master
    with _communicating():
        publications, subscriptions, _ = asked.getSystemState()
        types: dict[str, str] = dict(asked.getTopicTypes())
    published, heard = (
        [(name, types.get(name, "unknown type"), nodes) for name, nodes in ends]
        for ends in (publications, subscriptions)
    )
    return published, heard


def find_by_type(topic_type: str) -> list[str]:
    """The names of the topics of a type.

    Raises:
        ROSTopicIOException: there is no hub.
    """
    with _communicating():
        return [name for name, type_ in _master().getTopicTypes() if type_ == topic_type]


def _find(name: str) -> tuple[str, str] | None:
    """The topic that a global name begins with, and its type."""
    with _communicating():
        types: dict[str, str] = dict(_master().getTopicTypes())
    if name in types:
        return name, types[name]
    before = [each for each in types if name.startswith(f"{each}/")]
    before += [each for each in types if name.startswith(f"{each}[")]
    for topic in sorted(before, key=len, reverse=True):
        message_class = _message_class(types[topic])
        if message_class is None or has_field(message_class(), name[len(topic) :]):
            return topic, types[topic]
    return None


def _message_class(type_: str) -> Any:
    import genpy.message

    return genpy.message.get_message_class(type_)


def _master() -> rosgraph.Master:
    return rosgraph.Master("/rostopic")


@contextmanager
def _communicating() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise ROSTopicIOException(f"Unable to communicate with master! {error}") from None
