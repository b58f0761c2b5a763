"""The messages of smach_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import std_msgs

__all__ = [
    "SmachContainerInitialStatusCmd",
    "SmachContainerStatus",
    "SmachContainerStructure",
]


@dataclass(slots=True, eq=False, repr=False)
class SmachContainerInitialStatusCmd(ros.Message):
    """smach_msgs/SmachContainerInitialStatusCmd"""

    _type: ClassVar[str] = "smach_msgs/SmachContainerInitialStatusCmd"

    path: str = ""
    initial_states: list[str] = field(default_factory=list)
    local_data: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SmachContainerStatus(ros.Message):
    """smach_msgs/SmachContainerStatus"""

    _type: ClassVar[str] = "smach_msgs/SmachContainerStatus"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    path: str = ""
    initial_states: list[str] = field(default_factory=list)
    active_states: list[str] = field(default_factory=list)
    local_data: str = ""
    info: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SmachContainerStructure(ros.Message):
    """smach_msgs/SmachContainerStructure"""

    _type: ClassVar[str] = "smach_msgs/SmachContainerStructure"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    path: str = ""
    children: list[str] = field(default_factory=list)
    internal_outcomes: list[str] = field(default_factory=list)
    outcomes_from: list[str] = field(default_factory=list)
    outcomes_to: list[str] = field(default_factory=list)
    container_outcomes: list[str] = field(default_factory=list)
