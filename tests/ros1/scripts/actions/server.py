#!/usr/bin/env python
import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestResult


class TestServer:
    def __init__(self, name):
        self.server = actionlib.SimpleActionServer(
            name, TestAction, execute_cb=self.execute, auto_start=False
        )
        self.server.register_preempt_callback(self.preempt)
        self.server.start()

    def preempt(self):
        rospy.loginfo('preempt callback')

    def execute(self, goal):
        rospy.loginfo('goal %d' % goal.goal)
        if goal.goal < 0:
            self.server.set_aborted(TestResult(-1), 'negative goal')
        elif goal.goal == 100:
            raise ValueError('one hundred')
        elif goal.goal == 101:
            return
        elif goal.goal == 102:
            self.server.set_succeeded()
            self.server.set_succeeded()
        else:
            self.count(goal.goal)

    def count(self, goal):
        rate = rospy.Rate(20)
        for number in range(goal):
            if self.server.is_preempt_requested() or rospy.is_shutdown():
                rospy.loginfo('preempted')
                self.server.set_preempted(TestResult(7), 'no more')
                return
            self.server.publish_feedback(TestFeedback(number))
            rate.sleep()
        rospy.sleep(0.5)  # The result must not overtake the feedback, which goes by another topic.
        self.server.set_succeeded(TestResult(goal), 'counted')


if __name__ == '__main__':
    rospy.init_node('test_server')
    server = TestServer(rospy.get_name())
    rospy.loginfo('ready')
    rospy.spin()
