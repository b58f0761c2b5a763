#!/usr/bin/env python3
"""number_publisher.py COUNT [RATE]: publish numbers with fibws.Node.

It publishes as fast as possible, or at RATE. It prints the seconds of CPU time that this took.
"""

import asyncio
import sys
import time

import fibws
from fibws.msg.std_msgs import Int32

BURSTS = 100.0
"""Wake-ups per second; each publishes several messages."""


async def publish(count, hz):
    async with fibws.Node("bench_number_publisher") as node:
        publisher = await node.advertise("bench_numbers", Int32, queue_size=100)
        started = time.process_time()
        if hz is None:
            for number in range(count):
                await publisher.publish(number)
        else:
            rate = aiter(node.rate(BURSTS))
            burst = round(hz / BURSTS)
            for number in range(count):
                if number % burst == 0:
                    await anext(rate)
                await publisher.publish(number)
    print(time.process_time() - started, flush=True)


if __name__ == "__main__":
    asyncio.run(publish(int(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else None))
