#!/usr/bin/env python3
"""publisher.py TYPE SIZE RATE WARM COUNT SUBSCRIBERS: publish messages with rospy.

An ordinary rospy script: it runs under a real ROS and under fibws. It prints "begin" after WARM
messages and, after COUNT more, the seconds that these took.
"""

import sys
import time

import rospy
from messages import Messages, set_stamp

BURSTS = 1000.0
"""The most wake-ups per second: at a higher rate, each publishes several messages."""


def publish(type_name, size, hz, warm, count, subscribers):
    rospy.init_node("bench_publisher")
    messages = Messages("{}.msg")
    variants = messages.build(type_name, size)
    publisher = rospy.Publisher("bench", messages.message_class(type_name), queue_size=100)
    while publisher.get_num_connections() < subscribers:
        rospy.sleep(0.01)
    rate = rospy.Rate(min(hz, BURSTS))
    burst = max(1, round(hz / BURSTS))
    began = 0.0
    for number in range(warm + count):
        if number == warm:
            print("begin", flush=True)
            began = time.monotonic()
        if number % burst == 0:
            rate.sleep()
        message = variants[number % len(variants)]
        set_stamp(message, rospy.Time.now())
        publisher.publish(message)
    print(f"{time.monotonic() - began:.3f}", flush=True)
    rospy.spin()


if __name__ == "__main__":
    type_name, size, hz, *counts = sys.argv[1:]
    publish(type_name, int(size), float(hz), *map(int, counts))
