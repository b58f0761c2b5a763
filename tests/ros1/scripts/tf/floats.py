#!/usr/bin/env python3
"""Sets transforms with numbers of numpy, as tf.transformations returns them."""
import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped


def stamped(parent, child):
    message = TransformStamped()
    message.header.stamp = rospy.Time(1)
    message.header.frame_id = parent
    message.child_frame_id = child
    translation = message.transform.translation
    translation.x, translation.y, translation.z = np.float64(1.5), np.float32(2.5), np.int64(3)
    message.transform.rotation.w = np.float64(1.0)
    return message


core = tf2_ros.BufferCore(rospy.Duration(10))
core.set_transform(stamped('map', 'odom'), 'me')
core.set_transform_static(stamped('odom', 'base'), 'me')
for target, source in ('map', 'odom'), ('odom', 'base'), ('map', 'base'), ('base', 'map'):
    found = core.lookup_transform_core(target, source, rospy.Time(1)).transform
    t, r = found.translation, found.rotation
    print(target, source, [repr(number + 0.0) for number in (t.x, t.y, t.z, r.x, r.y, r.z, r.w)])
