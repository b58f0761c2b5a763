#!/usr/bin/env python3
"""tf_broadcaster.py FRAMES PARTS HZ SECONDS: send transforms of frames in so many messages.

An ordinary rospy script: it runs under a real ROS and under fibws.
"""

import math
import sys

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped


def send(frames, parts, hz, seconds):
    rospy.init_node("bench_broadcaster", anonymous=True)
    broadcaster = tf2_ros.TransformBroadcaster()
    transforms = []
    for number in range(frames):
        transform = TransformStamped(child_frame_id=f"link_{number}")
        # Chains of ten.
        transform.header.frame_id = f"link_{number - 1}" if number % 10 else "base_link"
        transform.transform.translation.x = 0.1
        transforms.append(transform)
    size = -(-frames // parts)
    rate = rospy.Rate(hz)
    while not broadcaster.pub_tf.get_num_connections():
        rate.sleep()
    print("ready", flush=True)
    end = rospy.Time.now() + rospy.Duration(seconds)
    while rospy.Time.now() < end and not rospy.is_shutdown():
        now = rospy.Time.now()
        for transform in transforms:
            turn = now.to_sec() % 6
            transform.header.stamp = now
            transform.transform.rotation.z = math.sin(turn)
            transform.transform.rotation.w = math.cos(turn)
        for first in range(0, frames, size):
            broadcaster.sendTransform(transforms[first : first + size])
        rate.sleep()
    print("done", flush=True)
    rospy.spin()


if __name__ == "__main__":
    frames, parts, hz = map(int, sys.argv[1:4])
    send(frames, parts, hz, float(sys.argv[4]))
