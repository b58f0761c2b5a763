"""The messages of rosserial_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import fibws.interfaces as ros

__all__ = [
    "Log",
    "TopicInfo",
]


@dataclass(slots=True, eq=False, repr=False)
class Log(ros.Message):
    """rosserial_msgs/Log"""

    _type: ClassVar[str] = "rosserial_msgs/Log"
    ROSDEBUG: ClassVar[int] = 0
    INFO: ClassVar[int] = 1
    WARN: ClassVar[int] = 2
    ERROR: ClassVar[int] = 3
    FATAL: ClassVar[int] = 4

    level: int = 0
    msg: str = ""


@dataclass(slots=True, eq=False, repr=False)
class TopicInfo(ros.Message):
    """rosserial_msgs/TopicInfo"""

    _type: ClassVar[str] = "rosserial_msgs/TopicInfo"
    ID_PUBLISHER: ClassVar[int] = 0
    ID_SUBSCRIBER: ClassVar[int] = 1
    ID_SERVICE_SERVER: ClassVar[int] = 2
    ID_SERVICE_CLIENT: ClassVar[int] = 4
    ID_PARAMETER_REQUEST: ClassVar[int] = 6
    ID_LOG: ClassVar[int] = 7
    ID_TIME: ClassVar[int] = 10
    ID_TX_STOP: ClassVar[int] = 11

    topic_id: int = 0
    topic_name: str = ""
    message_type: str = ""
    md5sum: str = ""
    buffer_size: int = 0
