"""The messages of fibws_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros

__all__ = [
    "ActionInfo",
    "ClientStatistics",
    "ConflictInfo",
    "HubInfo",
    "HubLink",
    "NodeInfo",
    "PlaybackState",
    "PublisherInfo",
    "PublisherStatistics",
    "RecordingState",
    "ServiceInfo",
    "SubscriptionInfo",
    "SubscriptionStatistics",
    "TopicInfo",
    "TopicStatistics",
]


@dataclass(slots=True, eq=False, repr=False)
class ActionInfo(ros.Message):
    """fibws_msgs/ActionInfo"""

    _type: ClassVar[str] = "fibws_msgs/ActionInfo"

    name: str = ""
    type: str = ""
    node: str = ""
    over_topics: bool = False


@dataclass(slots=True, eq=False, repr=False)
class ClientStatistics(ros.Message):
    """fibws_msgs/ClientStatistics"""

    _type: ClassVar[str] = "fibws_msgs/ClientStatistics"

    node: str = ""
    address: str = ""
    principal: str = ""
    protocol: str = ""
    since: ros.Time = field(default_factory=ros.Time)
    messages_received: int = 0
    bytes_received: int = 0
    messages_sent: int = 0
    bytes_sent: int = 0
    kept_bytes: int = 0
    dropped: int = 0
    limited: int = 0
    subscriptions: int = 0
    advertisements: int = 0
    slow: bool = False


@dataclass(slots=True, eq=False, repr=False)
class ConflictInfo(ros.Message):
    """fibws_msgs/ConflictInfo"""

    _type: ClassVar[str] = "fibws_msgs/ConflictInfo"

    node: str = ""
    type: str = ""
    publishes: bool = False
    fault: str = ""


@dataclass(slots=True, eq=False, repr=False)
class HubInfo(ros.Message):
    """fibws_msgs/HubInfo"""

    _type: ClassVar[str] = "fibws_msgs/HubInfo"

    id: str = ""
    name: str = ""
    version: str = ""
    link: str = ""
    distance: int = 0
    nodes: int = 0


@dataclass(slots=True, eq=False, repr=False)
class HubLink(ros.Message):
    """fibws_msgs/HubLink"""

    _type: ClassVar[str] = "fibws_msgs/HubLink"

    kind: str = ""
    address: str = ""
    name: str = ""
    id: str = ""
    version: str = ""
    fault: str = ""
    since: ros.Time = field(default_factory=ros.Time)
    round_trip: float = 0.0
    clock_offset: float = 0.0
    messages_sent: int = 0
    messages_received: int = 0
    bytes_sent: int = 0
    bytes_received: int = 0
    dropped: int = 0
    lost: int = 0


@dataclass(slots=True, eq=False, repr=False)
class NodeInfo(ros.Message):
    """fibws_msgs/NodeInfo"""

    _type: ClassVar[str] = "fibws_msgs/NodeInfo"

    name: str = ""
    address: str = ""
    since: ros.Time = field(default_factory=ros.Time)
    own: bool = False
    api: str = ""
    fault: str = ""
    hub: str = ""


@dataclass(slots=True, eq=False, repr=False)
class PlaybackState(ros.Message):
    """fibws_msgs/PlaybackState"""

    _type: ClassVar[str] = "fibws_msgs/PlaybackState"
    PLAYING: ClassVar[int] = 1
    PAUSED: ClassVar[int] = 2
    DELAYED: ClassVar[int] = 3
    ENDED: ClassVar[int] = 4

    status: int = 0
    start: ros.Time = field(default_factory=ros.Time)
    end: ros.Time = field(default_factory=ros.Time)
    position: ros.Time = field(default_factory=ros.Time)
    rate: float = 0.0
    bags: list[str] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class PublisherInfo(ros.Message):
    """fibws_msgs/PublisherInfo"""

    _type: ClassVar[str] = "fibws_msgs/PublisherInfo"

    node: str = ""
    latch: bool = False


@dataclass(slots=True, eq=False, repr=False)
class PublisherStatistics(ros.Message):
    """fibws_msgs/PublisherStatistics"""

    _type: ClassVar[str] = "fibws_msgs/PublisherStatistics"

    node: str = ""
    messages: int = 0
    bytes_: int = 0


@dataclass(slots=True, eq=False, repr=False)
class RecordingState(ros.Message):
    """fibws_msgs/RecordingState"""

    _type: ClassVar[str] = "fibws_msgs/RecordingState"

    stamp: ros.Time = field(default_factory=ros.Time)
    recording: bool = False
    since: ros.Time = field(default_factory=ros.Time)
    file: str = ""
    files: int = 0
    messages: int = 0
    bytes_: int = 0
    buffered: int = 0
    dropped: int = 0
    fault: str = ""


@dataclass(slots=True, eq=False, repr=False)
class ServiceInfo(ros.Message):
    """fibws_msgs/ServiceInfo"""

    _type: ClassVar[str] = "fibws_msgs/ServiceInfo"

    name: str = ""
    type: str = ""
    node: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SubscriptionInfo(ros.Message):
    """fibws_msgs/SubscriptionInfo"""

    _type: ClassVar[str] = "fibws_msgs/SubscriptionInfo"

    node: str = ""
    queue_length: int = 0
    throttle_rate: int = 0
    compression: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SubscriptionStatistics(ros.Message):
    """fibws_msgs/SubscriptionStatistics"""

    _type: ClassVar[str] = "fibws_msgs/SubscriptionStatistics"

    node: str = ""
    messages: int = 0
    dropped: int = 0
    throttled: int = 0


@dataclass(slots=True, eq=False, repr=False)
class TopicInfo(ros.Message):
    """fibws_msgs/TopicInfo"""

    _type: ClassVar[str] = "fibws_msgs/TopicInfo"

    name: str = ""
    type: str = ""
    checked: bool = False
    publishers: list[PublisherInfo] = field(default_factory=list)
    subscriptions: list[SubscriptionInfo] = field(default_factory=list)
    conflicts: list[ConflictInfo] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class TopicStatistics(ros.Message):
    """fibws_msgs/TopicStatistics"""

    _type: ClassVar[str] = "fibws_msgs/TopicStatistics"

    topic: str = ""
    publishers: list[PublisherStatistics] = field(default_factory=list)
    subscriptions: list[SubscriptionStatistics] = field(default_factory=list)
