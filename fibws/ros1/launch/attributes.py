"""The attributes that a tag has: which may be there, what they say."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import overload

from fibws.errors import FibwsError, LaunchError
from fibws.ros1.launch.scope import Scope
from fibws.ros1.launch.substitution import substitute
from fibws.ros1.launch.tag import Tag
from fibws.ros1.launch.value import boolean
from fibws.suggestions import suggestion_or_known

CONDITIONS = ("if", "unless")


def applies(tag: Tag, scope: Scope) -> bool:
    """Whether a tag is to be read, by its ``if`` or ``unless``.

    Raises:
        LaunchError: it has both, or what it has is neither true nor false.
    """
    if_, unless = Attributes(tag, scope, None).flag("if"), None
    if "unless" in tag.attributes:
        if if_ is not None:
            raise tag.fault(f"<{tag.name}> has both if and unless: one of them is enough")
        unless = Attributes(tag, scope, None).flag("unless")
    return if_ is not False and unless is not True


class Attributes:
    """The attributes of a tag, with every ``$(...)`` in them replaced.

    Args:
        tag: the tag.
        scope: what holds where it stands.
        known: the names that there may be, besides if and unless; None for no such look.

    Raises:
        LaunchError: the tag has one that is not known.
    """

    def __init__(self, tag: Tag, scope: Scope, known: Sequence[str] | None) -> None:
        self._tag = tag
        self._scope = scope
        if known is None:
            return
        for name in tag.attributes:
            if name not in known and name not in CONDITIONS:
                hint = suggestion_or_known(name, known) or "; it has none"
                raise tag.fault(f"<{tag.name}> has no attribute {name}{hint}")

    @overload
    def text(self, name: str) -> str | None: ...

    @overload
    def text(self, name: str, default: str) -> str: ...

    def text(self, name: str, default: str | None = None) -> str | None:
        """What an attribute says; the default if it is not there."""
        if name not in self._tag.attributes:
            return default
        return substituted(self._tag.attributes[name], self._tag, self._scope, name)

    def required(self, name: str) -> str:
        """What an attribute says that must be there, and must say something."""
        text = self.text(name)
        if text is None:
            raise self._tag.fault(f"<{self._tag.name}> has no {name}, which it must have")
        if not text.strip():
            raise self.fault(name, "it is empty")
        return text

    @overload
    def flag(self, name: str) -> bool | None: ...

    @overload
    def flag(self, name: str, default: bool) -> bool: ...

    def flag(self, name: str, default: bool | None = None) -> bool | None:
        """Whether an attribute says true."""
        text = self.text(name)
        if text is None:
            return default
        try:
            return boolean(text)
        except ValueError as error:
            raise self.fault(name, str(error)) from None

    def number(self, name: str, default: float) -> float:
        """The number that an attribute says, which is 0 or more."""
        text = self.text(name)
        if text is None:
            return default
        try:
            number = float(text)
        except ValueError:
            number = -1.0
        if not 0 <= number < math.inf:
            raise self.fault(name, f"{text!r} is no number of 0 or more")
        return number

    def one_of(self, name: str, *words: str) -> str | None:
        """What an attribute says, if that is one of these words."""
        text = self.text(name)
        if text is not None and text not in words:
            raise self.fault(name, f"{text!r} is not {' or '.join(words)}")
        return text

    def fault(self, name: str, text: str) -> LaunchError:
        """An error about the attribute."""
        return self._tag.fault(f"<{self._tag.name} {name}>: {text}")


def substituted(text: str, tag: Tag, scope: Scope, attribute: str = "") -> str:
    """A text with every ``$(...)`` replaced; it raises `LaunchError` if that cannot be done."""
    try:
        return substitute(text, scope)
    except (ValueError, FibwsError) as error:
        where = f"{tag.name} {attribute}".strip()
        raise tag.fault(f"<{where}>: {error}") from None
