"""The messages of diagnostic_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import std_msgs

__all__ = [
    "DiagnosticArray",
    "DiagnosticStatus",
    "KeyValue",
]


@dataclass(slots=True, eq=False, repr=False)
class KeyValue(ros.Message):
    """diagnostic_msgs/KeyValue"""

    _type: ClassVar[str] = "diagnostic_msgs/KeyValue"

    key: str = ""
    value: str = ""


@dataclass(slots=True, eq=False, repr=False)
class DiagnosticStatus(ros.Message):
    """diagnostic_msgs/DiagnosticStatus"""

    _type: ClassVar[str] = "diagnostic_msgs/DiagnosticStatus"
    OK: ClassVar[int] = 0
    WARN: ClassVar[int] = 1
    ERROR: ClassVar[int] = 2
    STALE: ClassVar[int] = 3

    level: int = 0
    name: str = ""
    message: str = ""
    hardware_id: str = ""
    values: list[KeyValue] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class DiagnosticArray(ros.Message):
    """diagnostic_msgs/DiagnosticArray"""

    _type: ClassVar[str] = "diagnostic_msgs/DiagnosticArray"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: list[DiagnosticStatus] = field(default_factory=list)
