#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32, String


def callback(data):
    raise KeyError("in the callback")


rospy.init_node('bad_callback')
rospy.Subscriber('chatter', String, callback)
pub = rospy.Publisher('chatter', String, queue_size=1)
heard = rospy.Subscriber('numbers', Int32, lambda m: print(m.data), queue_size=10)
numbers = rospy.Publisher('numbers', Int32, queue_size=10)
while pub.get_num_connections() == 0 or numbers.get_num_connections() == 0:
    rospy.sleep(0.02)
pub.publish("x")
rospy.sleep(0.3)
for number in range(3):
    numbers.publish(number)
rospy.sleep(0.3)
heard.unregister()
numbers.publish(99)
rospy.sleep(0.2)
try:
    rospy.wait_for_message('silence', String, timeout=0.2)
except rospy.ROSException as e:
    print(type(e).__name__, e)
for args in (('x', 'String', None), ('x', String, 5), ('x', None, None)):
    try:
        rospy.Subscriber(*args)
        print("ok")
    except Exception as e:
        print(type(e).__name__, e)
