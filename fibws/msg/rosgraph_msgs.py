"""The messages of rosgraph_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import std_msgs

__all__ = [
    "Clock",
    "Log",
    "TopicStatistics",
]


@dataclass(slots=True, eq=False, repr=False)
class Clock(ros.Message):
    """rosgraph_msgs/Clock"""

    _type: ClassVar[str] = "rosgraph_msgs/Clock"

    clock: ros.Time = field(default_factory=ros.Time)


@dataclass(slots=True, eq=False, repr=False)
class Log(ros.Message):
    """rosgraph_msgs/Log"""

    _type: ClassVar[str] = "rosgraph_msgs/Log"
    DEBUG: ClassVar[int] = 1
    INFO: ClassVar[int] = 2
    WARN: ClassVar[int] = 4
    ERROR: ClassVar[int] = 8
    FATAL: ClassVar[int] = 16

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    level: int = 0
    name: str = ""
    msg: str = ""
    file: str = ""
    function: str = ""
    line: int = 0
    topics: list[str] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class TopicStatistics(ros.Message):
    """rosgraph_msgs/TopicStatistics"""

    _type: ClassVar[str] = "rosgraph_msgs/TopicStatistics"

    topic: str = ""
    node_pub: str = ""
    node_sub: str = ""
    window_start: ros.Time = field(default_factory=ros.Time)
    window_stop: ros.Time = field(default_factory=ros.Time)
    delivered_msgs: int = 0
    dropped_msgs: int = 0
    traffic: int = 0
    period_mean: ros.Duration = field(default_factory=ros.Duration)
    period_stddev: ros.Duration = field(default_factory=ros.Duration)
    period_max: ros.Duration = field(default_factory=ros.Duration)
    stamp_age_mean: ros.Duration = field(default_factory=ros.Duration)
    stamp_age_stddev: ros.Duration = field(default_factory=ros.Duration)
    stamp_age_max: ros.Duration = field(default_factory=ros.Duration)
