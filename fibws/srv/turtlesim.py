"""The services of turtlesim, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros

__all__ = [
    "Kill",
    "KillRequest",
    "KillResponse",
    "SetPen",
    "SetPenRequest",
    "SetPenResponse",
    "Spawn",
    "SpawnRequest",
    "SpawnResponse",
    "TeleportAbsolute",
    "TeleportAbsoluteRequest",
    "TeleportAbsoluteResponse",
    "TeleportRelative",
    "TeleportRelativeRequest",
    "TeleportRelativeResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class KillRequest(ros.Message):
    """turtlesim/KillRequest"""

    _type: ClassVar[str] = "turtlesim/KillRequest"

    name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class KillResponse(ros.Message):
    """turtlesim/KillResponse"""

    _type: ClassVar[str] = "turtlesim/KillResponse"


class Kill(ros.Service[KillRequest, KillResponse]):
    """turtlesim/Kill"""

    _type = "turtlesim/Kill"
    Request: TypeAlias = KillRequest
    Response: TypeAlias = KillResponse


@dataclass(slots=True, eq=False, repr=False)
class SetPenRequest(ros.Message):
    """turtlesim/SetPenRequest"""

    _type: ClassVar[str] = "turtlesim/SetPenRequest"

    r: int = 0
    g: int = 0
    b: int = 0
    width: int = 0
    off: int = 0


@dataclass(slots=True, eq=False, repr=False)
class SetPenResponse(ros.Message):
    """turtlesim/SetPenResponse"""

    _type: ClassVar[str] = "turtlesim/SetPenResponse"


class SetPen(ros.Service[SetPenRequest, SetPenResponse]):
    """turtlesim/SetPen"""

    _type = "turtlesim/SetPen"
    Request: TypeAlias = SetPenRequest
    Response: TypeAlias = SetPenResponse


@dataclass(slots=True, eq=False, repr=False)
class SpawnRequest(ros.Message):
    """turtlesim/SpawnRequest"""

    _type: ClassVar[str] = "turtlesim/SpawnRequest"

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0
    name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SpawnResponse(ros.Message):
    """turtlesim/SpawnResponse"""

    _type: ClassVar[str] = "turtlesim/SpawnResponse"

    name: str = ""


class Spawn(ros.Service[SpawnRequest, SpawnResponse]):
    """turtlesim/Spawn"""

    _type = "turtlesim/Spawn"
    Request: TypeAlias = SpawnRequest
    Response: TypeAlias = SpawnResponse


@dataclass(slots=True, eq=False, repr=False)
class TeleportAbsoluteRequest(ros.Message):
    """turtlesim/TeleportAbsoluteRequest"""

    _type: ClassVar[str] = "turtlesim/TeleportAbsoluteRequest"

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class TeleportAbsoluteResponse(ros.Message):
    """turtlesim/TeleportAbsoluteResponse"""

    _type: ClassVar[str] = "turtlesim/TeleportAbsoluteResponse"


class TeleportAbsolute(ros.Service[TeleportAbsoluteRequest, TeleportAbsoluteResponse]):
    """turtlesim/TeleportAbsolute"""

    _type = "turtlesim/TeleportAbsolute"
    Request: TypeAlias = TeleportAbsoluteRequest
    Response: TypeAlias = TeleportAbsoluteResponse


@dataclass(slots=True, eq=False, repr=False)
class TeleportRelativeRequest(ros.Message):
    """turtlesim/TeleportRelativeRequest"""

    _type: ClassVar[str] = "turtlesim/TeleportRelativeRequest"

    linear: float = 0.0
    angular: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class TeleportRelativeResponse(ros.Message):
    """turtlesim/TeleportRelativeResponse"""

    _type: ClassVar[str] = "turtlesim/TeleportRelativeResponse"


class TeleportRelative(ros.Service[TeleportRelativeRequest, TeleportRelativeResponse]):
    """turtlesim/TeleportRelative"""

    _type = "turtlesim/TeleportRelative"
    Request: TypeAlias = TeleportRelativeRequest
    Response: TypeAlias = TeleportRelativeResponse
