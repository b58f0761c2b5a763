#!/usr/bin/env python
import actionlib
import rospy
from actionlib.msg import TestAction, TestGoal
from std_msgs.msg import Int32

if __name__ == '__main__':
    rospy.init_node('polling_client')
    numbers = rospy.Publisher('numbers', Int32, queue_size=10)
    client = actionlib.SimpleActionClient('polling', TestAction)
    client.wait_for_server()
    while not numbers.get_num_connections():
        rospy.sleep(0.05)
    print(client.get_state())

    client.send_goal(TestGoal(3))
    for number in (4, 5, 6):
        rospy.sleep(0.2)
        numbers.publish(number)
    print(client.wait_for_result(rospy.Duration(5)), client.get_state(), client.get_result())

    client.send_goal(TestGoal(3))
    rospy.sleep(0.2)
    client.cancel_goal()
    print(client.wait_for_result(rospy.Duration(5)), client.get_state(), client.get_result())

    other = actionlib.SimpleActionClient('polling', TestAction)
    other.wait_for_server()
    client.send_goal(TestGoal(3))
    rospy.sleep(0.2)
    other.send_goal(TestGoal(1))
    print(client.wait_for_result(rospy.Duration(5)), client.get_state())
    print(client.get_goal_status_text())
    rospy.sleep(0.2)
    numbers.publish(7)
    print(other.wait_for_result(rospy.Duration(5)), other.get_state(), other.get_result())
