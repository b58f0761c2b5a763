#!/usr/bin/env python3
import rospy
from rospy_tutorials.srv import AddTwoInts
from std_msgs.msg import String

rospy.init_node('connection_header_client')
pub = rospy.Publisher('chatter', String, queue_size=10, headers={'cookies': 'oreo'}, latch=True)
pub.publish("with a header")
while pub.get_num_connections() == 0:
    rospy.sleep(0.02)
rospy.sleep(1)  # The server says first what it heard.
rospy.wait_for_service('add_two_ints')
add = rospy.ServiceProxy('add_two_ints', AddTwoInts, headers={'cookies': 'peanut butter'})
response = add(1, 2)
print(response.sum, sorted(response._connection_header.items()))
