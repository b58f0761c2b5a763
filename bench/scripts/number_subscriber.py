#!/usr/bin/env python3
"""number_subscriber.py COUNT: receive the numbers from 0 to COUNT with fibws.Node.

It prints how many messages it received, and the seconds of CPU time from the first to the last.
"""

import asyncio
import sys
import time

import fibws
from fibws.msg.std_msgs import Int32


async def listen(count):
    async with fibws.Node("bench_number_subscriber") as node:
        async with node.subscribe("bench_numbers", Int32, queue_size=None) as numbers:
            await node.wait_for_service("/rosapi/topics")
            print("ready", flush=True)
            received = 0
            started = 0.0
            async for number in numbers:
                if not received:
                    started = time.process_time()
                received += 1
                if number.data == count - 1:
                    break
            print(received, time.process_time() - started, flush=True)


if __name__ == "__main__":
    asyncio.run(listen(int(sys.argv[1])))
