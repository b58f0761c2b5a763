#!/usr/bin/env python
"""A tf2 buffer that is filled by hand: all that can be asked of it, and its errors."""
import math
import random

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped

Time = rospy.Time


def stamped(parent, child, at, x=0.0, y=0.0, yaw=0.0):
    message = TransformStamped()
    message.header.stamp = Time.from_sec(at)
    message.header.frame_id = parent
    message.child_frame_id = child
    message.transform.translation.x = x
    message.transform.translation.y = y
    message.transform.rotation.z = math.sin(yaw / 2)
    message.transform.rotation.w = math.cos(yaw / 2)
    return message


def shown(value):
    if isinstance(value, TransformStamped):
        t, r = value.transform.translation, value.transform.rotation
        numbers = ['%.6f' % (number + 0.0 if abs(number) > 1e-9 else 0.0) for number in (t.x, t.y, t.z, r.x, r.y, r.z, r.w)]
        return '%r %s <- %s: %s' % (
            value.header.stamp, value.header.frame_id, value.child_frame_id, ' '.join(numbers))
    return repr(value)


def attempt(name, *args):
    try:
        print('%s%s: %s' % (name, args, shown(getattr(tree, name)(*args))))
    except Exception as error:
        print('%s%s: %s %s' % (name, args, type(error), error))


def ask(target, source, *times):
    for time in times:
        attempt('lookup_transform_core', target, source, Time.from_sec(time))
        attempt('can_transform_core', target, source, Time.from_sec(time))


def small_tree():
    print(repr(tree.all_frames_as_yaml()), repr(tree.all_frames_as_string()), tree._getFrameStrings())
    for at in (1, 2, 3):
        tree.set_transform(stamped('map', 'odom', at, x=at * 10, yaw=at / 2.0), '/odometry')
    tree.set_transform(stamped('/odom', '/base', 2.5, y=1), '/odometry')
    tree.set_transform_static(stamped('base', 'camera', 9, x=0.5, yaw=math.pi / 2), '/mount')
    tree.set_transform_static(stamped('base', 'arm', 0, y=0.5), '/mount')
    tree.set_transform(stamped('mars', 'rover', 2), '/nasa')
    print(tree.all_frames_as_yaml())
    print(tree.all_frames_as_string())
    print(tree._allFramesAsDot())
    print(tree._allFramesAsDot(Time(5)))
    print(tree._getFrameStrings(), tree._frameExists('map'), tree._frameExists('/map'))
    ask('map', 'odom', 0, 1, 1.25, 2, 2.5, 3, 0.5, 3.5)
    ask('odom', 'map', 0, 1.75, 7)
    ask('map', 'camera', 0, 2.5, 2.25, 9)
    ask('camera', 'map', 0, 2.5, 2.25)
    ask('camera', 'arm', 0, 2.5, 77)
    ask('camera', 'camera', 0, 5)
    ask('odom', 'odom', 0, 5)
    ask('nowhere', 'nowhere', 0, 5)
    ask('nowhere', 'elsewhere', 0)
    ask('map', 'elsewhere', 0, 1)
    ask('map', 'rover', 0, 1, 2)
    ask('rover', 'mars', 0)
    ask('/map', 'odom', 0)
    ask('map', '/odom', 0)
    ask('', 'odom', 0)
    ask('map', '', 0)
    for name in ('lookup_transform_full_core', 'can_transform_full_core'):
        attempt(name, 'camera', Time(3), 'odom', Time(1), 'map')
        attempt(name, 'odom', Time(3), 'odom', Time(1), 'map')
        attempt(name, 'odom', Time(), 'arm', Time(), 'map')
        attempt(name, 'odom', Time(9), 'odom', Time(1), 'map')
        attempt(name, 'odom', Time(1), 'odom', Time(9), 'map')
        attempt(name, 'nowhere', Time(1), 'odom', Time(9), 'map')
        attempt(name, 'odom', Time(1), 'odom', Time(9), '/map')
        attempt(name, 'odom', Time(1), 'rover', Time(2), 'map')
    attempt('lookup_transform_full_core', 'odom', Time(1), 'odom', Time(9), 'nowhere')
    attempt('lookup_transform_full_core', 'odom', Time(1), 'nowhere', Time(9), 'map')
    for pair in (('map', 'camera'), ('base', 'camera'), ('odom', 'odom'), ('map', 'rover'),
                 ('map', 'nowhere'), ('nowhere', 'map'), ('/map', 'odom'), ('', 'odom')):
        attempt('get_latest_common_time', *pair)
    attempt('_chain', 'map', Time(), 'camera', Time(), 'odom')
    attempt('_chain', 'arm', Time(), 'camera', Time(), 'base')
    attempt('_chain', 'camera', Time(2.5), 'map', Time(2.5), 'map')
    attempt('_chain', 'map', Time(), 'map', Time(), 'map')
    attempt('_chain', 'map', Time(), 'rover', Time(), 'map')
    attempt('lookup_transform_core', 'map', 'odom', 5)
    attempt('lookup_transform_core', 'map', 'odom', rospy.Duration(2))


