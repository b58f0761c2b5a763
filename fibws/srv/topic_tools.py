"""The services of topic_tools, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros

__all__ = [
    "DemuxAdd",
    "DemuxAddRequest",
    "DemuxAddResponse",
    "DemuxDelete",
    "DemuxDeleteRequest",
    "DemuxDeleteResponse",
    "DemuxList",
    "DemuxListRequest",
    "DemuxListResponse",
    "DemuxSelect",
    "DemuxSelectRequest",
    "DemuxSelectResponse",
    "MuxAdd",
    "MuxAddRequest",
    "MuxAddResponse",
    "MuxDelete",
    "MuxDeleteRequest",
    "MuxDeleteResponse",
    "MuxList",
    "MuxListRequest",
    "MuxListResponse",
    "MuxSelect",
    "MuxSelectRequest",
    "MuxSelectResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class DemuxAddRequest(ros.Message):
    """topic_tools/DemuxAddRequest"""

    _type: ClassVar[str] = "topic_tools/DemuxAddRequest"

    topic: str = ""


@dataclass(slots=True, eq=False, repr=False)
class DemuxAddResponse(ros.Message):
    """topic_tools/DemuxAddResponse"""

    _type: ClassVar[str] = "topic_tools/DemuxAddResponse"


class DemuxAdd(ros.Service[DemuxAddRequest, DemuxAddResponse]):
    """topic_tools/DemuxAdd"""

    _type = "topic_tools/DemuxAdd"
    Request: TypeAlias = DemuxAddRequest
    Response: TypeAlias = DemuxAddResponse


@dataclass(slots=True, eq=False, repr=False)
class DemuxDeleteRequest(ros.Message):
    """topic_tools/DemuxDeleteRequest"""

    _type: ClassVar[str] = "topic_tools/DemuxDeleteRequest"

    topic: str = ""


@dataclass(slots=True, eq=False, repr=False)
class DemuxDeleteResponse(ros.Message):
    """topic_tools/DemuxDeleteResponse"""

    _type: ClassVar[str] = "topic_tools/DemuxDeleteResponse"


class DemuxDelete(ros.Service[DemuxDeleteRequest, DemuxDeleteResponse]):
    """topic_tools/DemuxDelete"""

    _type = "topic_tools/DemuxDelete"
    Request: TypeAlias = DemuxDeleteRequest
    Response: TypeAlias = DemuxDeleteResponse


@dataclass(slots=True, eq=False, repr=False)
class DemuxListRequest(ros.Message):
    """topic_tools/DemuxListRequest"""

    _type: ClassVar[str] = "topic_tools/DemuxListRequest"


@dataclass(slots=True, eq=False, repr=False)
class DemuxListResponse(ros.Message):
    """topic_tools/DemuxListResponse"""

    _type: ClassVar[str] = "topic_tools/DemuxListResponse"

    topics: list[str] = field(default_factory=list)


class DemuxList(ros.Service[DemuxListRequest, DemuxListResponse]):
    """topic_tools/DemuxList"""

    _type = "topic_tools/DemuxList"
    Request: TypeAlias = DemuxListRequest
    Response: TypeAlias = DemuxListResponse


@dataclass(slots=True, eq=False, repr=False)
class DemuxSelectRequest(ros.Message):
    """topic_tools/DemuxSelectRequest"""

    _type: ClassVar[str] = "topic_tools/DemuxSelectRequest"

    topic: str = ""


@dataclass(slots=True, eq=False, repr=False)
class DemuxSelectResponse(ros.Message):
    """topic_tools/DemuxSelectResponse"""

    _type: ClassVar[str] = "topic_tools/DemuxSelectResponse"

    prev_topic: str = ""


class DemuxSelect(ros.Service[DemuxSelectRequest, DemuxSelectResponse]):
    """topic_tools/DemuxSelect"""

    _type = "topic_tools/DemuxSelect"
    Request: TypeAlias = DemuxSelectRequest
    Response: TypeAlias = DemuxSelectResponse


@dataclass(slots=True, eq=False, repr=False)
class MuxAddRequest(ros.Message):
    """topic_tools/MuxAddRequest"""

    _type: ClassVar[str] = "topic_tools/MuxAddRequest"

    topic: str = ""


@dataclass(slots=True, eq=False, repr=False)
class MuxAddResponse(ros.Message):
    """topic_tools/MuxAddResponse"""

    _type: ClassVar[str] = "topic_tools/MuxAddResponse"


class MuxAdd(ros.Service[MuxAddRequest, MuxAddResponse]):
    """topic_tools/MuxAdd"""

    _type = "topic_tools/MuxAdd"
    Request: TypeAlias = MuxAddRequest
    Response: TypeAlias = MuxAddResponse


@dataclass(slots=True, eq=False, repr=False)
class MuxDeleteRequest(ros.Message):
    """topic_tools/MuxDeleteRequest"""

    _type: ClassVar[str] = "topic_tools/MuxDeleteRequest"

    topic: str = ""


@dataclass(slots=True, eq=False, repr=False)
class MuxDeleteResponse(ros.Message):
    """topic_tools/MuxDeleteResponse"""

    _type: ClassVar[str] = "topic_tools/MuxDeleteResponse"


class MuxDelete(ros.Service[MuxDeleteRequest, MuxDeleteResponse]):
    """topic_tools/MuxDelete"""

    _type = "topic_tools/MuxDelete"
    Request: TypeAlias = MuxDeleteRequest
    Response: TypeAlias = MuxDeleteResponse


@dataclass(slots=True, eq=False, repr=False)
class MuxListRequest(ros.Message):
    """topic_tools/MuxListRequest"""

    _type: ClassVar[str] = "topic_tools/MuxListRequest"


@dataclass(slots=True, eq=False, repr=False)
class MuxListResponse(ros.Message):
    """topic_tools/MuxListResponse"""

    _type: ClassVar[str] = "topic_tools/MuxListResponse"

    topics: list[str] = field(default_factory=list)


class MuxList(ros.Service[MuxListRequest, MuxListResponse]):
    """topic_tools/MuxList"""

    _type = "topic_tools/MuxList"
    Request: TypeAlias = MuxListRequest
    Response: TypeAlias = MuxListResponse


@dataclass(slots=True, eq=False, repr=False)
class MuxSelectRequest(ros.Message):
    """topic_tools/MuxSelectRequest"""

    _type: ClassVar[str] = "topic_tools/MuxSelectRequest"

    topic: str = ""


@dataclass(slots=True, eq=False, repr=False)
class MuxSelectResponse(ros.Message):
    """topic_tools/MuxSelectResponse"""

    _type: ClassVar[str] = "topic_tools/MuxSelectResponse"

    prev_topic: str = ""


class MuxSelect(ros.Service[MuxSelectRequest, MuxSelectResponse]):
    """topic_tools/MuxSelect"""

    _type = "topic_tools/MuxSelect"
    Request: TypeAlias = MuxSelectRequest
    Response: TypeAlias = MuxSelectResponse
