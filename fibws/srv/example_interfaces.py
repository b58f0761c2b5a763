"""The services of example_interfaces, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros

__all__ = [
    "AddTwoInts",
    "AddTwoIntsRequest",
    "AddTwoIntsResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class AddTwoIntsRequest(ros.Message):
    """example_interfaces/AddTwoIntsRequest"""

    _type: ClassVar[str] = "example_interfaces/AddTwoIntsRequest"

    a: int = 0
    b: int = 0


@dataclass(slots=True, eq=False, repr=False)
class AddTwoIntsResponse(ros.Message):
    """example_interfaces/AddTwoIntsResponse"""

    _type: ClassVar[str] = "example_interfaces/AddTwoIntsResponse"

    sum: int = 0


class AddTwoInts(ros.Service[AddTwoIntsRequest, AddTwoIntsResponse]):
    """example_interfaces/AddTwoInts"""

    _type = "example_interfaces/AddTwoInts"
    Request: TypeAlias = AddTwoIntsRequest
    Response: TypeAlias = AddTwoIntsResponse
