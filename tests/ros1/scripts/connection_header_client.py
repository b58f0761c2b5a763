#!/usr/bin/env python3
import rospy
from rospy_tutorials.srv import AddTwoInts
from std_msgs.msg import String

rospy.init_node('connection_header_client')
pub = rospy.Publisher('chatter', String, queue_size=10, headers={'cookies': 'oreo'}, latch=True)
pub.publish("with a header")
rospy.sleep(1)
rospy.wait_for_service('add_two_ints')
add = rospy.ServiceProxy('add_two_ints', AddTwoInts, headers={'cookies': 'peanut butter'})
print(add(1, 2).sum)
