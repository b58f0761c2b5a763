"""Publishes positions of all joints of a robot, from others' messages and from parameters.

Source: joint_state_publisher of ROS Noetic, without its window.
"""

from __future__ import annotations

from math import isfinite
from typing import Any

import rospy
from robot_state_publisher.publisher import load_model
from sensor_msgs.msg import JointState

from fibws.ros1.urdf import Joint, RobotModel

RATE = 10.0


class JointPublisher:
    """Publishes ``joint_states``.

    Args:
        model: the robot.
    """

    def __init__(self, model: RobotModel) -> None:
        zeros: dict[str, float] = rospy.get_param("~zeros", {})
        dependent: dict[str, dict[str, Any]] = rospy.get_param("~dependent_joints", {})
        uses_mimic = rospy.get_param("~use_mimic_tags", True)
        self._followers = {
            name: (each["parent"], float(each.get("factor", 1)), float(each.get("offset", 0)))
            for name, each in dependent.items()
        }
        self._positions: dict[str, float] = {}
        for name, joint in model.joints.items():
            if not joint.moves:
                continue
            if joint.mimic is not None and uses_mimic and name not in self._followers:
                mimic = joint.mimic
                self._followers[name] = (mimic.joint, mimic.multiplier, mimic.offset)
            self._positions[name] = float(zeros.get(name, middle_of(joint)))
        self._publisher = rospy.Publisher("joint_states", JointState, queue_size=5)
        for source in rospy.get_param("~source_list", []):
            rospy.Subscriber(source, JointState, self._take)

    def run(self) -> None:
        """Publish until the node ends."""
        rate = rospy.Rate(float(rospy.get_param("~rate", RATE)))
        while not rospy.is_shutdown():
            message = JointState()
            message.header.stamp = rospy.Time.now()
            message.name = list(self._positions)
            message.position = [self._position(name, set()) for name in message.name]
            self._publisher.publish(message)
            rate.sleep()

    def _take(self, message: Any) -> None:
        for name, position in zip(message.name, message.position, strict=False):
            if name in self._positions and isfinite(position):
                self._positions[name] = position

    def _position(self, name: str, seen: set[str]) -> float:
        """Return a joint's position; a joint that follows itself by way of others stays."""
        if name not in self._followers or name in seen:
            return self._positions.get(name, 0.0)
        parent, factor, offset = self._followers[name]
        return factor * self._position(parent, seen | {name}) + offset


def middle_of(joint: Joint) -> float:
    """Return 0, or the middle of the limits if 0 is outside."""
    if joint.lower <= 0 <= joint.upper:
        return 0.0
    return (joint.lower + joint.upper) / 2


def main() -> None:
    """Run the program until the node ends."""
    rospy.init_node("joint_state_publisher")
    try:
        JointPublisher(load_model()).run()
    except rospy.ROSInterruptException:
        pass


if __name__ == "__main__":
    main()
