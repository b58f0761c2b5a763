#!/usr/bin/env python
"""Looks up where the robot is, waits for transforms, and transforms messages."""
import math
import re
import struct

import rospy
import tf2_geometry_msgs
import tf2_ros
import tf2_sensor_msgs
from geometry_msgs.msg import PointStamped, PoseStamped, Vector3Stamped, Wrench, WrenchStamped
from sensor_msgs import point_cloud2
from std_msgs.msg import Header
from tf2_msgs.srv import FrameGraph

Time, Duration = rospy.Time, rospy.Duration


def numbers(*values):
    return ' '.join('%.3f' % (0.0 if abs(value) < 5e-4 else value) for value in values)


def vector(v):
    return numbers(v.x, v.y, v.z)


def rotation(q):
    return numbers(q.x, q.y, q.z, q.w)


def attempt(name, function, *args):
    try:
        print(name, function(*args))
    except Exception as error:
        text = re.sub(r'\d+\.\d{9}s? ?', '', str(error))
        print(name, type(error).__name__, text)


def at_once():
    print('at once')
    attempt('nothing', buffer.lookup_transform, 'map', 'unicorn', Time())
    attempt('cannot', buffer.can_transform, 'map', 'unicorn', Time())
    attempt('why', lambda: buffer.can_transform('map', 'unicorn', Time(), return_debug_tuple=True))


def wait():
    print('waiting')
    began = Time.now()
    attempt('in vain', buffer.lookup_transform, 'map', 'unicorn', Time(), Duration(0.3))
    print('waited', 0.3 <= (Time.now() - began).to_sec() < 2)
    print('robot', buffer.can_transform('map', 'robot', Time(), Duration(20)))
    print('camera', buffer.can_transform('map', 'camera', Time(), Duration(20)))
    print('cup', buffer.can_transform('cup', 'camera', Time(), Duration(20)))
    now = Time.now()
    found = buffer.lookup_transform('map', 'robot', now, Duration(20))
    t = found.transform.translation
    difference = abs((found.header.stamp - now).to_sec())  # ROS rounds stamps to about 200 ns.
    print('now', difference < 1e-6, found.header.frame_id, found.child_frame_id,
          numbers(math.hypot(t.x, t.y)))
    attempt('future', buffer.lookup_transform, 'map', 'robot', Time.now() + Duration(100))
    attempt('past', buffer.lookup_transform, 'map', 'robot', Time.now() - Duration(100))


def look():
    print('looking')
    mast = buffer.lookup_transform('robot', 'camera', Time())
    print('camera', mast.header.stamp, vector(mast.transform.translation),
          rotation(mast.transform.rotation))
    print('back', vector(buffer.lookup_transform('camera', 'robot', Time()).transform.translation))
    cup = buffer.lookup_transform('map', 'cup', Time())
    print('cup', vector(cup.transform.translation), rotation(cup.transform.rotation))
    high = buffer.lookup_transform('map', 'camera', Time()).transform.translation
    print('height', numbers(high.z, math.hypot(high.x, high.y)))


def travel():
    print('travelling')
    before = Time.now()
    now = before + Duration(0.4)
    buffer.can_transform('map', 'robot', now, Duration(20))
    moved = buffer.lookup_transform_full('robot', now, 'robot', before, 'map', Duration(1))
    t, q = moved.transform.translation, moved.transform.rotation
    print('moved', '%.2f %.2f' % (math.hypot(t.x, t.y), abs(2 * math.atan2(q.z, q.w))))
    print(buffer.can_transform_full('robot', now, 'robot', before, 'map'))
    attempt('too far', buffer.lookup_transform_full, 'robot', now, 'robot', now - Duration(99), 'map')
    attempt('unfixed', buffer.lookup_transform_full, 'robot', now, 'robot', before, 'unicorn')


def header(frame):
    return Header(frame_id=frame, stamp=Time())


def transform():
    print('transforming')
    point = PointStamped(header=header('camera'))
    point.point.x, point.point.y, point.point.z = 1, 2, 3
    print('point', vector(buffer.transform(point, 'robot').point))
    there = buffer.transform(point, 'robot')
    print(there.header.frame_id, there.header.stamp, type(there).__name__)
    arrow = Vector3Stamped(header=header('camera'))
    arrow.vector.x = 1
    print('vector', vector(buffer.transform(arrow, 'robot').vector))
    pose = PoseStamped(header=header('camera'))
    pose.pose.position.x, pose.pose.orientation.y, pose.pose.orientation.w = 1, math.sqrt(0.5), math.sqrt(0.5)
    moved = buffer.transform(pose, 'robot', Duration(1)).pose
    print('pose', vector(moved.position), rotation(moved.orientation))
    for turn in ((0, 0, 1, 0), (0, 0, -1, 0), (0, 0, -0.6, -0.8), (0.6, 0, -0.8, 0)):
        (pose.pose.orientation.x, pose.pose.orientation.y, pose.pose.orientation.z,
         pose.pose.orientation.w) = turn
        print('turned', rotation(buffer.transform(pose, 'robot').pose.orientation))
    push = WrenchStamped(header=header('camera'), wrench=Wrench())
    push.wrench.force.x, push.wrench.torque.z = 1, 2
    pushed = buffer.transform(push, 'robot').wrench
    print('wrench', vector(pushed.force), vector(pushed.torque))
    attempt('no type', buffer.transform, header('camera'), 'robot')
    attempt('no frame', buffer.transform, point, 'unicorn')
    converted = buffer.transform(point, 'robot', new_type=PointStamped)
    print(vector(converted.point), tf2_ros.convert(point, PointStamped) == point)
    cloud = point_cloud2.create_cloud_xyz32(header('camera'), [(1, 2, 3), (4, 5, 6)])
    for each in point_cloud2.read_points(buffer.transform(cloud, 'robot')):
        print('cloud', numbers(*each))
    full = buffer.transform_full(point, 'map', Time(), 'cup')
    print('full', numbers(full.point.z), full.header.frame_id)


def describe():
    print('describing')
    graph = rospy.ServiceProxy('~tf2_frames', FrameGraph)().frame_yaml
    for line in sorted(graph.splitlines()):
        if line.startswith(('  parent', '  broadcaster')) or not line.startswith(' '):
            print(line)
    print(sorted(buffer.all_frames_as_string().splitlines()))
    print(sorted(buffer._getFrameStrings()))


if __name__ == '__main__':
    rospy.init_node('observer')
    buffer = tf2_ros.Buffer(Duration(5))
    at_once()
    listener = tf2_ros.TransformListener(buffer)
    wait()
    look()
    travel()
    transform()
    describe()
    buffer.clear()
    print('static', buffer.can_transform('robot', 'camera', Time()))
    listener.unregister()
