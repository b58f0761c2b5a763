#!/usr/bin/env python3
import threading

import rospy
from std_msgs.msg import String
from std_srvs.srv import Trigger, TriggerResponse

rospy.init_node('nested_services')


def inner(req):
    rospy.sleep(0.05)
    return TriggerResponse(True, 'inner')


def outer(req):
    return True, 'outer of ' + rospy.ServiceProxy('inner', Trigger)().message


inner_service = rospy.Service('inner', Trigger, inner)
outer_service = rospy.Service('outer', Trigger, outer)
call = rospy.ServiceProxy('outer', Trigger)
done = threading.Event()


def callback(msg):
    print(msg.data, call().message)
    print(rospy.wait_for_message('again', String, 60).data)
    done.set()


rospy.Subscriber('go', String, callback)
go = rospy.Publisher('go', String, queue_size=1)
again = rospy.Publisher('again', String, queue_size=1, latch=True)
again.publish('again!')
while go.get_num_connections() == 0:
    rospy.sleep(0.01)
go.publish('go')
print(done.wait(60))
try:
    rospy.Service('inner', Trigger, inner)
except rospy.ServiceException as e:
    print(e)
inner_service.shutdown('bye')
rospy.sleep(0.1)
try:
    call()
except rospy.ServiceException as e:
    print(e)
inner_service = rospy.Service('inner', Trigger, inner)
answers = []
threads = [threading.Thread(target=lambda: answers.append(call().message)) for _ in range(8)]
for t in threads:
    t.start()
for t in threads:
    t.join()
print(len(answers), set(answers))
