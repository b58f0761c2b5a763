#!/usr/bin/env python3
import rospy
from std_msgs.msg import String

rospy.init_node('on_shutdown_node')
# Without a queue, whose thread may come too late in ROS.
pub = rospy.Publisher('chatter', String, queue_size=None)


def hook():
    print("hook: is_shutdown is %s" % rospy.is_shutdown())
    pub.publish("I'm dead!")


rospy.on_shutdown(hook)
rospy.on_shutdown(lambda: print("second hook"))
while pub.get_num_connections() == 0:
    rospy.sleep(0.02)
print("ready")
rospy.spin()
print("after spin: is_shutdown is %s" % rospy.is_shutdown())
try:
    pub.publish("too late")
except rospy.ROSException as e:
    print(type(e).__name__, e)
