"""The errors that fibws raises on purpose, if more than one part of it does.

Others are in `fibws.hub.errors`, `fibws.ros1.errors` and `fibws.tf.errors`.

FibwsError
├── InvalidName            a graph name that ROS does not allow
├── InvalidValue           a value, a field or a condition that a person typed is invalid
│   └── UnknownField           messages have no such field, or an array is too short
├── UnknownName            the hub has no node, topic, service or action of this name
├── InterfaceError         something is wrong with a type
│   ├── DefinitionError        a .msg, .srv or .action text that does not parse
│   ├── InvalidTypeName        not of the form package/Type
│   ├── DefinitionLimit        the hub keeps no more definitions of clients
│   ├── UnknownType            the package is known, the type is not
│   └── UnknownPackage         the package is unknown
├── InvalidMessage         a message that does not fit its type
│   └── MessageTooLarge        a message larger than the hub takes
├── InvalidUtf8            a text message that is not UTF-8
├── OperationError         the hub refuses an operation; the text goes to the client
│   ├── NotSerialized          client and hub know the type of a call or a goal by other definitions
│   └── AuthenticationError    a client's token or certificate is missing, wrong or expired
├── ParameterError         an operation on a parameter failed
│   └── ParameterNotSet        there is no such parameter
├── AccessError            an invalid token file, right, key or certificate
├── BagError               a bag cannot be read or written
│   ├── BagFormatError         it is damaged, or not a bag
│   │   └── ChunkDamaged           a chunk is damaged; a reindex restores what can be read
│   ├── BagNotIndexed          it was not closed: reindex it first
│   └── UnsupportedBag         its version, compression or encryption is not supported
├── HubError               the hub cannot start or continue
│   └── SettingError           a setting is invalid, or cannot be used
├── Ros2Error              a ROS 2 node has sent something invalid, or a type cannot be converted
└── NodeError              a node's request failed, or the node cannot continue
    ├── InvalidAddress         not the address of a hub
    ├── HubUnreachable         the hub refuses this node, or can never be reached
    │   ├── NoHub                  nothing answers at the hub's address
    │   ├── NotAHub                another program answers there
    │   └── AccessDenied           the hub has closed the connection for good
    │       ├── NotAuthorized          the token is missing, unknown, expired or revoked
    │       ├── MissingRight           the token lacks a right that the node needs
    │       └── HubLimitReached        a limit of the client or its token is reached
    ├── HubLost                the connection of a tool to the hub has ended
    ├── OperationRejected      the hub refused an operation of the node
    ├── AlreadyOffered         the node already serves a service or an action of this name
    ├── ServiceError           a service call failed
    │   ├── UnknownService         no node serves it
    │   ├── ServiceTimeout         there was no response in time
    │   └── ServiceLost            the connection broke before the response
    ├── CallRefused            raised by a service's handler to choose its caller's text
    ├── ActionError            a goal did not succeed
    ├── WaitTimeout            a wait ended without a result
    ├── NodeReplaced           another node took this node's name
    ├── NodeKilled             the hub was asked to kill this node
    └── NodeClosed             the node was used after its end
"""

from __future__ import annotations

import re
from collections.abc import Callable
from enum import IntEnum
from typing import Any, Literal

from fibws.command_names import command_name
from fibws.hub_advice import advice

_FLAG = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")
_ARGUMENTS = {"as": "join_prefix", "export": "join_export", "import": "join_import"}
"""The arguments of the hub's ``Settings`` that have other names than their flags."""


class FibwsError(Exception):
    """The base of every error that fibws raises on purpose."""

    code: str = "error"
    """Names the kind of error for programs: the hub sends it beside the text (`fibws.v1`)."""


class InvalidName(FibwsError, ValueError):
    """A graph name that ROS does not allow (http://wiki.ros.org/Names)."""

    code = "invalid_name"

    def __init__(self, name: str, fault: str) -> None:
        self.name = name
        self.fault = fault
        super().__init__(f"{name!r} is not a legal name: {fault}")


