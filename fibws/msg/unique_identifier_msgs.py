"""The messages of unique_identifier_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import fibws.interfaces as ros

__all__ = [
    "UUID",
]


@dataclass(slots=True, eq=False, repr=False)
class UUID(ros.Message):
    """unique_identifier_msgs/UUID"""

    _type: ClassVar[str] = "unique_identifier_msgs/UUID"

    uuid: bytes = bytes(16)
