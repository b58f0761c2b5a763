"""The services of sensor_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import sensor_msgs

__all__ = [
    "SetCameraInfo",
    "SetCameraInfoRequest",
    "SetCameraInfoResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class SetCameraInfoRequest(ros.Message):
    """sensor_msgs/SetCameraInfoRequest"""

    _type: ClassVar[str] = "sensor_msgs/SetCameraInfoRequest"

    camera_info: sensor_msgs.CameraInfo = field(default_factory=lambda: sensor_msgs.CameraInfo())


@dataclass(slots=True, eq=False, repr=False)
class SetCameraInfoResponse(ros.Message):
    """sensor_msgs/SetCameraInfoResponse"""

    _type: ClassVar[str] = "sensor_msgs/SetCameraInfoResponse"

    success: bool = False
    status_message: str = ""


class SetCameraInfo(ros.Service[SetCameraInfoRequest, SetCameraInfoResponse]):
    """sensor_msgs/SetCameraInfo"""

    _type = "sensor_msgs/SetCameraInfo"
    Request: TypeAlias = SetCameraInfoRequest
    Response: TypeAlias = SetCameraInfoResponse
