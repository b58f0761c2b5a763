"""What a hub holds for clients: the parts of its memory account, beside what connections hold."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

from fibws.hub.federation.federation import Federation
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.memory.account import Account, AccountPart, Bound, Holding
from fibws.hub.memory.byte_room import ByteRoom
from fibws.hub.memory.machine import available_memory
from fibws.hub.settings import Settings
from fibws.hub.websocket.connection import Connection

if TYPE_CHECKING:
    from fibws.hub.recording import Recording
    from fibws.hub.ros1.server import Ros1Server
    from fibws.hub.ros2.server import Ros2

FindClient = Callable[[str], object | None]
"""Returns the client of a node, such as its connection."""


def memory_limit(settings: Settings) -> int:
    """Return the bytes that a hub may hold for all clients together."""
    return settings.max_memory or available_memory() // 2


def count_held(
    account: Account,
    graph: Graph,
    *,
    federation: Federation,
    ros1: Ros1Server | None,
    ros2: Callable[[], Ros2 | None],
    recording: Recording | None,
    files: ByteRoom,
    find_client: FindClient,
) -> None:
    """Add all that is held for clients to the account, beside what connections hold.

    Args:
        ros2: returns the ROS 2 nodes, which join later.
        files: the room for files on their way to clients.
    """
    graph.latched.on_grow = account.grow
    account.add("latched", AccountPart(partial(_latched, graph, find_client), is_metered=True))
    account.add("queues", AccountPart(federation.queued))
    account.add("incoming", AccountPart(federation.incoming))
    account.add("hubs", AccountPart(federation.records))
    if ros1 is not None:
        account.add("queues", AccountPart(ros1.queued))
        account.add("incoming", AccountPart(ros1.incoming))
    account.add_fixed("files", lambda: files.held, files.size)
    account.add_fixed("parameters", lambda: graph.parameters.bytes, 0)
    account.add_fixed("queues", partial(_ros2_bytes, ros2), 0)
    if recording is not None:
        account.add_fixed("recording", lambda: recording.held_bytes, 2 * recording.buffer_size)


def _latched(graph: Graph, find_client: FindClient) -> Iterator[Holding]:
    """Yield the latched messages and wills of each node."""
    owner = graph.policy.owner
    for quota in graph.latched.quotas:
        yield Holding(
            owner(quota.node) if quota.node else f"node {id(quota)}",
            partial(_latched_bytes, quota),
            shorten=partial(_shorten_latched, quota),
            end=partial(_end_client, find_client, quota.node),
        )


def _latched_bytes(quota: LatchQuota) -> int:
    return quota.used


def _shorten_latched(quota: LatchQuota, size: int, least: int, bound: Bound) -> None:
    limit = f"the hub may hold {bound.limit} bytes for all clients ({bound.setting})"
    quota.shorten(size, limit)


def _end_client(find_client: FindClient, node: str, bound: Bound) -> None:
    """Close the connection of a node for which too much is held, if it is a client."""
    client = find_client(node)
    if isinstance(client, Connection):
        client.fail(bound.reason)


def _ros2_bytes(ros2: Callable[[], Ros2 | None]) -> int:
    nodes = ros2()
    return nodes.network.waiting_bytes if nodes is not None else 0
