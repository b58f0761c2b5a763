#!/usr/bin/env python3
"""A server whose handlers fail in all ways, and answer in all forms."""
import rospy
from rospy_tutorials.srv import AddTwoInts, AddTwoIntsResponse
from std_srvs.srv import Empty, EmptyResponse, Trigger, TriggerResponse


def raises(req):
    raise ValueError("no sum today")


def raises_service_exception(req):
    raise rospy.ServiceException("told so")


rospy.init_node('faulty_server')
rospy.Service('raises', AddTwoInts, raises)
rospy.Service('raises_too', AddTwoInts, raises_service_exception)
rospy.Service('none', AddTwoInts, lambda req: None)
rospy.Service('wrong', AddTwoInts, lambda req: AddTwoIntsResponse("three"))
rospy.Service('too_many', AddTwoInts, lambda req: [1, 2])
rospy.Service('as_int', AddTwoInts, lambda req: req.a + req.b)
rospy.Service('as_list', AddTwoInts, lambda req: [req.a + req.b])
rospy.Service('as_tuple', Trigger, lambda req: (True, "a tuple"))
rospy.Service('as_dict', Trigger, lambda req: {"success": True, "message": "a dict"})
rospy.Service('as_response', Trigger, lambda req: TriggerResponse(message="a response"))
rospy.Service('empty', Empty, lambda req: EmptyResponse())
rospy.Service('empty_list', Empty, lambda req: [])
try:
    rospy.Service('empty', Empty, lambda req: EmptyResponse())
except rospy.ServiceException as e:
    print("ServiceException: %s" % e)
print("ready")
rospy.spin()
