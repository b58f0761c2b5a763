"""What nodes may do with the graph: the policy, the hub's own nodes, and guarded topics.

What they may see is `fibws.hub.graph.view`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from fibws.access.rights import Right
from fibws.hub.errors import NotAllowed
from fibws.hub.graph.action import Action, Goal
from fibws.hub.graph.policy import Policy
from fibws.hub.graph.service import Service
from fibws.hub.graph.topic import Guard, GuardedSource, Source, Topic


class GraphRights:
    """Asks the policy, and reports what is refused.

    Args:
        policy: decides what nodes may do that are not the hub's own.
    """

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self.internal: set[str] = set()
        """The hub's own nodes, for which the policy is not asked."""
        self.guards: dict[str, Guard] = {}
        """By topics: further checks of what nodes publish there that are not admins."""
        self.on_refused: Callable[[NotAllowed], object] = lambda error: None
        """Takes each refusal of the policy, but those of a node's name."""

    def check(self, node: str, right: Right, name: str) -> None:
        """Raise `NotAllowed`, and report it, unless the policy lets a node do this."""
        if not self.allows(node, right, name):
            raise self.refused(NotAllowed(node, right, name))

    def refused(self, error: NotAllowed) -> NotAllowed:
        """Report an error that is about to be raised, and return it."""
        self.on_refused(error)
        return error

    def allows(self, node: str, right: Right, name: str) -> bool:
        """Return whether a node may do this with a topic, service, action or parameter."""
        return node in self.internal or self._policy.may(node, right, name)

    def allows_source(self, source: Source) -> bool:
        """Return whether a source may still publish as it does."""
        name = source.topic.name
        is_guarded = isinstance(source, GuardedSource) or name not in self.guards
        is_free = is_guarded or self._policy.is_admin(source.node)
        return is_free and self.allows(source.node, "publish", name)

    def source_class(self, node: str, topic: Topic) -> Callable[..., Source]:
        """Return the class of a node's sources of a topic."""
        guard = self.guards.get(topic.name)
        is_free = guard is None or node in self.internal or self._policy.is_admin(node)
        return Source if guard is None or is_free else partial(GuardedSource, guard)

    def check_free(self, kind: str, name: str, older: Service | Action | None, node: str) -> None:
        """Refuse to take a service or an action away from another principal's node."""
        if older is not None and not self._policy.is_same_owner(node, older.node):
            fault = f"{kind} {name} belongs to another principal"
            raise self.refused(NotAllowed(node, "provide", name, fault))

    def may_end(self, caller: str, goal: Goal) -> bool:
        """Return whether a node may cancel a goal: its own, or its principal's."""
        return self._policy.is_same_owner(caller, goal.caller) or self._policy.is_admin(caller)

    def check_writable(self, node: str, name: str, others: Iterable[str]) -> None:
        """Check the right to write a parameter and others, whose names the error does not hold."""
        if self._policy.allows_all:
            return
        affected = tuple(others) or (name,)
        if not all(self.allows(node, "param_write", each) for each in affected):
            raise self.refused(NotAllowed(node, "param_write", name))
