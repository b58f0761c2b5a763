"""Every error that fibws raises on purpose, each naming whose fault it is.

FibwsError
├── InvalidName            a graph name that ROS does not allow
├── InterfaceError         something is wrong with a type
│   ├── DefinitionError        a .msg, .srv or .action text that does not parse
│   ├── InvalidTypeName        not of the form package/Type
│   ├── UnknownType            the package is known, the type is not
│   └── UnknownPackage         nobody ever defined this package
├── InvalidMessage         a message that does not fit its type
├── InvalidUtf8            bytes that should be a text and are none
├── OperationError         an operation that the hub refuses; its text goes to the client
│   └── TypeConflict           a topic that already has another type
├── HubError               the hub cannot start or go on
└── NodeError              a node cannot go on
    ├── InvalidAddress         what should say where the hub is does not
    ├── HubUnreachable         the hub is there and will not have this node, or never can be
    ├── OperationRejected      the hub refused what the node asked for
    ├── NodeReplaced           another node took this node's name
    └── NodeClosed             the node was used after its end
"""

from __future__ import annotations


class FibwsError(Exception):
    """The base of every error that fibws raises on purpose."""


class InvalidName(FibwsError, ValueError):
    """A graph name that ROS does not allow (http://wiki.ros.org/Names)."""

    def __init__(self, name: str, fault: str) -> None:
        self.name = name
        self.fault = fault
        super().__init__(f"{name!r} is not a legal name: {fault}")


class InterfaceError(FibwsError):
    """Something is wrong with a type, not with a message."""


class DefinitionError(InterfaceError, ValueError):
    """A .msg, .srv or .action text that does not parse."""

    def __init__(self, source: str, line: int, text: str, fault: str) -> None:
        self.source = source
        self.line = line
        self.text = text
        self.fault = fault
        super().__init__(f"{source}, line {line}: {fault}: {text.strip()!r}")


class InvalidTypeName(InterfaceError, ValueError):
    """A type name that is not of the form ``package/Type``."""

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(f"{name} is not a valid type string")


class UnknownType(InterfaceError, LookupError):
    """A type that its package, which is known, does not define: most likely a typing error."""

    def __init__(self, kind: str, package: str, name: str, nearest: str | None) -> None:
        self.package = package
        self.name = name
        self.nearest = nearest
        hint = f"did you mean {nearest}?" if nearest else f"no such {kind} in {package}"
        super().__init__(
            f"Unable to import {kind} class {name} from package {package}. Caused by: {hint}"
        )


class UnknownPackage(InterfaceError, LookupError):
    """A package that nobody defined, so its types cannot be checked."""

    def __init__(self, package: str) -> None:
        self.package = package
        super().__init__(
            f"Unable to load the manifest for package {package}. "
            f"Caused by: no folder of definitions holds it"
        )


class InvalidMessage(FibwsError, ValueError):
    """A message that does not fit its type; the text says which field and why."""


class InvalidUtf8(FibwsError, ValueError):
    """Bytes that should be a text and are none, which ends a WebSocket (RFC 6455, section 8.1)."""


class OperationError(FibwsError):
    """An operation that the hub refuses; the text is what its client is told."""


class TypeConflict(OperationError):
    """A topic that is already established with another type."""

    def __init__(self, topic: str, asked: str, established: str, by: str) -> None:
        self.topic = topic
        self.asked = asked
        self.established = established
        self.by = by
        super().__init__(
            f"Tried to register topic {topic} with type {asked} "
            f"but it is already established with type {established} (by {by})"
        )


class HubError(FibwsError):
    """The hub cannot start or go on."""


class NodeError(FibwsError):
    """A node cannot go on."""


class InvalidAddress(NodeError, ValueError):
    """What should say where the hub is does not."""

    def __init__(self, address: str, fault: str) -> None:
        self.address = address
        self.fault = fault
        super().__init__(f"{address!r} is not the address of a hub: {fault}. Write ws://host:port")


class HubUnreachable(NodeError):
    """The hub is there and will not have this node, or never can be: waiting is of no use."""

    def __init__(self, url: str, cause: str) -> None:
        self.url = url
        self.cause = cause
        super().__init__(f"The hub at {url} cannot be reached: {cause}")


class OperationRejected(NodeError):
    """The hub refused what the node asked for; the text is the hub's own."""


class NodeReplaced(NodeError):
    """Another node took this node's name, so this one ends, as in ROS."""


class NodeClosed(NodeError):
    """The node, publisher or subscription was used after its end."""
