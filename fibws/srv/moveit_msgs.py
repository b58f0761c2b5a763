"""The services of moveit_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import geometry_msgs, moveit_msgs, sensor_msgs, std_msgs

__all__ = [
    "ApplyPlanningScene",
    "ApplyPlanningSceneRequest",
    "ApplyPlanningSceneResponse",
    "ChangeControlDimensions",
    "ChangeControlDimensionsRequest",
    "ChangeControlDimensionsResponse",
    "ChangeDriftDimensions",
    "ChangeDriftDimensionsRequest",
    "ChangeDriftDimensionsResponse",
    "CheckIfRobotStateExistsInWarehouse",
    "CheckIfRobotStateExistsInWarehouseRequest",
    "CheckIfRobotStateExistsInWarehouseResponse",
    "DeleteRobotStateFromWarehouse",
    "DeleteRobotStateFromWarehouseRequest",
    "DeleteRobotStateFromWarehouseResponse",
    "ExecuteKnownTrajectory",
    "ExecuteKnownTrajectoryRequest",
    "ExecuteKnownTrajectoryResponse",
    "GetCartesianPath",
    "GetCartesianPathRequest",
    "GetCartesianPathResponse",
    "GetMotionPlan",
    "GetMotionPlanRequest",
    "GetMotionPlanResponse",
    "GetMotionSequence",
    "GetMotionSequenceRequest",
    "GetMotionSequenceResponse",
    "GetPlannerParams",
    "GetPlannerParamsRequest",
    "GetPlannerParamsResponse",
    "GetPlanningScene",
    "GetPlanningSceneRequest",
    "GetPlanningSceneResponse",
    "GetPositionFK",
    "GetPositionFKRequest",
    "GetPositionFKResponse",
    "GetPositionIK",
    "GetPositionIKRequest",
    "GetPositionIKResponse",
    "GetRobotStateFromWarehouse",
    "GetRobotStateFromWarehouseRequest",
    "GetRobotStateFromWarehouseResponse",
    "GetStateValidity",
    "GetStateValidityRequest",
    "GetStateValidityResponse",
    "GraspPlanning",
    "GraspPlanningRequest",
    "GraspPlanningResponse",
    "ListRobotStatesInWarehouse",
    "ListRobotStatesInWarehouseRequest",
    "ListRobotStatesInWarehouseResponse",
    "LoadMap",
    "LoadMapRequest",
    "LoadMapResponse",
    "QueryPlannerInterfaces",
    "QueryPlannerInterfacesRequest",
    "QueryPlannerInterfacesResponse",
    "RenameRobotStateInWarehouse",
    "RenameRobotStateInWarehouseRequest",
    "RenameRobotStateInWarehouseResponse",
    "SaveMap",
    "SaveMapRequest",
    "SaveMapResponse",
    "SaveRobotStateToWarehouse",
    "SaveRobotStateToWarehouseRequest",
    "SaveRobotStateToWarehouseResponse",
    "SetPlannerParams",
    "SetPlannerParamsRequest",
    "SetPlannerParamsResponse",
    "UpdatePointcloudOctomap",
    "UpdatePointcloudOctomapRequest",
    "UpdatePointcloudOctomapResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class ApplyPlanningSceneRequest(ros.Message):
    """moveit_msgs/ApplyPlanningSceneRequest"""

    _type: ClassVar[str] = "moveit_msgs/ApplyPlanningSceneRequest"

    scene: moveit_msgs.PlanningScene = field(default_factory=lambda: moveit_msgs.PlanningScene())


@dataclass(slots=True, eq=False, repr=False)
class ApplyPlanningSceneResponse(ros.Message):
    """moveit_msgs/ApplyPlanningSceneResponse"""

    _type: ClassVar[str] = "moveit_msgs/ApplyPlanningSceneResponse"

    success: bool = False


class ApplyPlanningScene(ros.Service[ApplyPlanningSceneRequest, ApplyPlanningSceneResponse]):
    """moveit_msgs/ApplyPlanningScene"""

    _type = "moveit_msgs/ApplyPlanningScene"
    Request: TypeAlias = ApplyPlanningSceneRequest
    Response: TypeAlias = ApplyPlanningSceneResponse


@dataclass(slots=True, eq=False, repr=False)
class ChangeControlDimensionsRequest(ros.Message):
    """moveit_msgs/ChangeControlDimensionsRequest"""

    _type: ClassVar[str] = "moveit_msgs/ChangeControlDimensionsRequest"

    control_x_translation: bool = False
    control_y_translation: bool = False
    control_z_translation: bool = False
    control_x_rotation: bool = False
    control_y_rotation: bool = False
    control_z_rotation: bool = False


@dataclass(slots=True, eq=False, repr=False)
class ChangeControlDimensionsResponse(ros.Message):
    """moveit_msgs/ChangeControlDimensionsResponse"""

    _type: ClassVar[str] = "moveit_msgs/ChangeControlDimensionsResponse"

    success: bool = False


class ChangeControlDimensions(
    ros.Service[ChangeControlDimensionsRequest, ChangeControlDimensionsResponse]
):
    """moveit_msgs/ChangeControlDimensions"""

    _type = "moveit_msgs/ChangeControlDimensions"
    Request: TypeAlias = ChangeControlDimensionsRequest
    Response: TypeAlias = ChangeControlDimensionsResponse


@dataclass(slots=True, eq=False, repr=False)
class ChangeDriftDimensionsRequest(ros.Message):
    """moveit_msgs/ChangeDriftDimensionsRequest"""

    _type: ClassVar[str] = "moveit_msgs/ChangeDriftDimensionsRequest"

    drift_x_translation: bool = False
    drift_y_translation: bool = False
    drift_z_translation: bool = False
    drift_x_rotation: bool = False
    drift_y_rotation: bool = False
    drift_z_rotation: bool = False
    transform_jog_frame_to_drift_frame: geometry_msgs.Transform = field(
        default_factory=lambda: geometry_msgs.Transform()
    )


@dataclass(slots=True, eq=False, repr=False)
class ChangeDriftDimensionsResponse(ros.Message):
    """moveit_msgs/ChangeDriftDimensionsResponse"""

    _type: ClassVar[str] = "moveit_msgs/ChangeDriftDimensionsResponse"

    success: bool = False


class ChangeDriftDimensions(
    ros.Service[ChangeDriftDimensionsRequest, ChangeDriftDimensionsResponse]
):
    """moveit_msgs/ChangeDriftDimensions"""

    _type = "moveit_msgs/ChangeDriftDimensions"
    Request: TypeAlias = ChangeDriftDimensionsRequest
    Response: TypeAlias = ChangeDriftDimensionsResponse


@dataclass(slots=True, eq=False, repr=False)
class CheckIfRobotStateExistsInWarehouseRequest(ros.Message):
    """moveit_msgs/CheckIfRobotStateExistsInWarehouseRequest"""

    _type: ClassVar[str] = "moveit_msgs/CheckIfRobotStateExistsInWarehouseRequest"

    name: str = ""
    robot: str = ""


@dataclass(slots=True, eq=False, repr=False)
class CheckIfRobotStateExistsInWarehouseResponse(ros.Message):
    """moveit_msgs/CheckIfRobotStateExistsInWarehouseResponse"""

    _type: ClassVar[str] = "moveit_msgs/CheckIfRobotStateExistsInWarehouseResponse"

    exists: bool = False


class CheckIfRobotStateExistsInWarehouse(
    ros.Service[
        CheckIfRobotStateExistsInWarehouseRequest,
        CheckIfRobotStateExistsInWarehouseResponse,
    ]
):
    """moveit_msgs/CheckIfRobotStateExistsInWarehouse"""

    _type = "moveit_msgs/CheckIfRobotStateExistsInWarehouse"
    Request: TypeAlias = CheckIfRobotStateExistsInWarehouseRequest
    Response: TypeAlias = CheckIfRobotStateExistsInWarehouseResponse


@dataclass(slots=True, eq=False, repr=False)
class DeleteRobotStateFromWarehouseRequest(ros.Message):
    """moveit_msgs/DeleteRobotStateFromWarehouseRequest"""

    _type: ClassVar[str] = "moveit_msgs/DeleteRobotStateFromWarehouseRequest"

    name: str = ""
    robot: str = ""


@dataclass(slots=True, eq=False, repr=False)
class DeleteRobotStateFromWarehouseResponse(ros.Message):
    """moveit_msgs/DeleteRobotStateFromWarehouseResponse"""

    _type: ClassVar[str] = "moveit_msgs/DeleteRobotStateFromWarehouseResponse"


class DeleteRobotStateFromWarehouse(
    ros.Service[DeleteRobotStateFromWarehouseRequest, DeleteRobotStateFromWarehouseResponse]
):
    """moveit_msgs/DeleteRobotStateFromWarehouse"""

    _type = "moveit_msgs/DeleteRobotStateFromWarehouse"
    Request: TypeAlias = DeleteRobotStateFromWarehouseRequest
    Response: TypeAlias = DeleteRobotStateFromWarehouseResponse


@dataclass(slots=True, eq=False, repr=False)
class ExecuteKnownTrajectoryRequest(ros.Message):
    """moveit_msgs/ExecuteKnownTrajectoryRequest"""

    _type: ClassVar[str] = "moveit_msgs/ExecuteKnownTrajectoryRequest"

    trajectory: moveit_msgs.RobotTrajectory = field(
        default_factory=lambda: moveit_msgs.RobotTrajectory()
    )
    wait_for_execution: bool = False


@dataclass(slots=True, eq=False, repr=False)
class ExecuteKnownTrajectoryResponse(ros.Message):
    """moveit_msgs/ExecuteKnownTrajectoryResponse"""

    _type: ClassVar[str] = "moveit_msgs/ExecuteKnownTrajectoryResponse"

    error_code: moveit_msgs.MoveItErrorCodes = field(
        default_factory=lambda: moveit_msgs.MoveItErrorCodes()
    )


class ExecuteKnownTrajectory(
    ros.Service[ExecuteKnownTrajectoryRequest, ExecuteKnownTrajectoryResponse]
):
    """moveit_msgs/ExecuteKnownTrajectory"""

    _type = "moveit_msgs/ExecuteKnownTrajectory"
    Request: TypeAlias = ExecuteKnownTrajectoryRequest
    Response: TypeAlias = ExecuteKnownTrajectoryResponse


@dataclass(slots=True, eq=False, repr=False)
class GetCartesianPathRequest(ros.Message):
    """moveit_msgs/GetCartesianPathRequest"""

    _type: ClassVar[str] = "moveit_msgs/GetCartesianPathRequest"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    start_state: moveit_msgs.RobotState = field(default_factory=lambda: moveit_msgs.RobotState())
    group_name: str = ""
    link_name: str = ""
    waypoints: list[geometry_msgs.Pose] = field(default_factory=list)
    max_step: float = 0.0
    jump_threshold: float = 0.0
    prismatic_jump_threshold: float = 0.0
    revolute_jump_threshold: float = 0.0
    avoid_collisions: bool = False
    path_constraints: moveit_msgs.Constraints = field(
        default_factory=lambda: moveit_msgs.Constraints()
    )
    cartesian_speed_limited_link: str = ""
    max_cartesian_speed: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class GetCartesianPathResponse(ros.Message):
    """moveit_msgs/GetCartesianPathResponse"""

    _type: ClassVar[str] = "moveit_msgs/GetCartesianPathResponse"

    start_state: moveit_msgs.RobotState = field(default_factory=lambda: moveit_msgs.RobotState())
    solution: moveit_msgs.RobotTrajectory = field(
        default_factory=lambda: moveit_msgs.RobotTrajectory()
    )
    fraction: float = 0.0
    error_code: moveit_msgs.MoveItErrorCodes = field(
        default_factory=lambda: moveit_msgs.MoveItErrorCodes()
    )


class GetCartesianPath(ros.Service[GetCartesianPathRequest, GetCartesianPathResponse]):
    """moveit_msgs/GetCartesianPath"""

    _type = "moveit_msgs/GetCartesianPath"
    Request: TypeAlias = GetCartesianPathRequest
    Response: TypeAlias = GetCartesianPathResponse


@dataclass(slots=True, eq=False, repr=False)
class GetMotionPlanRequest(ros.Message):
    """moveit_msgs/GetMotionPlanRequest"""

    _type: ClassVar[str] = "moveit_msgs/GetMotionPlanRequest"

    motion_plan_request: moveit_msgs.MotionPlanRequest = field(
        default_factory=lambda: moveit_msgs.MotionPlanRequest()
    )


@dataclass(slots=True, eq=False, repr=False)
class GetMotionPlanResponse(ros.Message):
    """moveit_msgs/GetMotionPlanResponse"""

    _type: ClassVar[str] = "moveit_msgs/GetMotionPlanResponse"

    motion_plan_response: moveit_msgs.MotionPlanResponse = field(
        default_factory=lambda: moveit_msgs.MotionPlanResponse()
    )


class GetMotionPlan(ros.Service[GetMotionPlanRequest, GetMotionPlanResponse]):
    """moveit_msgs/GetMotionPlan"""

    _type = "moveit_msgs/GetMotionPlan"
    Request: TypeAlias = GetMotionPlanRequest
    Response: TypeAlias = GetMotionPlanResponse


@dataclass(slots=True, eq=False, repr=False)
class GetMotionSequenceRequest(ros.Message):
    """moveit_msgs/GetMotionSequenceRequest"""

    _type: ClassVar[str] = "moveit_msgs/GetMotionSequenceRequest"

    request: moveit_msgs.MotionSequenceRequest = field(
        default_factory=lambda: moveit_msgs.MotionSequenceRequest()
    )


@dataclass(slots=True, eq=False, repr=False)
class GetMotionSequenceResponse(ros.Message):
    """moveit_msgs/GetMotionSequenceResponse"""

    _type: ClassVar[str] = "moveit_msgs/GetMotionSequenceResponse"

    response: moveit_msgs.MotionSequenceResponse = field(
        default_factory=lambda: moveit_msgs.MotionSequenceResponse()
    )


class GetMotionSequence(ros.Service[GetMotionSequenceRequest, GetMotionSequenceResponse]):
    """moveit_msgs/GetMotionSequence"""

    _type = "moveit_msgs/GetMotionSequence"
    Request: TypeAlias = GetMotionSequenceRequest
    Response: TypeAlias = GetMotionSequenceResponse


@dataclass(slots=True, eq=False, repr=False)
class GetPlannerParamsRequest(ros.Message):
    """moveit_msgs/GetPlannerParamsRequest"""

    _type: ClassVar[str] = "moveit_msgs/GetPlannerParamsRequest"

    pipeline_id: str = ""
    planner_config: str = ""
    group: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GetPlannerParamsResponse(ros.Message):
    """moveit_msgs/GetPlannerParamsResponse"""

    _type: ClassVar[str] = "moveit_msgs/GetPlannerParamsResponse"

    params: moveit_msgs.PlannerParams = field(default_factory=lambda: moveit_msgs.PlannerParams())


class GetPlannerParams(ros.Service[GetPlannerParamsRequest, GetPlannerParamsResponse]):
    """moveit_msgs/GetPlannerParams"""

    _type = "moveit_msgs/GetPlannerParams"
    Request: TypeAlias = GetPlannerParamsRequest
    Response: TypeAlias = GetPlannerParamsResponse


@dataclass(slots=True, eq=False, repr=False)
class GetPlanningSceneRequest(ros.Message):
    """moveit_msgs/GetPlanningSceneRequest"""

    _type: ClassVar[str] = "moveit_msgs/GetPlanningSceneRequest"

    components: moveit_msgs.PlanningSceneComponents = field(
        default_factory=lambda: moveit_msgs.PlanningSceneComponents()
    )


@dataclass(slots=True, eq=False, repr=False)
class GetPlanningSceneResponse(ros.Message):
    """moveit_msgs/GetPlanningSceneResponse"""

    _type: ClassVar[str] = "moveit_msgs/GetPlanningSceneResponse"

    scene: moveit_msgs.PlanningScene = field(default_factory=lambda: moveit_msgs.PlanningScene())


class GetPlanningScene(ros.Service[GetPlanningSceneRequest, GetPlanningSceneResponse]):
    """moveit_msgs/GetPlanningScene"""

    _type = "moveit_msgs/GetPlanningScene"
    Request: TypeAlias = GetPlanningSceneRequest
    Response: TypeAlias = GetPlanningSceneResponse


@dataclass(slots=True, eq=False, repr=False)
class GetPositionFKRequest(ros.Message):
    """moveit_msgs/GetPositionFKRequest"""

    _type: ClassVar[str] = "moveit_msgs/GetPositionFKRequest"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    fk_link_names: list[str] = field(default_factory=list)
    robot_state: moveit_msgs.RobotState = field(default_factory=lambda: moveit_msgs.RobotState())


@dataclass(slots=True, eq=False, repr=False)
class GetPositionFKResponse(ros.Message):
    """moveit_msgs/GetPositionFKResponse"""

    _type: ClassVar[str] = "moveit_msgs/GetPositionFKResponse"

    pose_stamped: list[geometry_msgs.PoseStamped] = field(default_factory=list)
    fk_link_names: list[str] = field(default_factory=list)
    error_code: moveit_msgs.MoveItErrorCodes = field(
        default_factory=lambda: moveit_msgs.MoveItErrorCodes()
    )


class GetPositionFK(ros.Service[GetPositionFKRequest, GetPositionFKResponse]):
    """moveit_msgs/GetPositionFK"""

    _type = "moveit_msgs/GetPositionFK"
    Request: TypeAlias = GetPositionFKRequest
    Response: TypeAlias = GetPositionFKResponse


@dataclass(slots=True, eq=False, repr=False)
class GetPositionIKRequest(ros.Message):
    """moveit_msgs/GetPositionIKRequest"""

    _type: ClassVar[str] = "moveit_msgs/GetPositionIKRequest"

    ik_request: moveit_msgs.PositionIKRequest = field(
        default_factory=lambda: moveit_msgs.PositionIKRequest()
    )


@dataclass(slots=True, eq=False, repr=False)
class GetPositionIKResponse(ros.Message):
    """moveit_msgs/GetPositionIKResponse"""

    _type: ClassVar[str] = "moveit_msgs/GetPositionIKResponse"

    solution: moveit_msgs.RobotState = field(default_factory=lambda: moveit_msgs.RobotState())
    error_code: moveit_msgs.MoveItErrorCodes = field(
        default_factory=lambda: moveit_msgs.MoveItErrorCodes()
    )


class GetPositionIK(ros.Service[GetPositionIKRequest, GetPositionIKResponse]):
    """moveit_msgs/GetPositionIK"""

    _type = "moveit_msgs/GetPositionIK"
    Request: TypeAlias = GetPositionIKRequest
    Response: TypeAlias = GetPositionIKResponse


@dataclass(slots=True, eq=False, repr=False)
class GetRobotStateFromWarehouseRequest(ros.Message):
    """moveit_msgs/GetRobotStateFromWarehouseRequest"""

    _type: ClassVar[str] = "moveit_msgs/GetRobotStateFromWarehouseRequest"

    name: str = ""
    robot: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GetRobotStateFromWarehouseResponse(ros.Message):
    """moveit_msgs/GetRobotStateFromWarehouseResponse"""

    _type: ClassVar[str] = "moveit_msgs/GetRobotStateFromWarehouseResponse"

    state: moveit_msgs.RobotState = field(default_factory=lambda: moveit_msgs.RobotState())


class GetRobotStateFromWarehouse(
    ros.Service[GetRobotStateFromWarehouseRequest, GetRobotStateFromWarehouseResponse]
):
    """moveit_msgs/GetRobotStateFromWarehouse"""

    _type = "moveit_msgs/GetRobotStateFromWarehouse"
    Request: TypeAlias = GetRobotStateFromWarehouseRequest
    Response: TypeAlias = GetRobotStateFromWarehouseResponse


@dataclass(slots=True, eq=False, repr=False)
class GetStateValidityRequest(ros.Message):
    """moveit_msgs/GetStateValidityRequest"""

    _type: ClassVar[str] = "moveit_msgs/GetStateValidityRequest"

    robot_state: moveit_msgs.RobotState = field(default_factory=lambda: moveit_msgs.RobotState())
    group_name: str = ""
    constraints: moveit_msgs.Constraints = field(default_factory=lambda: moveit_msgs.Constraints())


@dataclass(slots=True, eq=False, repr=False)
class GetStateValidityResponse(ros.Message):
    """moveit_msgs/GetStateValidityResponse"""

    _type: ClassVar[str] = "moveit_msgs/GetStateValidityResponse"

    valid: bool = False
    contacts: list[moveit_msgs.ContactInformation] = field(default_factory=list)
    cost_sources: list[moveit_msgs.CostSource] = field(default_factory=list)
    constraint_result: list[moveit_msgs.ConstraintEvalResult] = field(default_factory=list)


class GetStateValidity(ros.Service[GetStateValidityRequest, GetStateValidityResponse]):
    """moveit_msgs/GetStateValidity"""

    _type = "moveit_msgs/GetStateValidity"
    Request: TypeAlias = GetStateValidityRequest
    Response: TypeAlias = GetStateValidityResponse


@dataclass(slots=True, eq=False, repr=False)
class GraspPlanningRequest(ros.Message):
    """moveit_msgs/GraspPlanningRequest"""

    _type: ClassVar[str] = "moveit_msgs/GraspPlanningRequest"

    group_name: str = ""
    target: moveit_msgs.CollisionObject = field(
        default_factory=lambda: moveit_msgs.CollisionObject()
    )
    support_surfaces: list[str] = field(default_factory=list)
    candidate_grasps: list[moveit_msgs.Grasp] = field(default_factory=list)
    movable_obstacles: list[moveit_msgs.CollisionObject] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class GraspPlanningResponse(ros.Message):
    """moveit_msgs/GraspPlanningResponse"""

    _type: ClassVar[str] = "moveit_msgs/GraspPlanningResponse"

    grasps: list[moveit_msgs.Grasp] = field(default_factory=list)
    error_code: moveit_msgs.MoveItErrorCodes = field(
        default_factory=lambda: moveit_msgs.MoveItErrorCodes()
    )


class GraspPlanning(ros.Service[GraspPlanningRequest, GraspPlanningResponse]):
    """moveit_msgs/GraspPlanning"""

    _type = "moveit_msgs/GraspPlanning"
    Request: TypeAlias = GraspPlanningRequest
    Response: TypeAlias = GraspPlanningResponse


@dataclass(slots=True, eq=False, repr=False)
class ListRobotStatesInWarehouseRequest(ros.Message):
    """moveit_msgs/ListRobotStatesInWarehouseRequest"""

    _type: ClassVar[str] = "moveit_msgs/ListRobotStatesInWarehouseRequest"

    regex: str = ""
    robot: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ListRobotStatesInWarehouseResponse(ros.Message):
    """moveit_msgs/ListRobotStatesInWarehouseResponse"""

    _type: ClassVar[str] = "moveit_msgs/ListRobotStatesInWarehouseResponse"

    states: list[str] = field(default_factory=list)


class ListRobotStatesInWarehouse(
    ros.Service[ListRobotStatesInWarehouseRequest, ListRobotStatesInWarehouseResponse]
):
    """moveit_msgs/ListRobotStatesInWarehouse"""

    _type = "moveit_msgs/ListRobotStatesInWarehouse"
    Request: TypeAlias = ListRobotStatesInWarehouseRequest
    Response: TypeAlias = ListRobotStatesInWarehouseResponse


@dataclass(slots=True, eq=False, repr=False)
class LoadMapRequest(ros.Message):
    """moveit_msgs/LoadMapRequest"""

    _type: ClassVar[str] = "moveit_msgs/LoadMapRequest"

    filename: str = ""


@dataclass(slots=True, eq=False, repr=False)
class LoadMapResponse(ros.Message):
    """moveit_msgs/LoadMapResponse"""

    _type: ClassVar[str] = "moveit_msgs/LoadMapResponse"

    success: bool = False


class LoadMap(ros.Service[LoadMapRequest, LoadMapResponse]):
    """moveit_msgs/LoadMap"""

    _type = "moveit_msgs/LoadMap"
    Request: TypeAlias = LoadMapRequest
    Response: TypeAlias = LoadMapResponse


@dataclass(slots=True, eq=False, repr=False)
class QueryPlannerInterfacesRequest(ros.Message):
    """moveit_msgs/QueryPlannerInterfacesRequest"""

    _type: ClassVar[str] = "moveit_msgs/QueryPlannerInterfacesRequest"


@dataclass(slots=True, eq=False, repr=False)
class QueryPlannerInterfacesResponse(ros.Message):
    """moveit_msgs/QueryPlannerInterfacesResponse"""

    _type: ClassVar[str] = "moveit_msgs/QueryPlannerInterfacesResponse"

    planner_interfaces: list[moveit_msgs.PlannerInterfaceDescription] = field(default_factory=list)


class QueryPlannerInterfaces(
    ros.Service[QueryPlannerInterfacesRequest, QueryPlannerInterfacesResponse]
):
    """moveit_msgs/QueryPlannerInterfaces"""

    _type = "moveit_msgs/QueryPlannerInterfaces"
    Request: TypeAlias = QueryPlannerInterfacesRequest
    Response: TypeAlias = QueryPlannerInterfacesResponse


@dataclass(slots=True, eq=False, repr=False)
class RenameRobotStateInWarehouseRequest(ros.Message):
    """moveit_msgs/RenameRobotStateInWarehouseRequest"""

    _type: ClassVar[str] = "moveit_msgs/RenameRobotStateInWarehouseRequest"

    old_name: str = ""
    new_name: str = ""
    robot: str = ""


@dataclass(slots=True, eq=False, repr=False)
class RenameRobotStateInWarehouseResponse(ros.Message):
    """moveit_msgs/RenameRobotStateInWarehouseResponse"""

    _type: ClassVar[str] = "moveit_msgs/RenameRobotStateInWarehouseResponse"


class RenameRobotStateInWarehouse(
    ros.Service[RenameRobotStateInWarehouseRequest, RenameRobotStateInWarehouseResponse]
):
    """moveit_msgs/RenameRobotStateInWarehouse"""

    _type = "moveit_msgs/RenameRobotStateInWarehouse"
    Request: TypeAlias = RenameRobotStateInWarehouseRequest
    Response: TypeAlias = RenameRobotStateInWarehouseResponse


@dataclass(slots=True, eq=False, repr=False)
class SaveMapRequest(ros.Message):
    """moveit_msgs/SaveMapRequest"""

    _type: ClassVar[str] = "moveit_msgs/SaveMapRequest"

    filename: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SaveMapResponse(ros.Message):
    """moveit_msgs/SaveMapResponse"""

    _type: ClassVar[str] = "moveit_msgs/SaveMapResponse"

    success: bool = False


class SaveMap(ros.Service[SaveMapRequest, SaveMapResponse]):
    """moveit_msgs/SaveMap"""

    _type = "moveit_msgs/SaveMap"
    Request: TypeAlias = SaveMapRequest
    Response: TypeAlias = SaveMapResponse


@dataclass(slots=True, eq=False, repr=False)
class SaveRobotStateToWarehouseRequest(ros.Message):
    """moveit_msgs/SaveRobotStateToWarehouseRequest"""

    _type: ClassVar[str] = "moveit_msgs/SaveRobotStateToWarehouseRequest"

    name: str = ""
    robot: str = ""
    state: moveit_msgs.RobotState = field(default_factory=lambda: moveit_msgs.RobotState())


@dataclass(slots=True, eq=False, repr=False)
class SaveRobotStateToWarehouseResponse(ros.Message):
    """moveit_msgs/SaveRobotStateToWarehouseResponse"""

    _type: ClassVar[str] = "moveit_msgs/SaveRobotStateToWarehouseResponse"

    success: bool = False


class SaveRobotStateToWarehouse(
    ros.Service[SaveRobotStateToWarehouseRequest, SaveRobotStateToWarehouseResponse]
):
    """moveit_msgs/SaveRobotStateToWarehouse"""

    _type = "moveit_msgs/SaveRobotStateToWarehouse"
    Request: TypeAlias = SaveRobotStateToWarehouseRequest
    Response: TypeAlias = SaveRobotStateToWarehouseResponse


@dataclass(slots=True, eq=False, repr=False)
class SetPlannerParamsRequest(ros.Message):
    """moveit_msgs/SetPlannerParamsRequest"""

    _type: ClassVar[str] = "moveit_msgs/SetPlannerParamsRequest"

    pipeline_id: str = ""
    planner_config: str = ""
    group: str = ""
    params: moveit_msgs.PlannerParams = field(default_factory=lambda: moveit_msgs.PlannerParams())
    replace: bool = False


@dataclass(slots=True, eq=False, repr=False)
class SetPlannerParamsResponse(ros.Message):
    """moveit_msgs/SetPlannerParamsResponse"""

    _type: ClassVar[str] = "moveit_msgs/SetPlannerParamsResponse"


class SetPlannerParams(ros.Service[SetPlannerParamsRequest, SetPlannerParamsResponse]):
    """moveit_msgs/SetPlannerParams"""

    _type = "moveit_msgs/SetPlannerParams"
    Request: TypeAlias = SetPlannerParamsRequest
    Response: TypeAlias = SetPlannerParamsResponse


@dataclass(slots=True, eq=False, repr=False)
class UpdatePointcloudOctomapRequest(ros.Message):
    """moveit_msgs/UpdatePointcloudOctomapRequest"""

    _type: ClassVar[str] = "moveit_msgs/UpdatePointcloudOctomapRequest"

    cloud: sensor_msgs.PointCloud2 = field(default_factory=lambda: sensor_msgs.PointCloud2())


@dataclass(slots=True, eq=False, repr=False)
class UpdatePointcloudOctomapResponse(ros.Message):
    """moveit_msgs/UpdatePointcloudOctomapResponse"""

    _type: ClassVar[str] = "moveit_msgs/UpdatePointcloudOctomapResponse"

    success: bool = False


class UpdatePointcloudOctomap(
    ros.Service[UpdatePointcloudOctomapRequest, UpdatePointcloudOctomapResponse]
):
    """moveit_msgs/UpdatePointcloudOctomap"""

    _type = "moveit_msgs/UpdatePointcloudOctomap"
    Request: TypeAlias = UpdatePointcloudOctomapRequest
    Response: TypeAlias = UpdatePointcloudOctomapResponse
