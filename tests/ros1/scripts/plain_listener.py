#!/usr/bin/env python3
import rospy
from std_msgs.msg import String

rospy.init_node('plain_listener')
rospy.Subscriber('chatter', String, lambda data: print("heard", data.data))
print("ready")
rospy.spin()
