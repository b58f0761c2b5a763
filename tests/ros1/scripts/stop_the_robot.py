#!/usr/bin/env python3
"""Stops its motors behind the loop, as scripts do that know nothing of exceptions."""

import sys
import threading
import time

import rospy

rospy.init_node("stop_the_robot")
rospy.on_shutdown(lambda: print("hook", rospy.is_shutdown(), rospy.sleep(0.05)))
ended = []


def work():
    print("ready")
    while not rospy.is_shutdown():
        rospy.sleep(0.05)
    ended.append("thread")


worker = threading.Thread(target=work)
worker.start()
while not rospy.is_shutdown():
    rospy.sleep(rospy.Duration(0.2))
print("after the loop", rospy.is_shutdown())
start = time.time()
rospy.sleep(0.3)
rospy.sleep(rospy.Duration(0.3))
rospy.rostime.wallsleep(0.3)
print("slept", time.time() - start >= 0.89)
rospy.sleep(-1)
rospy.sleep(0)
rate = rospy.Rate(20)
for _ in range(3):
    rate.sleep()
late = rospy.Rate(100)
time.sleep(0.1)
late.sleep()
late.sleep()
worker.join()
print(ended)
sys.exit(4)
