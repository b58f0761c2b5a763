#!/usr/bin/env python3
import importlib

import roslib.message
import rospy
import rostopic
from geometry_msgs.msg import PoseStamped
from rospy import AnyMsg
from rospy.core import is_shutdown, logwarn
from rospy.impl.tcpros_base import DEFAULT_BUFF_SIZE
from std_msgs.msg import Float32

rospy.init_node('many_topics')
pub = rospy.Publisher('some/pose', PoseStamped, queue_size=1, latch=True)
p = PoseStamped()
p.header.frame_id = 'map'
p.pose.position.x = 1.5
pub.publish(p)
print(rostopic.get_topic_class('/some/pose'), rostopic.get_topic_class('/nope'))
print(roslib.message.get_message_class('std_msgs/String'))


def on_any(m):
    pkg, name = m._connection_header['type'].split('/')
    pose = getattr(importlib.import_module(pkg + '.msg'), name)().deserialize(m._buff)
    print(name, len(m._buff), pose.pose.position.x, m._connection_header['md5sum'])
    poses.append(pose)


poses = []
rospy.Subscriber('some/pose', AnyMsg, on_any, buff_size=DEFAULT_BUFF_SIZE * 10)
got = {}
subs = []
pubs = []
for i in range(20):
    name = 'robots/%d/battery' % i
    subs.append(rospy.Subscriber(name, Float32, lambda m, i=i: got.__setitem__(i, m.data)))
    pubs.append(rospy.Publisher(name, Float32, queue_size=1))
while not is_shutdown() and any(each.get_num_connections() == 0 for each in pubs):
    rospy.rostime.wallsleep(0.02)
for i, each in enumerate(pubs):
    each.publish(i / 2)
while len(got) < 20 or not poses:
    rospy.rostime.wallsleep(0.02)
print(len(got), sum(got.values()), pubs[7].resolved_name)
for each in subs + pubs:
    each.unregister()
try:
    pubs[0].publish(1)
except rospy.ROSException as e:
    logwarn(e)
