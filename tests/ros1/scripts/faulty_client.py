#!/usr/bin/env python3
import rospy
from rospy_tutorials.srv import AddTwoInts, AddTwoIntsRequest
from std_srvs.srv import Empty, Trigger

rospy.init_node('faulty_client')


def attempt(name, service, *args, **kwargs):
    try:
        print(name, "->", repr(rospy.ServiceProxy(name, service)(*args, **kwargs)))
    except Exception as e:
        print(name, "->", type(e).__name__, str(e))


for name in ('raises', 'raises_too', 'none', 'wrong', 'too_many', 'as_int', 'as_list'):
    attempt(name, AddTwoInts, 1, 2)
for name in ('as_tuple', 'as_dict', 'as_response'):
    attempt(name, Trigger)
attempt('empty', Empty)
attempt('empty_list', Empty)
attempt('nowhere', Empty)
attempt('as_int', Empty)
attempt('empty', AddTwoInts, 1, 2)
attempt('no name', Empty)
attempt('as_int', AddTwoInts, 1)
attempt('as_int', AddTwoInts, 1, 2, 3)
attempt('as_int', AddTwoInts, a=1)
attempt('as_int', AddTwoInts, c=1)
attempt('as_int', AddTwoInts, "one", 2)
attempt('as_int', AddTwoInts, AddTwoIntsRequest(2 ** 62, 1))
attempt('as_int', AddTwoInts, 2 ** 64, 1)
attempt('as_int', AddTwoInts, AddTwoIntsRequest(), 1)
try:
    rospy.wait_for_service('nowhere', timeout=0.3)
except rospy.ROSException as e:
    print(type(e).__name__, e)
try:
    rospy.wait_for_service('nowhere', timeout=0)
except ValueError as e:
    print(type(e).__name__, e)
proxy = rospy.ServiceProxy('as_int', AddTwoInts, persistent=True)
print(proxy(3, 4).sum, proxy(a=5, b=6).sum)
proxy.close()
print(proxy.resolved_name, proxy.service_class.__name__, proxy.request_class.__name__)
