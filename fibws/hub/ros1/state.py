"""The state file: the ROS 1 nodes that are registered, for a hub that starts after this one.

ROS 1 nodes register once and never again, so that a master without a memory loses them when it is
restarted. The file is JSON. It is written whole or not at all, in a thread, and soon after changes.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Callable, Sequence
from pathlib import Path

from pydantic import TypeAdapter

from fibws.errors import SettingError
from fibws.hub.kept_file import KeptFile
from fibws.hub.ros1.nodes import SavedNode, is_api

logger = logging.getLogger("fibws.hub")

DELAY = 0.1
"""Seconds after a change in which further ones are waited for."""
FLAG = "--ros1-state"
VERSION = 1
_NODES = TypeAdapter(list[SavedNode])


class StateFile(KeptFile[Sequence[SavedNode]]):
    """Keeps the nodes in a file.

    Args:
        path: of the file; a missing folder is created.
        saved: returns the nodes.
    """

    def __init__(self, path: Path, saved: Callable[[], Sequence[SavedNode]]) -> None:
        super().__init__(path, FLAG, saved, _text, delay=DELAY)

    def check(self) -> bytes:
        """Raise `HubError` also if the file is another program's."""
        content = super().check()
        # One that a crash has damaged, or a newer hub has written, is replaced.
        if (known := content.strip(b"\0 \n")) and not known.startswith(b"{"):
            raise SettingError(f"{FLAG}: {self.path} is not a state file; choose another path")
        return content

    def nodes(self) -> list[SavedNode]:
        """Return the nodes of the file; an empty list if it is missing or invalid."""
        try:
            document = json.loads(self.read())
            if document["version"] != VERSION:
                raise ValueError(f"version {document['version']} is not {VERSION}")
            nodes = _NODES.validate_python(document["nodes"])
            return [node for node in nodes if node.name.startswith("/") and is_api(node.api)]
        except FileNotFoundError:
            return []
        except (OSError, ValueError, LookupError, TypeError, RecursionError) as error:
            reason = str(error).splitlines()[0]
            logger.warning("%s is ignored: it is not a state file: %s.", self.path, reason)
            return []


def _text(nodes: Sequence[SavedNode]) -> bytes:
    return json.dumps({"version": VERSION, "nodes": [each._asdict() for each in nodes]}).encode()
