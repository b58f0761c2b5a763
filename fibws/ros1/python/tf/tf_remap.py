"""tf_remap: publishes the transforms of /tf_old on /tf with other names of frames.

For robots that were recorded with other names. Source: tf of ROS Noetic,
http://wiki.ros.org/tf#tf_remap.
"""

from __future__ import annotations

import sys
from typing import Any

import rospy
from tf2_msgs.msg import TFMessage


def read_mappings(value: Any) -> dict[str, str]:
    """Return the new names by the old ones.

    Args:
        value: the parameter ``~mappings``: ``[{old: /a, new: /b}, ...]``.

    Raises:
        ValueError: it is something else.
    """
    if not isinstance(value, list):
        raise ValueError(f"~mappings must be a list of {{old: NAME, new: NAME}}, got {value!r}")
    found = {}
    for each in value:
        old, new = (each.get("old"), each.get("new")) if isinstance(each, dict) else ("", "")
        if not (isinstance(old, str) and isinstance(new, str) and old and new):
            raise ValueError(f"~mappings must have {{old: NAME, new: NAME}}, got {each!r}")
        found[old.lstrip("/")] = new.lstrip("/")
    return found


def main() -> None:
    """Run the program until the node ends."""
    rospy.init_node("tf_remapper")
    try:
        names = read_mappings(rospy.get_param("~mappings", []))
    except ValueError as error:
        rospy.logfatal("%s", error)
        sys.exit(1)
    publisher = rospy.Publisher("/tf", TFMessage, queue_size=100)

    def rename(message: TFMessage) -> None:
        for transform in message.transforms:
            header = transform.header
            parent, child = header.frame_id.lstrip("/"), transform.child_frame_id.lstrip("/")
            header.frame_id = names.get(parent, header.frame_id)
            transform.child_frame_id = names.get(child, transform.child_frame_id)
        publisher.publish(message)

    rospy.Subscriber("/tf_old", TFMessage, rename)
    rospy.spin()


if __name__ == "__main__":
    main()
