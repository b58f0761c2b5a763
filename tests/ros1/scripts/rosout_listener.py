#!/usr/bin/env python3
import os

import rospy
from rosgraph_msgs.msg import Log


def callback(log):
    if log.name == '/logs' and (log.level > Log.DEBUG or log.msg.startswith('debug')):
        print(log.level, log.name, repr(log.msg), os.path.basename(log.file), log.function, log.line,
              sorted(log.topics))


rospy.init_node('rosout_listener')
rospy.Subscriber('/rosout', Log, callback)
print("ready")
rospy.spin()
