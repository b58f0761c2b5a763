"""Conditions on messages, as in rostopic's filters: ``m.data > 5 and m.name != ''``."""

from __future__ import annotations

import ast
from typing import Any

from fibws.errors import InvalidValue, UnknownField
from fibws.values.expressions import FUNCTIONS, Expression, Value
from fibws.values.field_paths import Path
from fibws.values.typedefs import FLOATS, Typedefs

_MESSAGE = "m."


class Filter:
    """A condition on messages, which are called ``m`` in it.

    Raises:
        InvalidValue: the text is not a condition.
    """

    def __init__(self, text: str) -> None:
        self._paths: list[Path] = []
        try:
            self._condition = Expression(text, FUNCTIONS, self._field)
        except InvalidValue as error:
            raise InvalidValue(f"--filter: {error}; example: m.data > 5") from None

    def check(self, typedefs: Typedefs) -> None:
        """Raise `UnknownField` if messages of a type lack a field of the condition."""
        for path in self._paths:
            path.field(typedefs)

    def passes(self, message: dict[str, Any], typedefs: Typedefs) -> bool:
        """Return whether a message meets the condition.

        Raises:
            UnknownField: an array of the message is too short.
            InvalidValue: an operation is impossible with the message's values.
        """
        try:
            return bool(self._condition.value((message, typedefs)))
        except UnknownField:
            raise
        except InvalidValue as error:
            raise InvalidValue(f"--filter could not be evaluated: {error}") from None

    def _field(self, expression: ast.expr) -> Value | None:
        text = ast.unparse(expression)
        if not text.startswith(_MESSAGE):
            return None
        path = Path(text.removeprefix(_MESSAGE).replace(".", "/"))
        self._paths.append(path)

        def value(variables: tuple[dict[str, Any], Typedefs]) -> Any:
            message, typedefs = variables
            found, field = path.pick(message, typedefs), path.field(typedefs)
            if field.length is not None:
                return field.elements(found)
            # JSON has no NaN.
            return float("nan") if found is None and field.type in FLOATS else found

        return value
