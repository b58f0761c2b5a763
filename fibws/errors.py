"""Every error that fibws raises on purpose, each naming whose fault it is.

FibwsError
├── InvalidName            a graph name that ROS does not allow
├── InterfaceError         something is wrong with a type
│   ├── DefinitionError        a .msg, .srv or .action text that does not parse
│   ├── InvalidTypeName        not of the form package/Type
│   ├── UnknownType            the package is known, the type is not
│   └── UnknownPackage         nobody ever defined this package
├── InvalidMessage         a message that does not fit its type
├── TransformError         something is wrong with a transform
│   ├── InvalidTransform       it cannot be kept, or asked for
│   ├── UnknownFrame           no transform has named this frame
│   ├── UnconnectedFrames      no transforms lead from the one frame to the other
│   ├── FrameLoop              the frames are no tree: one is its own ancestor
│   └── TransformOutOfTime     the frames are connected, but not at the time that was asked for
├── InvalidUtf8            bytes that should be a text and are none
├── OperationError         an operation that the hub refuses; its text goes to the client
│   ├── TypeConflict           a topic that already has another type
│   ├── NotAllowed             the hub's policy forbids it
│   ├── LimitReached           a client has as many of something as it may have
│   └── CallFailed             a call or a goal ends without a result
├── ParameterError         what cannot be done with a parameter
│   ├── ParameterNotSet        there is no such parameter
│   └── ParametersFull         there is no room for so much
├── WorkspaceError         something is wrong with a workspace, or with a package in it
│   ├── PackageNotFound        no package of this name is on the path
│   ├── ExecutableNotFound     the package has no such program, or it cannot be run
│   └── PackageFileError       a package.xml or a CMakeLists.txt that says what cannot be
├── LaunchError            a launch file that says what cannot be
├── HubError               the hub cannot start or go on
└── NodeError              what a node was asked for was in vain, or it cannot go on
    ├── InvalidAddress         what should say where the hub is does not
    ├── HubUnreachable         the hub is there and will not have this node, or never can be
    │   └── NoHub                  nothing answers at the hub's address
    ├── HubLost                the connection of a tool to the hub has ended
    ├── OperationRejected      the hub refused what the node asked for
    ├── AlreadyOffered         the node offers a service or an action of this name already
    ├── ServiceError           a service was called in vain
    │   ├── UnknownService         nobody offers it
    │   ├── ServiceTimeout         there was no answer in time
    │   └── ServiceLost            the connection broke before there was an answer
    ├── CallRefused            what a service's handler raises to choose its caller's text
    ├── ActionError            a goal did not succeed
    ├── WaitTimeout            what was waited for did not come in time
    ├── NodeReplaced           another node took this node's name
    ├── NodeKilled             somebody asked the hub to end this node
    └── NodeClosed             the node was used after its end
"""

from __future__ import annotations

import os
import re
from enum import IntEnum
from typing import Any


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

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(f"{name} is not a valid type string")


class UnknownType(InterfaceError, LookupError):
    """A type that its package, which is known, does not define: most likely a typing error."""

    code = "unknown_type"

    def __init__(self, kind: str, package: str, name: str, nearest: str | None) -> None:
        self.package = package
        self.name = name
        self.nearest = nearest
        hint = f"; did you mean {nearest}?" if nearest else ""
        super().__init__(
            f"Unable to import {kind} class {name} from package {package}. "
            f"Caused by: no such {kind} in {package}{hint}"
        )


class UnknownPackage(InterfaceError, LookupError):
    """A package that nobody defined, so its types cannot be checked."""

    code = "unknown_package"

    def __init__(self, package: str) -> None:
        self.package = package
        super().__init__(
            f"Unable to load the manifest for package {package}. "
            f"Caused by: no folder of definitions holds it"
        )


class InvalidMessage(FibwsError, ValueError):
    """A message that does not fit its type; the text says which field and why."""

    code = "invalid_message"


class TransformError(FibwsError):
    """Something is wrong with a transform; the kinds are those of tf2's errors."""


