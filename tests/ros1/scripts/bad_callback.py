#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32, String


heard = []


def callback(data):
    heard.append(data.data)
    raise KeyError("in the callback")


def on_number(data):
    print(data.data)
    heard.append(data.data)


def wait_for(count):
    while len(heard) < count:
        rospy.sleep(0.02)


rospy.init_node('bad_callback')
rospy.Subscriber('chatter', String, callback)
pub = rospy.Publisher('chatter', String, queue_size=1)
subscriber = rospy.Subscriber('numbers', Int32, on_number, queue_size=10)
numbers = rospy.Publisher('numbers', Int32, queue_size=10)
while pub.get_num_connections() == 0 or numbers.get_num_connections() == 0:
    rospy.sleep(0.02)
pub.publish("x")
wait_for(1)
for number in range(3):
    numbers.publish(number)
wait_for(4)
subscriber.unregister()
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
