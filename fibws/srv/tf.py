"""The services of tf, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros

__all__ = [
    "FrameGraph",
    "FrameGraphRequest",
    "FrameGraphResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class FrameGraphRequest(ros.Message):
    """tf/FrameGraphRequest"""

    _type: ClassVar[str] = "tf/FrameGraphRequest"


@dataclass(slots=True, eq=False, repr=False)
class FrameGraphResponse(ros.Message):
    """tf/FrameGraphResponse"""

    _type: ClassVar[str] = "tf/FrameGraphResponse"

    dot_graph: str = ""


class FrameGraph(ros.Service[FrameGraphRequest, FrameGraphResponse]):
    """tf/FrameGraph"""

    _type = "tf/FrameGraph"
    Request: TypeAlias = FrameGraphRequest
    Response: TypeAlias = FrameGraphResponse
