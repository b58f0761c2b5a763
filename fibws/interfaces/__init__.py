"""The types of ROS: their definitions, what a message of each must look like, its Python class.

    folders ─ package ─> text of .msg, .srv, .action ─ parser ─> definition, in builtin's types
    definition ─ linker ─> with all nested types there ─ catalogue ─> Interfaces, all types by name
    Interfaces ─ fingerprint ─> md5; ─ full_text ─> the text a client may send, to be learned
    Interfaces ─ validators, from leaves ─> JSON values in, complete messages out; or faults
    Interfaces ─ cbor ─> such messages as CBOR; ─ serialization, of binary parts ─> in ROS 1's bytes
    Interfaces ─ generator, from source ─> fibws.msg, .srv, .action: Python classes, with bases

Pure: no clock, no environment, no sockets; files are read when a type is first asked for.
"""

from fibws.interfaces.catalogue import Interfaces
from fibws.interfaces.definition import ActionDefinition, MessageDefinition, ServiceDefinition
from fibws.interfaces.message import Action, Message, Service
from fibws.interfaces.times import Duration, Time
from fibws.interfaces.validators import MessageValidator, Validators

__all__ = [
    "Action",
    "ActionDefinition",
    "Duration",
    "Interfaces",
    "Message",
    "MessageDefinition",
    "MessageValidator",
    "Service",
    "ServiceDefinition",
    "Time",
    "Validators",
]
