#!/usr/bin/env python
import actionlib
import rospy
from actionlib_tutorials.msg import FibonacciAction, FibonacciFeedback, FibonacciResult


class FibonacciServer:
    def __init__(self, name):
        self.name = name
        self.server = actionlib.SimpleActionServer(
            name, FibonacciAction, execute_cb=self.execute, auto_start=False
        )
        self.server.start()

    def execute(self, goal):
        rate = rospy.Rate(20)
        feedback = FibonacciFeedback(sequence=[0, 1])
        rospy.loginfo('%s: order %i', self.name, goal.order)
        for i in range(1, goal.order):
            if self.server.is_preempt_requested():
                rospy.loginfo('%s: preempted', self.name)
                self.server.set_preempted()
                return
            feedback.sequence.append(feedback.sequence[i] + feedback.sequence[i - 1])
            self.server.publish_feedback(feedback)
            rate.sleep()
        self.server.set_succeeded(FibonacciResult(feedback.sequence))
        rospy.loginfo('%s: succeeded', self.name)


if __name__ == '__main__':
    rospy.init_node('fibonacci')
    server = FibonacciServer(rospy.get_name())
    rospy.loginfo('ready')
    rospy.spin()
