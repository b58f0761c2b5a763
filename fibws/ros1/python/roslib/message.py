"""Former module of genpy's messages."""

from genpy.message import (
    DeserializationError,
    Message,
    MessageException,
    SerializationError,
    check_type,
    fill_message_args,
    get_message_class,
    get_printable_message_args,
    get_service_class,
    strify_message,
)
from genpy.rostime import Duration, Time

__all__ = [
    "DeserializationError",
    "Duration",
    "Message",
    "MessageException",
    "ROSMessageException",
    "SerializationError",
    "Time",
    "check_type",
    "fill_message_args",
    "get_message_class",
    "get_printable_message_args",
    "get_service_class",
    "strify_message",
]

ROSMessageException = MessageException
