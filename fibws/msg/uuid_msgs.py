"""The messages of uuid_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import fibws.interfaces as ros

__all__ = [
    "UniqueID",
]


@dataclass(slots=True, eq=False, repr=False)
class UniqueID(ros.Message):
    """uuid_msgs/UniqueID"""

    _type: ClassVar[str] = "uuid_msgs/UniqueID"

    uuid: bytes = bytes(16)
