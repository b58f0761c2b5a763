"""The time of a message, by which filters put it in order."""

from __future__ import annotations

from typing import Any

import rospy


def stamp_of(message: Any, allow_headerless: bool) -> Any:
    """The ``Time`` in a message's header, or of now for one without if that is allowed.

    Returns:
        None if it is not, which the log then tells.
    """
    header: Any = getattr(message, "header", None)
    if hasattr(header, "stamp"):
        return header.stamp
    if allow_headerless:
        return rospy.Time.now()
    rospy.logwarn(
        "Cannot use message filters with non-stamped messages. "
        "Use the 'allow_headerless' constructor option to "
        "auto-assign ROS time to headerless messages."
    )
    return None
