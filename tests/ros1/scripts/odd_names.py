#!/usr/bin/env python3
"""Uses names of which ROS only warns."""

import warnings

import rospy
from std_msgs.msg import String
from std_srvs.srv import Trigger, TriggerResponse

warnings.simplefilter("ignore")
rospy.init_node("my-node")
print(rospy.get_name(), rospy.resolve_name("~a-b"))


def meet(name):
    got = []
    subscriber = rospy.Subscriber(name, String, lambda message: got.append(message.data))
    publisher = rospy.Publisher(name, String, queue_size=1)
    while not publisher.get_num_connections() or not subscriber.get_num_connections():
        rospy.sleep(0.02)
    while not got:
        publisher.publish(name)
        rospy.sleep(0.02)
    print("topic", publisher.resolved_name, subscriber.resolved_name, got[0])


for name in "cam-1/data", "2nd", "~odd-1", "/1/2", "\u00fc":
    meet(name)
for name in "cam-1/trigger", "2/3", "~start-1":
    service = rospy.Service(name, Trigger, lambda request: TriggerResponse(True, "ok"))
    rospy.wait_for_service(name)
    print("service", service.resolved_name, rospy.ServiceProxy(name, Trigger)().message)
rospy.set_param("cam-1/p-q", 3)
rospy.set_param("~a-b", 4)
print("parameters", rospy.get_param("/cam-1"), rospy.get_param("/my-node"))
