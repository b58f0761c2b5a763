"""Menus of interactive markers.

Source: interactive_markers of ROS Noetic, http://wiki.ros.org/interactive_markers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import rospy
from visualization_msgs.msg import InteractiveMarker, InteractiveMarkerFeedback, MenuEntry

from interactive_markers.interactive_marker_server import InteractiveMarkerServer


@dataclass
class EntryContext:
    """An entry of a menu."""

    title: str
    command: str
    command_type: int
    feedback_cb: Callable[[Any], object] | None
    sub_entries: list[int] = field(default_factory=list)
    visible: bool = True
    check_state: int = 0


class MenuHandler:
    """A menu with entries below entries, which several markers may have."""

    NO_CHECKBOX = 0
    CHECKED = 1
    UNCHECKED = 2

    def __init__(self) -> None:
        self._top: list[int] = []
        self._entries: dict[int, EntryContext] = {}
        self._markers: set[str] = set()

    def insert(
        self,
        title: str,
        parent: int | None = None,
        command_type: int = MenuEntry.FEEDBACK,
        command: str = "",
        callback: Callable[[Any], object] | None = None,
    ) -> int | None:
        """Add an entry; return its handle, or None if the parent is unknown.

        Args:
            title: what people read.
            parent: the handle of the entry that it is below; None for the top.
            command_type: what a click does: ``MenuEntry.FEEDBACK``, ``ROSRUN`` or ``ROSLAUNCH``.
            command: the command for the last two.
            callback: takes the InteractiveMarkerFeedback of a click.
        """
        if parent is not None and parent not in self._entries:
            rospy.logerr("Parent menu entry %s not found.", parent)
            return None
        handle = len(self._entries) + 1
        self._entries[handle] = EntryContext(title, command, command_type, callback)
        siblings = self._top if parent is None else self._entries[parent].sub_entries
        siblings.append(handle)
        return handle

    def setVisible(self, handle: int, visible: bool) -> bool:
        """Show or hide an entry and those below it; return whether it exists."""
        if handle in self._entries:
            self._entries[handle].visible = visible
        return handle in self._entries

    def setCheckState(self, handle: int, check_state: int) -> bool:
        """Set an entry's box: `NO_CHECKBOX`, `CHECKED` or `UNCHECKED`; return whether it exists."""
        if handle in self._entries:
            self._entries[handle].check_state = check_state
        return handle in self._entries

    def getCheckState(self, handle: int) -> int | None:
        """Return the state of an entry's box, or None if it does not exist."""
        return self._entries[handle].check_state if handle in self._entries else None

    def getTitle(self, handle: int) -> str | None:
        """Return an entry's title, or None if it does not exist."""
        return self._entries[handle].title if handle in self._entries else None

    def apply(self, server: InteractiveMarkerServer, marker_name: str) -> bool:
        """Give a marker this menu; return whether the marker is there."""
        marker: InteractiveMarker | None = server.get(marker_name)
        if marker is None:
            self._markers.discard(marker_name)
            return False
        marker.menu_entries = list(self._messages(self._top, 0))
        server.insert(marker, self.processFeedback, InteractiveMarkerFeedback.MENU_SELECT)
        self._markers.add(marker_name)
        return True

    def reApply(self, server: InteractiveMarkerServer) -> bool:
        """Give the changed menu to all markers that have it; return whether all are there."""
        return all([self.apply(server, marker) for marker in list(self._markers)])

    def processFeedback(self, feedback: InteractiveMarkerFeedback) -> None:
        """Call the callback of the entry that was clicked."""
        entry = self._entries.get(feedback.menu_entry_id)
        if entry is not None and entry.feedback_cb is not None:
            entry.feedback_cb(feedback)

    def _messages(self, handles: Iterable[int], parent: int) -> Iterator[MenuEntry]:
        for handle in handles:
            entry = self._entries[handle]
            if entry.visible:
                title = _PREFIXES.get(entry.check_state, "") + entry.title
                yield MenuEntry(handle, parent, title, entry.command, entry.command_type)
                yield from self._messages(entry.sub_entries, handle)


_PREFIXES = {MenuHandler.CHECKED: "[x] ", MenuHandler.UNCHECKED: "[ ] "}
