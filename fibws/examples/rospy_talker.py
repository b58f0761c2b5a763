#!/usr/bin/env python3
"""Publishes a text on the topic chatter, ten times a second: rosrun rospy_tutorials talker."""

import rospy
from std_msgs.msg import String


def talk() -> None:
    """Publish until the node ends."""
    chatter = rospy.Publisher("chatter", String, queue_size=10)
    rospy.init_node("talker", anonymous=True)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        greeting = f"hello world {rospy.get_time()}"
        rospy.loginfo(greeting)
        chatter.publish(greeting)
        rate.sleep()


if __name__ == "__main__":
    try:
        talk()
    except rospy.ROSInterruptException:
        pass
