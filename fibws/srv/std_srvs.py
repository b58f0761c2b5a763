"""The services of std_srvs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros

__all__ = [
    "Empty",
    "EmptyRequest",
    "EmptyResponse",
    "SetBool",
    "SetBoolRequest",
    "SetBoolResponse",
    "Trigger",
    "TriggerRequest",
    "TriggerResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class EmptyRequest(ros.Message):
    """std_srvs/EmptyRequest"""

    _type: ClassVar[str] = "std_srvs/EmptyRequest"


@dataclass(slots=True, eq=False, repr=False)
class EmptyResponse(ros.Message):
    """std_srvs/EmptyResponse"""

    _type: ClassVar[str] = "std_srvs/EmptyResponse"


class Empty(ros.Service[EmptyRequest, EmptyResponse]):
    """std_srvs/Empty"""

    _type = "std_srvs/Empty"
    Request: TypeAlias = EmptyRequest
    Response: TypeAlias = EmptyResponse


@dataclass(slots=True, eq=False, repr=False)
class SetBoolRequest(ros.Message):
    """std_srvs/SetBoolRequest"""

    _type: ClassVar[str] = "std_srvs/SetBoolRequest"

    data: bool = False


@dataclass(slots=True, eq=False, repr=False)
class SetBoolResponse(ros.Message):
    """std_srvs/SetBoolResponse"""

    _type: ClassVar[str] = "std_srvs/SetBoolResponse"

    success: bool = False
    message: str = ""


class SetBool(ros.Service[SetBoolRequest, SetBoolResponse]):
    """std_srvs/SetBool"""

    _type = "std_srvs/SetBool"
    Request: TypeAlias = SetBoolRequest
    Response: TypeAlias = SetBoolResponse


@dataclass(slots=True, eq=False, repr=False)
class TriggerRequest(ros.Message):
    """std_srvs/TriggerRequest"""

    _type: ClassVar[str] = "std_srvs/TriggerRequest"


@dataclass(slots=True, eq=False, repr=False)
class TriggerResponse(ros.Message):
    """std_srvs/TriggerResponse"""

    _type: ClassVar[str] = "std_srvs/TriggerResponse"

    success: bool = False
    message: str = ""


class Trigger(ros.Service[TriggerRequest, TriggerResponse]):
    """std_srvs/Trigger"""

    _type = "std_srvs/Trigger"
    Request: TypeAlias = TriggerRequest
    Response: TypeAlias = TriggerResponse
