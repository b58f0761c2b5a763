"""The services of diagnostic_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import diagnostic_msgs

__all__ = [
    "AddDiagnostics",
    "AddDiagnosticsRequest",
    "AddDiagnosticsResponse",
    "SelfTest",
    "SelfTestRequest",
    "SelfTestResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class AddDiagnosticsRequest(ros.Message):
    """diagnostic_msgs/AddDiagnosticsRequest"""

    _type: ClassVar[str] = "diagnostic_msgs/AddDiagnosticsRequest"

    load_namespace: str = ""


@dataclass(slots=True, eq=False, repr=False)
class AddDiagnosticsResponse(ros.Message):
    """diagnostic_msgs/AddDiagnosticsResponse"""

    _type: ClassVar[str] = "diagnostic_msgs/AddDiagnosticsResponse"

    success: bool = False
    message: str = ""


class AddDiagnostics(ros.Service[AddDiagnosticsRequest, AddDiagnosticsResponse]):
    """diagnostic_msgs/AddDiagnostics"""

    _type = "diagnostic_msgs/AddDiagnostics"
    Request: TypeAlias = AddDiagnosticsRequest
    Response: TypeAlias = AddDiagnosticsResponse


@dataclass(slots=True, eq=False, repr=False)
class SelfTestRequest(ros.Message):
    """diagnostic_msgs/SelfTestRequest"""

    _type: ClassVar[str] = "diagnostic_msgs/SelfTestRequest"


@dataclass(slots=True, eq=False, repr=False)
class SelfTestResponse(ros.Message):
    """diagnostic_msgs/SelfTestResponse"""

    _type: ClassVar[str] = "diagnostic_msgs/SelfTestResponse"

    id: str = ""
    passed: int = 0
    status: list[diagnostic_msgs.DiagnosticStatus] = field(default_factory=list)


class SelfTest(ros.Service[SelfTestRequest, SelfTestResponse]):
    """diagnostic_msgs/SelfTest"""

    _type = "diagnostic_msgs/SelfTest"
    Request: TypeAlias = SelfTestRequest
    Response: TypeAlias = SelfTestResponse
