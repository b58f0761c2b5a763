#!/usr/bin/env python
"""Looks transforms up with another node's buffer."""
import math
import re

import rospy
import tf2_geometry_msgs
import tf2_ros
from geometry_msgs.msg import PointStamped

Time, Duration = rospy.Time, rospy.Duration


def attempt(name, function, *args):
    try:
        found = function(*args).transform.translation
        print(name, '%.3f %.3f %.3f' % (found.x, found.y, found.z))
    except Exception as error:
        print(name, type(error).__name__, re.sub(r'\d+\.\d{9}s? ?', '', str(error)))


if __name__ == '__main__':
    rospy.init_node('client')
    client = tf2_ros.BufferClient('tf2_buffer_server')
    print(client.wait_for_server())
    attempt('camera', client.lookup_transform, 'robot', 'camera', Time(), Duration(20))
    attempt('cup', client.lookup_transform, 'map', 'cup', Time(), Duration(20))
    found = client.lookup_transform('map', 'robot', Time.now(), Duration(20)).transform.translation
    print('robot', '%.2f' % math.hypot(found.x, found.y))
    attempt('unicorn', client.lookup_transform, 'map', 'unicorn', Time(), Duration(0.2))
    attempt('past', client.lookup_transform, 'map', 'robot', Time.now() - Duration(99))
    attempt('full', client.lookup_transform_full, 'table', Time(), 'cup', Time(), 'map')
    attempt('unfixed', client.lookup_transform_full, 'table', Time(), 'cup', Time(), 'unicorn')
    print(client.can_transform('map', 'cup', Time()), client.can_transform('map', 'x', Time()))
    print(client.can_transform_full('cup', Time(), 'table', Time(), 'map'))
    point = PointStamped()
    point.header.frame_id = 'camera'
    point.point.x = 1
    moved = client.transform(point, 'robot', Duration(1)).point
    print('point', '%.3f %.3f %.3f' % (moved.x, moved.y, moved.z))
