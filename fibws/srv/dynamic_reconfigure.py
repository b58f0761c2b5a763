"""The services of dynamic_reconfigure, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias

import fibws.interfaces as ros
from fibws.msg import dynamic_reconfigure

__all__ = [
    "Reconfigure",
    "ReconfigureRequest",
    "ReconfigureResponse",
]


@dataclass(slots=True, eq=False, repr=False)
class ReconfigureRequest(ros.Message):
    """dynamic_reconfigure/ReconfigureRequest"""

    _type: ClassVar[str] = "dynamic_reconfigure/ReconfigureRequest"

    config: dynamic_reconfigure.Config = field(default_factory=lambda: dynamic_reconfigure.Config())


@dataclass(slots=True, eq=False, repr=False)
class ReconfigureResponse(ros.Message):
    """dynamic_reconfigure/ReconfigureResponse"""

    _type: ClassVar[str] = "dynamic_reconfigure/ReconfigureResponse"

    config: dynamic_reconfigure.Config = field(default_factory=lambda: dynamic_reconfigure.Config())


class Reconfigure(ros.Service[ReconfigureRequest, ReconfigureResponse]):
    """dynamic_reconfigure/Reconfigure"""

    _type = "dynamic_reconfigure/Reconfigure"
    Request: TypeAlias = ReconfigureRequest
    Response: TypeAlias = ReconfigureResponse
