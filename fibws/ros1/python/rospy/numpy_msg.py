"""Message classes whose arrays of numbers are numpy's.

rospy.Subscriber("floats", numpy_msg(Floats), callback)
"""

from __future__ import annotations

from typing import Any, ClassVar, Self

from genpy.message import NUMPY_STYLE, Message

from fibws.interfaces.message import ObjectStyle

_classes: dict[type[Message], type[Message]] = {}


class _Numpy(Message):
    """Overrides the conversions from dicts and bytes."""

    __slots__ = ()
    _style: ClassVar[ObjectStyle] = NUMPY_STYLE

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Self:
        """Make a message from a valid dict, with numpy's arrays."""
        return cls.from_dict_numpy(values)


def numpy_msg(msg_type: type[Message]) -> type[Message]:
    """Return the variant of a message class with numpy's arrays, one in a process."""
    if msg_type not in _classes:
        name = f"Numpy_{msg_type._type.replace('/', '__')}"
        _classes[msg_type] = type(
            name, (_Numpy, msg_type), {"__slots__": msg_type.__slots__, "__module__": __name__}
        )
    return _classes[msg_type]
