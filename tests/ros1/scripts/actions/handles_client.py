#!/usr/bin/env python
import sys
import threading

import actionlib
import rospy
from actionlib import CommState, GoalStatus, TerminalState
from actionlib.msg import TwoIntsAction, TwoIntsGoal


class Follower:
    def __init__(self, name):
        self.name = name
        self.states = []
        self.done = threading.Event()

    def transition(self, handle):
        self.states.append(CommState.to_string(handle.get_comm_state()))
        if handle.get_comm_state() == CommState.DONE:
            self.done.set()

    def show(self, handle):
        print('%s done: %s' % (self.name, self.done.wait(60)))
        print(self.states[-2:])
        print(TerminalState.to_string(handle.get_terminal_state()))
        print(GoalStatus.to_string(handle.get_goal_status()), handle.get_goal_status_text())
        print(handle.get_result())
        sys.stdout.flush()


def until(state, *handles):
    while not all(handle.get_comm_state() == state for handle in handles):
        rospy.sleep(0.02)


if __name__ == '__main__':
    rospy.init_node('handles_client')
    client = actionlib.ActionClient('handles', TwoIntsAction)
    print(client.wait_for_server(rospy.Duration(60)))
    for a in (1, 2, 3):
        follower = Follower('goal %d' % a)
        handle = client.send_goal(TwoIntsGoal(a, 2), follower.transition)
        follower.show(handle)

    waiting = Follower('waiting')
    begun = Follower('begun')
    first = client.send_goal(TwoIntsGoal(4, 0), waiting.transition)
    second = client.send_goal(TwoIntsGoal(5, 0), begun.transition)
    until(CommState.PENDING, first)
    until(CommState.ACTIVE, second)
    print(first == second, first != second, len({first, second}))
    print(CommState.to_string(first.get_comm_state()), CommState.to_string(second.get_comm_state()))
    first.cancel()
    waiting.show(first)
    client.cancel_all_goals()
    begun.show(second)

    early = [client.send_goal(TwoIntsGoal(number, 0)) for number in (6, 7)]
    until(CommState.ACTIVE, *early)
    client.cancel_goals_at_and_before_time(rospy.Time.now())
    until(CommState.DONE, *early)
    print([GoalStatus.to_string(handle.get_terminal_state()) for handle in early])
