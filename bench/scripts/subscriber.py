#!/usr/bin/env python3
"""subscriber.py TYPE SIZE WARM COUNT: print how long messages took, with rospy.

An ordinary rospy script: it runs under a real ROS and under fibws.
"""

import sys
import threading

import rospy
from arrivals import Arrivals
from messages import Messages

QUIET = 5.0
"""Seconds without a message after which the subscriber stops waiting."""


def listen(type_name, size, warm, count):
    rospy.init_node("bench_subscriber", anonymous=True)
    messages = Messages("{}.msg")
    arrivals = Arrivals(messages.build(type_name, size), warm, warm + count)
    ended = threading.Event()

    def callback(message):
        if arrivals.add(message):
            ended.set()

    rospy.Subscriber("bench", messages.message_class(type_name), callback)
    print("ready", flush=True)
    seen = -1
    while not ended.is_set() and (not arrivals.received or arrivals.received > seen):
        seen = arrivals.received
        ended.wait(QUIET)
    arrivals.report()
    rospy.spin()


if __name__ == "__main__":
    type_name, *numbers = sys.argv[1:]
    listen(type_name, *map(int, numbers))
