"""What a node's publisher is to its hub."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from fibws.errors import NodeError
from fibws.node.peers import Peers
from fibws.protocol.operations import Advertise


@dataclass(slots=True, eq=False)
class Advertisement:
    """One publisher's registration, and what of its messages waits."""

    operation: Advertise
    refused: Callable[[NodeError], None] | None = None
    """Is told if the hub does not let this node have the topic."""
    peers: Peers = field(default_factory=Peers)
    """Who subscribes, if the operation asks for that."""
    waiting: deque[int] = field(default_factory=deque)
    latched: bytes | None = None
    dropped: int = 0
    closed: bool = False
    fault: NodeError | None = None
