"""The messages of roscpp, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import fibws.interfaces as ros

__all__ = [
    "Logger",
]


@dataclass(slots=True, eq=False, repr=False)
class Logger(ros.Message):
    """roscpp/Logger"""

    _type: ClassVar[str] = "roscpp/Logger"

    name: str = ""
    level: str = ""
