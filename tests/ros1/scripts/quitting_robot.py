#!/usr/bin/env python3
import sys

import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Empty


class Robot(object):
    def __init__(self):
        self.cmd_vel_pub = rospy.Publisher('/cmd_vel', Twist, queue_size=10)
        self.ctrl_c = False
        rospy.on_shutdown(self.shutdownhook)
        rospy.on_shutdown(lambda: print('second hook', rospy.is_shutdown()))
        rospy.Subscriber('quit', Empty, self.on_quit)

    def shutdownhook(self):
        self.cmd_vel_pub.publish(Twist())
        rospy.loginfo("shutdown time!")
        rospy.set_param('~ended', True)
        self.ctrl_c = True

    def on_quit(self, msg):
        print('quit')
        rospy.signal_shutdown("callback said so")

    def __del__(self):
        self.cmd_vel_pub.publish(Twist())

    def run(self):
        r = rospy.Rate(20)
        try:
            while not self.ctrl_c:
                self.cmd_vel_pub.publish(Twist())
                quitter.publish()
                r.sleep()
        except rospy.ROSInterruptException:
            pass


rospy.init_node('quitting_robot')
quitter = rospy.Publisher('quit', Empty, queue_size=1)
robot = Robot()
while quitter.get_num_connections() == 0:
    rospy.sleep(0.02)
robot.run()
rospy.spin()
print('end', rospy.is_shutdown(), rospy.get_param('~ended'))
robot.cmd_vel_pub.publish(Twist())
rospy.signal_shutdown('again')
sys.exit(3)
