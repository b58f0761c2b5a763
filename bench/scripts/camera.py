#!/usr/bin/env python3
"""camera.py BYTES HZ: publish compressed images of a size with fibws.Node until it is ended.

It prints how many it has published, with each of them.
"""

import asyncio
import os
import sys

import fibws
from fibws.msg.sensor_msgs import CompressedImage


async def publish(size, hz):
    async with fibws.Node("bench_camera") as node:
        camera = await node.advertise("bench_camera", CompressedImage)
        image = CompressedImage(format="jpeg", data=b"\xff\xd8" + os.urandom(size - 2))
        published = 0
        async for _ in node.rate(hz):
            await camera.publish(image)
            published += 1
            print(published, flush=True)


if __name__ == "__main__":
    asyncio.run(publish(int(sys.argv[1]), float(sys.argv[2])))
