"""The graph's parameters, as a node reads and sets them."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NoReturn

from fibws import names
from fibws.errors import InvalidName, ParameterNotSet
from fibws.node.calls import Calls
from fibws.public_classes import Public, made_by
from fibws.srv import rosapi

_MISSING = object()
_ROOT = "/"


@made_by("Node.params")
class Params(Public):
    """The parameters that all nodes share: a tree of values, which lasts as long as the hub.

    Names are resolved as everywhere: ``gain`` belongs to the node's namespace, ``~gain`` to the
    node alone; ``/`` is the whole tree. A value is any JSON value except null, and a dict is a
    namespace (http://wiki.ros.org/Parameter%20Server). While there is no hub, all methods wait,
    at most ``timeout`` seconds if it is given.

    Raises:
        InvalidName: a parameter's name is not legal.
        ServiceTimeout: the time is over (a TimeoutError, too).
        ServiceError: the hub refuses, or was lost, as the text says.
        NodeClosed: the node has ended.
    """

    if not TYPE_CHECKING:

        def __getitem__(self, name: str) -> NoReturn:
            raise TypeError("write await node.params.get(name), not node.params[name]")

        def __setitem__(self, name: str, value: object) -> NoReturn:
            raise TypeError("write await node.params.set(name, value), not node.params[name]")

    # calls: the node's.
    # resolve: returns the global name of a name.
    def __init__(self, calls: Calls, resolve: Callable[[str], str]) -> None:
        self._ask = calls.call_rosapi
        self._resolve = resolve

    async def get(self, name: str, default: Any = _MISSING, *, timeout: float | None = None) -> Any:
        """Return the value of a parameter, a namespace as a dict, or else ``default``.

        Raises:
            ParameterNotSet: the parameter is not set and no default was given (a KeyError, too).
        """
        name = self._global(name)
        answer = await self._ask("get_param", rosapi.GetParam, timeout, name=name, default="null")
        value = json.loads(answer.value)
        if value is not None:
            return value
        if default is _MISSING:
            raise ParameterNotSet(name)
        return default

    async def set(self, name: str, value: Any, *, timeout: float | None = None) -> None:
        """Set a parameter; a dict replaces a whole namespace.

        Raises:
            TypeError, ValueError: the value is None, or not a JSON value.
        """
        if value is None:
            raise ValueError(f"parameter {name}: None is not a value; use delete() to unset it")
        try:
            text = json.dumps(value, allow_nan=False)
        except (TypeError, ValueError) as error:
            kinds = "numbers, text, booleans, and lists and dicts of these"
            raise type(error)(f"parameter {name}: {error}; values are {kinds}") from None
        await self._ask("set_param", rosapi.SetParam, timeout, name=self._global(name), value=text)

    async def has(self, name: str, *, timeout: float | None = None) -> bool:
        """Return whether a parameter or a namespace of this name exists."""
        answer = await self._ask("has_param", rosapi.HasParam, timeout, name=self._global(name))
        return answer.exists

    async def delete(self, name: str, *, timeout: float | None = None) -> None:
        """Delete a parameter or a namespace; do nothing if it does not exist."""
        await self._ask("delete_param", rosapi.DeleteParam, timeout, name=self._global(name))

    async def search(self, name: str, *, timeout: float | None = None) -> str | None:
        """Return the global name of the nearest parameter of this name, or None.

        The search begins in the node's own namespace (``/robot/talker``) and goes up to ``/``. A
        global name stands for itself; a private one raises InvalidName.
        """
        if names.check(name).startswith("~"):
            raise InvalidName(name, "a private name cannot be searched for")
        answer = await self._ask("search_param", rosapi.SearchParam, timeout, name=name)
        return answer.global_name or None

    async def names(self, *, timeout: float | None = None) -> list[str]:
        """Return the names of all parameters, without namespaces."""
        return (await self._ask("get_param_names", rosapi.GetParamNames, timeout)).names

    def _global(self, name: str) -> str:
        return name if name == _ROOT else self._resolve(name)
