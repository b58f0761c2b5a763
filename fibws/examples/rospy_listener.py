#!/usr/bin/env python3
"""Logs the messages on the topic chatter: rosrun rospy_tutorials listener."""

import rospy
from std_msgs.msg import String


def callback(message: String) -> None:
    """Log a message."""
    rospy.loginfo("%sI heard %s", rospy.get_caller_id(), message.data)


def listen() -> None:
    """Subscribe until the node ends."""
    rospy.init_node("listener", anonymous=True)
    rospy.Subscriber("chatter", String, callback)
    rospy.spin()


if __name__ == "__main__":
    listen()
