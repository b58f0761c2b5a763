"""The public names, each loaded when it is first used; a new one is added here alone."""

from .message import (
    DeserializationError as DeserializationError,
    Message as Message,
    MessageException as MessageException,
    SerializationError as SerializationError,
    struct_I as struct_I,
)
from .rostime import Duration as Duration, Time as Time, TVal as TVal
