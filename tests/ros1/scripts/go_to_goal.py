#!/usr/bin/env python3
from math import atan2, sqrt

import rospy
from geometry_msgs.msg import Twist
from std_srvs.srv import Empty
from turtlesim.msg import Pose
from turtlesim.srv import Spawn, TeleportAbsolute


class TurtleBot:
    def __init__(self):
        rospy.init_node('turtlebot_controller', anonymous=True)
        self.velocity_publisher = rospy.Publisher('/turtle1/cmd_vel', Twist, queue_size=10)
        self.pose_subscriber = rospy.Subscriber('/turtle1/pose', Pose, self.update_pose)
        self.pose = Pose()
        self.rate = rospy.Rate(50)

    def update_pose(self, data):
        self.pose = data
        self.pose.x = round(self.pose.x, 4)
        self.pose.y = round(self.pose.y, 4)

    def distance(self, goal):
        return sqrt((goal.x - self.pose.x) ** 2 + (goal.y - self.pose.y) ** 2)

    def prepare(self):
        rospy.wait_for_service('/turtle1/teleport_absolute')
        print(repr(rospy.ServiceProxy('/turtle1/teleport_absolute', TeleportAbsolute)(5, 5, 0.5)))
        print(rospy.ServiceProxy('spawn', Spawn)(4, 2, 0, 'turtle2'))
        print(type(rospy.ServiceProxy('/clear', Empty)()).__name__)
        rospy.wait_for_message('/turtle1/pose', Pose, timeout=60)

    def move2goal(self):
        goal = Pose()
        goal.x = 6
        goal.y = 5.5
        vel = Twist()
        while self.distance(goal) >= 0.3:
            vel.linear.x = 1.5 * self.distance(goal)
            vel.angular.z = 6 * (atan2(goal.y - self.pose.y, goal.x - self.pose.x) - self.pose.theta)
            self.velocity_publisher.publish(vel)
            self.rate.sleep()
        vel.linear.x = 0
        vel.angular.z = 0
        self.velocity_publisher.publish(vel)
        print("arrived")


if __name__ == '__main__':
    try:
        x = TurtleBot()
        x.prepare()
        x.move2goal()
    except rospy.ROSInterruptException:
        pass
