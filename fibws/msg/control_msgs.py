"""The messages of control_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, geometry_msgs, std_msgs, trajectory_msgs

__all__ = [
    "FollowJointTrajectoryAction",
    "FollowJointTrajectoryActionFeedback",
    "FollowJointTrajectoryActionGoal",
    "FollowJointTrajectoryActionResult",
    "FollowJointTrajectoryFeedback",
    "FollowJointTrajectoryGoal",
    "FollowJointTrajectoryResult",
    "GripperCommand",
    "GripperCommandAction",
    "GripperCommandActionFeedback",
    "GripperCommandActionGoal",
    "GripperCommandActionResult",
    "GripperCommandFeedback",
    "GripperCommandGoal",
    "GripperCommandResult",
    "JointControllerState",
    "JointJog",
    "JointTolerance",
    "JointTrajectoryAction",
    "JointTrajectoryActionFeedback",
    "JointTrajectoryActionGoal",
    "JointTrajectoryActionResult",
    "JointTrajectoryControllerState",
    "JointTrajectoryFeedback",
    "JointTrajectoryGoal",
    "JointTrajectoryResult",
    "PidState",
    "PointHeadAction",
    "PointHeadActionFeedback",
    "PointHeadActionGoal",
    "PointHeadActionResult",
    "PointHeadFeedback",
    "PointHeadGoal",
    "PointHeadResult",
    "SingleJointPositionAction",
    "SingleJointPositionActionFeedback",
    "SingleJointPositionActionGoal",
    "SingleJointPositionActionResult",
    "SingleJointPositionFeedback",
    "SingleJointPositionGoal",
    "SingleJointPositionResult",
]


@dataclass(slots=True, eq=False, repr=False)
class JointTolerance(ros.Message):
    """control_msgs/JointTolerance"""

    _type: ClassVar[str] = "control_msgs/JointTolerance"

    name: str = ""
    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryGoal(ros.Message):
    """control_msgs/FollowJointTrajectoryGoal"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryGoal"

    trajectory: trajectory_msgs.JointTrajectory = field(
        default_factory=lambda: trajectory_msgs.JointTrajectory()
    )
    path_tolerance: list[JointTolerance] = field(default_factory=list)
    goal_tolerance: list[JointTolerance] = field(default_factory=list)
    goal_time_tolerance: ros.Duration = field(default_factory=ros.Duration)


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryActionGoal(ros.Message):
    """control_msgs/FollowJointTrajectoryActionGoal"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: FollowJointTrajectoryGoal = field(default_factory=lambda: FollowJointTrajectoryGoal())


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryResult(ros.Message):
    """control_msgs/FollowJointTrajectoryResult"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryResult"
    SUCCESSFUL: ClassVar[int] = 0
    INVALID_GOAL: ClassVar[int] = -1
    INVALID_JOINTS: ClassVar[int] = -2
    OLD_HEADER_TIMESTAMP: ClassVar[int] = -3
    PATH_TOLERANCE_VIOLATED: ClassVar[int] = -4
    GOAL_TOLERANCE_VIOLATED: ClassVar[int] = -5

    error_code: int = 0
    error_string: str = ""


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryActionResult(ros.Message):
    """control_msgs/FollowJointTrajectoryActionResult"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: FollowJointTrajectoryResult = field(
        default_factory=lambda: FollowJointTrajectoryResult()
    )


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryFeedback(ros.Message):
    """control_msgs/FollowJointTrajectoryFeedback"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    joint_names: list[str] = field(default_factory=list)
    desired: trajectory_msgs.JointTrajectoryPoint = field(
        default_factory=lambda: trajectory_msgs.JointTrajectoryPoint()
    )
    actual: trajectory_msgs.JointTrajectoryPoint = field(
        default_factory=lambda: trajectory_msgs.JointTrajectoryPoint()
    )
    error: trajectory_msgs.JointTrajectoryPoint = field(
        default_factory=lambda: trajectory_msgs.JointTrajectoryPoint()
    )


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryActionFeedback(ros.Message):
    """control_msgs/FollowJointTrajectoryActionFeedback"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: FollowJointTrajectoryFeedback = field(
        default_factory=lambda: FollowJointTrajectoryFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class FollowJointTrajectoryAction(ros.Message):
    """control_msgs/FollowJointTrajectoryAction"""

    _type: ClassVar[str] = "control_msgs/FollowJointTrajectoryAction"

    action_goal: FollowJointTrajectoryActionGoal = field(
        default_factory=lambda: FollowJointTrajectoryActionGoal()
    )
    action_result: FollowJointTrajectoryActionResult = field(
        default_factory=lambda: FollowJointTrajectoryActionResult()
    )
    action_feedback: FollowJointTrajectoryActionFeedback = field(
        default_factory=lambda: FollowJointTrajectoryActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class GripperCommand(ros.Message):
    """control_msgs/GripperCommand"""

    _type: ClassVar[str] = "control_msgs/GripperCommand"

    position: float = 0.0
    max_effort: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class GripperCommandGoal(ros.Message):
    """control_msgs/GripperCommandGoal"""

    _type: ClassVar[str] = "control_msgs/GripperCommandGoal"

    command: GripperCommand = field(default_factory=lambda: GripperCommand())


@dataclass(slots=True, eq=False, repr=False)
class GripperCommandActionGoal(ros.Message):
    """control_msgs/GripperCommandActionGoal"""

    _type: ClassVar[str] = "control_msgs/GripperCommandActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: GripperCommandGoal = field(default_factory=lambda: GripperCommandGoal())


@dataclass(slots=True, eq=False, repr=False)
class GripperCommandResult(ros.Message):
    """control_msgs/GripperCommandResult"""

    _type: ClassVar[str] = "control_msgs/GripperCommandResult"

    position: float = 0.0
    effort: float = 0.0
    stalled: bool = False
    reached_goal: bool = False


@dataclass(slots=True, eq=False, repr=False)
class GripperCommandActionResult(ros.Message):
    """control_msgs/GripperCommandActionResult"""

    _type: ClassVar[str] = "control_msgs/GripperCommandActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: GripperCommandResult = field(default_factory=lambda: GripperCommandResult())


@dataclass(slots=True, eq=False, repr=False)
class GripperCommandFeedback(ros.Message):
    """control_msgs/GripperCommandFeedback"""

    _type: ClassVar[str] = "control_msgs/GripperCommandFeedback"

    position: float = 0.0
    effort: float = 0.0
    stalled: bool = False
    reached_goal: bool = False


@dataclass(slots=True, eq=False, repr=False)
class GripperCommandActionFeedback(ros.Message):
    """control_msgs/GripperCommandActionFeedback"""

    _type: ClassVar[str] = "control_msgs/GripperCommandActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: GripperCommandFeedback = field(default_factory=lambda: GripperCommandFeedback())


@dataclass(slots=True, eq=False, repr=False)
class GripperCommandAction(ros.Message):
    """control_msgs/GripperCommandAction"""

    _type: ClassVar[str] = "control_msgs/GripperCommandAction"

    action_goal: GripperCommandActionGoal = field(
        default_factory=lambda: GripperCommandActionGoal()
    )
    action_result: GripperCommandActionResult = field(
        default_factory=lambda: GripperCommandActionResult()
    )
    action_feedback: GripperCommandActionFeedback = field(
        default_factory=lambda: GripperCommandActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class JointControllerState(ros.Message):
    """control_msgs/JointControllerState"""

    _type: ClassVar[str] = "control_msgs/JointControllerState"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    set_point: float = 0.0
    process_value: float = 0.0
    process_value_dot: float = 0.0
    error: float = 0.0
    time_step: float = 0.0
    command: float = 0.0
    p: float = 0.0
    i: float = 0.0
    d: float = 0.0
    i_clamp: float = 0.0
    antiwindup: bool = False


@dataclass(slots=True, eq=False, repr=False)
class JointJog(ros.Message):
    """control_msgs/JointJog"""

    _type: ClassVar[str] = "control_msgs/JointJog"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    joint_names: list[str] = field(default_factory=list)
    displacements: list[float] = field(default_factory=list)
    velocities: list[float] = field(default_factory=list)
    duration: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class JointTrajectoryGoal(ros.Message):
    """control_msgs/JointTrajectoryGoal"""

    _type: ClassVar[str] = "control_msgs/JointTrajectoryGoal"

    trajectory: trajectory_msgs.JointTrajectory = field(
        default_factory=lambda: trajectory_msgs.JointTrajectory()
    )


@dataclass(slots=True, eq=False, repr=False)
class JointTrajectoryActionGoal(ros.Message):
    """control_msgs/JointTrajectoryActionGoal"""

    _type: ClassVar[str] = "control_msgs/JointTrajectoryActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: JointTrajectoryGoal = field(default_factory=lambda: JointTrajectoryGoal())


@dataclass(slots=True, eq=False, repr=False)
class JointTrajectoryResult(ros.Message):
    """control_msgs/JointTrajectoryResult"""

    _type: ClassVar[str] = "control_msgs/JointTrajectoryResult"


@dataclass(slots=True, eq=False, repr=False)
class JointTrajectoryActionResult(ros.Message):
    """control_msgs/JointTrajectoryActionResult"""

    _type: ClassVar[str] = "control_msgs/JointTrajectoryActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: JointTrajectoryResult = field(default_factory=lambda: JointTrajectoryResult())


@dataclass(slots=True, eq=False, repr=False)
class JointTrajectoryFeedback(ros.Message):
    """control_msgs/JointTrajectoryFeedback"""

    _type: ClassVar[str] = "control_msgs/JointTrajectoryFeedback"


@dataclass(slots=True, eq=False, repr=False)
class JointTrajectoryActionFeedback(ros.Message):
    """control_msgs/JointTrajectoryActionFeedback"""

    _type: ClassVar[str] = "control_msgs/JointTrajectoryActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: JointTrajectoryFeedback = field(default_factory=lambda: JointTrajectoryFeedback())


@dataclass(slots=True, eq=False, repr=False)
class JointTrajectoryAction(ros.Message):
    """control_msgs/JointTrajectoryAction"""

    _type: ClassVar[str] = "control_msgs/JointTrajectoryAction"

    action_goal: JointTrajectoryActionGoal = field(
        default_factory=lambda: JointTrajectoryActionGoal()
    )
    action_result: JointTrajectoryActionResult = field(
        default_factory=lambda: JointTrajectoryActionResult()
    )
    action_feedback: JointTrajectoryActionFeedback = field(
        default_factory=lambda: JointTrajectoryActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class JointTrajectoryControllerState(ros.Message):
    """control_msgs/JointTrajectoryControllerState"""

    _type: ClassVar[str] = "control_msgs/JointTrajectoryControllerState"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    joint_names: list[str] = field(default_factory=list)
    desired: trajectory_msgs.JointTrajectoryPoint = field(
        default_factory=lambda: trajectory_msgs.JointTrajectoryPoint()
    )
    actual: trajectory_msgs.JointTrajectoryPoint = field(
        default_factory=lambda: trajectory_msgs.JointTrajectoryPoint()
    )
    error: trajectory_msgs.JointTrajectoryPoint = field(
        default_factory=lambda: trajectory_msgs.JointTrajectoryPoint()
    )


@dataclass(slots=True, eq=False, repr=False)
class PidState(ros.Message):
    """control_msgs/PidState"""

    _type: ClassVar[str] = "control_msgs/PidState"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    timestep: ros.Duration = field(default_factory=ros.Duration)
    error: float = 0.0
    error_dot: float = 0.0
    p_error: float = 0.0
    i_error: float = 0.0
    d_error: float = 0.0
    p_term: float = 0.0
    i_term: float = 0.0
    d_term: float = 0.0
    i_max: float = 0.0
    i_min: float = 0.0
    output: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class PointHeadGoal(ros.Message):
    """control_msgs/PointHeadGoal"""

    _type: ClassVar[str] = "control_msgs/PointHeadGoal"

    target: geometry_msgs.PointStamped = field(default_factory=lambda: geometry_msgs.PointStamped())
    pointing_axis: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())
    pointing_frame: str = ""
    min_duration: ros.Duration = field(default_factory=ros.Duration)
    max_velocity: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class PointHeadActionGoal(ros.Message):
    """control_msgs/PointHeadActionGoal"""

    _type: ClassVar[str] = "control_msgs/PointHeadActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: PointHeadGoal = field(default_factory=lambda: PointHeadGoal())


@dataclass(slots=True, eq=False, repr=False)
class PointHeadResult(ros.Message):
    """control_msgs/PointHeadResult"""

    _type: ClassVar[str] = "control_msgs/PointHeadResult"


@dataclass(slots=True, eq=False, repr=False)
class PointHeadActionResult(ros.Message):
    """control_msgs/PointHeadActionResult"""

    _type: ClassVar[str] = "control_msgs/PointHeadActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: PointHeadResult = field(default_factory=lambda: PointHeadResult())


@dataclass(slots=True, eq=False, repr=False)
class PointHeadFeedback(ros.Message):
    """control_msgs/PointHeadFeedback"""

    _type: ClassVar[str] = "control_msgs/PointHeadFeedback"

    pointing_angle_error: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class PointHeadActionFeedback(ros.Message):
    """control_msgs/PointHeadActionFeedback"""

    _type: ClassVar[str] = "control_msgs/PointHeadActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: PointHeadFeedback = field(default_factory=lambda: PointHeadFeedback())


@dataclass(slots=True, eq=False, repr=False)
class PointHeadAction(ros.Message):
    """control_msgs/PointHeadAction"""

    _type: ClassVar[str] = "control_msgs/PointHeadAction"

    action_goal: PointHeadActionGoal = field(default_factory=lambda: PointHeadActionGoal())
    action_result: PointHeadActionResult = field(default_factory=lambda: PointHeadActionResult())
    action_feedback: PointHeadActionFeedback = field(
        default_factory=lambda: PointHeadActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class SingleJointPositionGoal(ros.Message):
    """control_msgs/SingleJointPositionGoal"""

    _type: ClassVar[str] = "control_msgs/SingleJointPositionGoal"

    position: float = 0.0
    min_duration: ros.Duration = field(default_factory=ros.Duration)
    max_velocity: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class SingleJointPositionActionGoal(ros.Message):
    """control_msgs/SingleJointPositionActionGoal"""

    _type: ClassVar[str] = "control_msgs/SingleJointPositionActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: SingleJointPositionGoal = field(default_factory=lambda: SingleJointPositionGoal())


@dataclass(slots=True, eq=False, repr=False)
class SingleJointPositionResult(ros.Message):
    """control_msgs/SingleJointPositionResult"""

    _type: ClassVar[str] = "control_msgs/SingleJointPositionResult"


@dataclass(slots=True, eq=False, repr=False)
class SingleJointPositionActionResult(ros.Message):
    """control_msgs/SingleJointPositionActionResult"""

    _type: ClassVar[str] = "control_msgs/SingleJointPositionActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: SingleJointPositionResult = field(default_factory=lambda: SingleJointPositionResult())


@dataclass(slots=True, eq=False, repr=False)
class SingleJointPositionFeedback(ros.Message):
    """control_msgs/SingleJointPositionFeedback"""

    _type: ClassVar[str] = "control_msgs/SingleJointPositionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    position: float = 0.0
    velocity: float = 0.0
    error: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class SingleJointPositionActionFeedback(ros.Message):
    """control_msgs/SingleJointPositionActionFeedback"""

    _type: ClassVar[str] = "control_msgs/SingleJointPositionActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: SingleJointPositionFeedback = field(
        default_factory=lambda: SingleJointPositionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class SingleJointPositionAction(ros.Message):
    """control_msgs/SingleJointPositionAction"""

    _type: ClassVar[str] = "control_msgs/SingleJointPositionAction"

    action_goal: SingleJointPositionActionGoal = field(
        default_factory=lambda: SingleJointPositionActionGoal()
    )
    action_result: SingleJointPositionActionResult = field(
        default_factory=lambda: SingleJointPositionActionResult()
    )
    action_feedback: SingleJointPositionActionFeedback = field(
        default_factory=lambda: SingleJointPositionActionFeedback()
    )
