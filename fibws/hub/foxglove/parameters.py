"""The graph's parameters for one client: it reads and sets them, and follows their changes.

Their values are JSON as they are. Two things need a mark in this protocol: numbers that are floats,
which JavaScript does not tell from integers, and bytes.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import OrderedDict
from collections.abc import Callable, Generator, Iterable, Sequence
from typing import Any

from pydantic_core import from_json, to_json

from fibws.errors import FibwsError, InvalidName, ParameterError, ParameterNotSet
from fibws.hub.errors import LimitReached
from fibws.hub.foxglove.client import FoxgloveClient
from fibws.hub.foxglove.feeds import BATCH
from fibws.hub.foxglove.messages import GetParameters, Parameter, SetParameters, list_frame
from fibws.hub.foxglove.turns import TURN
from fibws.hub.graph.parameters import BINARY, canonical
from fibws.hub.websocket.endpoint import Work
from fibws.interfaces import base64text

FLOAT, FLOATS, BYTES = "float64", "float64_array", "byte_array"
"""The types that are named, as JSON does not have them."""
MOST_WATCHED = 10_000
"""Parameters whose changes one client may follow."""


class ParameterAccess:
    """One client's use of the parameters."""

    def __init__(self, client: FoxgloveClient) -> None:
        self._client = client
        self._watched: set[str] = set()
        self._sorted: list[str] = []
        """The same names, in which those below a namespace are neighbours."""
        self._changed: OrderedDict[str, None] = OrderedDict()
        """The names that have changed since the client was last sent changes."""
        self._pending: OrderedDict[str, None] = OrderedDict()
        """The parameters whose values are still to be sent."""
        self.answer_bytes = 0
        """The bytes of the values in an answer that is not complete yet."""

    def get(self, request: GetParameters) -> Work:
        """Send the values of parameters: those that are set and may be read.

        The answer has each name once, without empty parts.
        """
        client = self._client
        if client.queue.overfull:
            return
        if request.names:
            names = yield from _distinct(request.names, _spelled)
            yield from self._answer(request, names, self._asked)
        else:
            names = client.view.parameters()
            yield from self._answer(request, names, self._readable)

    def set(self, request: SetParameters) -> Work:
        """Set or delete parameters; those that fail change nothing and are reported one by one."""
        client = self._client
        for parameter in request.parameters:
            try:
                self._set(parameter)
            except FibwsError as error:
                client.statuses.error(f"setParameters: {error}", code=error.code)
            yield
        if request.id is None:
            return
        names = yield from _distinct((each.name for each in request.parameters), _spelled)
        yield from self._answer(request, names, self._value)

    def _answer(
        self,
        request: GetParameters | SetParameters,
        names: Iterable[str],
        value: Callable[[str], bytes | None],
    ) -> Work:
        """Reply with what ``value`` returns for some names."""
        client = self._client
        items: list[bytes] = []
        try:
            for name in names:
                if item := value(name):
                    items.append(item)
                    self.answer_bytes += len(item)
                if self.answer_bytes > self._most_bytes:
                    client.statuses.error(f"{request.op}: too many values, name fewer at once")
                    break
                yield
        finally:
            self.answer_bytes = 0
        client.queue.reply(list_frame("parameterValues", "parameters", items, id=request.id))

    def watch(self, names: Sequence[str]) -> Work:
        """Send the values of parameters from now on when they change.

        Raises:
            LimitReached: they are too many.
            InvalidName: a name is not global.
        """
        added = yield from _distinct(names, canonical)
        watched = self._watched.union(added)
        if len(watched) > MOST_WATCHED:
            raise LimitReached(f"too many parameters to follow (limit {MOST_WATCHED})")
        self._watch(watched)

    def unwatch(self, names: Sequence[str]) -> Work:
        """Stop sending the values of some parameters; of all if there are no names."""
        removed = yield from _distinct(names, canonical)
        self._watch(self._watched.difference(removed) if names else set())

    def changed(self, name: str) -> None:
        """Called when a parameter or a namespace was set or deleted."""
        if self._watched:
            self._changed[name] = None
            self._client.turns.wait(self._report)

    def leave(self) -> None:
        """Send nothing more."""
        self._watch(set())
        self._client.turns.cancel(self._report)

    def _report(self) -> None:
        """Send the parameters that have changed, once the client reads."""
        until = self._client.clock.time() + TURN
        while self._changed and self._client.clock.time() < until:
            name, _ = self._changed.popitem(last=False)
            found = self._watched.intersection((name, *_namespaces(name)))
            self._pending.update(dict.fromkeys((*sorted(found), *self._watched_below(name))))
        if self._changed:
            self._client.turns.wait(self._report)
        if self._pending:
            self._client.queue.reply_fresh(self._next_frame)

    def _watch(self, names: Iterable[str]) -> None:
        self._watched = set(names)
        self._sorted = sorted(self._watched)

    def _watched_below(self, name: str) -> Sequence[str]:
        name = name.removesuffix("/")
        begin = bisect_left(self._sorted, f"{name}/")
        end = bisect_left(self._sorted, f"{name}0")  # 0 is the character after the slash.
        return self._sorted[begin:end]

    def _next_frame(self) -> bytes:
        """Return the frame of some changes, and come back for the others in another turn."""
        items: list[bytes] = []
        size = 0
        until = self._client.clock.time() + TURN
        while self._pending and size < BATCH and self._client.clock.time() < until:
            name, _ = self._pending.popitem(last=False)
            item = self._value(name)
            if item is not None:
                items.append(item)
                size += len(item)
        if self._pending:
            self._client.turns.wait(self._report)
        return list_frame("parameterValues", "parameters", items) if items else b""

    @property
    def _most_bytes(self) -> int:
        """Bytes of the values in one answer: namespaces repeat what is in them."""
        return 2 * self._client.graph.parameters.max_bytes

    def _asked(self, name: str) -> bytes | None:
        """Return a parameter as JSON if it is set; report why it may not be read."""
        try:
            return self._text(name)
        except ParameterNotSet:
            return None
        except FibwsError as error:
            self._client.statuses.error(f"getParameters: {error}", code=error.code)
            return None

    def _readable(self, name: str) -> bytes | None:
        """Return a parameter as JSON if it is set and may be read."""
        return self._asked(name) if self._is_readable(name) else None

    def _value(self, name: str) -> bytes | None:
        """Return a parameter as JSON, without a value if it is not set.

        It is None for what the client may not know of.
        """
        try:
            return self._text(name) if self._is_readable(name) else None
        except ParameterNotSet:
            return to_json({"name": name})
        except FibwsError:
            return None

    def _is_readable(self, name: str) -> bool:
        """Return whether the client may read a parameter, or anything of a namespace."""
        return self._client.view.may_read(name)

    def _text(self, name: str) -> bytes:
        """Return a parameter as JSON; raises as `GraphView.parameter` does."""
        text = self._client.view.parameter(name)
        type_, text = _typed(text)
        mark = b',"type":"%b"' % type_.encode() if type_ else b""
        return b'{"name":%b,"value":%b%b}' % (to_json(name), text, mark)

    def _set(self, parameter: Parameter) -> None:
        client, name = self._client, parameter.name
        if parameter.value is None:
            client.graph.delete_parameter(client.node, name)
        else:
            client.graph.set_parameter(client.node, name, _native(parameter))
        client.audit.parameter_written(name, node=client.node, deleted=parameter.value is None)


