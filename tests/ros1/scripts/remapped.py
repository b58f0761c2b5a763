#!/usr/bin/env python3
import sys

import rospy
from std_msgs.msg import String

rospy.init_node('remapped')
print(rospy.get_name(), rospy.get_namespace())
print(rospy.resolve_name('chatter'), rospy.resolve_name('/chatter'), rospy.remap_name('chatter'))
print(rospy.resolve_name('~own'), rospy.resolve_name('other'))
print(rospy.get_param('~number'), rospy.get_param('~text'), rospy.get_param('~list'))
print(rospy.myargv()[1:], rospy.myargv(argv=['prog', 'a', 'b:=c', '_d:=e', 'f']))
pub = rospy.Publisher('chatter', String, queue_size=1)
print(pub.name, pub.resolved_name, pub.type, pub.md5sum)
