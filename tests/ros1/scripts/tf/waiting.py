#!/usr/bin/env python3
"""Looks up a transform that nobody sends, in a loop that Ctrl-C ends."""

import time

import rospy
import tf2_ros

rospy.init_node("waiting")
buffer = tf2_ros.Buffer()
print("ready")
while not rospy.is_shutdown():
    try:
        buffer.lookup_transform("map", "base", rospy.Time(), rospy.Duration(0.5))
    except (tf2_ros.LookupException, tf2_ros.ConnectivityException, tf2_ros.ExtrapolationException):
        continue
print("after the loop")
start = time.time()
print(buffer.can_transform("map", "base", rospy.Time(), rospy.Duration(0.2)))
print(time.time() - start >= 0.19)
