"""The tags of a launch file, which know its name and their lines."""

from __future__ import annotations

from dataclasses import dataclass

from fibws.errors import LaunchError
from fibws.ros1 import xml_tree


@dataclass
class Tag(xml_tree.Element):
    """One tag."""

    def fault(self, text: str) -> LaunchError:
        """An error that tells where this tag stands."""
        return LaunchError(self.file, self.line, text)


def read(document: bytes, file: str) -> Tag:
    """The root of a launch file; it raises `LaunchError` if that is no XML, or no harmless one."""
    return xml_tree.read(document, file, Tag)
