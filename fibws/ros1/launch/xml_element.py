"""The XML elements of a launch file, and their attributes in a scope."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import overload

from fibws.errors import FibwsError
from fibws.ros1 import xml_tree
from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.scope import Scope, boolean, substitute


@dataclass
class LaunchElement(xml_tree.Element):
    """One element of a launch file."""

    def fault(self, text: str) -> LaunchError:
        """Return an error with this element's file and line."""
        return LaunchError(self.file, self.line, text)


def parse(document: bytes, file: str) -> LaunchElement:
    """Return the root element of a launch file, or raise `LaunchError`."""
    return xml_tree.read(document, file, LaunchElement)


def applies(element: LaunchElement, scope: Scope) -> bool:
    """Return whether an element's ``if`` or ``unless`` allows it, or raise `LaunchError`."""
    attributes = Attributes(element, scope)
    if_, unless = attributes.flag("if"), attributes.flag("unless")
    if if_ is not None and unless is not None:
        raise element.fault(f"<{element.name}> has both if and unless; remove one")
    return if_ is not False and unless is not True


class Attributes:
    """The attributes of an element, with every ``$(...)`` in them replaced.

    All methods raise `LaunchError` for an invalid attribute.
    """

    def __init__(self, element: LaunchElement, scope: Scope) -> None:
        self._element = element
        self._scope = scope

    @overload
    def text(self, name: str) -> str | None: ...

    @overload
    def text(self, name: str, default: str) -> str: ...

    def text(self, name: str, default: str | None = None) -> str | None:
        """Return an attribute's text, or the default without such an attribute."""
        if name not in self._element.attributes:
            return default
        return substituted(self._element.attributes[name], self._element, self._scope, name)

    def required(self, name: str) -> str:
        """Return the text of an attribute that must exist and not be empty."""
        text = self.text(name)
        if text is None:
            raise self._element.fault(f"<{self._element.name}> requires attribute {name}")
        if not text.strip():
            raise self.fault(name, "must not be empty")
        return text

    @overload
    def flag(self, name: str) -> bool | None: ...

    @overload
    def flag(self, name: str, default: bool) -> bool: ...

    def flag(self, name: str, default: bool | None = None) -> bool | None:
        """Return whether an attribute is true."""
        text = self.text(name)
        if text is None:
            return default
        try:
            return boolean(text)
        except ValueError as error:
            raise self.fault(name, str(error)) from None

    def number(self, name: str, default: float, *, positive: bool = False) -> float:
        """Return the number in an attribute, which must be >= 0, or > 0 if ``positive``."""
        text = self.text(name)
        if text is None:
            return default
        try:
            number = float(text)
        except ValueError:
            number = -1.0
        if not 0 <= number < math.inf or (positive and not number):
            limit = "> 0" if positive else ">= 0"
            raise self.fault(name, f"must be a number {limit}, got {text!r}")
        return number

    def integer(self, name: str, default: int) -> int:
        """Return the integer in an attribute, or the default if it is missing or empty."""
        text = self.text(name)
        if not text:
            return default
        try:
            return int(text)
        except ValueError:
            raise self.fault(name, f"expected an integer, got {text!r}") from None

    def one_of(self, name: str, *choices: str) -> str | None:
        """Return the text of an attribute, which must be one of the choices."""
        text = self.text(name)
        if text is not None and text not in choices:
            raise self.fault(name, f"expected {' or '.join(choices)}, got {text!r}")
        return text

    def fault(self, name: str, text: str) -> LaunchError:
        """Return an error about an attribute."""
        return self._element.fault(f"<{self._element.name} {name}>: {text}")


def substituted(text: str, element: LaunchElement, scope: Scope, attribute: str = "") -> str:
    """Return a text with every ``$(...)`` replaced, or raise `LaunchError`."""
    try:
        return substitute(text, scope)
    except (ValueError, FibwsError) as error:
        where = f"{element.name} {attribute}".strip()
        raise element.fault(f"<{where}>: {error}") from None
