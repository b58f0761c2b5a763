"""How a ROS 1 API is called: its methods, the checks of their arguments, and system.multicall.

Every method takes the caller's name first and returns ``[code, text, value]``, where 1 is success,
0 a failure and -1 an error (http://wiki.ros.org/ROS/Master_Slave_APIs). The texts of errors are
those of rosmaster, as programs print them.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any, TypeAlias

from fibws import names
from fibws.errors import FibwsError, InvalidName
from fibws.hub.errors import XmlRpcError
from fibws.hub.foreign.worklist import TURN
from fibws.hub.ros1.http import XmlRpcCaller
from fibws.hub.ros1.xmlrpc import Written, write_value

logger = logging.getLogger("fibws.hub")

Answer: TypeAlias = tuple[int, str, object]
"""Code, text and value."""
Check: TypeAlias = Callable[[Any, str], Any]
"""Returns an argument as the method takes it, given the caller's name; raises `InvalidArgument`."""

MOST_CALLS = 100_000
"""Calls in one system.multicall."""
LONGEST_TEXT = names.MAX_LENGTH
"""Most characters of a URI or a type, which are kept with a registration; those of a name."""
TOO_LONG = f"it is longer than {LONGEST_TEXT} characters"


class InvalidArgument(Exception):
    """An argument of a call is invalid; the text says why."""


@dataclass(frozen=True, slots=True)
class Method:
    """A method of an API.

    Attributes:
        function: takes the `XmlRpcCaller`, the caller's name and the checked arguments.
        failed: the value of an answer that is an error.
        checks: one for each argument behind the caller's name.
        optional: how many of these may be missing.
    """

    function: Callable[..., Answer | Awaitable[Answer]]
    failed: object
    checks: Sequence[Check] = ()
    optional: int = 0

    def call(
        self, name: str, params: Sequence[Any], caller: XmlRpcCaller
    ) -> Answer | Awaitable[Answer]:
        """Check the arguments and call the function; a large call has an answer later."""
        if not params:
            return -1, "missing required caller_id parameter", self.failed
        caller_id, arguments = params[0], params[1:]
        most = len(self.checks)
        if not most - self.optional <= len(arguments) <= most:
            return -1, "Error: bad call arity", self.failed
        if not isinstance(caller_id, str):
            return -1, "caller_id must be a string", self.failed
        try:
            caller_id = _node_name(caller_id)
            checked = [
                check(each, caller_id) for check, each in zip(self.checks, arguments, strict=False)
            ]
            answer = self.function(caller, caller_id, *checked)
        except Exception as error:
            return self._failure(name, error)
        return self._later(name, answer) if isinstance(answer, Awaitable) else answer

    async def _later(self, name: str, answer: Awaitable[Answer]) -> Answer:
        try:
            return await answer
        except Exception as error:
            return self._failure(name, error)

    def _failure(self, name: str, error: Exception) -> Answer:
        if isinstance(error, (InvalidArgument, FibwsError)):
            return -1, str(error), self.failed
        logger.error("The ROS 1 method %s failed.", name, exc_info=error)
        return 0, f"Internal failure: {error}", self.failed


async def multicall(
    params: Sequence[Any],
    call: Callable[[str, list[Any]], Answer | Awaitable[Answer]],
    most: int,
) -> list[Written]:
    """Return the values of several calls, letting others have their turn meanwhile.

    A call that cannot be made has a struct with ``faultCode`` and ``faultString`` in its place
    (https://mirrors.talideon.com/articles/multicall.html).

    Args:
        most: characters of all values together.

    Raises:
        XmlRpcError: the parameter is not a list of calls, or the values are too large.
    """
    if len(params) != 1 or not isinstance(params[0], list) or len(params[0]) > MOST_CALLS:
        raise XmlRpcError(f"system.multicall: expected one list of at most {MOST_CALLS} calls")
    results: list[Written] = []
    until = perf_counter() + TURN
    for each in params[0]:
        match each:
            case {"methodName": "system.multicall"}:
                result: object = _fault("Recursive system.multicall forbidden")
            case {"methodName": str() as method, "params": list() as arguments}:
                try:
                    answer = call(method, arguments)
                    result = [await answer if isinstance(answer, Awaitable) else answer]
                except XmlRpcError as error:
                    result = _fault(str(error))
            case _:
                result = _fault("expected a struct with methodName and params")
        results.append(Written(write_value(result)))
        most -= len(results[-1].xml)
        if most < 0:
            raise XmlRpcError("system.multicall: the values are too large; make fewer calls")
        if perf_counter() > until:
            await asyncio.sleep(0)
            until = perf_counter() + TURN
    return results


