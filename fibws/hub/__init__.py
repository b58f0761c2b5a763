"""The hub: ROS's master and rosbridge's server in one asyncio process.

    websocket ─> Endpoint: rosbridge session ─> graph: Source.publish ─> Publication ─> every Sink
    Sink: rosbridge subscription ─> delivery: fan-out group, send queue ─> websocket
    rosapi: the hub's own nodes, which publish and serve in the same graph

The folders, from the inside out: ``graph`` knows nodes, topics, services, actions, parameters and
types, but no frames and no operations; ``delivery`` knows bytes; ``websocket`` knows connections
and endpoints; ``rosbridge`` is one endpoint, ``rosapi`` the hub's own nodes. ``server`` puts them
together, and ``embedded`` has what programs see of it. Only ``server``, ``websocket`` and
``__main__`` use sockets, files or the event loop.
"""

from fibws.hub.embedded import Hub
from fibws.hub.settings import Settings

__all__ = ["Hub", "Settings"]
