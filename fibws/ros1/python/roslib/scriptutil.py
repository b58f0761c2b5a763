"""Questions about publishers and subscribers, for programs that are not nodes."""

from __future__ import annotations


def is_topic(topic: str) -> bool:
    """Return whether a topic, given by its global name, has publishers or subscribers."""
    return bool(_nodes(0, topic) | _nodes(1, topic))


def is_publisher(topic: str, publisher_id: str) -> bool:
    """Return whether a node publishes a topic.

    Args:
        topic: the topic's global name.
        publisher_id: the node's global name.

    Raises:
        OSError: the hub cannot be reached.
    """
    return publisher_id in _nodes(0, topic)


def is_subscriber(topic: str, subscriber_id: str) -> bool:
    """Return whether a node subscribes to a topic; see `is_publisher`."""
    return subscriber_id in _nodes(1, topic)


def _nodes(role: int, topic: str) -> set[str]:
    """Return the nodes that publish a topic (role 0), or subscribe to it (role 1)."""
    from rosgraph import Master

    state = Master("/script").getSystemState()[role]
    return {node for name, nodes in state if name == topic for node in nodes}
