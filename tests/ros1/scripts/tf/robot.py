#!/usr/bin/env python
"""A robot that drives in a circle of 2 m in 8 s, with a camera on its mast."""
import math

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped


def stamped(parent, child, x, y, z, yaw):
    message = TransformStamped()
    message.header.stamp = rospy.Time.now()
    message.header.frame_id = parent
    message.child_frame_id = child
    message.transform.translation.x = x
    message.transform.translation.y = y
    message.transform.translation.z = z
    message.transform.rotation.z = math.sin(yaw / 2)
    message.transform.rotation.w = math.cos(yaw / 2)
    return message


if __name__ == '__main__':
    rospy.init_node('robot')
    static = tf2_ros.StaticTransformBroadcaster()
    static.sendTransform([stamped('robot', 'mast', 0.1, 0, 1, 0),
                          stamped('mast', 'camera', 0, 0, 0.5, math.pi / 2)])
    moving = tf2_ros.TransformBroadcaster()
    rate = rospy.Rate(50)
    start = rospy.Time.now()
    print('ready')
    while not rospy.is_shutdown():
        angle = (rospy.Time.now() - start).to_sec() * math.pi / 4
        moving.sendTransform(stamped('map', 'robot', 2 * math.cos(angle), 2 * math.sin(angle), 0,
                                     angle))
        moving.sendTransform([stamped('map', 'table', 5, 5, 0, 0),
                              stamped('table', 'cup', 0, 0, 1, 0)])
        try:
            rate.sleep()
        except rospy.ROSInterruptException:
            pass
