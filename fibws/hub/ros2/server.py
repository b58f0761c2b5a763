"""ROS 2 nodes with rmw_zenoh in the graph: the parts together.

    graph ── Ros2Nodes, Ros2Topics, Ros2Services ── Network ── zenoh ── ROS 2 nodes

`Ros2Nodes` learns from tokens who is there. `Ros2Topics` and `Ros2Services` attach what these nodes
have to the graph, and `Ros2Tokens` shows them what the graph has.
"""

from __future__ import annotations

import asyncio

from fibws.access.rights import Principal
from fibws.hub.graph.graph import Graph
from fibws.hub.ros2.network import Ros2Network
from fibws.hub.ros2.nodes import Ros2Nodes
from fibws.hub.ros2.own_nodes import Ros2Tokens
from fibws.hub.ros2.services import Ros2Services
from fibws.hub.ros2.topics import Ros2Topics
from fibws.hub.ros2.types import Ros2Types
from fibws.hub.settings import Settings


class Ros2:
    """The ROS 2 nodes of a domain.

    Args:
        principal: whose rights they have; None on a hub without authentication.
    """

    def __init__(self, graph: Graph, settings: Settings, principal: Principal | None) -> None:
        loop = asyncio.get_running_loop()
        self.network = Ros2Network(
            loop,
            listen=settings.ros2,
            connect=settings.ros2_connect,
            config=settings.zenoh_config,
            domain=settings.ros2_domain,
            max_queued=settings.max_queued_bytes,
            max_message_size=settings.max_message_size,
            token=lambda text, is_alive: self.nodes.token(text, is_alive),
        )
        self.nodes = Ros2Nodes(graph, lambda: self.network.session_id, principal)
        own, types = Ros2Tokens(graph, self.network), Ros2Types()
        self._own = own
        self._topics = self.nodes.topics = Ros2Topics(
            graph, self.network, self.nodes, own, types, loop, settings.max_latched_bytes
        )
        self._services = self.nodes.services = Ros2Services(
            graph, self.network, self.nodes, own, types, loop, settings.service_timeout
        )

    def set_principal(self, principal: Principal) -> None:
        """Give ROS 2 nodes the rights of a principal."""
        self.nodes.set_principal(principal)
        self._services.withdraw_forbidden()
        self._topics.start()
        self._services.start()

    async def start(self) -> None:
        """Join the network; raises `HubError` if that is impossible."""
        await self.network.open()
        self._own.start()
        self._topics.start()
        self._services.start()
        self.network.watch_tokens()

    async def close(self) -> None:
        """Leave the network."""
        self.nodes.close()
        self._topics.close()
        self._services.close()
        self._own.close()
        await self.network.close()
