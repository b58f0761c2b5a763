"""The messages of rosapi, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros

__all__ = [
    "TypeDef",
]


@dataclass(slots=True, eq=False, repr=False)
class TypeDef(ros.Message):
    """rosapi/TypeDef"""

    _type: ClassVar[str] = "rosapi/TypeDef"

    type: str = ""
    fieldnames: list[str] = field(default_factory=list)
    fieldtypes: list[str] = field(default_factory=list)
    fieldarraylen: list[int] = field(default_factory=list)
    examples: list[str] = field(default_factory=list)
    constnames: list[str] = field(default_factory=list)
    constvalues: list[str] = field(default_factory=list)
