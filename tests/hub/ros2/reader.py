"""A ROS 2 subscriber in a process of its own, which a test can stop.

    python -m hub.ros2.reader ENDPOINT NODE TOPIC

It writes the first characters of each message in a line.
"""

from __future__ import annotations

import asyncio
import sys

from .peer import Peer, text_of


async def read(endpoint: str, node: str, topic: str) -> None:
    """Subscribe for ever."""
    async with Peer(endpoint, lease=3600.0) as peer:
        _, queue = await peer.subscriber(node, topic)
        while True:
            print(text_of((await queue.get()).data)[:20], flush=True)


if __name__ == "__main__":
    asyncio.run(read(*sys.argv[1:]))
