"""The hub: ROS's master and rosbridge's server in one asyncio process.

    socket ─ connection, splitter ─> session, one operation after another
    session: topics | calls, services | goals, actions ─> graph: topic, service, action, parameters
    graph: topic ─ channel, encoding ─> frames ─ outbox ─> socket
    rosapi: the hub's own nodes, which publish and answer in the same graph

`server`, `connection`, `gate`, `pages`, `response` and `__main__` know sockets, files or the event
loop; all the rest is pure.
"""

from fibws.hub.server import Hub
from fibws.hub.settings import Settings

__all__ = ["Hub", "Settings"]