class InvalidTransform(TransformError, ValueError):
    """A transform that cannot be kept, or asked for; tf2's InvalidArgumentException."""


class UnknownFrame(TransformError, LookupError):
    """No transform has named this frame, so far or any more; tf2's LookupException."""

    def __init__(self, frame: str) -> None:
        self.frame = frame
        super().__init__(f"Frame {frame!r} does not exist: no transform leads to it or from it")


class UnconnectedFrames(TransformError):
    """No transforms lead from the one frame to the other; tf2's ConnectivityException."""

    def __init__(self, target: str, source: str) -> None:
        self.target = target
        self.source = source
        super().__init__(
            f"Could not find a connection between {target!r} and {source!r} "
            f"because they are not part of the same tree"
        )


class FrameLoop(TransformError):
    """The frames are no tree, since one is its own ancestor; in tf2 a LookupException too."""

    def __init__(self, frame: str) -> None:
        self.frame = frame
        super().__init__(f"The frames above {frame!r} are no tree: they contain a loop")


class TransformOutOfTime(TransformError):
    """The frames are connected, but not at the time asked for; tf2's ExtrapolationException."""


class InvalidUtf8(FibwsError, ValueError):
    """Bytes that should be a text and are none, which ends a WebSocket (RFC 6455, section 8.1)."""


class OperationError(FibwsError):
    """An operation that the hub refuses; the text is what its client is told."""

    code = "invalid_operation"


class TypeConflict(OperationError):
    """A topic that is already established with another type."""

    code = "type_conflict"

    def __init__(self, topic: str, asked: str, established: str, by: str) -> None:
        self.topic = topic
        self.asked = asked
        self.established = established
        self.by = by
        super().__init__(
            f"Tried to register topic {topic} with type {asked} "
            f"but it is already established with type {established} (by {by})"
        )


class NotAllowed(OperationError):
    """The hub's policy does not let a node do something."""

    code = "not_allowed"

    def __init__(self, node: str, verb: str, name: str) -> None:
        self.node = node
        self.verb = verb
        self.name = name
        super().__init__(f"{node} is not allowed to {verb} {name}")


class LimitReached(OperationError):
    """A client has as many of something as it may have."""

    code = "limit_reached"


class CallFailed(OperationError):
    """A call, or a goal, that ends without a result; ``code`` says why.

    ``code`` is ``unknown_service``, ``unknown_action``, ``timeout``, ``server_lost`` (it left or
    withdrew), ``server_busy`` (it reads too slowly), or ``server_failed`` (the text is its own).
    """

    def __init__(self, text: str, code: str) -> None:
        self.code = code
        super().__init__(text)


class ParameterError(FibwsError):
    """What cannot be done with a parameter; the text says which and why."""

    code = "invalid_parameter"


class ParameterNotSet(ParameterError, KeyError):
    """There is no such parameter; rospy raises a KeyError, too."""

    code = "parameter_not_set"

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(f"Parameter [{name}] is not set")

    __str__ = Exception.__str__  # KeyError's own writes the text as a key.


class ParametersFull(ParameterError):
    """There is no room for so much among the parameters."""

    code = "limit_reached"

    def __init__(self, name: str, needed: int, limit: int) -> None:
        self.name = name
        self.needed = needed
        self.limit = limit
        super().__init__(
            f"Parameter [{name}] has no room: all parameters together would take {needed} bytes, "
            f"and they may take {limit} (--max-parameter-bytes of the hub)"
        )


class WorkspaceError(FibwsError):
    """Something is wrong with a workspace, or with a package in it; the text says what."""


class PackageNotFound(WorkspaceError, LookupError):
    """No package of this name is on the path; ``hint`` says what was missed, as far as known."""

    def __init__(self, name: str, hint: str = "") -> None:
        self.name = name
        self.hint = hint
        super().__init__(f"package {name!r} not found{': ' if hint else ''}{hint}")


