#!/usr/bin/env python3
import rospy
from rospy_tutorials.msg import HeaderString


def talker():
    pub = rospy.Publisher("chatter_header", HeaderString, queue_size=10)
    rospy.init_node('talker_header', anonymous=True)
    while pub.get_num_connections() == 0 and not rospy.is_shutdown():
        rospy.sleep(0.02)
    r = rospy.Rate(20)
    count = 0
    while not rospy.is_shutdown():
        count += 1
        msg = HeaderString(None, "hello world %d" % count)
        pub.publish(msg)
        print("published seq %d frame %r" % (msg.header.seq, msg.header.frame_id))
        r.sleep()


if __name__ == '__main__':
    try:
        talker()
    except rospy.ROSInterruptException:
        pass
