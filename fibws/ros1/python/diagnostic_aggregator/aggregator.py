"""aggregator_node: sorts what all devices publish on /diagnostics into a tree.

Source: diagnostic_aggregator of ROS Noetic, http://wiki.ros.org/diagnostic_aggregator. Analyzers
that are plugins in C++ are reported as unknown.
"""

from __future__ import annotations

import re
import sys
import threading
from collections.abc import Iterable, Mapping
from typing import Any, Protocol

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

OK: int = DiagnosticStatus.OK
ERROR: int = DiagnosticStatus.ERROR
STALE: int = DiagnosticStatus.STALE
TEXTS = ("OK", "Warning", "Error", "Stale")

PACKAGE = "diagnostic_aggregator/"
OTHER = "Other"
TIMEOUT = 5.0
"""Seconds after which an item that is not repeated is stale."""
MOST_ITEMS = 10_000
"""Most items of an analyzer; more are ignored, with a warning."""


class InvalidAnalyzer(Exception):
    """The parameters of an analyzer are invalid; the text says why."""


class Item:
    """The last status of one name.

    Attributes:
        status: as it was received.
        time: when it was received, in seconds.
    """

    def __init__(self, status: DiagnosticStatus, time: float) -> None:
        self.status = status
        self.time = time

    @classmethod
    def missing(cls, name: str) -> Item:
        """Return the item of a name that is expected, and has not been received."""
        return cls(DiagnosticStatus(level=STALE, name=name, message="Missing"), float("-inf"))


class Analyzer(Protocol):
    """A branch of the tree."""

    path: str
    """The name of the branch, without those above it."""

    def matches(self, name: str) -> bool:
        """Return whether items of this name belong to it."""
        ...

    def take(self, item: Item) -> None:
        """Take an item that matches."""
        ...

    def report(self, above: str, now: float) -> tuple[DiagnosticStatus | None, list[Any]]:
        """Return the summary, or None if there is nothing to show, and all statuses in order."""
        ...


class GenericAnalyzer:
    """A branch of items that are chosen by their names.

    Args:
        parameters: ``path`` and what to choose; see ROS's documents.

    Raises:
        InvalidAnalyzer: they are invalid.
    """

    def __init__(self, parameters: Mapping[str, Any]) -> None:
        self.path = str(parameters.get("path", "")).strip("/")
        if not self.path:
            raise InvalidAnalyzer('GenericAnalyzer was not given parameter "path"')
        both = _texts(parameters, "find_and_remove_prefix")
        self._prefixes = [*both, *_texts(parameters, "remove_prefix")]
        self._starts = (*both, *_texts(parameters, "startswith"))
        self._parts = _texts(parameters, "contains")
        self._names = {*_texts(parameters, "name"), *_texts(parameters, "expected")}
        try:
            self._patterns = [re.compile(each) for each in _texts(parameters, "regex")]
        except re.error as error:
            raise InvalidAnalyzer(f"invalid regex: {error}") from None
        self._timeout = _number(parameters, "timeout", TIMEOUT)
        self._count = int(_number(parameters, "num_items", -1))
        self._discards_stale = bool(parameters.get("discard_stale", False))
        self._shows_empty = True
        """Whether a branch whose items are all discarded is shown for the first seconds."""
        self._fault = ""
        """A message that makes any item an error."""
        self._start: float | None = None
        self._items = {name: Item.missing(name) for name in _texts(parameters, "expected")}

    @classmethod
    def of_others(cls, *, as_errors: bool) -> GenericAnalyzer:
        """Return the branch of the items that no other branch has."""
        found = cls({"path": OTHER, "discard_stale": True})
        found._shows_empty = False
        found._fault = f'Unanalyzed items found in "{OTHER}"' if as_errors else ""
        return found

    def matches(self, name: str) -> bool:
        """Return whether items of this name belong to it."""
        return (
            name in self._names
            or name.startswith(self._starts)
            or any(part in name for part in self._parts)
            or any(pattern.fullmatch(name) for pattern in self._patterns)
        )

    def take(self, item: Item) -> None:
        """Take an item that matches."""
        name = item.status.name
        if name not in self._items and len(self._items) >= MOST_ITEMS:
            rospy.logwarn_once("%s has %d items; more are ignored", self.path, MOST_ITEMS)
            return
        self._items[name] = item

    def report(self, above: str, now: float) -> tuple[DiagnosticStatus | None, list[Any]]:
        """Return the summary, or None if there is nothing to show, and all statuses in order."""
        if self._start is None:
            self._start = now
        if self._discards_stale:
            fresh = {
                name: each for name, each in self._items.items() if not self._is_old(each, now)
            }
            self._items = fresh
            is_new = now - self._start <= self._timeout
            if not fresh and not (self._shows_empty and is_new):
                return None, []
        path = f"{above}/{self.path}"
        items = [self._items[name] for name in sorted(self._items)]
        levels = [STALE if self._is_old(item, now) else item.status.level for item in items]
        level, message = self._summary(levels)
        header = DiagnosticStatus(level=level, name=path, message=message)
        found = [header]
        for item, each in zip(items, levels, strict=True):
            status = item.status
            header.values.append(KeyValue(status.name, status.message))
            name = f"{path}/{self._short(status.name)}"
            found.append(
                DiagnosticStatus(each, name, status.message, status.hardware_id, status.values)
            )
        return header, found

    def _summary(self, levels: list[int]) -> tuple[int, str]:
        count = len(levels)
        level = _combined(levels)
        if self._count == 0 and not count:
            return OK, TEXTS[OK]
        if self._count > 0 and count != self._count:
            if not count:
                return STALE, f"No items found, expected {self._count}"
            return max(level, ERROR), f"Expected {self._count}, found {count}"
        if self._fault:
            return ERROR, self._fault
        return level, TEXTS[level]

    def _is_old(self, item: Item, now: float) -> bool:
        return 0 < self._timeout < now - item.time

    def _short(self, name: str) -> str:
        """Return a name without its prefixes, and without slashes."""
        for prefix in self._prefixes:
            if prefix and name.startswith(prefix):
                name = name.removeprefix(prefix).removeprefix(":").lstrip(" ")
        return name.replace("/", " ")


