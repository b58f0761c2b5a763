"""Transforming objects with any buffer, and converting them between types."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import Any, ClassVar

import rospy
from genpy.classes import message_class

Header = message_class("std_msgs/Header")

Transforming = Callable[[Any, Any], Any]


class BufferInterface:
    """The base of `Buffer` and `BufferClient`, which look transforms up.

    All frames are named in the order target, source: the result is in the target frame. A time of 0
    stands for the latest at which the transform is known. Timeouts are Durations.
    """

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(
        self,
        object_stamped: Any,
        target_frame: str,
        timeout: Any = rospy.Duration(0.0),
        new_type: Any = None,
    ) -> Any:
        """Return an object with a header, such as a PointStamped, in another frame.

        Args:
            object_stamped: an object of a registered type; ``import tf2_geometry_msgs`` registers
                those of geometry_msgs.
            target_frame: the frame to transform into.
            timeout: how long to wait for the transform.
            new_type: the type to convert the result to.

        Raises:
            TypeException: the type is not registered.
            TransformException: there is no transform.
        """
        transform_object = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        return _converted(transform_object(object_stamped, found), new_type)

    def transform_full(
        self,
        object_stamped: Any,
        target_frame: str,
        target_time: Any,
        fixed_frame: str,
        timeout: Any = rospy.Duration(0.0),
        new_type: Any = None,
    ) -> Any:
        """Return an object in another frame at another time; see `transform`.

        Args:
            target_time: the time of the target frame.
            fixed_frame: a frame that does not move between the two times.
        """
        transform_object = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        return _converted(transform_object(object_stamped, found), new_type)

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Any = rospy.Duration(0.0)
    ) -> Any:
        """Return a transform; subclasses implement it."""
        raise NotImplementedException()

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = rospy.Duration(0.0),
    ) -> Any:
        """Return a transform between two times; subclasses implement it."""
        raise NotImplementedException()

    def can_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Any = rospy.Duration(0.0)
    ) -> Any:
        """Return whether there is a transform; subclasses implement it."""
        raise NotImplementedException()

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = rospy.Duration(0.0),
    ) -> Any:
        """Return whether there is a transform between two times; subclasses implement it."""
        raise NotImplementedException()


def Stamped(obj: Any, stamp: Any, frame_id: str) -> Any:
    """Give an object a header, and return it."""
    obj.header = Header(frame_id=frame_id, stamp=stamp)
    return obj


class TypeException(Exception):
    """A type is not registered."""

    def __init__(self, errstr: str) -> None:
        super().__init__(errstr)
        self.errstr = errstr


class NotImplementedException(Exception):
    """A subclass of `BufferInterface` lacks a method."""

    def __init__(self) -> None:
        self.errstr = "CanTransform or LookupTransform not implemented"
        super().__init__(self.errstr)


class TransformRegistration:
    """The functions that transform objects, by type; one table for all."""

    _functions: ClassVar[dict[Any, Transforming]] = {}

    def print_me(self) -> None:
        """Print the table."""
        print(self._functions)

    def add(self, key: Any, callback: Transforming) -> None:
        """Register the function of a type; it gets an object and a TransformStamped."""
        self._functions[key] = callback

    def get(self, key: Any) -> Transforming:
        """Return the function of a type.

        Raises:
            TypeException: it has none.
        """
        return _registered(self._functions, key)


class ConvertRegistration:
    """The functions that convert objects, by type; one table for all."""

    _from_msg: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _to_msg: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _direct: ClassVar[dict[Any, Callable[[Any], Any]]] = {}

    def add_from_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Register the function that makes an object of a type from its message."""
        self._from_msg[key] = callback

    def add_to_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Register the function that makes a message from an object of a type."""
        self._to_msg[key] = callback

    def add_convert(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Register the function that converts directly between a pair of types."""
        self._direct[key] = callback

    def get_from_msg(self, key: Any) -> Callable[[Any], Any]:
        """Return the function that makes an object from its message; raise TypeException."""
        return _registered(self._from_msg, key)

    def get_to_msg(self, key: Any) -> Callable[[Any], Any]:
        """Return the function that makes a message from an object; raise TypeException."""
        return _registered(self._to_msg, key)

    def get_convert(self, key: Any) -> Callable[[Any], Any]:
        """Return the function that converts between a pair of types; raise TypeException."""
        return _registered(self._direct, key)


def convert(a: Any, b_type: Any) -> Any:
    """Return an object converted to another type, over its message if need be.

    Raises:
        TypeException: there is no way.
    """
    registration = ConvertRegistration()
    try:
        direct = registration.get_convert((type(a), b_type))
    except TypeException:
        if type(a) is b_type:
            return deepcopy(a)
        to_msg, from_msg = registration.get_to_msg(type(a)), registration.get_from_msg(b_type)
        return from_msg(to_msg(a))
    return direct(a)


def _registered(table: dict[Any, Callable[..., Any]], key: Any) -> Callable[..., Any]:
    if key not in table:
        raise TypeException(f"Type {key} if not loaded or supported")
    return table[key]


def _converted(result: Any, new_type: Any) -> Any:
    return convert(result, new_type) if new_type else result
