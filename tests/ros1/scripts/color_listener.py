#!/usr/bin/env python3
import rospy
from std_msgs.msg import ColorRGBA

rospy.init_node('color_listener')
rospy.Subscriber('color', ColorRGBA, lambda c: print("heard", c.r, c.g, c.b, c.a))
print("ready")
rospy.spin()
