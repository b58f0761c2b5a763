#!/usr/bin/env python3
"""tf_listener.py: listen to /tf, and print how many messages came, whenever that changes.

An ordinary rospy script: it runs under a real ROS and under fibws.
"""

import rospy
import tf2_ros


class Counting(tf2_ros.TransformListener):
    received = 0

    def callback(self, data):
        super().callback(data)
        self.received += 1


if __name__ == "__main__":
    rospy.init_node("bench_listener", anonymous=True)
    listener = Counting(tf2_ros.Buffer())
    print("ready", flush=True)
    rate = rospy.Rate(20)
    seen = -1
    while not rospy.is_shutdown():
        if listener.received != seen:
            seen = listener.received
            print(seen, flush=True)
        rate.sleep()
