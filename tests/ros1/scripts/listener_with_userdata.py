#!/usr/bin/env python3
import rospy
from std_msgs.msg import String


def callback(data, args):
    name, number = args
    rospy.loginfo("%s %d: I heard %s", name, number, data.data)


def main():
    rospy.init_node('listener_with_userdata', anonymous=True)
    rospy.Subscriber("chatter", String, callback, ("listener-userdata", 1))
    rospy.Subscriber("chatter", String, callback, callback_args=("another", 2))
    print("ready")
    rospy.spin()


if __name__ == '__main__':
    main()