class InvalidValue(FibwsError, ValueError):
    """A value, a field or a condition that a person typed is invalid; the text says why."""


class UnknownField(InvalidValue, LookupError):
    """The messages of a type have no such field, or an array of a message is too short."""


class UnknownName(FibwsError, LookupError):
    """A hub has no node, topic, service or action of this name."""


class InterfaceError(FibwsError):
    """Something is wrong with a type, not with a message."""

    code = "invalid_type"


class DefinitionError(InterfaceError, ValueError):
    """A .msg, .srv or .action text that does not parse."""

    code = "invalid_definition"

    def __init__(self, source: str, line: int, text: str, fault: str) -> None:
        self.source = source
        self.line = line
        self.text = text
        self.fault = fault
        super().__init__(f"{source}, line {line}: {fault}: {text.strip()!r}")


class InvalidTypeName(InterfaceError, ValueError):
    """A type name that is not of the form ``package/Type``."""

    code = "invalid_type_name"

    def __init__(self, name: str, hint: str = "") -> None:
        self.name = name
        super().__init__(f"{name} is not a valid type string{hint}")


class DefinitionLimit(InterfaceError):
    """The hub keeps no more definitions of clients; the text names the limit."""

    code = "limit_reached"


_A_KIND = {"msg": "a message", "srv": "a service", "action": "an action"}


class UnknownType(InterfaceError, LookupError):
    """A known package does not define this type."""

    code = "unknown_type"

    def __init__(
        self, kind: str, package: str, name: str, nearest: str | None, other: str | None = None
    ) -> None:
        self.package = package
        self.name = name
        self.nearest = nearest
        hint = f"; did you mean {nearest}?" if nearest else ""
        if other is not None:  # The kind of which the package has a type of this name.
            hint = f"; {package}/{name} is {_A_KIND[other]}"
        super().__init__(
            f"Unable to import {kind} class {name} from package {package}. "
            f"Caused by: no such {kind} in {package}{hint}"
        )


class UnknownPackage(InterfaceError, LookupError):
    """The package is unknown, so that its types cannot be checked."""

    code = "unknown_package"

    def __init__(self, package: str, nearest: str | None = None, meant: str | None = None) -> None:
        self.package = package
        self.nearest = nearest
        self.meant = meant
        """The type of a known package that is likely meant, if the name is that of a type."""
        hint = f"; did you mean {nearest}?" if nearest else ""
        super().__init__(
            f"Unable to load the manifest for package {package}. "
            f"Caused by: no folder of definitions contains it (FIBWS_INTERFACES names them){hint}"
        )


class InvalidMessage(FibwsError, ValueError):
    """A message that does not fit its type; the text says which field and why."""

    code = "invalid_message"


class MessageTooLarge(InvalidMessage):
    """A message, or an operation such as a call, is larger than the hub takes.

    It is not sent, and the connection goes on. The hub tells its limit when it accepts a client.

    Attributes:
        what: the topic, service or action.
        size: bytes of the message, as it would be sent.
        limit: bytes that the hub takes.
    """

    code = "message_too_large"

    def __init__(self, what: str, size: int, limit: int) -> None:
        self.what = what
        self.size = size
        self.limit = limit
        super().__init__(
            f"{what}: a message of {size} bytes is larger than the hub takes "
            f"(limit {limit}, --max-message-size of the hub)"
        )


class InvalidUtf8(FibwsError, ValueError):
    """A text message that is not UTF-8, which closes a WebSocket (RFC 6455, section 8.1)."""


class OperationError(FibwsError):
    """The hub refuses an operation; the text goes to its client."""

    code = "invalid_operation"


class NotSerialized(OperationError):
    """Bytes of a call or a goal cannot be read, since client and hub know different definitions."""

    code = "not_serialized"

    def __init__(self, type_: str, md5sum: str | None) -> None:
        self.type = type_
        self.md5sum = md5sum
        known = "has another definition in the hub" if md5sum else "is unknown to the hub"
        super().__init__(f"{type_} {known}: send its values as JSON, not as bytes")


