#!/usr/bin/env python3
import rospy

rospy.init_node('same_name')
rospy.on_shutdown(lambda: print("hook"))
print("ready")
rospy.spin()
print("ended", rospy.is_shutdown())
