"""The type of an action: its classes, and how their objects become JSON and come from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Generic

from fibws.interfaces import Action, Message
from fibws.interfaces.bases import F, G, R
from fibws.node.types import Types


class ActionType(Generic[G, R, F]):
    """One action's type.

    Raises:
        InterfaceError: there is no such type.
    """

    def __init__(self, types: Types, action: type[Action[G, R, F]]) -> None:
        self.name = action._type
        self.Goal = action.Goal
        self.Result = action.Result
        self.Feedback = action.Feedback
        self.definition = types.action_definition(action._type)
        """The text that explains it to a hub that may not have it: none for standard ones."""
        self._types = types
        self._read_goal = types.reader(action.Goal)
        self._read_result = types.reader(action.Result)
        self._read_feedback = types.reader(action.Feedback)

    def read_goal(self, values: Any) -> G:
        """The goal off the wire; raises `InvalidMessage`."""
        return self._read_goal(values)

    def read_result(self, values: Any) -> R:
        """The result off the wire; raises `InvalidMessage`."""
        return self._read_result(values)

    def read_feedback(self, values: Any) -> F:
        """The feedback off the wire; raises `InvalidMessage`."""
        return self._read_feedback(values)

    def write_goal(self, goal: G | Mapping[str, Any]) -> dict[str, Any]:
        """The goal as JSON has it; raises `InvalidMessage`, or TypeError if it is none."""
        if isinstance(goal, Mapping):
            return self._types.validate(self.Goal._type)(dict(goal))
        return self._write(goal, self.Goal)

    def write_result(self, result: R) -> dict[str, Any]:
        """The result as JSON has it; raises as `write_goal` does."""
        return self._write(result, self.Result)

    def write_feedback(self, feedback: F) -> dict[str, Any]:
        """The feedback as JSON has it; raises as `write_goal` does."""
        return self._write(feedback, self.Feedback)

    def _write(self, message: object, expected: type[Message]) -> dict[str, Any]:
        if not isinstance(message, expected):
            found = message._type if isinstance(message, Message) else type(message).__name__
            raise TypeError(f"expected [{expected._type}] but got [{found}]")
        return self._types.validate(expected._type)(message.to_dict())
