"""The services of rosserial_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros

__all__ = [
    "RequestMessageInfo",
    "RequestMessageInfoRequest",
    "RequestMessageInfoResponse",
    "RequestParam",
    "RequestParamRequest",
    "RequestParamResponse",
    "RequestServiceInfo",
    "RequestServiceInfoRequest",
    "RequestServiceInfoResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class RequestMessageInfoRequest(ros.Message):
    """rosserial_msgs/RequestMessageInfoRequest"""

    _type: ClassVar[str] = "rosserial_msgs/RequestMessageInfoRequest"

    type: str = ""


@dataclass(slots=True, eq=False, repr=False)
class RequestMessageInfoResponse(ros.Message):
    """rosserial_msgs/RequestMessageInfoResponse"""

    _type: ClassVar[str] = "rosserial_msgs/RequestMessageInfoResponse"

    md5: str = ""
    definition: str = ""


class RequestMessageInfo(ros.Service[RequestMessageInfoRequest, RequestMessageInfoResponse]):
    """rosserial_msgs/RequestMessageInfo"""

    _type = "rosserial_msgs/RequestMessageInfo"
    Request: TypeAlias = RequestMessageInfoRequest
    Response: TypeAlias = RequestMessageInfoResponse


@dataclass(slots=True, eq=False, repr=False)
class RequestParamRequest(ros.Message):
    """rosserial_msgs/RequestParamRequest"""

    _type: ClassVar[str] = "rosserial_msgs/RequestParamRequest"

    name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class RequestParamResponse(ros.Message):
    """rosserial_msgs/RequestParamResponse"""

    _type: ClassVar[str] = "rosserial_msgs/RequestParamResponse"

    ints: list[int] = field(default_factory=list)
    floats: list[float] = field(default_factory=list)
    strings: list[str] = field(default_factory=list)


class RequestParam(ros.Service[RequestParamRequest, RequestParamResponse]):
    """rosserial_msgs/RequestParam"""

    _type = "rosserial_msgs/RequestParam"
    Request: TypeAlias = RequestParamRequest
    Response: TypeAlias = RequestParamResponse


@dataclass(slots=True, eq=False, repr=False)
class RequestServiceInfoRequest(ros.Message):
    """rosserial_msgs/RequestServiceInfoRequest"""

    _type: ClassVar[str] = "rosserial_msgs/RequestServiceInfoRequest"

    service: str = ""


@dataclass(slots=True, eq=False, repr=False)
class RequestServiceInfoResponse(ros.Message):
    """rosserial_msgs/RequestServiceInfoResponse"""

    _type: ClassVar[str] = "rosserial_msgs/RequestServiceInfoResponse"

    service_md5: str = ""
    request_md5: str = ""
    response_md5: str = ""


class RequestServiceInfo(ros.Service[RequestServiceInfoRequest, RequestServiceInfoResponse]):
    """rosserial_msgs/RequestServiceInfo"""

    _type = "rosserial_msgs/RequestServiceInfo"
    Request: TypeAlias = RequestServiceInfoRequest
    Response: TypeAlias = RequestServiceInfoResponse
