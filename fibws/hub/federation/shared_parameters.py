"""Parameters that hubs share: each hub has all of them, and the last change wins.

Which change is the last is told by the clocks of the hubs, and a change of a known value is always
later than that. While two hubs are not connected each changes its own copy; when they meet, the
later value of each parameter replaces the other one. A deletion is a change, too.
"""

from __future__ import annotations

import logging
from bisect import bisect_left, insort
from collections.abc import Callable, Collection

from pydantic_core import from_json

from fibws.errors import FibwsError, ParameterNotSet
from fibws.hub.federation.backplane import Backplane
from fibws.hub.federation.names import NameView
from fibws.hub.federation.records import LATEST, ParameterRecord
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.parameters import native

logger = logging.getLogger("fibws.hub")

MOST_DELETED = 10_000
"""Deletions that are remembered; each could be undone by a hub that has not heard of it."""


class SharedParameters:
    """The parameters of this hub that other hubs have, too.

    Args:
        hub: the id of this one.
        namespaces: those that are shared with all hubs, under the same names.
        changed: called with the name of a parameter whose record has changed.
    """

    def __init__(
        self,
        graph: Graph,
        hub: str,
        namespaces: Collection[str],
        changed: Callable[[str], object],
    ) -> None:
        self.records: dict[str, ParameterRecord] = {}
        """By name."""
        self._names: list[str] = []
        """The same names, sorted."""
        self._graph = graph
        self._hub = hub
        self._namespaces = tuple(namespaces)
        self._changed = changed
        self._own = frozenset(graph.parameters.names())
        """Parameters that the hub sets for itself, such as /run_id."""
        self._followed: set[str] = set()
        """The namespaces whose changes are recorded."""
        self._deleted: dict[str, None] = {}
        graph.parameters.watch(self._parameter_changed)
        for namespace in namespaces:
            self._follow(namespace)

    def attach(self, view: NameView) -> None:
        """Share what is to be shared with a hub."""
        if view.prefix:
            self._follow("/" if view.is_below else view.prefix)

    def record(self, name: str, view: NameView) -> ParameterRecord | None:
        """Return the record of a parameter for a hub; None if it does not get it."""
        return self.records.get(name) if self._is_shared(name, view) else None

    def take(self, name: str, record: ParameterRecord | None, backplane: Backplane) -> None:
        """Take a change that a hub has announced, unless a later one is known.

        Args:
            name: at this hub.
        """
        view = backplane.view
        if record is None or not self._is_shared(name, view) or not view.may_import(name):
            return
        known = self.records.get(name)
        if known is not None and (known.stamp, known.hub) >= (record.stamp, record.hub):
            return
        self._keep(name, record)
        try:
            self._apply(name, record.value, backplane.node)
        except (FibwsError, ValueError) as error:
            logger.warning("%s is not set as at other hubs: %s", name, error)
            if known is None:
                self._forget(name)
            else:
                self.records[name] = known
            return
        self._changed(name)

    def _apply(self, name: str, value: str | None, node: str) -> None:
        graph = self._graph
        if value is None:
            graph.delete_parameter(node, name)
        else:
            graph.set_parameter(node, name, native(from_json(value)))

    def _is_shared(self, name: str, view: NameView) -> bool:
        if name in self._own:
            return False
        if view.prefix:
            return view.outward(name) is not None
        return any(_is_in(name, namespace) for namespace in self._namespaces)

    def _follow(self, namespace: str) -> None:
        """Record all changes of a namespace from now on; what is there counts as set now."""
        if namespace not in self._followed:
            self._followed.add(namespace)
            self._compare(namespace)

    def _parameter_changed(self, name: str, node: str) -> None:
        for namespace in self._followed:
            if _is_in(name, namespace):
                self._compare(name)
                return
            if _is_in(namespace, name):  # A namespace around it was replaced.
                self._compare(namespace)

    def _compare(self, name: str) -> None:
        """Record what has changed of a parameter, or in a namespace."""
        present = set(self._graph.parameters.below(name)) - self._own
        known = set(self._known_in(name))
        parents = {each for each in self._parents(name) if each in self.records}
        for each in present | known | parents:
            value = self._text(each)
            older = self.records.get(each)
            if value != (older.value if older is not None else None):
                earliest = older.stamp + 1 if older is not None else 0
                stamp = min(max(self._graph.now(), earliest), LATEST)
                self._keep(each, ParameterRecord(stamp=stamp, hub=self._hub, value=value))
                self._changed(each)

    def _known_in(self, name: str) -> list[str]:
        """Return the parameters with a record in a namespace, or of the name itself."""
        if name == "/":
            return list(self._names)
        begin = bisect_left(self._names, f"{name}/")
        end = bisect_left(self._names, f"{name}0")  # 0 is the character after the slash.
        return [*([name] if name in self.records else ()), *self._names[begin:end]]

    def _parents(self, name: str) -> list[str]:
        """Return the names above one, of which a value gives way to a namespace."""
        parts = name.split("/")
        return ["/".join(parts[:end]) for end in range(2, len(parts))]

    def _text(self, name: str) -> str | None:
        """Return a value as JSON; None for a namespace or a parameter that is not set."""
        parameters = self._graph.parameters
        try:
            if parameters.below(name) not in ([name], (name,)):
                return None
            return parameters.text(name).decode()
        except ParameterNotSet:
            return None

    def _keep(self, name: str, record: ParameterRecord) -> None:
        if name not in self.records:
            insort(self._names, name)
        self.records[name] = record
        self._deleted.pop(name, None)
        if record.value is None:
            self._deleted[name] = None
            if len(self._deleted) > MOST_DELETED:
                oldest = next(iter(self._deleted))
                del self._deleted[oldest]
                self._forget(oldest)

    def _forget(self, name: str) -> None:
        del self.records[name]
        del self._names[bisect_left(self._names, name)]


def _is_in(name: str, namespace: str) -> bool:
    """Return whether a name is that of a namespace, or in it."""
    return namespace == "/" or name == namespace or name.startswith(f"{namespace}/")
