"""Publications: one message of a topic, in the form it arrived in and in each requested form."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from pydantic_core import from_json, to_json

from fibws.hub.graph.types import Buffer, MessageType
from fibws.interfaces.json_text import INFINITE, exact_json_of, json_of

T = TypeVar("T")


class Publication:
    """One published message.

    It holds the form in which it arrived: validated values, or bytes in ROS 1's serialization that
    `MessageType.check` has accepted. Each other form is made on first use, once for
    all who ask.

    Args:
        type_: of the topic.
        node: the publisher's global name.
        header: the publisher's connection header, as JSON.
        received: when the hub received it, in nanoseconds since 1970. A message of /clock that
            sets the graph's time has that time.
    """

    __slots__ = (
        "_cache",
        "_json",
        "_ros1",
        "_values",
        "has_invalid_text",
        "header",
        "node",
        "received",
        "type",
    )

    def __init__(
        self,
        type_: MessageType,
        node: str,
        header: bytes,
        received: int,
        values: dict[str, Any] | None = None,
        ros1: Buffer | None = None,
    ) -> None:
        self.type = type_
        self.node = node
        self.header = header
        self.received = received
        self.has_invalid_text = False
        """Whether `values` have U+FFFD in place of bytes that are not UTF-8."""
        self._values = values
        self._ros1 = ros1
        self._json: bytes | None = None
        self._cache: dict[object, Any] | None = None

    @property
    def size(self) -> int:
        """Bytes of the serialized message if it was serialized, else of its JSON."""
        return len(self._ros1 if self._ros1 is not None else self.json())

    def values(self) -> dict[str, Any]:
        """Return the fields as `MessageValidator.validate` returns them; do not change them."""
        if self._values is None:
            if self._ros1 is not None:
                self._values, self.has_invalid_text = self.type.deserialize(self._ros1)
            else:
                self._values = cast("dict[str, Any]", from_json(self.exact_json()))
        return self._values

    def ros1(self) -> Buffer:
        """Return the message in ROS 1's serialization.

        Raises:
            OperationError: the fields of the type are unknown.
        """
        if self._ros1 is None:
            self._ros1 = self.type.serialize(self.values())
        return self._ros1

    def json(self) -> bytes:
        """Return the message as JSON, in which NaN and infinity are null."""
        if self._json is None:
            self._json = to_json(self.values(), inf_nan_mode="null")
        return self._json

    def exact_json(self) -> bytes:
        """Return the message as JSON, in which infinity is a number that no float can hold."""
        if not self.type.has_floats:
            return self.json()
        return self.cached("exact_json", self._make_exact_json)

    def json_with_strings(self, *, exact: bool) -> bytes:
        """Return the message as JSON in which 64-bit integers are decimal strings.

        Args:
            exact: whether infinity is as in `exact_json`.
        """
        convert = self.type.long_integers
        if convert is None:
            return self.exact_json() if exact else self.json()
        exact = exact and self.type.has_floats
        return self.cached(
            ("json_with_strings", exact),
            lambda: (exact_json_of if exact else json_of)(convert(self.values())),
        )

    def cbor(self) -> bytes:
        """Return the message as CBOR, with typed arrays."""
        return self.cached("cbor", self._make_cbor)

    def cached(self, key: object, make: Callable[[], T]) -> T:
        """Return the result of ``make``, which is called once for each ``key``."""
        if self._cache is None:
            self._cache = {}
        if key not in self._cache:
            self._cache[key] = make()
        made: T = self._cache[key]
        return made

    def _make_exact_json(self) -> bytes:
        text = exact_json_of(self.values())
        if INFINITE not in text:
            self._json = text
        return text

    def _make_cbor(self) -> bytes:
        if self._values is None and self._ros1 is not None:
            cbor, self.has_invalid_text = self.type.cbor_of(self._ros1)
            return cbor
        return self.type.cbor(self.values())

    def compact(self) -> int:
        """Keep the serialized bytes alone, or JSON if the type's fields are unknown.

        Returns:
            How many bytes that is.
        """
        if self.type.checked:
            kept = self._ros1 = bytes(self.ros1())
            self._json = self._cache = None
        else:
            kept = self.exact_json()
            self._cache = {"exact_json": kept}
        self._values = None
        return len(kept)
