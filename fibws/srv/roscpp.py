"""The services of roscpp, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import roscpp

__all__ = [
    "Empty",
    "EmptyRequest",
    "EmptyResponse",
    "GetLoggers",
    "GetLoggersRequest",
    "GetLoggersResponse",
    "SetLoggerLevel",
    "SetLoggerLevelRequest",
    "SetLoggerLevelResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class EmptyRequest(ros.Message):
    """roscpp/EmptyRequest"""

    _type: ClassVar[str] = "roscpp/EmptyRequest"


@dataclass(slots=True, eq=False, repr=False)
class EmptyResponse(ros.Message):
    """roscpp/EmptyResponse"""

    _type: ClassVar[str] = "roscpp/EmptyResponse"


class Empty(ros.Service[EmptyRequest, EmptyResponse]):
    """roscpp/Empty"""

    _type = "roscpp/Empty"
    Request: TypeAlias = EmptyRequest
    Response: TypeAlias = EmptyResponse


@dataclass(slots=True, eq=False, repr=False)
class GetLoggersRequest(ros.Message):
    """roscpp/GetLoggersRequest"""

    _type: ClassVar[str] = "roscpp/GetLoggersRequest"


@dataclass(slots=True, eq=False, repr=False)
class GetLoggersResponse(ros.Message):
    """roscpp/GetLoggersResponse"""

    _type: ClassVar[str] = "roscpp/GetLoggersResponse"

    loggers: list[roscpp.Logger] = field(default_factory=list)


class GetLoggers(ros.Service[GetLoggersRequest, GetLoggersResponse]):
    """roscpp/GetLoggers"""

    _type = "roscpp/GetLoggers"
    Request: TypeAlias = GetLoggersRequest
    Response: TypeAlias = GetLoggersResponse


@dataclass(slots=True, eq=False, repr=False)
class SetLoggerLevelRequest(ros.Message):
    """roscpp/SetLoggerLevelRequest"""

    _type: ClassVar[str] = "roscpp/SetLoggerLevelRequest"

    logger: str = ""
    level: str = ""


@dataclass(slots=True, eq=False, repr=False)
class SetLoggerLevelResponse(ros.Message):
    """roscpp/SetLoggerLevelResponse"""

    _type: ClassVar[str] = "roscpp/SetLoggerLevelResponse"


class SetLoggerLevel(ros.Service[SetLoggerLevelRequest, SetLoggerLevelResponse]):
    """roscpp/SetLoggerLevel"""

    _type = "roscpp/SetLoggerLevel"
    Request: TypeAlias = SetLoggerLevelRequest
    Response: TypeAlias = SetLoggerLevelResponse
