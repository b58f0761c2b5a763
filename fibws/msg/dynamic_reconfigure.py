"""The messages of dynamic_reconfigure, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros

__all__ = [
    "BoolParameter",
    "Config",
    "ConfigDescription",
    "DoubleParameter",
    "Group",
    "GroupState",
    "IntParameter",
    "ParamDescription",
    "SensorLevels",
    "StrParameter",
]


@dataclass(slots=True, eq=False, repr=False)
class BoolParameter(ros.Message):
    """dynamic_reconfigure/BoolParameter"""

    _type: ClassVar[str] = "dynamic_reconfigure/BoolParameter"

    name: str = ""
    value: bool = False


@dataclass(slots=True, eq=False, repr=False)
class IntParameter(ros.Message):
    """dynamic_reconfigure/IntParameter"""

    _type: ClassVar[str] = "dynamic_reconfigure/IntParameter"

    name: str = ""
    value: int = 0


@dataclass(slots=True, eq=False, repr=False)
class StrParameter(ros.Message):
    """dynamic_reconfigure/StrParameter"""

    _type: ClassVar[str] = "dynamic_reconfigure/StrParameter"

    name: str = ""
    value: str = ""


@dataclass(slots=True, eq=False, repr=False)
class DoubleParameter(ros.Message):
    """dynamic_reconfigure/DoubleParameter"""

    _type: ClassVar[str] = "dynamic_reconfigure/DoubleParameter"

    name: str = ""
    value: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class GroupState(ros.Message):
    """dynamic_reconfigure/GroupState"""

    _type: ClassVar[str] = "dynamic_reconfigure/GroupState"

    name: str = ""
    state: bool = False
    id: int = 0
    parent: int = 0


@dataclass(slots=True, eq=False, repr=False)
class Config(ros.Message):
    """dynamic_reconfigure/Config"""

    _type: ClassVar[str] = "dynamic_reconfigure/Config"

    bools: list[BoolParameter] = field(default_factory=list)
    ints: list[IntParameter] = field(default_factory=list)
    strs: list[StrParameter] = field(default_factory=list)
    doubles: list[DoubleParameter] = field(default_factory=list)
    groups: list[GroupState] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class ParamDescription(ros.Message):
    """dynamic_reconfigure/ParamDescription"""

    _type: ClassVar[str] = "dynamic_reconfigure/ParamDescription"

    name: str = ""
    type: str = ""
    level: int = 0
    description: str = ""
    edit_method: str = ""


@dataclass(slots=True, eq=False, repr=False)
class Group(ros.Message):
    """dynamic_reconfigure/Group"""

    _type: ClassVar[str] = "dynamic_reconfigure/Group"

    name: str = ""
    type: str = ""
    parameters: list[ParamDescription] = field(default_factory=list)
    parent: int = 0
    id: int = 0


@dataclass(slots=True, eq=False, repr=False)
class ConfigDescription(ros.Message):
    """dynamic_reconfigure/ConfigDescription"""

    _type: ClassVar[str] = "dynamic_reconfigure/ConfigDescription"

    groups: list[Group] = field(default_factory=list)
    max: Config = field(default_factory=lambda: Config())
    min: Config = field(default_factory=lambda: Config())
    dflt: Config = field(default_factory=lambda: Config())


@dataclass(slots=True, eq=False, repr=False)
class SensorLevels(ros.Message):
    """dynamic_reconfigure/SensorLevels"""

    _type: ClassVar[str] = "dynamic_reconfigure/SensorLevels"
    RECONFIGURE_CLOSE: ClassVar[int] = 3
    RECONFIGURE_STOP: ClassVar[int] = 1
    RECONFIGURE_RUNNING: ClassVar[int] = 0
