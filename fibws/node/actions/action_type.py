"""The type of an action: how its goals, results and feedback get to the wire, and back."""

from __future__ import annotations

from typing import Generic

from fibws.interfaces import Action
from fibws.interfaces.message import F, G, R
from fibws.node.types import Types


class ActionType(Generic[G, R, F]):
    """One action's type.

    Raises:
        InterfaceError: there is no such type.
    """

    def __init__(self, types: Types, action: type[Action[G, R, F]]) -> None:
        self.name = action._type
        self.definition = types.action_definition(action._type)
        """The text that explains it to a hub that may not have it: none for standard ones."""
        self.goal = types.wire(action.Goal)
        self.result = types.wire(action.Result)
        self.feedback = types.wire(action.Feedback)
