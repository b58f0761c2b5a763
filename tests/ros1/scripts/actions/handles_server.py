#!/usr/bin/env python
"""A server that decides on each goal by its handle: of TwoInts, a says what it does."""
import actionlib
import rospy
from actionlib.msg import TwoIntsAction, TwoIntsResult


class HandlesServer:
    def __init__(self):
        self.handles = {}
        self.server = actionlib.ActionServer(
            'handles', TwoIntsAction, self.goal, self.cancel, auto_start=False
        )
        self.server.start()

    def goal(self, handle):
        goal = handle.get_goal()
        rospy.loginfo('goal %d %d', goal.a, goal.b)
        self.handles[goal.a] = handle
        if goal.a == 1:
            handle.set_accepted('accepted')
            handle.set_succeeded(TwoIntsResult(goal.a + goal.b), 'added')
        elif goal.a == 2:
            handle.set_rejected(None, 'never')
            handle.set_accepted()
        elif goal.a == 3:
            handle.set_succeeded()
            handle.set_aborted()
            handle.set_accepted()
            handle.set_rejected()
            handle.set_aborted(TwoIntsResult(3), 'given up')
            handle.set_canceled()
        elif goal.a == 4:
            pass
        else:
            handle.set_accepted()

    def cancel(self, handle):
        number = handle.get_goal().a
        rospy.loginfo('cancel %d in state %d', number, handle.get_goal_status().status)
        assert handle == self.handles[number] and not handle != self.handles[number]
        assert handle.get_goal_id().id.startswith('/handles_client-')
        handle.set_canceled(TwoIntsResult(number), 'canceled')


if __name__ == '__main__':
    rospy.init_node('handles_server')
    server = HandlesServer()
    rospy.loginfo('ready')
    rospy.spin()
