"""The services of gazebo_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import gazebo_msgs, geometry_msgs, std_msgs, trajectory_msgs

__all__ = [
    "ApplyBodyWrench",
    "ApplyBodyWrenchRequest",
    "ApplyBodyWrenchResponse",
    "ApplyJointEffort",
    "ApplyJointEffortRequest",
    "ApplyJointEffortResponse",
    "BodyRequest",
    "BodyRequestRequest",
    "BodyRequestResponse",
    "DeleteLight",
    "DeleteLightRequest",
    "DeleteLightResponse",
    "DeleteModel",
    "DeleteModelRequest",
    "DeleteModelResponse",
    "GetJointProperties",
    "GetJointPropertiesRequest",
    "GetJointPropertiesResponse",
    "GetLightProperties",
    "GetLightPropertiesRequest",
    "GetLightPropertiesResponse",
    "GetLinkProperties",
    "GetLinkPropertiesRequest",
    "GetLinkPropertiesResponse",
    "GetLinkState",
    "GetLinkStateRequest",
    "GetLinkStateResponse",
    "GetModelProperties",
    "GetModelPropertiesRequest",
    "GetModelPropertiesResponse",
    "GetModelState",
    "GetModelStateRequest",
    "GetModelStateResponse",
    "GetPhysicsProperties",
    "GetPhysicsPropertiesRequest",
    "GetPhysicsPropertiesResponse",
    "GetWorldProperties",
    "GetWorldPropertiesRequest",
    "GetWorldPropertiesResponse",
    "JointRequest",
    "JointRequestRequest",
    "JointRequestResponse",
    "SetJointProperties",
    "SetJointPropertiesRequest",
    "SetJointPropertiesResponse",
    "SetJointTrajectory",
    "SetJointTrajectoryRequest",
    "SetJointTrajectoryResponse",
    "SetLightProperties",
    "SetLightPropertiesRequest",
    "SetLightPropertiesResponse",
    "SetLinkProperties",
    "SetLinkPropertiesRequest",
    "SetLinkPropertiesResponse",
    "SetLinkState",
    "SetLinkStateRequest",
    "SetLinkStateResponse",
    "SetModelConfiguration",
    "SetModelConfigurationRequest",
    "SetModelConfigurationResponse",
    "SetModelState",
    "SetModelStateRequest",
    "SetModelStateResponse",
    "SetPhysicsProperties",
    "SetPhysicsPropertiesRequest",
    "SetPhysicsPropertiesResponse",
    "SpawnModel",
    "SpawnModelRequest",
    "SpawnModelResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class ApplyBodyWrenchRequest(ros.Message):
    """gazebo_msgs/ApplyBodyWrenchRequest"""

    _type: ClassVar[str] = "gazebo_msgs/ApplyBodyWrenchRequest"

    body_name: str = ""
    reference_frame: str = ""
    reference_point: geometry_msgs.Point = field(default_factory=lambda: geometry_msgs.Point())
    wrench: geometry_msgs.Wrench = field(default_factory=lambda: geometry_msgs.Wrench())
    start_time: ros.Time = field(default_factory=ros.Time)
    duration: ros.Duration = field(default_factory=ros.Duration)


@dataclass(slots=True, eq=False, repr=False)
class ApplyBodyWrenchResponse(ros.Message):
    """gazebo_msgs/ApplyBodyWrenchResponse"""

    _type: ClassVar[str] = "gazebo_msgs/ApplyBodyWrenchResponse"

    success: bool = False
    status_message: str = ""


class ApplyBodyWrench(ros.Service[ApplyBodyWrenchRequest, ApplyBodyWrenchResponse]):
    """gazebo_msgs/ApplyBodyWrench"""

    _type = "gazebo_msgs/ApplyBodyWrench"
    Request: TypeAlias = ApplyBodyWrenchRequest
    Response: TypeAlias = ApplyBodyWrenchResponse


@dataclass(slots=True, eq=False, repr=False)
class ApplyJointEffortRequest(ros.Message):
    """gazebo_msgs/ApplyJointEffortRequest"""

    _type: ClassVar[str] = "gazebo_msgs/ApplyJointEffortRequest"

    joint_name: str = ""
    effort: float = 0.0
    start_time: ros.Time = field(default_factory=ros.Time)
    duration: ros.Duration = field(default_factory=ros.Duration)


@dataclass(slots=True, eq=False, repr=False)
class ApplyJointEffortResponse(ros.Message):
    """gazebo_msgs/ApplyJointEffortResponse"""

    _type: ClassVar[str] = "gazebo_msgs/ApplyJointEffortResponse"

    success: bool = False
    status_message: str = ""


class ApplyJointEffort(ros.Service[ApplyJointEffortRequest, ApplyJointEffortResponse]):
    """gazebo_msgs/ApplyJointEffort"""

    _type = "gazebo_msgs/ApplyJointEffort"
    Request: TypeAlias = ApplyJointEffortRequest
    Response: TypeAlias = ApplyJointEffortResponse


@dataclass(slots=True, eq=False, repr=False)
class BodyRequestRequest(ros.Message):
    """gazebo_msgs/BodyRequestRequest"""

    _type: ClassVar[str] = "gazebo_msgs/BodyRequestRequest"

    body_name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class BodyRequestResponse(ros.Message):
    """gazebo_msgs/BodyRequestResponse"""

    _type: ClassVar[str] = "gazebo_msgs/BodyRequestResponse"


class BodyRequest(ros.Service[BodyRequestRequest, BodyRequestResponse]):
    """gazebo_msgs/BodyRequest"""

    _type = "gazebo_msgs/BodyRequest"
    Request: TypeAlias = BodyRequestRequest
    Response: TypeAlias = BodyRequestResponse


@dataclass(slots=True, eq=False, repr=False)
class DeleteLightRequest(ros.Message):
    """gazebo_msgs/DeleteLightRequest"""

    _type: ClassVar[str] = "gazebo_msgs/DeleteLightRequest"

    light_name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class DeleteLightResponse(ros.Message):
    """gazebo_msgs/DeleteLightResponse"""

    _type: ClassVar[str] = "gazebo_msgs/DeleteLightResponse"

    success: bool = False
    status_message: str = ""


class DeleteLight(ros.Service[DeleteLightRequest, DeleteLightResponse]):
    """gazebo_msgs/DeleteLight"""

    _type = "gazebo_msgs/DeleteLight"
    Request: TypeAlias = DeleteLightRequest
    Response: TypeAlias = DeleteLightResponse


@dataclass(slots=True, eq=False, repr=False)
class DeleteModelRequest(ros.Message):
    """gazebo_msgs/DeleteModelRequest"""

    _type: ClassVar[str] = "gazebo_msgs/DeleteModelRequest"

    model_name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class DeleteModelResponse(ros.Message):
    """gazebo_msgs/DeleteModelResponse"""

    _type: ClassVar[str] = "gazebo_msgs/DeleteModelResponse"

    success: bool = False
    status_message: str = ""


class DeleteModel(ros.Service[DeleteModelRequest, DeleteModelResponse]):
    """gazebo_msgs/DeleteModel"""

    _type = "gazebo_msgs/DeleteModel"
    Request: TypeAlias = DeleteModelRequest
    Response: TypeAlias = DeleteModelResponse


@dataclass(slots=True, eq=False, repr=False)
class GetJointPropertiesRequest(ros.Message):
    """gazebo_msgs/GetJointPropertiesRequest"""

    _type: ClassVar[str] = "gazebo_msgs/GetJointPropertiesRequest"

    joint_name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GetJointPropertiesResponse(ros.Message):
    """gazebo_msgs/GetJointPropertiesResponse"""

    _type: ClassVar[str] = "gazebo_msgs/GetJointPropertiesResponse"
    REVOLUTE: ClassVar[int] = 0
    CONTINUOUS: ClassVar[int] = 1
    PRISMATIC: ClassVar[int] = 2
    FIXED: ClassVar[int] = 3
    BALL: ClassVar[int] = 4
    UNIVERSAL: ClassVar[int] = 5

    type: int = 0
    damping: list[float] = field(default_factory=list)
    position: list[float] = field(default_factory=list)
    rate: list[float] = field(default_factory=list)
    success: bool = False
    status_message: str = ""


class GetJointProperties(ros.Service[GetJointPropertiesRequest, GetJointPropertiesResponse]):
    """gazebo_msgs/GetJointProperties"""

    _type = "gazebo_msgs/GetJointProperties"
    Request: TypeAlias = GetJointPropertiesRequest
    Response: TypeAlias = GetJointPropertiesResponse


@dataclass(slots=True, eq=False, repr=False)
class GetLightPropertiesRequest(ros.Message):
    """gazebo_msgs/GetLightPropertiesRequest"""

    _type: ClassVar[str] = "gazebo_msgs/GetLightPropertiesRequest"

    light_name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GetLightPropertiesResponse(ros.Message):
    """gazebo_msgs/GetLightPropertiesResponse"""

    _type: ClassVar[str] = "gazebo_msgs/GetLightPropertiesResponse"

    diffuse: std_msgs.ColorRGBA = field(default_factory=lambda: std_msgs.ColorRGBA())
    attenuation_constant: float = 0.0
    attenuation_linear: float = 0.0
    attenuation_quadratic: float = 0.0
    success: bool = False
    status_message: str = ""


class GetLightProperties(ros.Service[GetLightPropertiesRequest, GetLightPropertiesResponse]):
    """gazebo_msgs/GetLightProperties"""

    _type = "gazebo_msgs/GetLightProperties"
    Request: TypeAlias = GetLightPropertiesRequest
    Response: TypeAlias = GetLightPropertiesResponse


@dataclass(slots=True, eq=False, repr=False)
class GetLinkPropertiesRequest(ros.Message):
    """gazebo_msgs/GetLinkPropertiesRequest"""

    _type: ClassVar[str] = "gazebo_msgs/GetLinkPropertiesRequest"

    link_name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GetLinkPropertiesResponse(ros.Message):
    """gazebo_msgs/GetLinkPropertiesResponse"""

    _type: ClassVar[str] = "gazebo_msgs/GetLinkPropertiesResponse"

    com: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    gravity_mode: bool = False
    mass: float = 0.0
    ixx: float = 0.0
    ixy: float = 0.0
    ixz: float = 0.0
    iyy: float = 0.0
    iyz: float = 0.0
    izz: float = 0.0
    success: bool = False
    status_message: str = ""


class GetLinkProperties(ros.Service[GetLinkPropertiesRequest, GetLinkPropertiesResponse]):
    """gazebo_msgs/GetLinkProperties"""

    _type = "gazebo_msgs/GetLinkProperties"
    Request: TypeAlias = GetLinkPropertiesRequest
    Response: TypeAlias = GetLinkPropertiesResponse


@dataclass(slots=True, eq=False, repr=False)
class GetLinkStateRequest(ros.Message):
    """gazebo_msgs/GetLinkStateRequest"""

    _type: ClassVar[str] = "gazebo_msgs/GetLinkStateRequest"

    link_name: str = ""
    reference_frame: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GetLinkStateResponse(ros.Message):
    """gazebo_msgs/GetLinkStateResponse"""

    _type: ClassVar[str] = "gazebo_msgs/GetLinkStateResponse"

    link_state: gazebo_msgs.LinkState = field(default_factory=lambda: gazebo_msgs.LinkState())
    success: bool = False
    status_message: str = ""


class GetLinkState(ros.Service[GetLinkStateRequest, GetLinkStateResponse]):
    """gazebo_msgs/GetLinkState"""

    _type = "gazebo_msgs/GetLinkState"
    Request: TypeAlias = GetLinkStateRequest
    Response: TypeAlias = GetLinkStateResponse


@dataclass(slots=True, eq=False, repr=False)
class GetModelPropertiesRequest(ros.Message):
    """gazebo_msgs/GetModelPropertiesRequest"""

    _type: ClassVar[str] = "gazebo_msgs/GetModelPropertiesRequest"

    model_name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GetModelPropertiesResponse(ros.Message):
    """gazebo_msgs/GetModelPropertiesResponse"""

    _type: ClassVar[str] = "gazebo_msgs/GetModelPropertiesResponse"

    parent_model_name: str = ""
    canonical_body_name: str = ""
    body_names: list[str] = field(default_factory=list)
    geom_names: list[str] = field(default_factory=list)
    joint_names: list[str] = field(default_factory=list)
    child_model_names: list[str] = field(default_factory=list)
    is_static: bool = False
    success: bool = False
    status_message: str = ""


class GetModelProperties(ros.Service[GetModelPropertiesRequest, GetModelPropertiesResponse]):
    """gazebo_msgs/GetModelProperties"""

    _type = "gazebo_msgs/GetModelProperties"
    Request: TypeAlias = GetModelPropertiesRequest
    Response: TypeAlias = GetModelPropertiesResponse


@dataclass(slots=True, eq=False, repr=False)
class GetModelStateRequest(ros.Message):
    """gazebo_msgs/GetModelStateRequest"""

    _type: ClassVar[str] = "gazebo_msgs/GetModelStateRequest"

    model_name: str = ""
    relative_entity_name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class GetModelStateResponse(ros.Message):
    """gazebo_msgs/GetModelStateResponse"""

    _type: ClassVar[str] = "gazebo_msgs/GetModelStateResponse"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    twist: geometry_msgs.Twist = field(default_factory=lambda: geometry_msgs.Twist())
    success: bool = False
    status_message: str = ""


class GetModelState(ros.Service[GetModelStateRequest, GetModelStateResponse]):
    """gazebo_msgs/GetModelState"""

    _type = "gazebo_msgs/GetModelState"
    Request: TypeAlias = GetModelStateRequest
    Response: TypeAlias = GetModelStateResponse


@dataclass(slots=True, eq=False, repr=False)
class GetPhysicsPropertiesRequest(ros.Message):
    """gazebo_msgs/GetPhysicsPropertiesRequest"""

    _type: ClassVar[str] = "gazebo_msgs/GetPhysicsPropertiesRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetPhysicsPropertiesResponse(ros.Message):
    """gazebo_msgs/GetPhysicsPropertiesResponse"""

    _type: ClassVar[str] = "gazebo_msgs/GetPhysicsPropertiesResponse"

    time_step: float = 0.0
    pause: bool = False
    max_update_rate: float = 0.0
    gravity: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())
    ode_config: gazebo_msgs.ODEPhysics = field(default_factory=lambda: gazebo_msgs.ODEPhysics())
    success: bool = False
    status_message: str = ""


class GetPhysicsProperties(ros.Service[GetPhysicsPropertiesRequest, GetPhysicsPropertiesResponse]):
    """gazebo_msgs/GetPhysicsProperties"""

    _type = "gazebo_msgs/GetPhysicsProperties"
    Request: TypeAlias = GetPhysicsPropertiesRequest
    Response: TypeAlias = GetPhysicsPropertiesResponse


@dataclass(slots=True, eq=False, repr=False)
class GetWorldPropertiesRequest(ros.Message):
    """gazebo_msgs/GetWorldPropertiesRequest"""

    _type: ClassVar[str] = "gazebo_msgs/GetWorldPropertiesRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetWorldPropertiesResponse(ros.Message):
    """gazebo_msgs/GetWorldPropertiesResponse"""

    _type: ClassVar[str] = "gazebo_msgs/GetWorldPropertiesResponse"

    sim_time: float = 0.0
    model_names: list[str] = field(default_factory=list)
    rendering_enabled: bool = False
    success: bool = False
    status_message: str = ""


class GetWorldProperties(ros.Service[GetWorldPropertiesRequest, GetWorldPropertiesResponse]):
    """gazebo_msgs/GetWorldProperties"""

    _type = "gazebo_msgs/GetWorldProperties"
    Request: TypeAlias = GetWorldPropertiesRequest
    Response: TypeAlias = GetWorldPropertiesResponse


@dataclass(slots=True, eq=False, repr=False)
class JointRequestRequest(ros.Message):
    """gazebo_msgs/JointRequestRequest"""

    _type: ClassVar[str] = "gazebo_msgs/JointRequestRequest"

    joint_name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class JointRequestResponse(ros.Message):
    """gazebo_msgs/JointRequestResponse"""

    _type: ClassVar[str] = "gazebo_msgs/JointRequestResponse"


class JointRequest(ros.Service[JointRequestRequest, JointRequestResponse]):
    """gazebo_msgs/JointRequest"""

    _type = "gazebo_msgs/JointRequest"
    Request: TypeAlias = JointRequestRequest
    Response: TypeAlias = JointRequestResponse


@dataclass(slots=True, eq=False, repr=False)
class SetJointPropertiesRequest(ros.Message):
    """gazebo_msgs/SetJointPropertiesRequest"""

    _type: ClassVar[str] = "gazebo_msgs/SetJointPropertiesRequest"

    joint_name: str = ""
    ode_joint_config: gazebo_msgs.ODEJointProperties = field(
        default_factory=lambda: gazebo_msgs.ODEJointProperties()
    )


@dataclass(slots=True, eq=False, repr=False)
class SetJointPropertiesResponse(ros.Message):
    """gazebo_msgs/SetJointPropertiesResponse"""

    _type: ClassVar[str] = "gazebo_msgs/SetJointPropertiesResponse"

    success: bool = False
    status_message: str = ""


class SetJointProperties(ros.Service[SetJointPropertiesRequest, SetJointPropertiesResponse]):
    """gazebo_msgs/SetJointProperties"""

    _type = "gazebo_msgs/SetJointProperties"
    Request: TypeAlias = SetJointPropertiesRequest
    Response: TypeAlias = SetJointPropertiesResponse


@dataclass(slots=True, eq=False, repr=False)
class SetJointTrajectoryRequest(ros.Message):
    """gazebo_msgs/SetJointTrajectoryRequest"""

    _type: ClassVar[str] = "gazebo_msgs/SetJointTrajectoryRequest"

    model_name: str = ""
    joint_trajectory: trajectory_msgs.JointTrajectory = field(
        default_factory=lambda: trajectory_msgs.JointTrajectory()
    )
    model_pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    set_model_pose: bool = False
    disable_physics_updates: bool = False


@dataclass(slots=True, eq=False, repr=False)
class SetJointTrajectoryResponse(ros.Message):
    """gazebo_msgs/SetJointTrajectoryResponse"""

    _type: ClassVar[str] = "gazebo_msgs/SetJointTrajectoryResponse"

    success: bool = False
    status_message: str = ""


class SetJointTrajectory(ros.Service[SetJointTrajectoryRequest, SetJointTrajectoryResponse]):
    """gazebo_msgs/SetJointTrajectory"""

    _type = "gazebo_msgs/SetJointTrajectory"
    Request: TypeAlias = SetJointTrajectoryRequest
    Response: TypeAlias = SetJointTrajectoryResponse


@dataclass(slots=True, eq=False, repr=False)
class SetLightPropertiesRequest(ros.Message):
    """gazebo_msgs/SetLightPropertiesRequest"""

    _type: ClassVar[str] = "gazebo_msgs/SetLightPropertiesRequest"

    light_name: str = ""
    cast_shadows: bool = False
    diffuse: std_msgs.ColorRGBA = field(default_factory=lambda: std_msgs.ColorRGBA())
    specular: std_msgs.ColorRGBA = field(default_factory=lambda: std_msgs.ColorRGBA())
    attenuation_constant: float = 0.0
    attenuation_linear: float = 0.0
    attenuation_quadratic: float = 0.0
    direction: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())
    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())


@dataclass(slots=True, eq=False, repr=False)
class SetLightPropertiesResponse(ros.Message):
    """gazebo_msgs/SetLightPropertiesResponse"""

    _type: ClassVar[str] = "gazebo_msgs/SetLightPropertiesResponse"

    success: bool = False
    status_message: str = ""


class SetLightProperties(ros.Service[SetLightPropertiesRequest, SetLightPropertiesResponse]):
    """gazebo_msgs/SetLightProperties"""

    _type = "gazebo_msgs/SetLightProperties"
    Request: TypeAlias = SetLightPropertiesRequest
    Response: TypeAlias = SetLightPropertiesResponse


@dataclass(slots=True, eq=False, repr=False)
class SetLinkPropertiesRequest(ros.Message):
    """gazebo_msgs/SetLinkPropertiesRequest"""

    _type: ClassVar[str] = "gazebo_msgs/SetLinkPropertiesRequest"

    link_name: str = ""
    com: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    gravity_mode: bool = False
    mass: float = 0.0
    ixx: float = 0.0
    ixy: float = 0.0
    ixz: float = 0.0
    iyy: float = 0.0
    iyz: float = 0.0
    izz: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class SetLinkPropertiesResponse(ros.Message):
    """gazebo_msgs/SetLinkPropertiesResponse"""

    _type: ClassVar[str] = "gazebo_msgs/SetLinkPropertiesResponse"

    success: bool = False
    status_message: str = ""


class SetLinkProperties(ros.Service[SetLinkPropertiesRequest, SetLinkPropertiesResponse]):
    """gazebo_msgs/SetLinkProperties"""

    _type = "gazebo_msgs/SetLinkProperties"
    Request: TypeAlias = SetLinkPropertiesRequest
    Response: TypeAlias = SetLinkPropertiesResponse


@dataclass(slots=True, eq=False, repr=False)
class SetLinkStateRequest(ros.Message):
    """gazebo_msgs/SetLinkStateRequest"""

    _type: ClassVar[str] = "gazebo_msgs/SetLinkStateRequest"

    link_state: gazebo_msgs.LinkState = field(default_factory=lambda: gazebo_msgs.LinkState())


@dataclass(slots=True, eq=False, repr=False)
class SetLinkStateResponse(ros.Message):
    """gazebo_msgs/SetLinkStateResponse"""

    _type: ClassVar[str] = "gazebo_msgs/SetLinkStateResponse"

    success: bool = False
    status_message: str = ""


class SetLinkState(ros.Service[SetLinkStateRequest, SetLinkStateResponse]):
    """gazebo_msgs/SetLinkState"""

    _type = "gazebo_msgs/SetLinkState"
    Request: TypeAlias = SetLinkStateRequest
    Response: TypeAlias = SetLinkStateResponse


@dataclass(slots=True, eq=False, repr=False)
class SetModelConfigurationRequest(ros.Message):
    """gazebo_msgs/SetModelConfigurationRequest"""

    _type: ClassVar[str] = "gazebo_msgs/SetModelConfigurationRequest"

    model_name: str = ""
    urdf_param_name: str = ""
    joint_names: list[str] = field(default_factory=list)
    joint_positions: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class SetModelConfigurationResponse(ros.Message):
    """gazebo_msgs/SetModelConfigurationResponse"""

    _type: ClassVar[str] = "gazebo_msgs/SetModelConfigurationResponse"

    success: bool = False
    status_message: str = ""


class SetModelConfiguration(
    ros.Service[SetModelConfigurationRequest, SetModelConfigurationResponse]
):
    """gazebo_msgs/SetModelConfiguration"""

    _type = "gazebo_msgs/SetModelConfiguration"
    Request: TypeAlias = SetModelConfigurationRequest
    Response: TypeAlias = SetModelConfigurationResponse


@dataclass(slots=True, eq=False, repr=False)
class SetModelStateRequest(ros.Message):
    """gazebo_msgs/SetModelStateRequest"""

    _type: ClassVar[str] = "gazebo_msgs/SetModelStateRequest"

    model_state: gazebo_msgs.ModelState = field(default_factory=lambda: gazebo_msgs.ModelState())


@dataclass(slots=True, eq=False, repr=False)
class SetModelStateResponse(ros.Message):
    """gazebo_msgs/SetModelStateResponse"""

    _type: ClassVar[str] = "gazebo_msgs/SetModelStateResponse"

    success: bool = False
    status_message: str = ""


class SetModelState(ros.Service[SetModelStateRequest, SetModelStateResponse]):
    """gazebo_msgs/SetModelState"""

    _type = "gazebo_msgs/SetModelState"
    Request: TypeAlias = SetModelStateRequest
    Response: TypeAlias = SetModelStateResponse


@dataclass(slots=True, eq=False, repr=False)
class SetPhysicsPropertiesRequest(ros.Message):
    """gazebo_msgs/SetPhysicsPropertiesRequest"""

    _type: ClassVar[str] = "gazebo_msgs/SetPhysicsPropertiesRequest"

    time_step: float = 0.0
    max_update_rate: float = 0.0
    gravity: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())
    ode_config: gazebo_msgs.ODEPhysics = field(default_factory=lambda: gazebo_msgs.ODEPhysics())


@dataclass(slots=True, eq=False, repr=False)
class SetPhysicsPropertiesResponse(ros.Message):
    """gazebo_msgs/SetPhysicsPropertiesResponse"""

    _type: ClassVar[str] = "gazebo_msgs/SetPhysicsPropertiesResponse"

    success: bool = False
    status_message: str = ""


class SetPhysicsProperties(ros.Service[SetPhysicsPropertiesRequest, SetPhysicsPropertiesResponse]):
    """gazebo_msgs/SetPhysicsProperties"""

    _type = "gazebo_msgs/SetPhysicsProperties"
    Request: TypeAlias = SetPhysicsPropertiesRequest
    Response: TypeAlias = SetPhysicsPropertiesResponse


@dataclass(slots=True, eq=False, repr=False)
class SpawnModelRequest(ros.Message):
    """gazebo_msgs/SpawnModelRequest"""

    _type: ClassVar[str] = "gazebo_msgs/SpawnModelRequest"

    model_name: str = ""
    model_xml: str = ""
    robot_namespace: str = ""
    initial_pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    reference_frame: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SpawnModelResponse(ros.Message):
    """gazebo_msgs/SpawnModelResponse"""

    _type: ClassVar[str] = "gazebo_msgs/SpawnModelResponse"

    success: bool = False
    status_message: str = ""


class SpawnModel(ros.Service[SpawnModelRequest, SpawnModelResponse]):
    """gazebo_msgs/SpawnModel"""

    _type = "gazebo_msgs/SpawnModel"
    Request: TypeAlias = SpawnModelRequest
    Response: TypeAlias = SpawnModelResponse
