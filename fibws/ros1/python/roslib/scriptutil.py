"""Asks who publishes and subscribes to what, without a node."""

from __future__ import annotations


def is_topic(topic: str) -> bool:
    """Whether somebody publishes or subscribes to the topic, given by its global name."""
    return bool(_nodes(0, topic) | _nodes(1, topic))


def is_publisher(topic: str, publisher_id: str) -> bool:
    """Whether a node publishes on a topic.

    Args:
        topic: the topic's global name.
        publisher_id: the node's.
    """
    return publisher_id in _nodes(0, topic)


def is_subscriber(topic: str, subscriber_id: str) -> bool:
    """Whether a node subscribes to a topic; its arguments are as those of `is_publisher`."""
    return subscriber_id in _nodes(1, topic)


def _nodes(role: int, topic: str) -> set[str]:
    """The nodes that publish on a topic (0), or subscribe to it (1)."""
    from rosgraph import Master

    state = Master("/script").getSystemState()[role]
    return {node for name, nodes in state if name == topic for node in nodes}
