"""The hub: ROS's master and rosbridge's server in one asyncio process."""

from fibws.hub.server import Hub
from fibws.hub.settings import Settings

__all__ = ["Hub", "Settings"]