class AuthenticationError(OperationError):
    """A client has not proved who it is: its token or certificate is missing, wrong or expired."""

    code = "not_authenticated"


class ParameterError(FibwsError):
    """An operation on a parameter failed; the text says which and why."""

    code = "invalid_parameter"


class ParameterNotSet(ParameterError, KeyError):
    """There is no such parameter; rospy raises a KeyError, too."""

    code = "parameter_not_set"

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(f"Parameter [{name}] is not set")

    __str__ = Exception.__str__  # KeyError's own writes the text as a key.


class AccessError(FibwsError, ValueError):
    """A token file, a right, a key or a certificate is invalid; the text says why."""


class BagError(FibwsError):
    """A bag cannot be read or written; the text says which and why."""


class BagFormatError(BagError, ValueError):
    """A file is damaged, or is not a bag."""


class ChunkDamaged(BagFormatError):
    """A chunk of a bag is damaged; what can be read is restored by a reindex."""

    def __init__(self, path: str, fault: str) -> None:
        restore = f"{command_name('bag reindex')} {path}"
        super().__init__(f"{fault}; to restore what can be read: {restore}")


class BagNotIndexed(BagError):
    """A bag has no index, because its recorder did not close it, or has not yet.

    Args:
        writer: says which program writes it, if one does: ``being written by process 5``.
    """

    def __init__(self, path: str, fault: str = "it was not closed", writer: str = "") -> None:
        self.path, self.writer = path, writer
        advice = f"; write one with {command_name('bag reindex')} {path}"
        super().__init__(f"{path} has no index ({writer or fault}){'' if writer else advice}")


class UnsupportedBag(BagError):
    """The version, the compression or the encryption of a bag is not supported.

    Attributes:
        feature: what is not supported.
    """

    def __init__(
        self, text: str, feature: Literal["version", "compression", "encryption", "format"]
    ) -> None:
        self.feature = feature
        super().__init__(text)


class HubError(FibwsError):
    """The hub cannot start or continue."""


class SettingError(HubError):
    """A setting of the hub is invalid, or cannot be used.

    Args:
        text: the reason, with settings as flags: ``--port must be >= 0``. To programs, it names
            them as arguments: ``Settings(port=...) must be >= 0``.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._text = text

    def __str__(self) -> str:
        return self.named(_argument)

    def named(self, name: Callable[[str], str]) -> str:
        """Return the text, with the name that a function gives to each flag in it."""
        return _FLAG.sub(lambda found: name(found[0]), self._text)


def _argument(flag: str) -> str:
    name = flag.removeprefix("--").replace("-", "_")
    return f"Settings({_ARGUMENTS.get(name, name)}=...)"


class Ros2Error(FibwsError):
    """A ROS 2 node has sent something invalid, or a type cannot be converted."""


class NodeError(FibwsError):
    """A node's request failed, or the node cannot continue."""


class InvalidAddress(NodeError, ValueError):
    """Not the address of a hub."""

    def __init__(self, address: str, fault: str) -> None:
        self.address = address
        self.fault = fault
        scheme = "wss" if address.startswith(("https:", "wss:")) else "ws"
        text = f"{address!r} is not the address of a hub: {fault}. Write {scheme}://host:port"
        super().__init__(text)


class HubUnreachable(NodeError):
    """The hub refuses this node, or can never be reached: waiting does not help."""

    def __init__(self, url: str, cause: str) -> None:
        self.url = url
        self.cause = cause
        super().__init__(f"The hub at {url} cannot be reached: {cause}")


class NoHub(HubUnreachable):
    """Nothing answers at the hub's address. Nodes wait for a hub; tools do not."""

    def __str__(self) -> str:
        return f"No hub at {self.url} ({self.cause}). {self.remedy}"

    @property
    def remedy(self) -> str:
        """Advice for the user."""
        return advice(self.url)


