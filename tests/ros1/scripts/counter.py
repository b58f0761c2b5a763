#!/usr/bin/env python3
import rospy

if __name__ == '__main__':
    rospy.init_node('counter')
    rospy.on_shutdown(lambda: print('hook', rospy.is_shutdown()))
    rate = rospy.Rate(5)
    print('ready')
    while not rospy.is_shutdown():
        rate.sleep()
    print('after the loop', rospy.is_shutdown())