class DiscardAnalyzer(GenericAnalyzer):
    """Items that are not shown."""

    def take(self, item: Item) -> None:
        """Discard the item."""

    def report(self, above: str, now: float) -> tuple[DiagnosticStatus | None, list[Any]]:
        """Return nothing."""
        return None, []


class AnalyzerGroup:
    """A branch of branches.

    Args:
        path: its name; empty for the root.
        parameters: those of each branch, by names that only sort them.
    """

    def __init__(self, path: str, parameters: Mapping[str, Any]) -> None:
        self.path = path.strip("/")
        self.analyzers: list[Analyzer] = []
        self._failed: list[str] = []
        for name in sorted(parameters):
            try:
                analyzer = _make(name, parameters[name])
            except InvalidAnalyzer as error:
                rospy.logerr("Analyzer %s: %s", name, error)
                self._failed.append(name)
                continue
            if analyzer is not None:
                self.analyzers.append(analyzer)
        if self._failed and not self.analyzers and self.path:
            raise InvalidAnalyzer("none of its analyzers is valid")

    def matches(self, name: str) -> bool:
        """Return whether items of this name belong to any branch."""
        return any(each.matches(name) for each in self.analyzers)

    def take(self, item: Item) -> None:
        """Pass an item to all branches that match."""
        for each in self.analyzers:
            if each.matches(item.status.name):
                each.take(item)

    def report(self, above: str, now: float) -> tuple[DiagnosticStatus | None, list[Any]]:
        """Return the summary, or None for a root without a name, and all statuses in order."""
        path = f"{above}/{self.path}" if self.path else above
        found: list[Any] = []
        values, levels = [], []
        for each in self.analyzers:
            header, statuses = each.report(path, now)
            found.extend(statuses)
            if header is not None:
                values.append(KeyValue(each.path, header.message))
                levels.append(header.level)
        header = None
        if self.path:
            level = _combined(levels) if levels else OK
            message = TEXTS[level]
            if not self.analyzers:
                level, message = ERROR, "No analyzers"
            header = DiagnosticStatus(level=level, name=path, message=message, values=values)
            found.append(header)
        for name in self._failed:
            message = "Analyzer init failed"
            found.append(DiagnosticStatus(level=STALE, name=f"{path}/{name}", message=message))
        return header, found


