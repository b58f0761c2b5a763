"""The types of ROS: their definitions, what a message of each must look like, its Python class.

    folders ─ package ─> text of .msg, .srv, .action ─ parser ─> definition, in builtin's types
    definition ─ linker ─> with all nested types there ─ catalogue ─> Interfaces, all types by name
    Interfaces ─ fingerprint ─> md5 and full text
    Interfaces ─ validators, from leaves ─> JSON values in, complete messages out; or faults
    Interfaces ─ generator ─> fibws.msg, Python classes: each a message, with times in it

Pure: no clock, no environment, no sockets; files are read when a type is first asked for.
"""

from fibws.interfaces.catalogue import Interfaces
from fibws.interfaces.definition import ActionDefinition, MessageDefinition, ServiceDefinition
from fibws.interfaces.message import Message
from fibws.interfaces.times import Duration, Time
from fibws.interfaces.validators import MessageValidator, Validators

__all__ = [
    "ActionDefinition",
    "Duration",
    "Interfaces",
    "Message",
    "MessageDefinition",
    "MessageValidator",
    "ServiceDefinition",
    "Time",
    "Validators",
]
