"""The types of ROS 2 that stand for those of the graph: hashes and converters.

A type has the same name in both, ``std_msgs/String`` and ``std_msgs/msg/String``, and is the same
if its fields are: then its hash is the one that ROS 2 has for it. ROS 2 Humble tells no hashes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

from fibws.errors import FibwsError, Ros2Error
from fibws.hub.ros2.key_layout import NO_HASH
from fibws.hub.ros2.type_hashes import message_hash, service_hash
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.cdr import Converter, Converters

T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Ros2Message:
    """A message as ROS 2 has it.

    Attributes:
        name: ``package/Type``.
        type_hash: ``RIHS01_...``.
    """

    name: str
    type_hash: str
    converter: Converter


@dataclass(frozen=True, slots=True, eq=False)
class Ros2Service:
    """A service as ROS 2 has it; see `Ros2Message`."""

    name: str
    type_hash: str
    request: Converter
    response: Converter


class Ros2Types:
    """The types of ROS 2 by the definitions and the names of those here, each made on first use."""

    def __init__(self) -> None:
        self._known: WeakKeyDictionary[Definitions, _KnownType] = WeakKeyDictionary()

    def message(self, definitions: Definitions, name: str) -> Ros2Message:
        """Return a message of ROS 2.

        Raises:
            InterfaceError: it is unknown.
            Ros2Error: it cannot be converted.
        """

        def make(known: _KnownType) -> Ros2Message:
            definition = definitions.message(name)
            type_hash = message_hash(definition, definitions.message)
            return Ros2Message(name, type_hash, known.converters.of(name))

        return self._get(definitions, ("msg", name), make)

    def service(self, definitions: Definitions, name: str) -> Ros2Service:
        """Return a service of ROS 2; raises as `message`."""

        def make(known: _KnownType) -> Ros2Service:
            definition = definitions.service(name)
            type_hash = service_hash(definition, definitions.message)
            convert = known.converters.of_definition
            return Ros2Service(
                name, type_hash, convert(definition.request), convert(definition.response)
            )

        return self._get(definitions, ("srv", name), make)

    def _get(
        self, definitions: Definitions, key: tuple[str, str], make: Callable[[_KnownType], T]
    ) -> T:
        known = self._known.get(definitions)
        if known is None:
            known = self._known[definitions] = _KnownType(Converters(_find(definitions)))
        found: Any = known.types.get(key)
        if found is None:
            try:
                found = make(known)
            except FibwsError as error:
                found = error
            known.types[key] = found
        if isinstance(found, FibwsError):
            raise found
        made: T = found
        return made


class _KnownType:
    """The types of some definitions, or why they cannot be converted."""

    def __init__(self, converters: Converters) -> None:
        self.converters = converters
        self.types: dict[tuple[str, str], Any] = {}


def _find(definitions: Definitions) -> Callable[[str], Any]:
    """Return the function that finds definitions, without holding these."""
    return lambda name: definitions.message(name)


def check_hash(name: str, own: str, theirs: str) -> None:
    """Raise `Ros2Error` if the fields of a type in ROS 2 are not the known ones."""
    if theirs not in (own, NO_HASH):
        raise Ros2Error(
            f"the fields of {name} differ in ROS 2: its type hash is {theirs}, "
            f"and that of the definition known here is {own}"
        )
