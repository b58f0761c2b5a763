"""The messages of gazebo_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import geometry_msgs, std_msgs

__all__ = [
    "ContactState",
    "ContactsState",
    "LinkState",
    "LinkStates",
    "ModelState",
    "ModelStates",
    "ODEJointProperties",
    "ODEPhysics",
    "PerformanceMetrics",
    "SensorPerformanceMetric",
    "WorldState",
]


@dataclass(slots=True, eq=False, repr=False)
class ContactState(ros.Message):
    """gazebo_msgs/ContactState"""

    _type: ClassVar[str] = "gazebo_msgs/ContactState"

    info: str = ""
    collision1_name: str = ""
    collision2_name: str = ""
    wrenches: list[geometry_msgs.Wrench] = field(default_factory=list)
    total_wrench: geometry_msgs.Wrench = field(default_factory=lambda: geometry_msgs.Wrench())
    contact_positions: list[geometry_msgs.Vector3] = field(default_factory=list)
    contact_normals: list[geometry_msgs.Vector3] = field(default_factory=list)
    depths: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class ContactsState(ros.Message):
    """gazebo_msgs/ContactsState"""

    _type: ClassVar[str] = "gazebo_msgs/ContactsState"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    states: list[ContactState] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class LinkState(ros.Message):
    """gazebo_msgs/LinkState"""

    _type: ClassVar[str] = "gazebo_msgs/LinkState"

    link_name: str = ""
    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    twist: geometry_msgs.Twist = field(default_factory=lambda: geometry_msgs.Twist())
    reference_frame: str = ""


@dataclass(slots=True, eq=False, repr=False)
class LinkStates(ros.Message):
    """gazebo_msgs/LinkStates"""

    _type: ClassVar[str] = "gazebo_msgs/LinkStates"

    name: list[str] = field(default_factory=list)
    pose: list[geometry_msgs.Pose] = field(default_factory=list)
    twist: list[geometry_msgs.Twist] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class ModelState(ros.Message):
    """gazebo_msgs/ModelState"""

    _type: ClassVar[str] = "gazebo_msgs/ModelState"

    model_name: str = ""
    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    twist: geometry_msgs.Twist = field(default_factory=lambda: geometry_msgs.Twist())
    reference_frame: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ModelStates(ros.Message):
    """gazebo_msgs/ModelStates"""

    _type: ClassVar[str] = "gazebo_msgs/ModelStates"

    name: list[str] = field(default_factory=list)
    pose: list[geometry_msgs.Pose] = field(default_factory=list)
    twist: list[geometry_msgs.Twist] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class ODEJointProperties(ros.Message):
    """gazebo_msgs/ODEJointProperties"""

    _type: ClassVar[str] = "gazebo_msgs/ODEJointProperties"

    damping: list[float] = field(default_factory=list)
    hiStop: list[float] = field(default_factory=list)
    loStop: list[float] = field(default_factory=list)
    erp: list[float] = field(default_factory=list)
    cfm: list[float] = field(default_factory=list)
    stop_erp: list[float] = field(default_factory=list)
    stop_cfm: list[float] = field(default_factory=list)
    fudge_factor: list[float] = field(default_factory=list)
    fmax: list[float] = field(default_factory=list)
    vel: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class ODEPhysics(ros.Message):
    """gazebo_msgs/ODEPhysics"""

    _type: ClassVar[str] = "gazebo_msgs/ODEPhysics"

    auto_disable_bodies: bool = False
    sor_pgs_precon_iters: int = 0
    sor_pgs_iters: int = 0
    sor_pgs_w: float = 0.0
    sor_pgs_rms_error_tol: float = 0.0
    contact_surface_layer: float = 0.0
    contact_max_correcting_vel: float = 0.0
    cfm: float = 0.0
    erp: float = 0.0
    max_contacts: int = 0


@dataclass(slots=True, eq=False, repr=False)
class SensorPerformanceMetric(ros.Message):
    """gazebo_msgs/SensorPerformanceMetric"""

    _type: ClassVar[str] = "gazebo_msgs/SensorPerformanceMetric"

    name: str = ""
    sim_update_rate: float = 0.0
    real_update_rate: float = 0.0
    fps: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class PerformanceMetrics(ros.Message):
    """gazebo_msgs/PerformanceMetrics"""

    _type: ClassVar[str] = "gazebo_msgs/PerformanceMetrics"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    real_time_factor: float = 0.0
    sensors: list[SensorPerformanceMetric] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class WorldState(ros.Message):
    """gazebo_msgs/WorldState"""

    _type: ClassVar[str] = "gazebo_msgs/WorldState"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    name: list[str] = field(default_factory=list)
    pose: list[geometry_msgs.Pose] = field(default_factory=list)
    twist: list[geometry_msgs.Twist] = field(default_factory=list)
    wrench: list[geometry_msgs.Wrench] = field(default_factory=list)
