"""The services of tf2_web_republisher_interfaces, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros

__all__ = [
    "RepublishTFs",
    "RepublishTFsRequest",
    "RepublishTFsResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class RepublishTFsRequest(ros.Message):
    """tf2_web_republisher_interfaces/RepublishTFsRequest"""

    _type: ClassVar[str] = "tf2_web_republisher_interfaces/RepublishTFsRequest"

    source_frames: list[str] = field(default_factory=list)
    target_frame: str = ""
    angular_thres: float = 0.0
    trans_thres: float = 0.0
    rate: float = 0.0
    timeout: ros.Duration = field(default_factory=ros.Duration)


@dataclass(slots=True, eq=False, repr=False)
class RepublishTFsResponse(ros.Message):
    """tf2_web_republisher_interfaces/RepublishTFsResponse"""

    _type: ClassVar[str] = "tf2_web_republisher_interfaces/RepublishTFsResponse"

    topic_name: str = ""


class RepublishTFs(ros.Service[RepublishTFsRequest, RepublishTFsResponse]):
    """tf2_web_republisher_interfaces/RepublishTFs"""

    _type = "tf2_web_republisher_interfaces/RepublishTFs"
    Request: TypeAlias = RepublishTFsRequest
    Response: TypeAlias = RepublishTFsResponse
