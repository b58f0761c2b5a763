"""The services of fibws_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import fibws_msgs

__all__ = [
    "ControlPlayback",
    "ControlPlaybackRequest",
    "ControlPlaybackResponse",
    "GetGraph",
    "GetGraphRequest",
    "GetGraphResponse",
    "GetHubs",
    "GetHubsRequest",
    "GetHubsResponse",
    "GetRecording",
    "GetRecordingRequest",
    "GetRecordingResponse",
    "GetStatistics",
    "GetStatisticsRequest",
    "GetStatisticsResponse",
    "KillNode",
    "KillNodeRequest",
    "KillNodeResponse",
    "PingNode",
    "PingNodeRequest",
    "PingNodeResponse",
    "UnregisterNode",
    "UnregisterNodeRequest",
    "UnregisterNodeResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class ControlPlaybackRequest(ros.Message):
    """fibws_msgs/ControlPlaybackRequest"""

    _type: ClassVar[str] = "fibws_msgs/ControlPlaybackRequest"

    command: str = ""
    position: ros.Time = field(default_factory=ros.Time)
    rate: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class ControlPlaybackResponse(ros.Message):
    """fibws_msgs/ControlPlaybackResponse"""

    _type: ClassVar[str] = "fibws_msgs/ControlPlaybackResponse"

    success: bool = False
    message: str = ""
    state: fibws_msgs.PlaybackState = field(default_factory=lambda: fibws_msgs.PlaybackState())


class ControlPlayback(ros.Service[ControlPlaybackRequest, ControlPlaybackResponse]):
    """fibws_msgs/ControlPlayback"""

    _type = "fibws_msgs/ControlPlayback"
    Request: TypeAlias = ControlPlaybackRequest
    Response: TypeAlias = ControlPlaybackResponse


@dataclass(slots=True, eq=False, repr=False)
class GetGraphRequest(ros.Message):
    """fibws_msgs/GetGraphRequest"""

    _type: ClassVar[str] = "fibws_msgs/GetGraphRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetGraphResponse(ros.Message):
    """fibws_msgs/GetGraphResponse"""

    _type: ClassVar[str] = "fibws_msgs/GetGraphResponse"

    revision: int = 0
    nodes: list[fibws_msgs.NodeInfo] = field(default_factory=list)
    topics: list[fibws_msgs.TopicInfo] = field(default_factory=list)
    services: list[fibws_msgs.ServiceInfo] = field(default_factory=list)
    actions: list[fibws_msgs.ActionInfo] = field(default_factory=list)


class GetGraph(ros.Service[GetGraphRequest, GetGraphResponse]):
    """fibws_msgs/GetGraph"""

    _type = "fibws_msgs/GetGraph"
    Request: TypeAlias = GetGraphRequest
    Response: TypeAlias = GetGraphResponse


@dataclass(slots=True, eq=False, repr=False)
class GetHubsRequest(ros.Message):
    """fibws_msgs/GetHubsRequest"""

    _type: ClassVar[str] = "fibws_msgs/GetHubsRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetHubsResponse(ros.Message):
    """fibws_msgs/GetHubsResponse"""

    _type: ClassVar[str] = "fibws_msgs/GetHubsResponse"

    stamp: ros.Time = field(default_factory=ros.Time)
    hub: fibws_msgs.HubInfo = field(default_factory=lambda: fibws_msgs.HubInfo())
    links: list[fibws_msgs.HubLink] = field(default_factory=list)
    hubs: list[fibws_msgs.HubInfo] = field(default_factory=list)


class GetHubs(ros.Service[GetHubsRequest, GetHubsResponse]):
    """fibws_msgs/GetHubs"""

    _type = "fibws_msgs/GetHubs"
    Request: TypeAlias = GetHubsRequest
    Response: TypeAlias = GetHubsResponse


@dataclass(slots=True, eq=False, repr=False)
class GetRecordingRequest(ros.Message):
    """fibws_msgs/GetRecordingRequest"""

    _type: ClassVar[str] = "fibws_msgs/GetRecordingRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetRecordingResponse(ros.Message):
    """fibws_msgs/GetRecordingResponse"""

    _type: ClassVar[str] = "fibws_msgs/GetRecordingResponse"

    state: fibws_msgs.RecordingState = field(default_factory=lambda: fibws_msgs.RecordingState())


class GetRecording(ros.Service[GetRecordingRequest, GetRecordingResponse]):
    """fibws_msgs/GetRecording"""

    _type = "fibws_msgs/GetRecording"
    Request: TypeAlias = GetRecordingRequest
    Response: TypeAlias = GetRecordingResponse


@dataclass(slots=True, eq=False, repr=False)
class GetStatisticsRequest(ros.Message):
    """fibws_msgs/GetStatisticsRequest"""

    _type: ClassVar[str] = "fibws_msgs/GetStatisticsRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetStatisticsResponse(ros.Message):
    """fibws_msgs/GetStatisticsResponse"""

    _type: ClassVar[str] = "fibws_msgs/GetStatisticsResponse"

    revision: int = 0
    stamp: ros.Time = field(default_factory=ros.Time)
    topics: list[fibws_msgs.TopicStatistics] = field(default_factory=list)
    clients: list[fibws_msgs.ClientStatistics] = field(default_factory=list)


class GetStatistics(ros.Service[GetStatisticsRequest, GetStatisticsResponse]):
    """fibws_msgs/GetStatistics"""

    _type = "fibws_msgs/GetStatistics"
    Request: TypeAlias = GetStatisticsRequest
    Response: TypeAlias = GetStatisticsResponse


@dataclass(slots=True, eq=False, repr=False)
class KillNodeRequest(ros.Message):
    """fibws_msgs/KillNodeRequest"""

    _type: ClassVar[str] = "fibws_msgs/KillNodeRequest"

    node: str = ""


@dataclass(slots=True, eq=False, repr=False)
class KillNodeResponse(ros.Message):
    """fibws_msgs/KillNodeResponse"""

    _type: ClassVar[str] = "fibws_msgs/KillNodeResponse"

    success: bool = False
    message: str = ""


class KillNode(ros.Service[KillNodeRequest, KillNodeResponse]):
    """fibws_msgs/KillNode"""

    _type = "fibws_msgs/KillNode"
    Request: TypeAlias = KillNodeRequest
    Response: TypeAlias = KillNodeResponse


@dataclass(slots=True, eq=False, repr=False)
class PingNodeRequest(ros.Message):
    """fibws_msgs/PingNodeRequest"""

    _type: ClassVar[str] = "fibws_msgs/PingNodeRequest"

    node: str = ""


@dataclass(slots=True, eq=False, repr=False)
class PingNodeResponse(ros.Message):
    """fibws_msgs/PingNodeResponse"""

    _type: ClassVar[str] = "fibws_msgs/PingNodeResponse"

    success: bool = False
    message: str = ""
    seconds: float = 0.0


class PingNode(ros.Service[PingNodeRequest, PingNodeResponse]):
    """fibws_msgs/PingNode"""

    _type = "fibws_msgs/PingNode"
    Request: TypeAlias = PingNodeRequest
    Response: TypeAlias = PingNodeResponse


@dataclass(slots=True, eq=False, repr=False)
class UnregisterNodeRequest(ros.Message):
    """fibws_msgs/UnregisterNodeRequest"""

    _type: ClassVar[str] = "fibws_msgs/UnregisterNodeRequest"

    node: str = ""


@dataclass(slots=True, eq=False, repr=False)
class UnregisterNodeResponse(ros.Message):
    """fibws_msgs/UnregisterNodeResponse"""

    _type: ClassVar[str] = "fibws_msgs/UnregisterNodeResponse"

    success: bool = False
    message: str = ""


class UnregisterNode(ros.Service[UnregisterNodeRequest, UnregisterNodeResponse]):
    """fibws_msgs/UnregisterNode"""

    _type = "fibws_msgs/UnregisterNode"
    Request: TypeAlias = UnregisterNodeRequest
    Response: TypeAlias = UnregisterNodeResponse