_ANALYZERS = {"GenericAnalyzer": GenericAnalyzer, "DiscardAnalyzer": DiscardAnalyzer}


def _make(name: str, parameters: Any) -> Analyzer | None:
    """Return an analyzer; None for one that has nothing to do, or that is unknown.

    Raises:
        InvalidAnalyzer: its parameters are invalid.
    """
    if not isinstance(parameters, Mapping) or not isinstance(parameters.get("type"), str):
        raise InvalidAnalyzer('requires the parameter "type"')
    kind = parameters["type"].removeprefix(PACKAGE)
    if kind == "AnalyzerGroup":
        inner = parameters.get("analyzers")
        if not isinstance(inner, Mapping):
            raise InvalidAnalyzer('AnalyzerGroup requires the parameter "analyzers"')
        return AnalyzerGroup(str(parameters.get("path", name)), inner)
    if kind in _ANALYZERS:
        return _ANALYZERS[kind](parameters)
    if kind != "IgnoreAnalyzer":
        known = ", ".join([*_ANALYZERS, "IgnoreAnalyzer", "AnalyzerGroup"])
        rospy.logerr("Analyzer %s: unknown type %s; known are %s", name, kind, known)
    return None


def _combined(levels: Iterable[int]) -> int:
    """Return the level of several: stale if all are, and an error if some are."""
    found = list(levels)
    least, most = min(found, default=STALE), max(found, default=STALE)
    return ERROR if most > ERROR >= least else most


def _texts(parameters: Mapping[str, Any], name: str) -> list[str]:
    """Return a parameter that is a text, or a list of them."""
    value = parameters.get(name, [])
    return [str(each) for each in (value if isinstance(value, list) else [value])]


def _number(parameters: Mapping[str, Any], name: str, default: float) -> float:
    value = parameters.get(name, default)
    return value if isinstance(value, int | float) else default


class Aggregator:
    """Publishes the tree, once in a while."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        base = str(rospy.get_param("~base_path", ""))
        self._root = AnalyzerGroup(base, rospy.get_param("~analyzers", {}))
        as_errors = bool(rospy.get_param("~other_as_errors", False))
        self._others = GenericAnalyzer.of_others(as_errors=as_errors)
        self._above = f"/{base.strip('/')}" if base.strip("/") else ""
        self._tree = rospy.Publisher("/diagnostics_agg", DiagnosticArray, queue_size=1)
        self._state = rospy.Publisher("/diagnostics_toplevel_state", DiagnosticStatus, queue_size=1)
        rospy.Subscriber("/diagnostics", DiagnosticArray, self._receive, queue_size=1000)

    def _receive(self, array: DiagnosticArray) -> None:
        now = rospy.get_time()
        with self._lock:
            for status in array.status:
                home = self._root if self._root.matches(status.name) else self._others
                home.take(Item(status, now))

    def publish(self) -> None:
        """Publish the tree and its worst level."""
        with self._lock:
            now = rospy.get_time()
            _, statuses = self._root.report("", now)
            statuses += self._others.report(self._above, now)[1]
        array = DiagnosticArray(status=statuses)
        array.header.stamp = rospy.Time.now()
        self._tree.publish(array)
        level = _combined(each.level for each in statuses) if statuses else OK
        self._state.publish(DiagnosticStatus(level=level, name="toplevel_state"))


def main() -> None:
    """Run the program until the node ends."""
    rospy.init_node("diagnostic_aggregator")
    frequency = _number({"f": rospy.get_param("~pub_rate", 1.0)}, "f", 0)
    if frequency <= 0:
        rospy.logfatal("~pub_rate must be > 0")
        sys.exit(1)
    aggregator = Aggregator()
    rate = rospy.Rate(frequency)
    while not rospy.is_shutdown():
        aggregator.publish()
        rate.sleep()


if __name__ == "__main__":
    main()
