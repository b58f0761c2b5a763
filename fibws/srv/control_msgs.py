"""The services of control_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros

__all__ = [
    "QueryCalibrationState",
    "QueryCalibrationStateRequest",
    "QueryCalibrationStateResponse",
    "QueryTrajectoryState",
    "QueryTrajectoryStateRequest",
    "QueryTrajectoryStateResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class QueryCalibrationStateRequest(ros.Message):
    """control_msgs/QueryCalibrationStateRequest"""

    _type: ClassVar[str] = "control_msgs/QueryCalibrationStateRequest"


@dataclass(slots=True, eq=False, repr=False)
class QueryCalibrationStateResponse(ros.Message):
    """control_msgs/QueryCalibrationStateResponse"""

    _type: ClassVar[str] = "control_msgs/QueryCalibrationStateResponse"

    is_calibrated: bool = False


class QueryCalibrationState(
    ros.Service[QueryCalibrationStateRequest, QueryCalibrationStateResponse]
):
    """control_msgs/QueryCalibrationState"""

    _type = "control_msgs/QueryCalibrationState"
    Request: TypeAlias = QueryCalibrationStateRequest
    Response: TypeAlias = QueryCalibrationStateResponse


@dataclass(slots=True, eq=False, repr=False)
class QueryTrajectoryStateRequest(ros.Message):
    """control_msgs/QueryTrajectoryStateRequest"""

    _type: ClassVar[str] = "control_msgs/QueryTrajectoryStateRequest"

    time: ros.Time = field(default_factory=ros.Time)


@dataclass(slots=True, eq=False, repr=False)
class QueryTrajectoryStateResponse(ros.Message):
    """control_msgs/QueryTrajectoryStateResponse"""

    _type: ClassVar[str] = "control_msgs/QueryTrajectoryStateResponse"

    name: list[str] = field(default_factory=list)
    position: list[float] = field(default_factory=list)
    velocity: list[float] = field(default_factory=list)
    acceleration: list[float] = field(default_factory=list)


class QueryTrajectoryState(ros.Service[QueryTrajectoryStateRequest, QueryTrajectoryStateResponse]):
    """control_msgs/QueryTrajectoryState"""

    _type = "control_msgs/QueryTrajectoryState"
    Request: TypeAlias = QueryTrajectoryStateRequest
    Response: TypeAlias = QueryTrajectoryStateResponse
