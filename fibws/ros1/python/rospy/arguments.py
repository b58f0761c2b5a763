"""What a message is made of that is published, or asks a service."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from genpy import Message


def args_kwds_to_message(
    data_class: type[Message], args: tuple[Any, ...], kwds: Mapping[str, Any]
) -> Message:
    """The message that is given, or one that is made of the given fields.

    Args:
        data_class: the class of the message to make.
        args: one message of that class, or of `AnyMsg`; or all the fields in order.
        kwds: some of the fields by name.

    Raises:
        TypeError: both, or a message of another class, or not all fields.
        AttributeError: there is no field of that name.
    """
    if args and kwds:
        raise TypeError("publish() can be called with arguments or keywords, but not both.")
    if kwds or len(args) != 1:
        return data_class(*args, **kwds)
    given = args[0]
    if not hasattr(given, "_md5sum"):
        return data_class(given)
    if given._md5sum in (data_class._md5sum, "*"):
        message: Message = given
        return message
    expected = data_class._slot_types[0] if data_class._slot_types else ""
    if given._type != expected:
        raise TypeError(f"expected [{expected}] but got [{given._type}]")
    return data_class(given)


def serialized(message: Message) -> bytes:
    """A message in ROS 1's bytes; it raises `genpy.SerializationError` as the message does."""
    from io import BytesIO

    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()
