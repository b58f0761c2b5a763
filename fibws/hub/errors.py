"""The errors of the hub that only the hub raises, below those of `fibws.errors`.

OperationError         the hub refuses an operation; the text goes to the client
├── TypeConflict           a node's second type of a topic, or not that of the hub's own
├── DefinitionMismatch     a client knows a type by another definition
├── UnknownDefinition      messages cannot be serialized, as their fields are unknown
├── UnknownPublisher       a binary frame of a publisher that is not advertised
├── NotAllowed             the hub's policy forbids it
├── AuthenticationError
│   └── TooManyAttempts        after many wrong tokens, the next must wait
├── LimitReached           a client's limit for something is reached
└── CallFailed             a call or a goal ended without a result
ParameterError
└── ParametersFull         all parameters together would exceed the limit
FibwsError
├── AssetRefused           a file of a robot's packages is not served
├── FederationError        another hub, or the connection to it, has failed
└── Ros1Error              a ROS 1 node, or a program that speaks its protocols, cannot be served
    ├── XmlRpcError            invalid XML-RPC, or a response that is a fault
    ├── TcprosError            an invalid TCPROS header or frame, or an answer that is an error
    └── NodeUnreachable        a node does not answer at its address
"""

from __future__ import annotations

from fibws.errors import AuthenticationError, FibwsError, OperationError, ParameterError


class TypeConflict(OperationError):
    """The node itself uses the topic with another type, or the topic is the hub's own.

    Attributes:
        topic: its name.
        asked: the type that is refused.
        established: the type that it is used with.
        by: a node that uses it so.
    """

    code = "type_conflict"

    def __init__(self, topic: str, asked: str, established: str, by: str, advice: str = "") -> None:
        self.topic = topic
        self.asked = asked
        self.established = established
        self.by = by
        super().__init__(
            f"Tried to register topic {topic} with type {asked} "
            f"but it is already established with type {established} (by {by})"
            f"{'; ' if advice else ''}{advice}"
        )


class DefinitionMismatch(OperationError):
    """A client's definition of a type differs from the hub's."""

    code = "type_conflict"

    def __init__(self, type_: str, given: str, known: str) -> None:
        self.type = type_
        self.given = given
        self.known = known
        super().__init__(
            f"{type_} has the md5sum {known} at the hub, but {given} at the client: "
            "their definitions differ"
        )


class UnknownDefinition(OperationError):
    """Messages of a type cannot be serialized, since its fields are unknown."""

    code = "unknown_definition"

    def __init__(self, type_: str, fault: str = "") -> None:
        self.type = type_
        self.fault = fault
        super().__init__(
            f"serialized messages need the definition of {type_}, which is unknown"
            f"{': ' if fault else ''}{fault}"
        )


class UnknownPublisher(OperationError):
    """A binary frame names a publisher that its client has not advertised, or no longer."""

    code = "unknown_publisher"

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(f"unknown publisher number {number}: not advertised, or unadvertised")


class NotAllowed(OperationError):
    """The hub's policy does not let a node do something.

    Args:
        right: the missing right, such as ``publish``.
        name: the topic, service, action, parameter or node that it is for.
        fault: why, if the right is not what is missing.
    """

    code = "not_allowed"

    def __init__(self, node: str, right: str, name: str, fault: str = "") -> None:
        self.node = node
        self.right = right
        self.name = name
        text = fault or f"missing right {right} for {name}"
        # The text need not name the node twice.
        super().__init__(text if name == node else f"{text} (node {node})")


class TooManyAttempts(AuthenticationError):
    """After many wrong tokens from one address, the next must wait."""

    def __init__(self, seconds: int) -> None:
        self.seconds = seconds
        super().__init__(f"too many wrong tokens; try again in {seconds} s")


class LimitReached(OperationError):
    """A client's limit for something is reached; the text names the limit."""

    code = "limit_reached"


class CallFailed(OperationError):
    """A call or a goal ended without a result; ``code`` says why.

    ``code`` is ``unknown_service``, ``unknown_action``, ``timeout``, ``server_lost`` (it left or
    withdrew), ``server_busy`` (it reads too slowly), or ``server_failed`` (the text is its own).
    """

    def __init__(self, text: str, code: str) -> None:
        self.code = code
        super().__init__(text)


class ParametersFull(ParameterError):
    """All parameters together would exceed the limit."""

    code = "limit_reached"

    def __init__(self, name: str, needed: int, limit: int) -> None:
        self.name = name
        self.needed = needed
        self.limit = limit
        super().__init__(
            f"Parameter [{name}] does not fit: all parameters would take {needed} bytes, the limit "
            f"is {limit} (--max-parameter-bytes of the hub)"
        )


class AssetRefused(FibwsError):
    """A file of a robot's packages is not served; the text says why."""


class FederationError(FibwsError):
    """Another hub, or the connection to it, has failed."""


class Ros1Error(FibwsError):
    """A ROS 1 node, or a program that speaks its protocols, cannot be served."""


class XmlRpcError(Ros1Error):
    """Invalid XML-RPC, or a response that is a fault."""


class TcprosError(Ros1Error):
    """An invalid TCPROS header or frame, or an answer that is an error."""


class NodeUnreachable(Ros1Error):
    """A ROS 1 node does not answer at its address.

    Args:
        uri: the address.
        fault: what failed.
    """

    def __init__(self, uri: str, fault: str) -> None:
        self.uri = uri
        self.fault = fault
        super().__init__(f"no answer at {uri}: {fault}")
