#!/usr/bin/env python3
"""subscriber.py COUNT: prints the microseconds that COUNT texts took, after what went wrong."""

import sys
import threading
import time

import rospy
from std_msgs.msg import String

QUIET = 5.0
"""Seconds without a message after which no more is waited for."""

took = []
disorder = []
ended = threading.Event()


def callback(message, count):
    number, sent = message.data.split()
    took.append((time.monotonic() - float(sent)) * 1e6)
    if int(number) != len(took) - 1:
        disorder.append(number)
    if int(number) == count - 1:
        ended.set()


def listen(count):
    rospy.init_node("bench_subscriber")
    rospy.Subscriber("bench", String, callback, count)
    print("ready", flush=True)
    seen = -1
    while not took or len(took) > seen:
        seen = len(took)
        if ended.wait(QUIET):
            break
    print(f"{len(took)} of {count}, {len(disorder)} out of order")
    print(" ".join(f"{each:.0f}" for each in took))


if __name__ == "__main__":
    listen(int(sys.argv[1]))