def _distinct(
    names: Iterable[str], spell: Callable[[str], str]
) -> Generator[None, None, list[str]]:
    """Return each of some names once, however it is spelled; takes a step for each."""
    found: dict[str, None] = {}
    for name in names:
        found[spell(name)] = None
        yield
    return list(found)


def _spelled(name: str) -> str:
    """Return a parameter's name as `canonical` does, but an invalid one as it is."""
    try:
        return canonical(name)
    except InvalidName:
        return name


def _typed(text: bytes) -> tuple[str, bytes]:
    """Return the name of a value's type, if it needs one, and its JSON in this protocol."""
    if text[:1] in (b'"', b"t", b"f"):
        return "", text
    value = from_json(text)
    if isinstance(value, float):
        return FLOAT, text
    if isinstance(value, list) and value and all(isinstance(each, float) for each in value):
        return FLOATS, text
    if isinstance(value, dict) and value.keys() == {BINARY}:
        return BYTES, to_json(value[BINARY])
    return "", text


def _native(parameter: Parameter) -> Any:
    """Return the value that a client sets; raise `ParameterError` if it is not of its type."""
    value, type_ = parameter.value, parameter.type
    try:
        if type_ == FLOAT:
            return float(_number(value))
        if type_ == FLOATS and isinstance(value, list):
            return [float(_number(each)) for each in value]
        if type_ == BYTES and isinstance(value, str):
            return base64text.decode(value)
    except (ValueError, OverflowError, TypeError):
        pass
    else:
        if type_ not in (FLOATS, BYTES):
            return value
    raise ParameterError(f"Parameter [{parameter.name}]: its value is not of type {type_}")


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(value)
    return value


def _namespaces(name: str) -> Iterable[str]:
    """Yield the namespaces that a parameter is in: those of ``/a/b`` are ``/a`` and ``/``."""
    while name != "/":
        name = name.rpartition("/")[0] or "/"
        yield name
