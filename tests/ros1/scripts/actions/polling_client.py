#!/usr/bin/env python
import actionlib
import rospy
from actionlib.msg import TestAction, TestGoal
from std_msgs.msg import Int32


def until_active(client):
    while client.get_state() != actionlib.GoalStatus.ACTIVE:
        rospy.sleep(0.02)


if __name__ == '__main__':
    rospy.init_node('polling_client')
    numbers = rospy.Publisher('numbers', Int32, queue_size=10)
    client = actionlib.SimpleActionClient('polling', TestAction)
    client.wait_for_server()
    while not numbers.get_num_connections():
        rospy.sleep(0.05)
    print(client.get_state())

    client.send_goal(TestGoal(3))
    until_active(client)
    for number in (4, 5, 6):
        numbers.publish(number)
    print(client.wait_for_result(rospy.Duration(60)), client.get_state(), client.get_result())

    client.send_goal(TestGoal(3))
    until_active(client)
    client.cancel_goal()
    print(client.wait_for_result(rospy.Duration(60)), client.get_state(), client.get_result())

    other = actionlib.SimpleActionClient('polling', TestAction)
    other.wait_for_server()
    client.send_goal(TestGoal(3))
    until_active(client)
    other.send_goal(TestGoal(1))
    print(client.wait_for_result(rospy.Duration(60)), client.get_state())
    print(client.get_goal_status_text())
    until_active(other)
    numbers.publish(7)
    print(other.wait_for_result(rospy.Duration(60)), other.get_state(), other.get_result())
