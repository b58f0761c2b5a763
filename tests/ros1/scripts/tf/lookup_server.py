#!/usr/bin/env python
"""Serves lookups as tf2_ros's buffer_server, which is in C++ in ROS."""
import os

import rospy
import tf2_ros

if __name__ == '__main__':
    print('ready')
    if not hasattr(tf2_ros, 'BufferServer'):
        os.execv('/usr/lib/tf2_ros/buffer_server', ['buffer_server', '__name:=lookups'])
    rospy.init_node('lookups')
    buffer = tf2_ros.Buffer()
    listener = tf2_ros.TransformListener(buffer)
    server = tf2_ros.BufferServer(buffer, 'tf2_buffer_server', False)
    server.start()
    rospy.spin()
