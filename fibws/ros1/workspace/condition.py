"""The conditions of package.xml's format 3 (REP 149): ``$ROS_VERSION == 1 and $A != "b"``."""

from __future__ import annotations

import operator
import os
import re
from collections.abc import Callable, Mapping

from fibws.ros1.shell.environment import OF_ROS

_WORD = re.compile(r"""\s*(?:([()])|([=!<>]=|[<>])|(["'])(.*?)\3|(\$\w+)|([\w.-]+))""", re.ASCII)
_OPERATORS: dict[str, Callable[[str, str], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<=": operator.le,
    ">=": operator.ge,
    "<": operator.lt,
    ">": operator.gt,
}


def holds(condition: str, variables: Mapping[str, str] | None = None) -> bool:
    """Whether the condition is met; values are compared as texts, as catkin does.

    Args:
        condition: the text of the attribute.
        variables: what ``$NAME`` stands for; by default the environment, with `OF_ROS`.

    Raises:
        ValueError: the text is no condition.
    """
    return _Condition(condition, {**OF_ROS, **os.environ} if variables is None else variables)()


class _Condition:
    """Reads a condition from left to right; ``and`` binds closer than ``or``."""

    def __init__(self, text: str, variables: Mapping[str, str]) -> None:
        self._text = text.rstrip()
        self._at = 0
        self._variables = variables

    def __call__(self) -> bool:
        value = self._either()
        if self._at < len(self._text):
            raise self._fault()
        return value

    def _either(self) -> bool:
        value = self._both()
        while self._take("or"):
            value = self._both() or value
        return value

    def _both(self) -> bool:
        value = self._comparison()
        while self._take("and"):
            value = self._comparison() and value
        return value

    def _comparison(self) -> bool:
        if self._take("("):
            value = self._either()
            if not self._take(")"):
                raise self._fault()
            return value
        left = self._value()
        found = _WORD.match(self._text, self._at)
        if found is None or not found[2]:
            raise self._fault()
        self._at = found.end()
        return _OPERATORS[found[2]](left, self._value())

    def _value(self) -> str:
        found = _WORD.match(self._text, self._at)
        if found is None or found[1] or found[2]:
            raise self._fault()
        self._at = found.end()
        if found[3]:
            return found[4]
        return self._variables.get(found[5][1:], "") if found[5] else found[6]

    def _take(self, word: str) -> bool:
        found = _WORD.match(self._text, self._at)
        if found is None or word not in (found[1], found[6]):
            return False
        self._at = found.end()
        return True

    def _fault(self) -> ValueError:
        return ValueError(f"{self._text!r} is no condition, as in $ROS_VERSION == 1")
