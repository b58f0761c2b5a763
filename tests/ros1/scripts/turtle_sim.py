#!/usr/bin/env python3
import math

import rospy
from geometry_msgs.msg import Twist
from std_srvs.srv import Empty, EmptyResponse
from turtlesim.msg import Pose
from turtlesim.srv import Spawn, TeleportAbsolute, TeleportAbsoluteResponse


class Turtle(object):
    def __init__(self, name):
        self.pose = Pose(x=5.5, y=5.5)
        self.cmd = Twist()
        self.pub = rospy.Publisher(name + '/pose', Pose, queue_size=1)
        rospy.Subscriber(name + '/cmd_vel', Twist, self.on_cmd)
        rospy.Service(name + '/teleport_absolute', TeleportAbsolute, self.teleport)
        rospy.Service('clear', Empty, lambda req: EmptyResponse())
        rospy.Service('spawn', Spawn, self.spawn)
        self.timer = rospy.Timer(rospy.Duration(0.02), self.update)

    def on_cmd(self, msg):
        self.cmd = msg

    def teleport(self, req):
        self.pose.x, self.pose.y, self.pose.theta = req.x, req.y, req.theta
        return TeleportAbsoluteResponse()

    def spawn(self, req):
        rospy.loginfo('Spawning turtle [%s] at x=[%f], y=[%f]', req.name, req.x, req.y)
        return req.name

    def update(self, event):
        dt = 0.1
        self.pose.x += self.cmd.linear.x * dt * math.cos(self.pose.theta)
        self.pose.y += self.cmd.linear.x * dt * math.sin(self.pose.theta)
        self.pose.theta += self.cmd.angular.z * dt
        self.pub.publish(self.pose)


if __name__ == '__main__':
    rospy.init_node('turtlesim')
    turtle = Turtle('turtle1')
    print('ready')
    rospy.spin()