class ExecutableNotFound(WorkspaceError, LookupError):
    """The package has no such program, or none that can be run; ``hint`` says more."""

    def __init__(self, package: str, name: str, hint: str) -> None:
        self.package = package
        self.name = name
        self.hint = hint
        super().__init__(f"no executable {name!r} in package {package!r}: {hint}")


class PackageFileError(WorkspaceError, ValueError):
    """A package.xml or a CMakeLists.txt that does not parse, or says what cannot be."""

    def __init__(self, source: str, line: int, fault: str) -> None:
        self.source = source
        self.line = line
        self.fault = fault
        super().__init__(f"{source}, line {line}: {fault}")


class LaunchError(FibwsError, ValueError):
    """A launch file that says what cannot be; ``file`` and ``line`` tell where.

    ``files`` are those that include it, the nearest first, each with the line of its <include>.
    """

    def __init__(
        self, file: str, line: int, fault: str, files: tuple[tuple[str, int], ...] = ()
    ) -> None:
        self.file = file
        self.line = line
        self.fault = fault
        self.files = files
        above = "".join(f", included from {file}:{line}" for file, line in files)
        super().__init__(f"{file}:{line}: {fault}{above}")


class HubError(FibwsError):
    """The hub cannot start or go on."""


class NodeError(FibwsError):
    """What a node was asked for was in vain, or the node cannot go on."""


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


class NoHub(HubUnreachable):
    """Nothing answers at the hub's address. Nodes wait for one; tools do not."""

    def __str__(self) -> str:
        return f"No hub at {self.url}. Start one with: {self.remedy}"

    @property
    def remedy(self) -> str:
        """The command that starts one here: roscore in a shell where `fibws setup` was sourced."""
        return "roscore" if "FIBWS_PYTHON" in os.environ else "fibws hub"


class HubLost(NodeError):
    """The connection of a tool to the hub has ended; ``cause`` is what the hub gave as reason."""

    def __init__(self, url: str, cause: str) -> None:
        self.url = url
        self.cause = cause
        super().__init__(f"The hub at {url} is gone: {cause}")


class OperationRejected(NodeError):
    """The hub refused what the node asked for; the text is the hub's own."""


class AlreadyOffered(NodeError, ValueError):
    """The node offers a service, or serves an action, of this name already."""

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(f"{name}: this node offers it already")


class ServiceError(NodeError):
    """A service was called in vain: its provider, or the hub, says in ``text`` why."""

    def __init__(self, service: str, text: str) -> None:
        self.service = service
        self.text = text
        is_named = re.search(rf"(?<![\w/]){re.escape(service)}(?![\w/])", text)
        super().__init__(text if is_named else f"{service}: {text}")


class UnknownService(ServiceError, LookupError):
    """Nobody offers the service: there is nobody yet, or the name is mistaken."""


class ServiceTimeout(ServiceError, TimeoutError):
    """There was no answer in time; the provider may still be at it."""


class ServiceLost(ServiceError):
    """The connection broke before there was an answer: the call may have taken place or not."""

    def __init__(self, service: str) -> None:
        super().__init__(service, "the connection to the hub was lost")


class CallRefused(NodeError):
    """What a service's handler raises to fail a call with just this text, unlogged."""


class ActionError(NodeError):
    """A goal did not succeed: ``status`` and ``text`` say why, as its server or the hub told them.

    Attributes:
        action: the action's name.
        status: what became of the goal, a `fibws.GoalStatus`.
        text: the reason; empty if the server gave none.
        result: what was reached until then, if the server said it.
    """

    def __init__(self, action: str, status: IntEnum, text: str, result: Any = None) -> None:
        self.action = action
        self.status = status
        self.text = text
        self.result = result
        super().__init__(f"{action}: {status.name}{': ' if text else ''}{text}")


class WaitTimeout(NodeError, TimeoutError):
    """What was waited for did not come in time."""


class NodeReplaced(NodeError):
    """Another node took this node's name, so this one ends, as in ROS."""


class NodeKilled(NodeError):
    """Somebody asked the hub to end this node, as rosnode kill does in ROS."""


class NodeClosed(NodeError):
    """The node, publisher or subscription was used after its end."""
