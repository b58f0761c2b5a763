"""The server of interactive markers.

Source: interactive_markers of ROS Noetic, http://wiki.ros.org/interactive_markers.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, auto
from threading import RLock
from typing import Any, TypeAlias

import rospy
from std_msgs.msg import Header
from visualization_msgs.msg import (
    InteractiveMarker,
    InteractiveMarkerFeedback,
    InteractiveMarkerInit,
    InteractiveMarkerPose,
    InteractiveMarkerUpdate,
)

ALIVE_INTERVAL = 0.5
"""Seconds between two messages that say that the server is alive."""
HOLD = 1.0
"""Seconds after the last feedback of a client in which others may not change its marker."""

Callback: TypeAlias = Callable[[Any], object]


class _Callbacks:
    """The functions that take a marker's feedback."""

    def __init__(self) -> None:
        self._default: Callback | None = None
        self._by_type: dict[int, Callback] = {}

    def set(self, callback: Callback | None, feedback_type: int) -> None:
        if feedback_type == InteractiveMarkerServer.DEFAULT_FEEDBACK_CB:
            self._default = callback
        elif callback is None:
            self._by_type.pop(feedback_type, None)
        else:
            self._by_type[feedback_type] = callback

    def call(self, feedback: InteractiveMarkerFeedback) -> None:
        callback = self._by_type.get(feedback.event_type, self._default)
        if callback is not None:
            callback(feedback)


class _Shown:
    """A marker as the clients have it."""

    def __init__(self, marker: InteractiveMarker, callbacks: _Callbacks) -> None:
        self.marker = marker
        self.callbacks = callbacks
        self._client = ""
        self._last_feedback = rospy.Time()

    def take(self, client: str) -> bool:
        """Return whether a client may change the marker now; it holds it for `HOLD` seconds."""
        now = rospy.Time.now()
        is_held = 0 <= (now - self._last_feedback).to_sec() < HOLD
        if is_held and self._client not in ("", client):
            return False
        self._client, self._last_feedback = client, now
        return True


class _Kind(Enum):
    FULL = auto()
    POSE = auto()
    ERASE = auto()


class _Change:
    """A change that `InteractiveMarkerServer.applyChanges` will publish."""

    def __init__(self, kind: _Kind, marker: InteractiveMarker) -> None:
        self.kind = kind
        self.marker = marker
        """The marker, of which only the pose and the header count for `_Kind.POSE`."""
        self.callbacks = _Callbacks()


