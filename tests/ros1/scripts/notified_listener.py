#!/usr/bin/env python3
import rospy
from std_msgs.msg import String

heard = []


def callback(data):
    print("I heard %s" % data.data)
    heard.append(data.data)
    if "alone" in data.data:
        rospy.signal_shutdown("heard enough")


rospy.init_node('notified_listener', anonymous=True)
rospy.Subscriber("chatter", String, callback)
rospy.spin()
print("bye")
