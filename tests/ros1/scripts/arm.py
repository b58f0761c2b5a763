#!/usr/bin/env python3
import copy

import rospy
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint


def get_param(name, value=None):
    private = "~%s" % name
    if rospy.has_param(private):
        return rospy.get_param(private)
    elif rospy.has_param(name):
        return rospy.get_param(name)
    else:
        return value


class Arm():
    def __init__(self):
        self.joints = get_param('joints', ['elbow'])
        self.zeros = get_param('zeros', {})
        self.position = dict((j, self.zeros.get(j, 0)) for j in self.joints)
        print(self.joints, self.zeros, get_param('use_gui', False))
        self.pub = rospy.Publisher('joint_states', JointState, queue_size=5)
        rospy.Subscriber('override', JointState, self.override)

    def override(self, msg):
        for i, name in enumerate(msg.name):
            if name in self.position:
                self.position[name] = msg.position[i]

    def publish(self):
        msg = JointState()
        msg.header.stamp = rospy.Time.now()
        for name, position in sorted(self.position.items()):
            msg.name.append(str(name))
            msg.position.append(position)
        msg.velocity = [0.0] * len(msg.name)
        self.pub.publish(msg)


rospy.init_node('arm')
rospy.set_param('joints', ['shoulder', 'elbow', 'wrist'])
rospy.set_param('~zeros', {'elbow': 0.5})
arm = Arm()
pub = rospy.Publisher('override', JointState, queue_size=1, latch=True)
pub.publish(JointState(name=['wrist', 'knee'], position=(0.25, 1)))
got = []
rospy.Subscriber('joint_states', JointState, got.append)
while arm.pub.get_num_connections() == 0 or arm.position['wrist'] == 0:
    rospy.sleep(0.02)
r = rospy.Rate(50)
while len(got) < 3:
    arm.publish()
    r.sleep()
print(got[-1].name, got[-1].position, got[-1].velocity, got[-1].effort)

trajectory = JointTrajectory(joint_names=['shoulder', 'elbow'])
p = JointTrajectoryPoint()
for i in range(3):
    p.positions = [i * 0.1, -i]
    p.velocities = [0] * 2
    p.time_from_start = rospy.Duration.from_sec(i * 0.5)
    trajectory.points.append(copy.deepcopy(p))
command = rospy.Publisher('arm_controller/command', JointTrajectory, queue_size=1, latch=True)
command.publish(trajectory)
back = rospy.wait_for_message('arm_controller/command', JointTrajectory, timeout=60)
print([(p.positions, p.time_from_start.to_sec()) for p in back.points], back.joint_names)
print(back.points[1])
rospy.delete_param('joints')
for forget in (rospy.delete_param, rospy.get_param):
    try:
        forget('joints')
    except KeyError as e:
        print("KeyError", e)