class InteractiveMarkerServer:
    """Shows markers, and passes on what people do with them.

    Changes are published by `applyChanges`.

    Args:
        topic_ns: the namespace of the topics ``update``, ``update_full`` and ``feedback``.
        server_id: what tells several servers of a node apart.
        q_size: the most feedback that waits for the callbacks.
    """

    DEFAULT_FEEDBACK_CB = 255
    """The type of feedback of a callback that takes all that has no callback of its own."""

    def __init__(self, topic_ns: str, server_id: str = "", q_size: int = 100) -> None:
        self.topic_ns = topic_ns
        self.server_id = rospy.get_name() + server_id
        self.seq_num = 0
        self._lock = RLock()
        self._shown: dict[str, _Shown] = {}
        self._changes: dict[str, _Change] = {}
        self.init_pub = rospy.Publisher(
            f"{topic_ns}/update_full", InteractiveMarkerInit, latch=True, queue_size=100
        )
        self.update_pub = rospy.Publisher(
            f"{topic_ns}/update", InteractiveMarkerUpdate, queue_size=100
        )
        self._subscriber = rospy.Subscriber(
            f"{topic_ns}/feedback",
            InteractiveMarkerFeedback,
            self.processFeedback,
            queue_size=q_size,
        )
        self._timer = rospy.Timer(rospy.Duration(ALIVE_INTERVAL), self.keepAlive, reset=True)
        self.publishInit()

    def insert(
        self,
        marker: InteractiveMarker,
        feedback_cb: Callback | int | None = -1,
        feedback_type: int = DEFAULT_FEEDBACK_CB,
    ) -> None:
        """Add a marker, or replace the one of its name.

        Args:
            feedback_cb: a callback, as for `setCallback`; -1 leaves the callbacks as they are.
            feedback_type: the callback's type of feedback.
        """
        with self._lock:
            change = self._changes.get(marker.name)
            if change is None:
                change = self._changes[marker.name] = _Change(_Kind.FULL, marker)
            change.kind, change.marker = _Kind.FULL, marker
        if not isinstance(feedback_cb, int):
            self.setCallback(marker.name, feedback_cb, feedback_type)

    def setPose(self, name: str, pose: Any, header: Header | None = None) -> bool:
        """Move a marker; return whether it is there.

        Args:
            header: the frame and the time of the pose; the marker's own if it has no frame.
        """
        with self._lock:
            marker = self.get(name)
            if marker is None:
                return False
            has_frame = header is not None and bool(header.frame_id)
            self._set_pose(name, pose, header if has_frame else marker.header)
            return True

    def erase(self, name: str) -> bool:
        """Remove a marker; return whether it is there."""
        with self._lock:
            if name in self._changes:
                self._changes[name].kind = _Kind.ERASE
            elif name in self._shown:
                self._changes[name] = _Change(_Kind.ERASE, InteractiveMarker())
            else:
                return False
            return True

    def clear(self) -> None:
        """Remove all markers."""
        with self._lock:
            self._changes = {}
            for name in self._shown:
                self.erase(name)

    def setCallback(
        self,
        name: str,
        feedback_cb: Callback | None,
        feedback_type: int = DEFAULT_FEEDBACK_CB,
    ) -> bool:
        """Set the function that takes the feedback of a marker; return whether that is there.

        Args:
            feedback_cb: takes an InteractiveMarkerFeedback, in a thread of its own; None for no
                function.
            feedback_type: the feedback that it takes, such as ``MENU_SELECT``.
        """
        with self._lock:
            shown, change = self._shown.get(name), self._changes.get(name)
            if shown is not None:
                shown.callbacks.set(feedback_cb, feedback_type)
            if change is not None:
                change.callbacks.set(feedback_cb, feedback_type)
            return shown is not None or change is not None

    def applyChanges(self) -> None:
        """Publish all changes since the last call."""
        with self._lock:
            if not self._changes:
                return
            message = InteractiveMarkerUpdate(type=InteractiveMarkerUpdate.UPDATE)
            for name, change in self._changes.items():
                self._apply(name, change, message)
            self._changes = {}
            self.seq_num += 1
            self.publish(message)
            self.publishInit()

    def get(self, name: str) -> InteractiveMarker | None:
        """Return a marker with its pending changes, or None if the name is unknown."""
        with self._lock:
            shown, change = self._shown.get(name), self._changes.get(name)
            if change is None:
                return shown.marker if shown is not None else None
            if change.kind is _Kind.FULL:
                return change.marker
            if change.kind is _Kind.ERASE or shown is None:
                return None
            shown.marker.pose = change.marker.pose
            return shown.marker

    def processFeedback(self, feedback: InteractiveMarkerFeedback) -> None:
        """Process feedback from a viewer, and call the marker's callback."""
        with self._lock:
            shown = self._shown.get(feedback.marker_name)
            if shown is None:
                return
            if not shown.take(feedback.client_id):
                rospy.logdebug(
                    "Rejecting feedback for %s: another client moves it", feedback.marker_name
                )
                return
            if feedback.event_type == InteractiveMarkerFeedback.POSE_UPDATE:
                own = shown.marker.header
                header = feedback.header if own.stamp else own
                self._set_pose(feedback.marker_name, feedback.pose, header)
        shown.callbacks.call(feedback)

    def keepAlive(self, msg: object) -> None:
        """Publish that the server is alive."""
        self.publish(InteractiveMarkerUpdate(type=InteractiveMarkerUpdate.KEEP_ALIVE))

    def publish(self, update: InteractiveMarkerUpdate) -> None:
        """Publish a message in the server's name."""
        update.server_id, update.seq_num = self.server_id, self.seq_num
        self.update_pub.publish(update)

    def publishInit(self) -> None:
        """Publish all markers, for clients that come later."""
        with self._lock:
            markers = [shown.marker for shown in self._shown.values()]
            message = InteractiveMarkerInit(self.server_id, self.seq_num, markers)
            self.init_pub.publish(message)

    def _apply(self, name: str, change: _Change, message: InteractiveMarkerUpdate) -> None:
        """Make a change, and add it to the message."""
        shown = self._shown.get(name)
        if change.kind is _Kind.FULL:
            if shown is None:
                self._shown[name] = _Shown(change.marker, change.callbacks)
            else:
                shown.marker = change.marker
            message.markers.append(change.marker)
        elif shown is None:
            return  # It was erased before the clients had it.
        elif change.kind is _Kind.ERASE:
            del self._shown[name]
            message.erases.append(name)
        else:
            shown.marker.pose, shown.marker.header = change.marker.pose, change.marker.header
            message.poses.append(
                InteractiveMarkerPose(shown.marker.header, shown.marker.pose, name)
            )

    def _set_pose(self, name: str, pose: Any, header: Header) -> None:
        change = self._changes.get(name)
        if change is None or change.kind is _Kind.ERASE:
            change = self._changes[name] = _Change(_Kind.POSE, InteractiveMarker())
        change.marker.pose, change.marker.header = pose, header
