#!/usr/bin/env python
"""A server that accepts goals in a callback, as the averaging tutorial does."""
import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestResult
from std_msgs.msg import Int32


class PollingServer:
    def __init__(self):
        self.server = actionlib.SimpleActionServer('polling', TestAction, auto_start=False)
        self.server.register_goal_callback(self.goal)
        self.server.register_preempt_callback(self.preempt)
        self.left = 0
        self.server.start()
        rospy.Subscriber('numbers', Int32, self.number)

    def goal(self):
        self.left = self.server.accept_new_goal().goal
        rospy.loginfo('accepted %d', self.left)

    def preempt(self):
        rospy.loginfo('preempted, new: %s', self.server.is_new_goal_available())
        if not self.server.is_new_goal_available():
            self.server.set_preempted()

    def number(self, message):
        if not self.server.is_active():
            return
        self.left -= 1
        self.server.publish_feedback(TestFeedback(self.left))
        if self.left == 0:
            self.server.set_succeeded(TestResult(message.data))


if __name__ == '__main__':
    rospy.init_node('polling_server')
    server = PollingServer()
    server.server.accept_new_goal()
    rospy.loginfo('ready')
    rospy.spin()
