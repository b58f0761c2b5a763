#!/usr/bin/env python3
"""publisher.py RATE COUNT: publishes COUNT texts, RATE a second, each with the time of day in it.

A rospy script like any other: it is run under a real ROS and under fibws.
"""

import sys
import time

import rospy
from std_msgs.msg import String

BURSTS = 100.0
"""A second, at most: above it messages leave several at a time, as sleep is not that exact."""


def publish(hz, count):
    rospy.init_node("bench_publisher")
    publisher = rospy.Publisher("bench", String, queue_size=1000)
    while publisher.get_num_connections() == 0:
        rospy.sleep(0.01)
    rate = rospy.Rate(min(hz, BURSTS))
    burst = max(1, round(hz / BURSTS))
    began = time.monotonic()
    for number in range(count):
        if number % burst == 0:
            rate.sleep()
        publisher.publish(f"{number} {time.monotonic()!r}")
    print(f"{time.monotonic() - began:.3f}")
    rospy.sleep(1.0)


if __name__ == "__main__":
    publish(float(sys.argv[1]), int(sys.argv[2]))
