#!/usr/bin/env python
import sys
import threading

import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestGoal, TestResult
from actionlib_msgs.msg import GoalStatus


class Client(actionlib.SimpleActionClient):
    """The real one loses a goal's first transition if that comes before send_goal() returns."""

    sending = threading.RLock()

    def send_goal(self, *args, **kwargs):
        with self.sending:
            actionlib.SimpleActionClient.send_goal(self, *args, **kwargs)

    def _handle_transition(self, goal):
        with self.sending:
            actionlib.SimpleActionClient._handle_transition(self, goal)


def done(state, result):
    print('done: %s %s' % (GoalStatus.to_string(state), result))


def active():
    begun.append('active')


def feedback(message):
    assert isinstance(message, TestFeedback)
    heard.append(message.feedback)


def until_it_counts(client, **callbacks):
    counted = []
    client.send_goal(TestGoal(1000), active_cb=active, feedback_cb=counted.append, **callbacks)
    while not (begun and counted):
        rospy.sleep(0.05)


def show(client, finished):
    # Each topic has its thread: what one says before another is different each time.
    print('%s, feedback %s' % (begun, heard))
    del begun[:], heard[:]
    print('finished: %s' % finished)
    print('state: %d %s' % (client.get_state(), actionlib.GoalStatus.to_string(client.get_state())))
    print('text: %r' % client.get_goal_status_text())
    print('result: %s' % client.get_result())
    sys.stdout.flush()


begun = []
heard = []

if __name__ == '__main__':
    rospy.init_node('test_client')
    nobody = Client('nobody', TestAction)
    print(nobody.wait_for_server(rospy.Duration(0.3)))
    print(nobody.wait_for_result(), nobody.get_result(), nobody.get_state())
    print(nobody.get_goal_status_text())
    nobody.cancel_goal()

    client = Client('test_server', TestAction)
    print(client.wait_for_server())

    for number in (3, -5, 100, 101, 102):
        print('goal %d' % number)
        client.send_goal(TestGoal(goal=number), done, active, feedback)
        show(client, client.wait_for_result(rospy.Duration.from_sec(60.0)))

    print('too long')
    until_it_counts(client, done_cb=done)
    show(client, client.wait_for_result(rospy.Duration(0.5)))
    client.cancel_goal()
    show(client, client.wait_for_result())
    client.cancel_goal()

    print('and wait')
    state = client.send_goal_and_wait(TestGoal(2))
    print(state == GoalStatus.SUCCEEDED)
    state = client.send_goal_and_wait(TestGoal(1000), rospy.Duration(0.5), rospy.Duration(60))
    show(client, state)

    print('a later goal')
    other = Client('test_server', TestAction)
    other.wait_for_server()
    until_it_counts(client)
    other.send_goal(TestGoal(1))
    show(client, client.wait_for_result())
    show(other, other.wait_for_result())

    print('all of them')
    until_it_counts(client)
    other.cancel_all_goals()
    show(client, client.wait_for_result())

    client.stop_tracking_goal()
    show(client, client.wait_for_result())
    try:
        actionlib.SimpleActionClient('test_server', TestGoal)
    except actionlib.action_client.ActionException as error:
        print(str(error).partition(';')[0])
