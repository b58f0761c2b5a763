#!/usr/bin/env python3
"""tf_lookups.py LINKS SECONDS: print how many lookups per second a tf2 buffer makes.

An ordinary rospy script: it runs under a real ROS and under fibws.
"""

import json
import math
import sys
import time

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped

STEPS = 100


def fill(buffer, links):
    for step in range(STEPS):
        for link in range(links):
            transform = TransformStamped(child_frame_id=f"frame_{link + 1}")
            transform.header.frame_id = f"frame_{link}"
            # No two frames have a common stamp: all but one link are interpolated.
            transform.header.stamp = rospy.Time.from_sec(100 + step * 0.1 + link * 0.001)
            transform.transform.translation.x = step
            transform.transform.rotation.z = math.sin(step / 50.0)
            transform.transform.rotation.w = math.cos(step / 50.0)
            buffer.set_transform(transform, "bench")


def rate(lookup, seconds):
    count, end = 0, time.perf_counter() + seconds
    while time.perf_counter() < end:
        for _ in range(50):
            lookup()
        count += 50
    return count / seconds


if __name__ == "__main__":
    links, seconds = int(sys.argv[1]), float(sys.argv[2])
    buffer = tf2_ros.Buffer(debug=False)
    fill(buffer, links)
    top, tip, latest = "frame_0", f"frame_{links}", rospy.Time()
    then = rospy.Time.from_sec(105.0505)
    side = "frame_1"
    facts = {
        "latest": rate(lambda: buffer.lookup_transform(top, tip, latest), seconds),
        "at a time": rate(lambda: buffer.lookup_transform(top, tip, then), seconds),
        "down": rate(lambda: buffer.lookup_transform(tip, side, then), seconds),
    }
    print(json.dumps(facts), flush=True)