class NotAHub(HubUnreachable):
    """Another program answers at the hub's address."""

    def __init__(self, url: str, fault: str) -> None:
        what, semicolon, remedy = fault.partition("; ")
        super().__init__(url, f"the server is not a hub ({what}){semicolon}{remedy}")
        self.has_remedy = bool(remedy)
        """Whether the fault says itself what to do."""

    def __str__(self) -> str:
        return ". ".join(filter(None, [super().__str__(), self.remedy]))

    @property
    def remedy(self) -> str:
        """What to do about it, if the fault does not say that."""
        return "" if self.has_remedy else advice(self.url, answers=True)


class AccessDenied(HubUnreachable):
    """The hub refuses a client: the token, its rights or the hub's limits must change first."""

    remedy = ""
    """Advice for the user."""

    def __init__(self, url: str, cause: str, remedy: str = "") -> None:
        super().__init__(url, cause)
        self.remedy = remedy or self.remedy

    def __str__(self) -> str:
        return f"The hub at {self.url} refused the connection: {self.cause}. {self.remedy}"


class NotAuthorized(AccessDenied):
    """The hub wants a token, and the client's is missing, unknown, expired or revoked."""

    remedy = "Set FIBWS_TOKEN to a token of this hub, or FIBWS_TOKEN_FILE to a file that holds it"


class MissingRight(AccessDenied):
    """The client's token lacks a right without which it cannot connect; ``cause`` names it."""

    remedy = "Use a token that has this right, or ask whoever runs the hub for it"


class HubLimitReached(AccessDenied):
    """The hub has no room for a tool, because of a limit that ``cause`` names. Nodes try again."""

    remedy = "Try again later, or ask whoever runs the hub to raise its limits"


class HubLost(NodeError):
    """The connection of a tool to the hub has ended; ``cause`` is the hub's reason."""

    def __init__(self, url: str, cause: str) -> None:
        self.url = url
        self.cause = cause
        super().__init__(f"Lost the hub at {url}: {cause}")


class OperationRejected(NodeError):
    """The hub refused an operation of the node; the text is the hub's own."""


class AlreadyOffered(NodeError, ValueError):
    """The node already serves a service or an action of this name."""

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(f"{name}: this node already serves it")


class ServiceError(NodeError):
    """A service call failed.

    Attributes:
        service: the service's name.
        text: the server's or the hub's reason.
        code: that of `CallFailed`, if a hub of fibws sent one.
    """

    def __init__(self, service: str, text: str, code: str | None = None) -> None:
        self.service = service
        self.text = text
        if code is not None:
            self.code = code
        is_named = re.search(rf"(?<![\w/]){re.escape(service)}(?![\w/])", text)
        super().__init__(text if is_named else f"{service}: {text}")


class UnknownService(ServiceError, LookupError):
    """No node serves this name: not yet, or the name is wrong."""


class ServiceTimeout(ServiceError, TimeoutError):
    """There was no response in time; the server may still be working."""


class ServiceLost(ServiceError):
    """The connection broke before the response: the call may have been executed or not."""

    def __init__(self, service: str) -> None:
        super().__init__(service, "the connection to the hub was lost")


class CallRefused(NodeError):
    """Raised by a service's handler to fail a call with just this text, without logging it."""


class ActionError(NodeError):
    """A goal did not succeed: ``status`` and ``text`` are its server's or the hub's reason.

    Attributes:
        action: the action's name.
        status: the goal's last status, a `fibws.GoalStatus`.
        text: the reason; empty if the server gave none.
        result: the result so far, if the server sent one.
    """

    def __init__(self, action: str, status: IntEnum, text: str, result: Any = None) -> None:
        self.action = action
        self.status = status
        self.text = text
        self.result = result
        super().__init__(f"{action}: {status.name}{': ' if text else ''}{text}")


class WaitTimeout(NodeError, TimeoutError):
    """A wait ended without a result."""


class NodeReplaced(NodeError):
    """Another node took this node's name, so this one ends, as in ROS."""


class NodeKilled(NodeError):
    """The hub was asked to kill this node, as rosnode kill does in ROS."""


class NodeClosed(NodeError):
    """The node, publisher or subscription was used after its end."""