def _fault(text: str) -> dict[str, object]:
    return {"faultCode": 1, "faultString": text}


def _node_name(name: str) -> str:
    """Return a caller's name as a global one; rosmaster takes any text."""
    return names.resolve_any(name) if name and name != "/" else "/"


def resolve(name: str, caller_id: str) -> str:
    """Return the global name for a name that a node uses; raises `InvalidName`."""
    namespace = caller_id.rpartition("/")[0] or "/"
    return names.resolve_any(name, namespace=namespace, node=caller_id)


# Checks; those with a name return a function.


def anything(value: Any, caller_id: str) -> Any:
    """Return a value as it is."""
    return value


def key(value: Any, caller_id: str) -> str:
    """Return a parameter's name as a global one."""
    if not value:
        raise InvalidArgument("ERROR: parameter [key] must be specified and non-empty")
    if not isinstance(value, str):
        raise InvalidArgument("ERROR: parameter [key] must be a string")
    # A namespace is often written with / at its end, and the root is /.
    parts = [part for part in value.removeprefix("~").split("/") if part]
    if value.startswith("~"):
        return "/".join([caller_id.rstrip("/"), *parts])
    if value.startswith("/"):
        return "/" + "/".join(parts)
    return "/".join([caller_id.rpartition("/")[0], *parts])


def search_key(value: Any, caller_id: str) -> str:
    """Return a parameter's name as it was given."""
    key(value, caller_id)
    return str(value)


def value(argument: Any, caller_id: str) -> Any:
    """Return a parameter's value."""
    if argument is None:
        raise InvalidArgument("ERROR: parameter [value] must be specified")
    return argument


def api(name: str) -> Check:
    """Check the URI of a node or a service."""

    def check(value: Any, caller_id: str) -> str:
        if not value or not isinstance(value, str):
            raise InvalidArgument(f"ERROR: parameter [{name}] is not an XMLRPC URI")
        if not value.startswith(("http://", "rosrpc://")):
            raise InvalidArgument(f"ERROR: parameter [{name}] is not an RPC URI")
        if len(value) > LONGEST_TEXT:
            raise InvalidArgument(f"ERROR: parameter [{name}]: {TOO_LONG}")
        return value

    return check


def resolved(name: str, *, may_be_empty: bool = False) -> Check:
    """Check the name of a topic, a service or a node, and resolve it for the caller."""

    def check(value: Any, caller_id: str) -> str:
        if may_be_empty and value == "":
            return ""
        if not value or not isinstance(value, str):
            raise InvalidArgument(f"ERROR: parameter [{name}] must be a non-empty string")
        if ":" in value or " " in value:
            raise InvalidArgument(f"ERROR: parameter [{name}] contains illegal chars")
        if value == "/":
            if may_be_empty:
                return ""
            raise InvalidArgument(f"ERROR: parameter [{name}] cannot be the global namespace")
        try:
            return resolve(value, caller_id)
        except InvalidName as error:
            raise InvalidArgument(f"ERROR: parameter [{name}]: {error}") from None

    return check


def type_name(value: Any, caller_id: str) -> str:
    """Check the name of a message's type, or ``*``."""
    if not value or not isinstance(value, str):
        raise InvalidArgument("ERROR: parameter [topic_type] must be a non-empty string")
    if value != "*" and value.count("/") != 1:
        text = "ERROR: parameter [topic_type] is not a valid package resource name"
        raise InvalidArgument(text)
    if len(value) > LONGEST_TEXT:
        raise InvalidArgument(f"ERROR: parameter [topic_type]: {TOO_LONG}")
    return value
