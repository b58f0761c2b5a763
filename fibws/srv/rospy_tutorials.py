"""The services of rospy_tutorials, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros

__all__ = [
    "AddTwoInts",
    "AddTwoIntsRequest",
    "AddTwoIntsResponse",
    "BadTwoInts",
    "BadTwoIntsRequest",
    "BadTwoIntsResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class AddTwoIntsRequest(ros.Message):
    """rospy_tutorials/AddTwoIntsRequest"""

    _type: ClassVar[str] = "rospy_tutorials/AddTwoIntsRequest"

    a: int = 0
    b: int = 0


@dataclass(slots=True, eq=False, repr=False)
class AddTwoIntsResponse(ros.Message):
    """rospy_tutorials/AddTwoIntsResponse"""

    _type: ClassVar[str] = "rospy_tutorials/AddTwoIntsResponse"

    sum: int = 0


class AddTwoInts(ros.Service[AddTwoIntsRequest, AddTwoIntsResponse]):
    """rospy_tutorials/AddTwoInts"""

    _type = "rospy_tutorials/AddTwoInts"
    Request: TypeAlias = AddTwoIntsRequest
    Response: TypeAlias = AddTwoIntsResponse


@dataclass(slots=True, eq=False, repr=False)
class BadTwoIntsRequest(ros.Message):
    """rospy_tutorials/BadTwoIntsRequest"""

    _type: ClassVar[str] = "rospy_tutorials/BadTwoIntsRequest"

    a: int = 0
    b: int = 0


@dataclass(slots=True, eq=False, repr=False)
class BadTwoIntsResponse(ros.Message):
    """rospy_tutorials/BadTwoIntsResponse"""

    _type: ClassVar[str] = "rospy_tutorials/BadTwoIntsResponse"

    sum: int = 0


class BadTwoInts(ros.Service[BadTwoIntsRequest, BadTwoIntsResponse]):
    """rospy_tutorials/BadTwoInts"""

    _type = "rospy_tutorials/BadTwoInts"
    Request: TypeAlias = BadTwoIntsRequest
    Response: TypeAlias = BadTwoIntsResponse
