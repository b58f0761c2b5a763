#!/usr/bin/env python3
"""node_publisher.py TYPE SIZE RATE WARM COUNT SUBSCRIBERS: publish messages with fibws.Node.

As publisher.py does with rospy.
"""

import asyncio
import sys
import time

from messages import Messages, set_stamp

import fibws

BURSTS = 1000.0
"""The most wake-ups per second: at a higher rate, each publishes several messages."""


async def publish(type_name, size, hz, warm, count, subscribers):
    messages = Messages("fibws.msg.{}")
    variants = messages.build(type_name, size)
    async with fibws.Node("bench_publisher") as node:
        publisher = await node.advertise(
            "bench", messages.message_class(type_name), queue_size=100, peers=True
        )
        async for names in publisher.peers.changes():
            if len(names) >= subscribers:
                break
        rate = aiter(node.rate(min(hz, BURSTS)))
        burst = max(1, round(hz / BURSTS))
        began = 0.0
        for number in range(warm + count):
            if number == warm:
                print("begin", flush=True)
                began = time.monotonic()
            if number % burst == 0:
                await anext(rate)
            message = variants[number % len(variants)]
            set_stamp(message, node.now())
            await publisher.publish(message)
        print(f"{time.monotonic() - began:.3f}", flush=True)
        await node.spin()


if __name__ == "__main__":
    type_name, size, hz, *counts = sys.argv[1:]
    asyncio.run(publish(type_name, int(size), float(hz), *map(int, counts)))
