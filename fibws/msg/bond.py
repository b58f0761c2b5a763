"""The messages of bond, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import std_msgs

__all__ = [
    "Constants",
    "Status",
]


@dataclass(slots=True, eq=False, repr=False)
class Constants(ros.Message):
    """bond/Constants"""

    _type: ClassVar[str] = "bond/Constants"
    DEAD_PUBLISH_PERIOD: ClassVar[float] = 0.05
    DEFAULT_CONNECT_TIMEOUT: ClassVar[float] = 10.0
    DEFAULT_HEARTBEAT_TIMEOUT: ClassVar[float] = 4.0
    DEFAULT_DISCONNECT_TIMEOUT: ClassVar[float] = 2.0
    DEFAULT_HEARTBEAT_PERIOD: ClassVar[float] = 1.0
    DISABLE_HEARTBEAT_TIMEOUT_PARAM: ClassVar[str] = "/bond_disable_heartbeat_timeout"


@dataclass(slots=True, eq=False, repr=False)
class Status(ros.Message):
    """bond/Status"""

    _type: ClassVar[str] = "bond/Status"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    id: str = ""
    instance_id: str = ""
    active: bool = False
    heartbeat_timeout: float = 0.0
    heartbeat_period: float = 0.0
