"""Errors of messages.

MessageException
├── SerializationError      a value does not fit its field
└── DeserializationError    bytes are invalid for the type
MsgGenerationException      a definition is invalid
"""

from __future__ import annotations


class MessageException(Exception):
    """The base of errors of messages."""


class SerializationError(MessageException):
    """A value does not fit its field."""


class DeserializationError(MessageException):
    """The bytes are invalid for the type."""


class MsgGenerationException(Exception):
    """A definition is invalid, so that no class can be made from it."""
