"""The source of all filters: a subscription."""

from __future__ import annotations

from typing import Any

import rospy

from message_filters.simple_filter import SimpleFilter


class Subscriber(SimpleFilter):
    """Lets all messages of a topic through.

    Args:
        args: those of `rospy.Subscriber`, but for the callback.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        self.topic = args[0] if args else kwargs["name"]
        self.sub = rospy.Subscriber(*args, **{**kwargs, "callback": self.callback})

    def callback(self, msg: Any) -> None:
        """Let a message through."""
        self.signalMessage(msg)

    def getTopic(self) -> str:
        """The topic's name, as it was given."""
        return str(self.topic)

    def __getattr__(self, key: str) -> Any:
        """What a `rospy.Subscriber` has, such as ``unregister``."""
        if key == "sub":  # It could not be made.
            raise AttributeError(key)
        return getattr(self.sub, key)
