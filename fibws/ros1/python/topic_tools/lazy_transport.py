"""`LazyTransport`, the base of nodes that subscribe only while somebody subscribes to them."""

from __future__ import annotations

import threading
from typing import Any

import rospy

WARNING_AFTER = 5.0
"""Seconds without any subscriber after which the log says why nothing is passed on."""


class _WithEnd(type):
    """Calls `LazyTransport._post_init` after the constructors of all subclasses."""

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        found = super().__call__(*args, **kwargs)
        found._post_init()
        return found


class LazyTransport(rospy.SubscribeListener, metaclass=_WithEnd):
    """Calls `subscribe` and `unsubscribe`, which subclasses define, as `advertise`d topics need it.

    With the parameter ``~lazy`` false, it subscribes at once. Source: topic_tools of ROS Noetic.
    """

    def __init__(self) -> None:
        super().__init__()
        self._publishers: list[rospy.Publisher] = []
        self._connection_status: bool | None = None
        """Whether it has subscribed; None if it never has."""
        self._lock = threading.RLock()
        rospy.Timer(rospy.Duration(WARNING_AFTER), self._warn_never_subscribed_cb, oneshot=True)

    def _post_init(self) -> None:
        with self._lock:
            if not rospy.get_param("~lazy", True) and not self._connection_status:
                self.subscribe()
                self._connection_status = True

    def _warn_never_subscribed_cb(self, timer_event: object) -> None:
        if self._connection_status is None:
            rospy.logwarn(
                "[%s] subscribes topics only with child subscribers. Set '~lazy' as False to have "
                "it always transport message.",
                rospy.get_name(),
            )

    def subscribe(self) -> None:
        """Subscribe to the inputs; subclasses override it."""
        raise NotImplementedError("Please overwrite this method")

    def unsubscribe(self) -> None:
        """Undo `subscribe`; subclasses override it."""
        raise NotImplementedError("Please overwrite this method")

    def peer_subscribe(self, *args: Any, **kwargs: Any) -> None:
        """Subscribe for the first subscriber."""
        with self._lock:
            if not self._connection_status:
                self.subscribe()
                self._connection_status = True

    def peer_unsubscribe(self, *args: Any, **kwargs: Any) -> None:
        """Unsubscribe after the last subscriber."""
        with self._lock:
            if not self._connection_status or not rospy.get_param("~lazy", True):
                return
            if not any(each.get_num_connections() for each in self._publishers):
                self.unsubscribe()
                self._connection_status = False

    def advertise(self, *args: Any, **kwargs: Any) -> rospy.Publisher:
        """Return a `rospy.Publisher` whose subscribers count; the arguments are its own."""
        kwargs["subscriber_listener"] = self
        publisher = rospy.Publisher(*args, **kwargs)
        self._publishers.append(publisher)
        return publisher
