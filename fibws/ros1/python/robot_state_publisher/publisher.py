"""Publishes the frames of a robot from the positions of its joints.

Joints that do not move are published once, on /tf_static. Source: robot_state_publisher of ROS
Noetic.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

import rospy
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster

from fibws.ros1.errors import UrdfError
from fibws.ros1.urdf import Joint, RobotModel, read_urdf
from fibws.tf.transform import Transform, with_sign_of_matrix

DESCRIPTION = "robot_description"
FREQUENCY = 50.0


def load_model() -> RobotModel:
    """Return the robot in the parameter ``robot_description``; end the program without one."""
    name = rospy.search_param(DESCRIPTION)
    if name is None:
        rospy.logfatal("parameter %s not found: set it to the robot's URDF", DESCRIPTION)
        sys.exit(1)
    try:
        return read_urdf(str(rospy.get_param(name)), rospy.resolve_name(name))
    except UrdfError as error:
        rospy.logfatal("%s", error)
        sys.exit(1)


class StatePublisher:
    """Publishes the frames of a robot.

    Args:
        model: the robot.
    """

    def __init__(self, model: RobotModel) -> None:
        self._model = model
        prefix = rospy.search_param("tf_prefix")
        self._prefix = str(rospy.get_param(prefix)).strip("/") if prefix is not None else ""
        self._period = 1.0 / max(0.001, float(rospy.get_param("~publish_frequency", FREQUENCY)))
        self._ignores_stamps = bool(rospy.get_param("~ignore_timestamp", False))
        self._uses_static = bool(rospy.get_param("~use_tf_static", True))
        self._static = StaticTransformBroadcaster()
        self._moving = TransformBroadcaster()
        self._published: dict[str, float] = {}
        """The times of the last transforms, by the joints' names."""
        self._last = 0.0
        fixed = [each for each in model.joints.values() if not each.moves]
        self._fixed = [self._message(each, each.origin) for each in fixed]

    def start(self) -> None:
        """Publish the fixed joints, and follow the others."""
        if self._uses_static:
            self._publish_fixed(None)
        else:
            rospy.Timer(rospy.Duration.from_sec(self._period), self._publish_fixed)
        rospy.Subscriber("joint_states", JointState, self._follow, queue_size=1)

    def _publish_fixed(self, event: Any) -> None:
        if not self._fixed:
            return
        now = rospy.Time.now()
        for message in self._fixed:
            # Those that are sent again and again are for the near future, as in ROS.
            message.header.stamp = now if event is None else now + rospy.Duration.from_sec(0.5)
        broadcaster = self._static if event is None else self._moving
        broadcaster.sendTransform(self._fixed)

    def _follow(self, state: Any) -> None:
        if len(state.name) != len(state.position):
            rospy.logerr_throttle(
                30,
                f"ignored joint states with {len(state.name)} names and {len(state.position)} "
                "positions",
            )
            return
        stamp = state.header.stamp
        now = rospy.get_time()
        if now < self._last:  # Simulated time has started again.
            self._published.clear()
        self._last = now
        joints = [name for name in state.name if name in self._model.joints]
        oldest = min((self._published.get(name, 0.0) for name in joints), default=0.0)
        if not self._ignores_stamps and stamp.to_sec() < oldest + self._period:
            return
        known = dict(zip(state.name, state.position, strict=True))
        self._publish(self._model.positions(known), stamp)
        self._published.update(dict.fromkeys(joints, stamp.to_sec()))

    def _publish(self, positions: Mapping[str, float], stamp: rospy.Time) -> None:
        messages = []
        for name, position in positions.items():
            joint = self._model.joints[name]
            message = self._message(joint, joint.at(position))
            message.header.stamp = stamp
            messages.append(message)
        if messages:
            self._moving.sendTransform(messages)

    def _message(self, joint: Joint, transform: Transform) -> TransformStamped:
        message = TransformStamped()
        message.header.frame_id = self._frame(joint.parent)
        message.child_frame_id = self._frame(joint.child)
        translation, rotation = message.transform.translation, message.transform.rotation
        translation.x, translation.y, translation.z = transform.translation
        numbers = with_sign_of_matrix(transform.rotation)
        rotation.x, rotation.y, rotation.z, rotation.w = numbers
        return message

    def _frame(self, link: str) -> str:
        return f"{self._prefix}/{link}" if self._prefix else link


def main() -> None:
    """Run the program until the node ends."""
    rospy.init_node("robot_state_publisher")
    StatePublisher(load_model()).start()
    rospy.spin()


if __name__ == "__main__":
    main()
