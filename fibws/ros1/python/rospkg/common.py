"""What all of rospkg has in common."""

from __future__ import annotations

MANIFEST_FILE = "package.xml"


class ResourceNotFound(Exception):
    """There is no such package; the text begins with its name.

    Args:
        msg: the name, and what may have been missed.
        ros_paths: where it was looked for.
    """

    def __init__(self, msg: str, ros_paths: list[str] | None = None) -> None:
        super().__init__(msg)
        self.ros_paths = ros_paths
