"""The services of object_recognition_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import object_recognition_msgs

__all__ = [
    "GetObjectInformation",
    "GetObjectInformationRequest",
    "GetObjectInformationResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class GetObjectInformationRequest(ros.Message):
    """object_recognition_msgs/GetObjectInformationRequest"""

    _type: ClassVar[str] = "object_recognition_msgs/GetObjectInformationRequest"

    type: object_recognition_msgs.ObjectType = field(
        default_factory=lambda: object_recognition_msgs.ObjectType()
    )


@dataclass(slots=True, eq=False, repr=False)
class GetObjectInformationResponse(ros.Message):
    """object_recognition_msgs/GetObjectInformationResponse"""

    _type: ClassVar[str] = "object_recognition_msgs/GetObjectInformationResponse"

    information: object_recognition_msgs.ObjectInformation = field(
        default_factory=lambda: object_recognition_msgs.ObjectInformation()
    )


class GetObjectInformation(ros.Service[GetObjectInformationRequest, GetObjectInformationResponse]):
    """object_recognition_msgs/GetObjectInformation"""

    _type = "object_recognition_msgs/GetObjectInformation"
    Request: TypeAlias = GetObjectInformationRequest
    Response: TypeAlias = GetObjectInformationResponse
