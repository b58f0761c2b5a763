"""The services of tf2_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros

__all__ = [
    "FrameGraph",
    "FrameGraphRequest",
    "FrameGraphResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class FrameGraphRequest(ros.Message):
    """tf2_msgs/FrameGraphRequest"""

    _type: ClassVar[str] = "tf2_msgs/FrameGraphRequest"


@dataclass(slots=True, eq=False, repr=False)
class FrameGraphResponse(ros.Message):
    """tf2_msgs/FrameGraphResponse"""

    _type: ClassVar[str] = "tf2_msgs/FrameGraphResponse"

    frame_yaml: str = ""


class FrameGraph(ros.Service[FrameGraphRequest, FrameGraphResponse]):
    """tf2_msgs/FrameGraph"""

    _type = "tf2_msgs/FrameGraph"
    Request: TypeAlias = FrameGraphRequest
    Response: TypeAlias = FrameGraphResponse
