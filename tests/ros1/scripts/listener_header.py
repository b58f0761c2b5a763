#!/usr/bin/env python3
import rospy
from rospy_tutorials.msg import HeaderString


def callback(data):
    print("seq %d stamp %s frame %r: %s" % (
        data.header.seq, data.header.stamp, data.header.frame_id, data.data))
    print(data)
    print("---")


rospy.init_node('listener_header', anonymous=True)
rospy.Subscriber("chatter_header", HeaderString, callback)
print("ready")
rospy.spin()