def bad_data():
    for message in (stamped('map', 'odom', 3, x=99), stamped('map', 'map', 1), stamped('', 'a', 1),
                    stamped('a', '', 1), stamped('a', 'b', 1, x=float('nan'))):
        print(tree.set_transform(message, '/me'))
    crooked = stamped('a', 'b', 1)
    crooked.transform.rotation.w = 1.5
    print(tree.set_transform(crooked, '/me'))
    ask('map', 'odom', 0)
    tree.set_transform(stamped('map', 'odom', 20, x=1), '/me')
    tree.set_transform(stamped('map', 'odom', 9, x=1), '/me')
    tree.set_transform(stamped('map', 'odom', 12, x=2), '/me')
    ask('map', 'odom', 9, 10, 11, 12, 16, 20)
    tree.set_transform(stamped('c1', 'c2', 1), '/me')
    tree.set_transform(stamped('c2', 'c1', 1), '/me')
    ask('map', 'c1', 0, 1)
    ask('c2', 'map', 0)
    ask('c1', 'c2', 0, 1)
    ask('map', 'camera', 0)


def changes():
    tree.set_transform(stamped('table', 'cup', 1, x=1), '/me')
    tree.set_transform(stamped('hand', 'cup', 2, x=2), '/me')
    ask('hand', 'cup', 0, 1.5, 2)
    ask('table', 'cup', 0, 1, 1.5, 2)
    tree.set_transform_static(stamped('base', 'camera', 0, x=7), '/mount')
    tree.set_transform(stamped('base', 'camera', 8, x=8), '/mount')
    ask('base', 'camera', 0, 1, 99)
    tree.set_transform_static(stamped('hand', 'cup', 3, x=3), '/mount')
    ask('hand', 'cup', 0, 2.5, 99)
    print(tree.clear())
    ask('base', 'camera', 0, 1)
    ask('map', 'camera', 0)


def random_trees():
    numbers = random.Random(5)
    for _ in range(30):
        global tree
        tree = tf2_ros.BufferCore(rospy.Duration(numbers.choice([1, 5, 10])))
        count = numbers.randint(2, 9)
        for child in range(1, count):
            parent = numbers.randrange(child) if numbers.random() < 0.9 else child + 50
            static = numbers.random() < 0.3
            for _ in range(1 if static else numbers.randint(1, 20)):
                at = numbers.randint(100, 400) / 20.0
                message = stamped('f%d' % parent, 'f%d' % child, at, numbers.uniform(-9, 9),
                                  numbers.uniform(-9, 9), numbers.uniform(-3, 3))
                (tree.set_transform_static if static else tree.set_transform)(message, '/random')
        print(tree.all_frames_as_yaml())
        for _ in range(12):
            frames = ['f%d' % numbers.randrange(count) for _ in range(3)]
            times = [numbers.choice([0, numbers.randint(100, 400) / 20.0 + 0.01]) for _ in range(2)]
            ask(frames[0], frames[1], times[0])
            attempt('get_latest_common_time', frames[0], frames[1])
            attempt('lookup_transform_full_core', frames[0], Time.from_sec(times[0]), frames[1],
                    Time.from_sec(times[1]), frames[2])


if __name__ == '__main__':
    tree = tf2_ros.BufferCore()
    small_tree()
    bad_data()
    changes()
    random_trees()
    attempt.__globals__['tree'] = tf2_ros
    attempt('BufferCore', 1)
