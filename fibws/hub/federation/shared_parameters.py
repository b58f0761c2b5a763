"""Parameters that hubs share: each hub has all of them, and the last change wins.

Which change is the last is told by the clocks of the hubs, and a change of a known value is always
later than that. While two hubs are not connected each changes its own copy; when they meet, the
later value of each parameter replaces the other one. A deletion is a change, too.
"""

from __future__ import annotations

import logging
from bisect import bisect_left, insort
from collections import OrderedDict
from collections.abc import Callable, Collection, Mapping

from pydantic_core import from_json

from fibws.errors import FibwsError
from fibws.hub.federation.backplane import Backplane
from fibws.hub.federation.names import NameView
from fibws.hub.federation.records import LATEST, ParameterRecord
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.parameters import native

logger = logging.getLogger("fibws.hub")

MOST_DELETED = 10_000
"""Deletions that are remembered; each could be undone by a hub that has not heard of it."""

EMPTY = "{}"
"""The value of a namespace in which there is nothing."""


class SharedParameters:
    """The parameters of this hub that other hubs have, too.

    Args:
        hub: the id of this one.
        namespaces: those that are shared with all hubs, under the same names.
        changed: called with the name of a parameter whose record has changed.
        loaded: the parameters that are older than the hub, with the times at which they were set;
            others that are there are the hub's own, and are not shared.
    """

    def __init__(
        self,
        graph: Graph,
        hub: str,
        namespaces: Collection[str],
        changed: Callable[[str], object],
        loaded: Mapping[str, int],
    ) -> None:
        self.records: dict[str, ParameterRecord] = {}
        """By name."""
        self._names: list[str] = []
        """The same names, sorted."""
        self._graph = graph
        self._hub = hub
        self._namespaces = tuple(namespaces)
        self._changed = changed
        self._loaded = dict(loaded)
        self._own = frozenset(graph.parameters.names()) - self._loaded.keys()
        """Parameters that the hub sets for itself, such as /run_id."""
        self._followed: set[str] = set()
        """The namespaces whose changes are recorded."""
        self._deleted: OrderedDict[str, None] = OrderedDict()
        self._is_applying = False
        """Whether a change of another hub is being made here."""
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
        self._is_applying = True
        try:
            self._apply(name, record.value, backplane.node)
        except (FibwsError, ValueError) as error:
            logger.warning("%s is not set as at other hubs: %s", name, error)
            if known is None:
                self._forget(name)
            else:
                self.records[name] = known
            return
        finally:
            self._is_applying = False
        self._changed(name)
        if not (record.value == EMPTY and self._is_full(name)):
            self._compare(name)

    def _apply(self, name: str, value: str | None, node: str) -> None:
        """Make a change of another hub; a namespace that is not empty here remains.

        What was deleted from it has records of its own, and what is new in it is not known there.
        """
        graph, is_full = self._graph, self._is_full(name)
        if value is None and not is_full:
            graph.delete_parameter(node, name)
            self._remove_emptied(name, node)
        elif value is not None and not (value == EMPTY and is_full):
            graph.set_parameter(node, name, native(from_json(value)))

    def _is_full(self, name: str) -> bool:
        """Return whether a name is that of a namespace with parameters."""
        parameters = self._graph.parameters
        return parameters.has(name) and not parameters.is_leaf(name)

    def _remove_emptied(self, name: str, node: str) -> None:
        """Delete the namespaces that a deletion has left empty, unless they are so elsewhere."""
        for parent in reversed(self._parents(name)):
            record = self.records.get(parent)
            is_known = record is not None and record.value == EMPTY
            if is_known or not self._is_followed(parent) or self._text(parent) != EMPTY:
                return
            self._graph.delete_parameter(node, parent)

    def _is_shared(self, name: str, view: NameView) -> bool:
        if name in self._own:
            return False
        if view.prefix:
            return view.outward(name) is not None
        return any(_is_in(name, namespace) for namespace in self._namespaces)

    def _follow(self, namespace: str) -> None:
        """Record all changes of a namespace from now on.

        What is there counts as set now, unless it was loaded.
        """
        if namespace not in self._followed:
            self._followed.add(namespace)
            self._compare(namespace)

    def _parameter_changed(self, name: str, node: str) -> None:
        if self._loaded:
            for each in (name, *self._graph.parameters.leaves(name)):
                self._loaded.pop(each, None)
        for namespace in self._followed:
            if _is_in(name, namespace):
                self._compare(name)
                return
            if _is_in(namespace, name):  # A namespace around it was replaced.
                self._compare(namespace)

    def _compare(self, name: str) -> None:
        """Record what has changed of a parameter, or in a namespace."""
        present = set(self._graph.parameters.leaves(name)) - self._own - {"/"}
        known = set(self._known_in(name))
        parents = set(filter(self._is_concerned, self._parents(name)))
        for each in sorted(present | known | parents):
            value = self._text(each)
            older = self.records.get(each)
            if value != (older.value if older is not None else None):
                earliest = older.stamp + 1 if older is not None else 0
                now = self._loaded.get(each) if older is None else None
                stamp = min(max(now or self._graph.now(), earliest), LATEST)
                self._keep(each, ParameterRecord(stamp=stamp, hub=self._hub, value=value))
                self._changed(each)

    def _is_concerned(self, parent: str) -> bool:
        """Return whether a change below a namespace may give it a new record."""
        is_emptied = self._text(parent) == EMPTY
        if is_emptied and self._is_applying:
            return False  # The other hub knows best whether it remains.
        return parent in self.records or (is_emptied and self._is_followed(parent))

    def _is_followed(self, name: str) -> bool:
        return any(_is_in(name, namespace) for namespace in self._followed)

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
        """Return a value as JSON; None for a parameter that is not set, and for a namespace.

        A namespace in which there is nothing is a value: it comes and goes like one.
        """
        parameters = self._graph.parameters
        return parameters.text(name).decode() if parameters.is_leaf(name) else None

    def _keep(self, name: str, record: ParameterRecord) -> None:
        if name not in self.records:
            insort(self._names, name)
        self.records[name] = record
        self._deleted.pop(name, None)
        if record.value is None:
            self._deleted[name] = None
            if len(self._deleted) > MOST_DELETED:
                oldest, _ = self._deleted.popitem(last=False)
                self._forget(oldest)

    def _forget(self, name: str) -> None:
        del self.records[name]
        del self._names[bisect_left(self._names, name)]


def _is_in(name: str, namespace: str) -> bool:
    """Return whether a name is that of a namespace, or in it."""
    return namespace == "/" or name == namespace or name.startswith(f"{namespace}/")
