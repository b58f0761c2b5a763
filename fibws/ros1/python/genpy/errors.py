"""What goes wrong with messages.

MessageException
├── SerializationError      a value does not fit its field
└── DeserializationError    bytes that are no such message
"""

from __future__ import annotations


class MessageException(Exception):
    """The base of what goes wrong with messages."""


class SerializationError(MessageException):
    """A value does not fit its field."""


class DeserializationError(MessageException):
    """The bytes are no such message."""
