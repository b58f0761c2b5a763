"""ROS types: their definitions, validation and serialization of messages, and Python classes.

    folders ─> text of .msg, .srv, .action ─ parser, with literals ─> definition
    folders ─> text of .idl ─ idl ─> definition
    folders ─ catalogue, with resolver ─> Interfaces: all installed types by name
    text from a client ─ client_definitions ─> the same for types that clients brought
    Interfaces ─ md5sum ─> md5
    Interfaces ─ full_text ─> the text of a type with its nested types, as clients send it
    Interfaces ─ validators, with schema ─> dicts from JSON, complete and valid
    Interfaces ─ serialization, with serialization_code ─> ROS 1's bytes for dicts and objects
    Interfaces ─ cdr, with ros2_definitions ─> ROS 1's bytes as ROS 2's, and back
    Interfaces ─ cbor, json_text, long_integers ─> valid dicts as CBOR and JSON
    Interfaces ─ generator, with class_source ─> Python classes in fibws.msg, .srv and .action
    generator ─ generated_modules ─> files of the standard packages' classes
    generator ─ stubs ─> .pyi files of the user's packages for type checkers
    message, times ─> the base classes of messages and times

There is no clock, no environment and no socket here. A type's file is read when it is first needed.
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
