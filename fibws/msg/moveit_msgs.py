"""The messages of moveit_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, geometry_msgs, object_recognition_msgs, octomap_msgs, sensor_msgs, shape_msgs, std_msgs, trajectory_msgs

__all__ = [
    "AllowedCollisionEntry",
    "AllowedCollisionMatrix",
    "AttachedCollisionObject",
    "BoundingVolume",
    "CartesianPoint",
    "CartesianTrajectory",
    "CartesianTrajectoryPoint",
    "CollisionObject",
    "ConstraintEvalResult",
    "Constraints",
    "ContactInformation",
    "CostSource",
    "DisplayRobotState",
    "DisplayTrajectory",
    "ExecuteTrajectoryAction",
    "ExecuteTrajectoryActionFeedback",
    "ExecuteTrajectoryActionGoal",
    "ExecuteTrajectoryActionResult",
    "ExecuteTrajectoryFeedback",
    "ExecuteTrajectoryGoal",
    "ExecuteTrajectoryResult",
    "GenericTrajectory",
    "Grasp",
    "GripperTranslation",
    "JointConstraint",
    "JointLimits",
    "KinematicSolverInfo",
    "LinkPadding",
    "LinkScale",
    "MotionPlanDetailedResponse",
    "MotionPlanRequest",
    "MotionPlanResponse",
    "MotionSequenceItem",
    "MotionSequenceRequest",
    "MotionSequenceResponse",
    "MoveGroupAction",
    "MoveGroupActionFeedback",
    "MoveGroupActionGoal",
    "MoveGroupActionResult",
    "MoveGroupFeedback",
    "MoveGroupGoal",
    "MoveGroupResult",
    "MoveGroupSequenceAction",
    "MoveGroupSequenceActionFeedback",
    "MoveGroupSequenceActionGoal",
    "MoveGroupSequenceActionResult",
    "MoveGroupSequenceFeedback",
    "MoveGroupSequenceGoal",
    "MoveGroupSequenceResult",
    "MoveItErrorCodes",
    "ObjectColor",
    "OrientationConstraint",
    "OrientedBoundingBox",
    "PickupAction",
    "PickupActionFeedback",
    "PickupActionGoal",
    "PickupActionResult",
    "PickupFeedback",
    "PickupGoal",
    "PickupResult",
    "PlaceAction",
    "PlaceActionFeedback",
    "PlaceActionGoal",
    "PlaceActionResult",
    "PlaceFeedback",
    "PlaceGoal",
    "PlaceLocation",
    "PlaceResult",
    "PlannerInterfaceDescription",
    "PlannerParams",
    "PlanningOptions",
    "PlanningScene",
    "PlanningSceneComponents",
    "PlanningSceneWorld",
    "PositionConstraint",
    "PositionIKRequest",
    "RobotState",
    "RobotTrajectory",
    "TrajectoryConstraints",
    "VisibilityConstraint",
    "WorkspaceParameters",
]


@dataclass(slots=True, eq=False, repr=False)
class AllowedCollisionEntry(ros.Message):
    """moveit_msgs/AllowedCollisionEntry"""

    _type: ClassVar[str] = "moveit_msgs/AllowedCollisionEntry"

    enabled: list[bool] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class AllowedCollisionMatrix(ros.Message):
    """moveit_msgs/AllowedCollisionMatrix"""

    _type: ClassVar[str] = "moveit_msgs/AllowedCollisionMatrix"

    entry_names: list[str] = field(default_factory=list)
    entry_values: list[AllowedCollisionEntry] = field(default_factory=list)
    default_entry_names: list[str] = field(default_factory=list)
    default_entry_values: list[bool] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class CollisionObject(ros.Message):
    """moveit_msgs/CollisionObject"""

    _type: ClassVar[str] = "moveit_msgs/CollisionObject"
    ADD: ClassVar[int] = 0
    REMOVE: ClassVar[int] = 1
    APPEND: ClassVar[int] = 2
    MOVE: ClassVar[int] = 3

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    id: str = ""
    type: object_recognition_msgs.ObjectType = field(
        default_factory=lambda: object_recognition_msgs.ObjectType()
    )
    primitives: list[shape_msgs.SolidPrimitive] = field(default_factory=list)
    primitive_poses: list[geometry_msgs.Pose] = field(default_factory=list)
    meshes: list[shape_msgs.Mesh] = field(default_factory=list)
    mesh_poses: list[geometry_msgs.Pose] = field(default_factory=list)
    planes: list[shape_msgs.Plane] = field(default_factory=list)
    plane_poses: list[geometry_msgs.Pose] = field(default_factory=list)
    subframe_names: list[str] = field(default_factory=list)
    subframe_poses: list[geometry_msgs.Pose] = field(default_factory=list)
    operation: int = 0


@dataclass(slots=True, eq=False, repr=False)
class AttachedCollisionObject(ros.Message):
    """moveit_msgs/AttachedCollisionObject"""

    _type: ClassVar[str] = "moveit_msgs/AttachedCollisionObject"

    link_name: str = ""
    object: CollisionObject = field(default_factory=lambda: CollisionObject())
    touch_links: list[str] = field(default_factory=list)
    detach_posture: trajectory_msgs.JointTrajectory = field(
        default_factory=lambda: trajectory_msgs.JointTrajectory()
    )
    weight: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class BoundingVolume(ros.Message):
    """moveit_msgs/BoundingVolume"""

    _type: ClassVar[str] = "moveit_msgs/BoundingVolume"

    primitives: list[shape_msgs.SolidPrimitive] = field(default_factory=list)
    primitive_poses: list[geometry_msgs.Pose] = field(default_factory=list)
    meshes: list[shape_msgs.Mesh] = field(default_factory=list)
    mesh_poses: list[geometry_msgs.Pose] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class CartesianPoint(ros.Message):
    """moveit_msgs/CartesianPoint"""

    _type: ClassVar[str] = "moveit_msgs/CartesianPoint"

    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    velocity: geometry_msgs.Twist = field(default_factory=lambda: geometry_msgs.Twist())
    acceleration: geometry_msgs.Accel = field(default_factory=lambda: geometry_msgs.Accel())


@dataclass(slots=True, eq=False, repr=False)
class CartesianTrajectoryPoint(ros.Message):
    """moveit_msgs/CartesianTrajectoryPoint"""

    _type: ClassVar[str] = "moveit_msgs/CartesianTrajectoryPoint"

    point: CartesianPoint = field(default_factory=lambda: CartesianPoint())
    time_from_start: ros.Duration = field(default_factory=ros.Duration)


@dataclass(slots=True, eq=False, repr=False)
class CartesianTrajectory(ros.Message):
    """moveit_msgs/CartesianTrajectory"""

    _type: ClassVar[str] = "moveit_msgs/CartesianTrajectory"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    tracked_frame: str = ""
    points: list[CartesianTrajectoryPoint] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class ConstraintEvalResult(ros.Message):
    """moveit_msgs/ConstraintEvalResult"""

    _type: ClassVar[str] = "moveit_msgs/ConstraintEvalResult"

    result: bool = False
    distance: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class JointConstraint(ros.Message):
    """moveit_msgs/JointConstraint"""

    _type: ClassVar[str] = "moveit_msgs/JointConstraint"

    joint_name: str = ""
    position: float = 0.0
    tolerance_above: float = 0.0
    tolerance_below: float = 0.0
    weight: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class PositionConstraint(ros.Message):
    """moveit_msgs/PositionConstraint"""

    _type: ClassVar[str] = "moveit_msgs/PositionConstraint"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    link_name: str = ""
    target_point_offset: geometry_msgs.Vector3 = field(
        default_factory=lambda: geometry_msgs.Vector3()
    )
    constraint_region: BoundingVolume = field(default_factory=lambda: BoundingVolume())
    weight: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class OrientationConstraint(ros.Message):
    """moveit_msgs/OrientationConstraint"""

    _type: ClassVar[str] = "moveit_msgs/OrientationConstraint"
    XYZ_EULER_ANGLES: ClassVar[int] = 0
    ROTATION_VECTOR: ClassVar[int] = 1

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    orientation: geometry_msgs.Quaternion = field(
        default_factory=lambda: geometry_msgs.Quaternion()
    )
    link_name: str = ""
    absolute_x_axis_tolerance: float = 0.0
    absolute_y_axis_tolerance: float = 0.0
    absolute_z_axis_tolerance: float = 0.0
    parameterization: int = 0
    weight: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class VisibilityConstraint(ros.Message):
    """moveit_msgs/VisibilityConstraint"""

    _type: ClassVar[str] = "moveit_msgs/VisibilityConstraint"
    SENSOR_Z: ClassVar[int] = 0
    SENSOR_Y: ClassVar[int] = 1
    SENSOR_X: ClassVar[int] = 2

    target_radius: float = 0.0
    target_pose: geometry_msgs.PoseStamped = field(
        default_factory=lambda: geometry_msgs.PoseStamped()
    )
    cone_sides: int = 0
    sensor_pose: geometry_msgs.PoseStamped = field(
        default_factory=lambda: geometry_msgs.PoseStamped()
    )
    max_view_angle: float = 0.0
    max_range_angle: float = 0.0
    sensor_view_direction: int = 0
    weight: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Constraints(ros.Message):
    """moveit_msgs/Constraints"""

    _type: ClassVar[str] = "moveit_msgs/Constraints"

    name: str = ""
    joint_constraints: list[JointConstraint] = field(default_factory=list)
    position_constraints: list[PositionConstraint] = field(default_factory=list)
    orientation_constraints: list[OrientationConstraint] = field(default_factory=list)
    visibility_constraints: list[VisibilityConstraint] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class ContactInformation(ros.Message):
    """moveit_msgs/ContactInformation"""

    _type: ClassVar[str] = "moveit_msgs/ContactInformation"
    ROBOT_LINK: ClassVar[int] = 0
    WORLD_OBJECT: ClassVar[int] = 1
    ROBOT_ATTACHED: ClassVar[int] = 2

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    position: geometry_msgs.Point = field(default_factory=lambda: geometry_msgs.Point())
    normal: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())
    depth: float = 0.0
    contact_body_1: str = ""
    body_type_1: int = 0
    contact_body_2: str = ""
    body_type_2: int = 0


@dataclass(slots=True, eq=False, repr=False)
class CostSource(ros.Message):
    """moveit_msgs/CostSource"""

    _type: ClassVar[str] = "moveit_msgs/CostSource"

    cost_density: float = 0.0
    aabb_min: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())
    aabb_max: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())


@dataclass(slots=True, eq=False, repr=False)
class RobotState(ros.Message):
    """moveit_msgs/RobotState"""

    _type: ClassVar[str] = "moveit_msgs/RobotState"

    joint_state: sensor_msgs.JointState = field(default_factory=lambda: sensor_msgs.JointState())
    multi_dof_joint_state: sensor_msgs.MultiDOFJointState = field(
        default_factory=lambda: sensor_msgs.MultiDOFJointState()
    )
    attached_collision_objects: list[AttachedCollisionObject] = field(default_factory=list)
    is_diff: bool = False


@dataclass(slots=True, eq=False, repr=False)
class ObjectColor(ros.Message):
    """moveit_msgs/ObjectColor"""

    _type: ClassVar[str] = "moveit_msgs/ObjectColor"

    id: str = ""
    color: std_msgs.ColorRGBA = field(default_factory=lambda: std_msgs.ColorRGBA())


@dataclass(slots=True, eq=False, repr=False)
class DisplayRobotState(ros.Message):
    """moveit_msgs/DisplayRobotState"""

    _type: ClassVar[str] = "moveit_msgs/DisplayRobotState"

    state: RobotState = field(default_factory=lambda: RobotState())
    highlight_links: list[ObjectColor] = field(default_factory=list)
    hide: bool = False


@dataclass(slots=True, eq=False, repr=False)
class RobotTrajectory(ros.Message):
    """moveit_msgs/RobotTrajectory"""

    _type: ClassVar[str] = "moveit_msgs/RobotTrajectory"

    joint_trajectory: trajectory_msgs.JointTrajectory = field(
        default_factory=lambda: trajectory_msgs.JointTrajectory()
    )
    multi_dof_joint_trajectory: trajectory_msgs.MultiDOFJointTrajectory = field(
        default_factory=lambda: trajectory_msgs.MultiDOFJointTrajectory()
    )


@dataclass(slots=True, eq=False, repr=False)
class DisplayTrajectory(ros.Message):
    """moveit_msgs/DisplayTrajectory"""

    _type: ClassVar[str] = "moveit_msgs/DisplayTrajectory"

    model_id: str = ""
    trajectory: list[RobotTrajectory] = field(default_factory=list)
    trajectory_start: RobotState = field(default_factory=lambda: RobotState())


@dataclass(slots=True, eq=False, repr=False)
class ExecuteTrajectoryGoal(ros.Message):
    """moveit_msgs/ExecuteTrajectoryGoal"""

    _type: ClassVar[str] = "moveit_msgs/ExecuteTrajectoryGoal"

    trajectory: RobotTrajectory = field(default_factory=lambda: RobotTrajectory())


@dataclass(slots=True, eq=False, repr=False)
class ExecuteTrajectoryActionGoal(ros.Message):
    """moveit_msgs/ExecuteTrajectoryActionGoal"""

    _type: ClassVar[str] = "moveit_msgs/ExecuteTrajectoryActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: ExecuteTrajectoryGoal = field(default_factory=lambda: ExecuteTrajectoryGoal())


@dataclass(slots=True, eq=False, repr=False)
class MoveItErrorCodes(ros.Message):
    """moveit_msgs/MoveItErrorCodes"""

    _type: ClassVar[str] = "moveit_msgs/MoveItErrorCodes"
    SUCCESS: ClassVar[int] = 1
    FAILURE: ClassVar[int] = 99999
    PLANNING_FAILED: ClassVar[int] = -1
    INVALID_MOTION_PLAN: ClassVar[int] = -2
    MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE: ClassVar[int] = -3
    CONTROL_FAILED: ClassVar[int] = -4
    UNABLE_TO_AQUIRE_SENSOR_DATA: ClassVar[int] = -5
    TIMED_OUT: ClassVar[int] = -6
    PREEMPTED: ClassVar[int] = -7
    START_STATE_IN_COLLISION: ClassVar[int] = -10
    START_STATE_VIOLATES_PATH_CONSTRAINTS: ClassVar[int] = -11
    START_STATE_INVALID: ClassVar[int] = -26
    GOAL_IN_COLLISION: ClassVar[int] = -12
    GOAL_VIOLATES_PATH_CONSTRAINTS: ClassVar[int] = -13
    GOAL_CONSTRAINTS_VIOLATED: ClassVar[int] = -14
    GOAL_STATE_INVALID: ClassVar[int] = -27
    UNRECOGNIZED_GOAL_TYPE: ClassVar[int] = -28
    INVALID_GROUP_NAME: ClassVar[int] = -15
    INVALID_GOAL_CONSTRAINTS: ClassVar[int] = -16
    INVALID_ROBOT_STATE: ClassVar[int] = -17
    INVALID_LINK_NAME: ClassVar[int] = -18
    INVALID_OBJECT_NAME: ClassVar[int] = -19
    FRAME_TRANSFORM_FAILURE: ClassVar[int] = -21
    COLLISION_CHECKING_UNAVAILABLE: ClassVar[int] = -22
    ROBOT_STATE_STALE: ClassVar[int] = -23
    SENSOR_INFO_STALE: ClassVar[int] = -24
    COMMUNICATION_FAILURE: ClassVar[int] = -25
    CRASH: ClassVar[int] = -29
    ABORT: ClassVar[int] = -30
    NO_IK_SOLUTION: ClassVar[int] = -31

    val: int = 0


@dataclass(slots=True, eq=False, repr=False)
class ExecuteTrajectoryResult(ros.Message):
    """moveit_msgs/ExecuteTrajectoryResult"""

    _type: ClassVar[str] = "moveit_msgs/ExecuteTrajectoryResult"

    error_code: MoveItErrorCodes = field(default_factory=lambda: MoveItErrorCodes())


@dataclass(slots=True, eq=False, repr=False)
class ExecuteTrajectoryActionResult(ros.Message):
    """moveit_msgs/ExecuteTrajectoryActionResult"""

    _type: ClassVar[str] = "moveit_msgs/ExecuteTrajectoryActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: ExecuteTrajectoryResult = field(default_factory=lambda: ExecuteTrajectoryResult())


@dataclass(slots=True, eq=False, repr=False)
class ExecuteTrajectoryFeedback(ros.Message):
    """moveit_msgs/ExecuteTrajectoryFeedback"""

    _type: ClassVar[str] = "moveit_msgs/ExecuteTrajectoryFeedback"

    state: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ExecuteTrajectoryActionFeedback(ros.Message):
    """moveit_msgs/ExecuteTrajectoryActionFeedback"""

    _type: ClassVar[str] = "moveit_msgs/ExecuteTrajectoryActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: ExecuteTrajectoryFeedback = field(default_factory=lambda: ExecuteTrajectoryFeedback())


@dataclass(slots=True, eq=False, repr=False)
class ExecuteTrajectoryAction(ros.Message):
    """moveit_msgs/ExecuteTrajectoryAction"""

    _type: ClassVar[str] = "moveit_msgs/ExecuteTrajectoryAction"

    action_goal: ExecuteTrajectoryActionGoal = field(
        default_factory=lambda: ExecuteTrajectoryActionGoal()
    )
    action_result: ExecuteTrajectoryActionResult = field(
        default_factory=lambda: ExecuteTrajectoryActionResult()
    )
    action_feedback: ExecuteTrajectoryActionFeedback = field(
        default_factory=lambda: ExecuteTrajectoryActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class GenericTrajectory(ros.Message):
    """moveit_msgs/GenericTrajectory"""

    _type: ClassVar[str] = "moveit_msgs/GenericTrajectory"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    joint_trajectory: list[trajectory_msgs.JointTrajectory] = field(default_factory=list)
    cartesian_trajectory: list[CartesianTrajectory] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class GripperTranslation(ros.Message):
    """moveit_msgs/GripperTranslation"""

    _type: ClassVar[str] = "moveit_msgs/GripperTranslation"

    direction: geometry_msgs.Vector3Stamped = field(
        default_factory=lambda: geometry_msgs.Vector3Stamped()
    )
    desired_distance: float = 0.0
    min_distance: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Grasp(ros.Message):
    """moveit_msgs/Grasp"""

    _type: ClassVar[str] = "moveit_msgs/Grasp"

    id: str = ""
    pre_grasp_posture: trajectory_msgs.JointTrajectory = field(
        default_factory=lambda: trajectory_msgs.JointTrajectory()
    )
    grasp_posture: trajectory_msgs.JointTrajectory = field(
        default_factory=lambda: trajectory_msgs.JointTrajectory()
    )
    grasp_pose: geometry_msgs.PoseStamped = field(
        default_factory=lambda: geometry_msgs.PoseStamped()
    )
    grasp_quality: float = 0.0
    pre_grasp_approach: GripperTranslation = field(default_factory=lambda: GripperTranslation())
    post_grasp_retreat: GripperTranslation = field(default_factory=lambda: GripperTranslation())
    post_place_retreat: GripperTranslation = field(default_factory=lambda: GripperTranslation())
    max_contact_force: float = 0.0
    allowed_touch_objects: list[str] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class JointLimits(ros.Message):
    """moveit_msgs/JointLimits"""

    _type: ClassVar[str] = "moveit_msgs/JointLimits"

    joint_name: str = ""
    has_position_limits: bool = False
    min_position: float = 0.0
    max_position: float = 0.0
    has_velocity_limits: bool = False
    max_velocity: float = 0.0
    has_acceleration_limits: bool = False
    max_acceleration: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class KinematicSolverInfo(ros.Message):
    """moveit_msgs/KinematicSolverInfo"""

    _type: ClassVar[str] = "moveit_msgs/KinematicSolverInfo"

    joint_names: list[str] = field(default_factory=list)
    limits: list[JointLimits] = field(default_factory=list)
    link_names: list[str] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class LinkPadding(ros.Message):
    """moveit_msgs/LinkPadding"""

    _type: ClassVar[str] = "moveit_msgs/LinkPadding"

    link_name: str = ""
    padding: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class LinkScale(ros.Message):
    """moveit_msgs/LinkScale"""

    _type: ClassVar[str] = "moveit_msgs/LinkScale"

    link_name: str = ""
    scale: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class MotionPlanDetailedResponse(ros.Message):
    """moveit_msgs/MotionPlanDetailedResponse"""

    _type: ClassVar[str] = "moveit_msgs/MotionPlanDetailedResponse"

    trajectory_start: RobotState = field(default_factory=lambda: RobotState())
    group_name: str = ""
    trajectory: list[RobotTrajectory] = field(default_factory=list)
    description: list[str] = field(default_factory=list)
    processing_time: list[float] = field(default_factory=list)
    error_code: MoveItErrorCodes = field(default_factory=lambda: MoveItErrorCodes())


@dataclass(slots=True, eq=False, repr=False)
class WorkspaceParameters(ros.Message):
    """moveit_msgs/WorkspaceParameters"""

    _type: ClassVar[str] = "moveit_msgs/WorkspaceParameters"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    min_corner: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())
    max_corner: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())


@dataclass(slots=True, eq=False, repr=False)
class TrajectoryConstraints(ros.Message):
    """moveit_msgs/TrajectoryConstraints"""

    _type: ClassVar[str] = "moveit_msgs/TrajectoryConstraints"

    constraints: list[Constraints] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class MotionPlanRequest(ros.Message):
    """moveit_msgs/MotionPlanRequest"""

    _type: ClassVar[str] = "moveit_msgs/MotionPlanRequest"

    workspace_parameters: WorkspaceParameters = field(default_factory=lambda: WorkspaceParameters())
    start_state: RobotState = field(default_factory=lambda: RobotState())
    goal_constraints: list[Constraints] = field(default_factory=list)
    path_constraints: Constraints = field(default_factory=lambda: Constraints())
    trajectory_constraints: TrajectoryConstraints = field(
        default_factory=lambda: TrajectoryConstraints()
    )
    reference_trajectories: list[GenericTrajectory] = field(default_factory=list)
    pipeline_id: str = ""
    planner_id: str = ""
    group_name: str = ""
    num_planning_attempts: int = 0
    allowed_planning_time: float = 0.0
    max_velocity_scaling_factor: float = 0.0
    max_acceleration_scaling_factor: float = 0.0
    cartesian_speed_limited_link: str = ""
    max_cartesian_speed: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class MotionPlanResponse(ros.Message):
    """moveit_msgs/MotionPlanResponse"""

    _type: ClassVar[str] = "moveit_msgs/MotionPlanResponse"

    trajectory_start: RobotState = field(default_factory=lambda: RobotState())
    group_name: str = ""
    trajectory: RobotTrajectory = field(default_factory=lambda: RobotTrajectory())
    planning_time: float = 0.0
    error_code: MoveItErrorCodes = field(default_factory=lambda: MoveItErrorCodes())


@dataclass(slots=True, eq=False, repr=False)
class MotionSequenceItem(ros.Message):
    """moveit_msgs/MotionSequenceItem"""

    _type: ClassVar[str] = "moveit_msgs/MotionSequenceItem"

    req: MotionPlanRequest = field(default_factory=lambda: MotionPlanRequest())
    blend_radius: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class MotionSequenceRequest(ros.Message):
    """moveit_msgs/MotionSequenceRequest"""

    _type: ClassVar[str] = "moveit_msgs/MotionSequenceRequest"

    items: list[MotionSequenceItem] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class MotionSequenceResponse(ros.Message):
    """moveit_msgs/MotionSequenceResponse"""

    _type: ClassVar[str] = "moveit_msgs/MotionSequenceResponse"

    error_code: MoveItErrorCodes = field(default_factory=lambda: MoveItErrorCodes())
    sequence_start: RobotState = field(default_factory=lambda: RobotState())
    planned_trajectories: list[RobotTrajectory] = field(default_factory=list)
    planning_time: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class PlanningSceneWorld(ros.Message):
    """moveit_msgs/PlanningSceneWorld"""

    _type: ClassVar[str] = "moveit_msgs/PlanningSceneWorld"

    collision_objects: list[CollisionObject] = field(default_factory=list)
    octomap: octomap_msgs.OctomapWithPose = field(
        default_factory=lambda: octomap_msgs.OctomapWithPose()
    )


@dataclass(slots=True, eq=False, repr=False)
class PlanningScene(ros.Message):
    """moveit_msgs/PlanningScene"""

    _type: ClassVar[str] = "moveit_msgs/PlanningScene"

    name: str = ""
    robot_state: RobotState = field(default_factory=lambda: RobotState())
    robot_model_name: str = ""
    fixed_frame_transforms: list[geometry_msgs.TransformStamped] = field(default_factory=list)
    allowed_collision_matrix: AllowedCollisionMatrix = field(
        default_factory=lambda: AllowedCollisionMatrix()
    )
    link_padding: list[LinkPadding] = field(default_factory=list)
    link_scale: list[LinkScale] = field(default_factory=list)
    object_colors: list[ObjectColor] = field(default_factory=list)
    world: PlanningSceneWorld = field(default_factory=lambda: PlanningSceneWorld())
    is_diff: bool = False


@dataclass(slots=True, eq=False, repr=False)
class PlanningOptions(ros.Message):
    """moveit_msgs/PlanningOptions"""

    _type: ClassVar[str] = "moveit_msgs/PlanningOptions"

    planning_scene_diff: PlanningScene = field(default_factory=lambda: PlanningScene())
    plan_only: bool = False
    look_around: bool = False
    look_around_attempts: int = 0
    max_safe_execution_cost: float = 0.0
    replan: bool = False
    replan_attempts: int = 0
    replan_delay: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupGoal(ros.Message):
    """moveit_msgs/MoveGroupGoal"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupGoal"

    request: MotionPlanRequest = field(default_factory=lambda: MotionPlanRequest())
    planning_options: PlanningOptions = field(default_factory=lambda: PlanningOptions())


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupActionGoal(ros.Message):
    """moveit_msgs/MoveGroupActionGoal"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: MoveGroupGoal = field(default_factory=lambda: MoveGroupGoal())


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupResult(ros.Message):
    """moveit_msgs/MoveGroupResult"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupResult"

    error_code: MoveItErrorCodes = field(default_factory=lambda: MoveItErrorCodes())
    trajectory_start: RobotState = field(default_factory=lambda: RobotState())
    planned_trajectory: RobotTrajectory = field(default_factory=lambda: RobotTrajectory())
    executed_trajectory: RobotTrajectory = field(default_factory=lambda: RobotTrajectory())
    planning_time: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupActionResult(ros.Message):
    """moveit_msgs/MoveGroupActionResult"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: MoveGroupResult = field(default_factory=lambda: MoveGroupResult())


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupFeedback(ros.Message):
    """moveit_msgs/MoveGroupFeedback"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupFeedback"

    state: str = ""


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupActionFeedback(ros.Message):
    """moveit_msgs/MoveGroupActionFeedback"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: MoveGroupFeedback = field(default_factory=lambda: MoveGroupFeedback())


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupAction(ros.Message):
    """moveit_msgs/MoveGroupAction"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupAction"

    action_goal: MoveGroupActionGoal = field(default_factory=lambda: MoveGroupActionGoal())
    action_result: MoveGroupActionResult = field(default_factory=lambda: MoveGroupActionResult())
    action_feedback: MoveGroupActionFeedback = field(
        default_factory=lambda: MoveGroupActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupSequenceGoal(ros.Message):
    """moveit_msgs/MoveGroupSequenceGoal"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupSequenceGoal"

    request: MotionSequenceRequest = field(default_factory=lambda: MotionSequenceRequest())
    planning_options: PlanningOptions = field(default_factory=lambda: PlanningOptions())


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupSequenceActionGoal(ros.Message):
    """moveit_msgs/MoveGroupSequenceActionGoal"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupSequenceActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: MoveGroupSequenceGoal = field(default_factory=lambda: MoveGroupSequenceGoal())


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupSequenceResult(ros.Message):
    """moveit_msgs/MoveGroupSequenceResult"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupSequenceResult"

    response: MotionSequenceResponse = field(default_factory=lambda: MotionSequenceResponse())


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupSequenceActionResult(ros.Message):
    """moveit_msgs/MoveGroupSequenceActionResult"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupSequenceActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: MoveGroupSequenceResult = field(default_factory=lambda: MoveGroupSequenceResult())


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupSequenceFeedback(ros.Message):
    """moveit_msgs/MoveGroupSequenceFeedback"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupSequenceFeedback"

    state: str = ""


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupSequenceActionFeedback(ros.Message):
    """moveit_msgs/MoveGroupSequenceActionFeedback"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupSequenceActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: MoveGroupSequenceFeedback = field(default_factory=lambda: MoveGroupSequenceFeedback())


@dataclass(slots=True, eq=False, repr=False)
class MoveGroupSequenceAction(ros.Message):
    """moveit_msgs/MoveGroupSequenceAction"""

    _type: ClassVar[str] = "moveit_msgs/MoveGroupSequenceAction"

    action_goal: MoveGroupSequenceActionGoal = field(
        default_factory=lambda: MoveGroupSequenceActionGoal()
    )
    action_result: MoveGroupSequenceActionResult = field(
        default_factory=lambda: MoveGroupSequenceActionResult()
    )
    action_feedback: MoveGroupSequenceActionFeedback = field(
        default_factory=lambda: MoveGroupSequenceActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class OrientedBoundingBox(ros.Message):
    """moveit_msgs/OrientedBoundingBox"""

    _type: ClassVar[str] = "moveit_msgs/OrientedBoundingBox"

    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    extents: geometry_msgs.Point32 = field(default_factory=lambda: geometry_msgs.Point32())


@dataclass(slots=True, eq=False, repr=False)
class PickupGoal(ros.Message):
    """moveit_msgs/PickupGoal"""

    _type: ClassVar[str] = "moveit_msgs/PickupGoal"

    target_name: str = ""
    group_name: str = ""
    end_effector: str = ""
    possible_grasps: list[Grasp] = field(default_factory=list)
    support_surface_name: str = ""
    allow_gripper_support_collision: bool = False
    attached_object_touch_links: list[str] = field(default_factory=list)
    minimize_object_distance: bool = False
    path_constraints: Constraints = field(default_factory=lambda: Constraints())
    planner_id: str = ""
    allowed_touch_objects: list[str] = field(default_factory=list)
    allowed_planning_time: float = 0.0
    planning_options: PlanningOptions = field(default_factory=lambda: PlanningOptions())


@dataclass(slots=True, eq=False, repr=False)
class PickupActionGoal(ros.Message):
    """moveit_msgs/PickupActionGoal"""

    _type: ClassVar[str] = "moveit_msgs/PickupActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: PickupGoal = field(default_factory=lambda: PickupGoal())


@dataclass(slots=True, eq=False, repr=False)
class PickupResult(ros.Message):
    """moveit_msgs/PickupResult"""

    _type: ClassVar[str] = "moveit_msgs/PickupResult"

    error_code: MoveItErrorCodes = field(default_factory=lambda: MoveItErrorCodes())
    trajectory_start: RobotState = field(default_factory=lambda: RobotState())
    trajectory_stages: list[RobotTrajectory] = field(default_factory=list)
    trajectory_descriptions: list[str] = field(default_factory=list)
    grasp: Grasp = field(default_factory=lambda: Grasp())
    planning_time: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class PickupActionResult(ros.Message):
    """moveit_msgs/PickupActionResult"""

    _type: ClassVar[str] = "moveit_msgs/PickupActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: PickupResult = field(default_factory=lambda: PickupResult())


@dataclass(slots=True, eq=False, repr=False)
class PickupFeedback(ros.Message):
    """moveit_msgs/PickupFeedback"""

    _type: ClassVar[str] = "moveit_msgs/PickupFeedback"

    state: str = ""


@dataclass(slots=True, eq=False, repr=False)
class PickupActionFeedback(ros.Message):
    """moveit_msgs/PickupActionFeedback"""

    _type: ClassVar[str] = "moveit_msgs/PickupActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: PickupFeedback = field(default_factory=lambda: PickupFeedback())


@dataclass(slots=True, eq=False, repr=False)
class PickupAction(ros.Message):
    """moveit_msgs/PickupAction"""

    _type: ClassVar[str] = "moveit_msgs/PickupAction"

    action_goal: PickupActionGoal = field(default_factory=lambda: PickupActionGoal())
    action_result: PickupActionResult = field(default_factory=lambda: PickupActionResult())
    action_feedback: PickupActionFeedback = field(default_factory=lambda: PickupActionFeedback())


@dataclass(slots=True, eq=False, repr=False)
class PlaceLocation(ros.Message):
    """moveit_msgs/PlaceLocation"""

    _type: ClassVar[str] = "moveit_msgs/PlaceLocation"

    id: str = ""
    post_place_posture: trajectory_msgs.JointTrajectory = field(
        default_factory=lambda: trajectory_msgs.JointTrajectory()
    )
    place_pose: geometry_msgs.PoseStamped = field(
        default_factory=lambda: geometry_msgs.PoseStamped()
    )
    quality: float = 0.0
    pre_place_approach: GripperTranslation = field(default_factory=lambda: GripperTranslation())
    post_place_retreat: GripperTranslation = field(default_factory=lambda: GripperTranslation())
    allowed_touch_objects: list[str] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class PlaceGoal(ros.Message):
    """moveit_msgs/PlaceGoal"""

    _type: ClassVar[str] = "moveit_msgs/PlaceGoal"

    group_name: str = ""
    attached_object_name: str = ""
    place_locations: list[PlaceLocation] = field(default_factory=list)
    place_eef: bool = False
    support_surface_name: str = ""
    allow_gripper_support_collision: bool = False
    path_constraints: Constraints = field(default_factory=lambda: Constraints())
    planner_id: str = ""
    allowed_touch_objects: list[str] = field(default_factory=list)
    allowed_planning_time: float = 0.0
    planning_options: PlanningOptions = field(default_factory=lambda: PlanningOptions())


@dataclass(slots=True, eq=False, repr=False)
class PlaceActionGoal(ros.Message):
    """moveit_msgs/PlaceActionGoal"""

    _type: ClassVar[str] = "moveit_msgs/PlaceActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: PlaceGoal = field(default_factory=lambda: PlaceGoal())


@dataclass(slots=True, eq=False, repr=False)
class PlaceResult(ros.Message):
    """moveit_msgs/PlaceResult"""

    _type: ClassVar[str] = "moveit_msgs/PlaceResult"

    error_code: MoveItErrorCodes = field(default_factory=lambda: MoveItErrorCodes())
    trajectory_start: RobotState = field(default_factory=lambda: RobotState())
    trajectory_stages: list[RobotTrajectory] = field(default_factory=list)
    trajectory_descriptions: list[str] = field(default_factory=list)
    place_location: PlaceLocation = field(default_factory=lambda: PlaceLocation())
    planning_time: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class PlaceActionResult(ros.Message):
    """moveit_msgs/PlaceActionResult"""

    _type: ClassVar[str] = "moveit_msgs/PlaceActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: PlaceResult = field(default_factory=lambda: PlaceResult())


@dataclass(slots=True, eq=False, repr=False)
class PlaceFeedback(ros.Message):
    """moveit_msgs/PlaceFeedback"""

    _type: ClassVar[str] = "moveit_msgs/PlaceFeedback"

    state: str = ""


@dataclass(slots=True, eq=False, repr=False)
class PlaceActionFeedback(ros.Message):
    """moveit_msgs/PlaceActionFeedback"""

    _type: ClassVar[str] = "moveit_msgs/PlaceActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: PlaceFeedback = field(default_factory=lambda: PlaceFeedback())


@dataclass(slots=True, eq=False, repr=False)
class PlaceAction(ros.Message):
    """moveit_msgs/PlaceAction"""

    _type: ClassVar[str] = "moveit_msgs/PlaceAction"

    action_goal: PlaceActionGoal = field(default_factory=lambda: PlaceActionGoal())
    action_result: PlaceActionResult = field(default_factory=lambda: PlaceActionResult())
    action_feedback: PlaceActionFeedback = field(default_factory=lambda: PlaceActionFeedback())


@dataclass(slots=True, eq=False, repr=False)
class PlannerInterfaceDescription(ros.Message):
    """moveit_msgs/PlannerInterfaceDescription"""

    _type: ClassVar[str] = "moveit_msgs/PlannerInterfaceDescription"

    name: str = ""
    pipeline_id: str = ""
    planner_ids: list[str] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class PlannerParams(ros.Message):
    """moveit_msgs/PlannerParams"""

    _type: ClassVar[str] = "moveit_msgs/PlannerParams"

    keys: list[str] = field(default_factory=list)
    values: list[str] = field(default_factory=list)
    descriptions: list[str] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class PlanningSceneComponents(ros.Message):
    """moveit_msgs/PlanningSceneComponents"""

    _type: ClassVar[str] = "moveit_msgs/PlanningSceneComponents"
    SCENE_SETTINGS: ClassVar[int] = 1
    ROBOT_STATE: ClassVar[int] = 2
    ROBOT_STATE_ATTACHED_OBJECTS: ClassVar[int] = 4
    WORLD_OBJECT_NAMES: ClassVar[int] = 8
    WORLD_OBJECT_GEOMETRY: ClassVar[int] = 16
    OCTOMAP: ClassVar[int] = 32
    TRANSFORMS: ClassVar[int] = 64
    ALLOWED_COLLISION_MATRIX: ClassVar[int] = 128
    LINK_PADDING_AND_SCALING: ClassVar[int] = 256
    OBJECT_COLORS: ClassVar[int] = 512

    components: int = 0


@dataclass(slots=True, eq=False, repr=False)
class PositionIKRequest(ros.Message):
    """moveit_msgs/PositionIKRequest"""

    _type: ClassVar[str] = "moveit_msgs/PositionIKRequest"

    group_name: str = ""
    robot_state: RobotState = field(default_factory=lambda: RobotState())
    constraints: Constraints = field(default_factory=lambda: Constraints())
    avoid_collisions: bool = False
    ik_link_name: str = ""
    pose_stamped: geometry_msgs.PoseStamped = field(
        default_factory=lambda: geometry_msgs.PoseStamped()
    )
    ik_link_names: list[str] = field(default_factory=list)
    pose_stamped_vector: list[geometry_msgs.PoseStamped] = field(default_factory=list)
    timeout: ros.Duration = field(default_factory=ros.Duration)
