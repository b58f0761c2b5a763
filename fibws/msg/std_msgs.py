"""The messages of std_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros

__all__ = [
    "Bool",
    "Byte",
    "ByteMultiArray",
    "Char",
    "ColorRGBA",
    "Duration",
    "Empty",
    "Float32",
    "Float32MultiArray",
    "Float64",
    "Float64MultiArray",
    "Header",
    "Int16",
    "Int16MultiArray",
    "Int32",
    "Int32MultiArray",
    "Int64",
    "Int64MultiArray",
    "Int8",
    "Int8MultiArray",
    "MultiArrayDimension",
    "MultiArrayLayout",
    "String",
    "Time",
    "UInt16",
    "UInt16MultiArray",
    "UInt32",
    "UInt32MultiArray",
    "UInt64",
    "UInt64MultiArray",
    "UInt8",
    "UInt8MultiArray",
]


@dataclass(slots=True, eq=False, repr=False)
class Bool(ros.Message):
    """std_msgs/Bool"""

    _type: ClassVar[str] = "std_msgs/Bool"

    data: bool = False


@dataclass(slots=True, eq=False, repr=False)
class Byte(ros.Message):
    """std_msgs/Byte"""

    _type: ClassVar[str] = "std_msgs/Byte"

    data: int = 0


@dataclass(slots=True, eq=False, repr=False)
class MultiArrayDimension(ros.Message):
    """std_msgs/MultiArrayDimension"""

    _type: ClassVar[str] = "std_msgs/MultiArrayDimension"

    label: str = ""
    size: int = 0
    stride: int = 0


@dataclass(slots=True, eq=False, repr=False)
class MultiArrayLayout(ros.Message):
    """std_msgs/MultiArrayLayout"""

    _type: ClassVar[str] = "std_msgs/MultiArrayLayout"

    dim: list[MultiArrayDimension] = field(default_factory=list)
    data_offset: int = 0


@dataclass(slots=True, eq=False, repr=False)
class ByteMultiArray(ros.Message):
    """std_msgs/ByteMultiArray"""

    _type: ClassVar[str] = "std_msgs/ByteMultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class Char(ros.Message):
    """std_msgs/Char"""

    _type: ClassVar[str] = "std_msgs/Char"

    data: int = 0


@dataclass(slots=True, eq=False, repr=False)
class ColorRGBA(ros.Message):
    """std_msgs/ColorRGBA"""

    _type: ClassVar[str] = "std_msgs/ColorRGBA"

    r: float = 0.0
    g: float = 0.0
    b: float = 0.0
    a: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Duration(ros.Message):
    """std_msgs/Duration"""

    _type: ClassVar[str] = "std_msgs/Duration"

    data: ros.Duration = field(default_factory=ros.Duration)


@dataclass(slots=True, eq=False, repr=False)
class Empty(ros.Message):
    """std_msgs/Empty"""

    _type: ClassVar[str] = "std_msgs/Empty"


@dataclass(slots=True, eq=False, repr=False)
class Float32(ros.Message):
    """std_msgs/Float32"""

    _type: ClassVar[str] = "std_msgs/Float32"

    data: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Float32MultiArray(ros.Message):
    """std_msgs/Float32MultiArray"""

    _type: ClassVar[str] = "std_msgs/Float32MultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class Float64(ros.Message):
    """std_msgs/Float64"""

    _type: ClassVar[str] = "std_msgs/Float64"

    data: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Float64MultiArray(ros.Message):
    """std_msgs/Float64MultiArray"""

    _type: ClassVar[str] = "std_msgs/Float64MultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class Header(ros.Message):
    """std_msgs/Header"""

    _type: ClassVar[str] = "std_msgs/Header"

    seq: int = 0
    stamp: ros.Time = field(default_factory=ros.Time)
    frame_id: str = ""


@dataclass(slots=True, eq=False, repr=False)
class Int16(ros.Message):
    """std_msgs/Int16"""

    _type: ClassVar[str] = "std_msgs/Int16"

    data: int = 0


@dataclass(slots=True, eq=False, repr=False)
class Int16MultiArray(ros.Message):
    """std_msgs/Int16MultiArray"""

    _type: ClassVar[str] = "std_msgs/Int16MultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class Int32(ros.Message):
    """std_msgs/Int32"""

    _type: ClassVar[str] = "std_msgs/Int32"

    data: int = 0


@dataclass(slots=True, eq=False, repr=False)
class Int32MultiArray(ros.Message):
    """std_msgs/Int32MultiArray"""

    _type: ClassVar[str] = "std_msgs/Int32MultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class Int64(ros.Message):
    """std_msgs/Int64"""

    _type: ClassVar[str] = "std_msgs/Int64"

    data: int = 0


@dataclass(slots=True, eq=False, repr=False)
class Int64MultiArray(ros.Message):
    """std_msgs/Int64MultiArray"""

    _type: ClassVar[str] = "std_msgs/Int64MultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class Int8(ros.Message):
    """std_msgs/Int8"""

    _type: ClassVar[str] = "std_msgs/Int8"

    data: int = 0


@dataclass(slots=True, eq=False, repr=False)
class Int8MultiArray(ros.Message):
    """std_msgs/Int8MultiArray"""

    _type: ClassVar[str] = "std_msgs/Int8MultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class String(ros.Message):
    """std_msgs/String"""

    _type: ClassVar[str] = "std_msgs/String"

    data: str = ""


@dataclass(slots=True, eq=False, repr=False)
class Time(ros.Message):
    """std_msgs/Time"""

    _type: ClassVar[str] = "std_msgs/Time"

    data: ros.Time = field(default_factory=ros.Time)


@dataclass(slots=True, eq=False, repr=False)
class UInt16(ros.Message):
    """std_msgs/UInt16"""

    _type: ClassVar[str] = "std_msgs/UInt16"

    data: int = 0


@dataclass(slots=True, eq=False, repr=False)
class UInt16MultiArray(ros.Message):
    """std_msgs/UInt16MultiArray"""

    _type: ClassVar[str] = "std_msgs/UInt16MultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class UInt32(ros.Message):
    """std_msgs/UInt32"""

    _type: ClassVar[str] = "std_msgs/UInt32"

    data: int = 0


@dataclass(slots=True, eq=False, repr=False)
class UInt32MultiArray(ros.Message):
    """std_msgs/UInt32MultiArray"""

    _type: ClassVar[str] = "std_msgs/UInt32MultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class UInt64(ros.Message):
    """std_msgs/UInt64"""

    _type: ClassVar[str] = "std_msgs/UInt64"

    data: int = 0


@dataclass(slots=True, eq=False, repr=False)
class UInt64MultiArray(ros.Message):
    """std_msgs/UInt64MultiArray"""

    _type: ClassVar[str] = "std_msgs/UInt64MultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class UInt8(ros.Message):
    """std_msgs/UInt8"""

    _type: ClassVar[str] = "std_msgs/UInt8"

    data: int = 0


@dataclass(slots=True, eq=False, repr=False)
class UInt8MultiArray(ros.Message):
    """std_msgs/UInt8MultiArray"""

    _type: ClassVar[str] = "std_msgs/UInt8MultiArray"

    layout: MultiArrayLayout = field(default_factory=lambda: MultiArrayLayout())
    data: bytes = b""
