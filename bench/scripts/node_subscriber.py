#!/usr/bin/env python3
"""node_subscriber.py TYPE SIZE WARM COUNT: print how long messages took, with fibws.Node.

As subscriber.py does with rospy.
"""

import asyncio
import sys

from arrivals import Arrivals
from messages import Messages

import fibws

QUIET = 5.0
"""Seconds without a message after which the subscriber stops waiting."""


async def listen(type_name, size, warm, count):
    messages = Messages("fibws.msg.{}")
    arrivals = Arrivals(messages.build(type_name, size), warm, warm + count)
    async with fibws.Node("bench_subscriber", anonymous=True) as node:
        subscription = node.subscribe("bench", messages.message_class(type_name), queue_size=100)
        print("ready", flush=True)
        reader = asyncio.create_task(read(subscription, arrivals))
        seen = -1
        while not reader.done() and (not arrivals.received or arrivals.received > seen):
            seen = arrivals.received
            await asyncio.wait([reader], timeout=QUIET)
        arrivals.report()
        await node.spin()


async def read(subscription, arrivals):
    async for message in subscription:
        if arrivals.add(message):
            break


if __name__ == "__main__":
    type_name, *numbers = sys.argv[1:]
    asyncio.run(listen(type_name, *map(int, numbers)))
