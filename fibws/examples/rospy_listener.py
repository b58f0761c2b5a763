#!/usr/bin/env python3
"""Prints what it hears on the topic chatter: rosrun rospy_tutorials listener."""

import rospy
from std_msgs.msg import String


def hear(message: String) -> None:
    """Log a message."""
    rospy.loginfo("%sI heard %s", rospy.get_caller_id(), message.data)


def listen() -> None:
    """Listen until the node ends."""
    rospy.init_node("listener", anonymous=True)
    rospy.Subscriber("chatter", String, hear)
    rospy.spin()


if __name__ == "__main__":
    listen()
