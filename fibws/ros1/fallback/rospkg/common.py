"""Names that all modules of rospkg use."""

from __future__ import annotations

MANIFEST_FILE = "package.xml"


class ResourceNotFound(Exception):
    """The package is unknown; the text begins with its name.

    Args:
        msg: the name, and hints.
        ros_paths: the folders that were searched.
    """

    def __init__(self, msg: str, ros_paths: list[str] | None = None) -> None:
        super().__init__(msg)
        self.ros_paths = ros_paths
