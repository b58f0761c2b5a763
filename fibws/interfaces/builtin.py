"""The types that ROS itself defines, from which all messages are made.

Their names and ranges are those of ROS 1 (http://wiki.ros.org/msg): ``byte`` is an old name of
int8 and ``char`` of uint8. ``wstring`` is ROS 2's.
"""

from __future__ import annotations

from typing import Final

INTEGERS: Final = {
    "int8": (-(2**7), 2**7 - 1),
    "uint8": (0, 2**8 - 1),
    "int16": (-(2**15), 2**15 - 1),
    "uint16": (0, 2**16 - 1),
    "int32": (-(2**31), 2**31 - 1),
    "uint32": (0, 2**32 - 1),
    "int64": (-(2**63), 2**63 - 1),
    "uint64": (0, 2**64 - 1),
    "byte": (-(2**7), 2**7 - 1),
    "char": (0, 2**8 - 1),
}
"""Every integer type with the smallest and the largest value it holds."""

FLOATS: Final = frozenset({"float32", "float64"})
STRINGS: Final = frozenset({"string", "wstring"})
TIMES: Final = {"time": "uint32", "duration": "int32"}
"""The two types of time, each with the integer type of its ``secs`` and ``nsecs``."""

BYTES: Final = frozenset({"uint8", "char"})
"""Arrays of these are byte strings: base64 in JSON, ``bytes`` in Python."""

CONSTANTS: Final = frozenset(INTEGERS) | FLOATS | STRINGS | {"bool"}
"""The types that a constant, or a field with a default, may have."""

NAMES: Final = CONSTANTS | frozenset(TIMES)

HEADER: Final = "std_msgs/Header"
ALIASES: Final = {
    "Header": HEADER,
    "builtin_interfaces/Time": "time",
    "builtin_interfaces/Duration": "duration",
}
"""Names that mean another type, in each package."""


def zero(name: str) -> bool | int | float | str:
    """Return the default value of a field of a type in `CONSTANTS`."""
    if name in STRINGS:
        return ""
    if name in FLOATS:
        return 0.0
    return False if name == "bool" else 0
