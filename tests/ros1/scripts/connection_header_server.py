#!/usr/bin/env python3
import rospy
from rospy_tutorials.srv import AddTwoInts, AddTwoIntsResponse
from std_msgs.msg import String


def callback(data):
    header = data._connection_header
    print("topic:", header['callerid'], header['topic'], header['type'], header['md5sum'],
          header['latching'], header.get('cookies'), repr(header['message_definition']))


def add_two_ints(req):
    header = req._connection_header
    print("service:", header['callerid'], header['service'], header.get('cookies'))
    return AddTwoIntsResponse(req.a + req.b)


rospy.init_node('connection_header_server')
rospy.Subscriber('chatter', String, callback)
rospy.Service('add_two_ints', AddTwoInts, add_two_ints)
print("ready")
rospy.spin()
