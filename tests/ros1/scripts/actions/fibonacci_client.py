#!/usr/bin/env python
import sys
import threading

import actionlib
import rospy
from actionlib_tutorials.msg import FibonacciAction, FibonacciGoal


heard = threading.Event()


def feedback(message):
    # In one piece: another thread prints, too.
    sys.stdout.write('feedback: %s\n' % list(message.sequence))
    heard.set()


if __name__ == '__main__':
    rospy.init_node('fibonacci_client')
    client = actionlib.SimpleActionClient('fibonacci', FibonacciAction)
    client.wait_for_server()
    client.send_goal(FibonacciGoal(order=int(sys.argv[1])), feedback_cb=feedback)
    if not client.wait_for_result(rospy.Duration.from_sec(float(sys.argv[2]))):
        client.cancel_goal()
        client.wait_for_result()
    result = client.get_result()
    if result.sequence:
        # Feedback and result are topics of their own: either may come first.
        heard.wait(60)
    print(client.get_state(), client.get_goal_status_text())
    print(list(result.sequence))
