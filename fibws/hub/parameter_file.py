"""The file of --params: parameters that are set at the start, and with --keep-params are kept.

It is YAML, as rosparam and ``fibws param dump`` write it. Parameters that tell of one run of the
hub, such as /run_id, are neither taken from the file nor written into it.
"""

from __future__ import annotations

import asyncio
from collections.abc import Collection
from pathlib import Path
from typing import Any

from pydantic_core import from_json

from fibws.errors import FibwsError, SettingError
from fibws.hub.graph.parameters import Namespace, Parameters, canonical, native
from fibws.hub.kept_file import KeptFile
from fibws.values import parameter_files

DELAY = 1.0
"""Seconds from a change to the write, with which others are written."""
FLAG = "--params"
OF_ONE_RUN = "/roslaunch"
"""The namespace in which roslaunch registers itself."""
HEAD = b"""\
# Parameters of a fibws hub, kept by --keep-params. Edit it while the hub is stopped.
"""


class ParameterFile:
    """Sets the parameters of a file, and keeps the file up to date.

    Args:
        own: the parameters that the hub sets for itself.
    """

    def __init__(
        self, path: Path, parameters: Parameters, own: Collection[str], *, is_kept: bool
    ) -> None:
        self._path = path
        self._parameters = parameters
        self._own = frozenset(own)
        self._is_kept = is_kept
        self.file = KeptFile(path, FLAG, parameters.tree, self._text, delay=DELAY, keeps_edits=True)

    async def load(self) -> dict[str, int]:
        """Set the parameters; return when each was set at the latest, in nanoseconds since 1970.

        Raises:
            HubError: the file cannot be read, or not be written if that is wanted, or a parameter
                in it is invalid.
        """
        entries, changed = await asyncio.to_thread(self._entries)
        found = {}
        for name, value in entries:
            known = canonical(name)
            if known in self._own or f"{known}/".startswith(f"{OF_ONE_RUN}/"):
                continue
            try:
                if value != {} or not self._parameters.has(known):
                    self._parameters.set(known, value)
            except FibwsError as error:
                raise SettingError(f"{FLAG}: {self._path}: {error}") from None
            found[known] = changed
        return found

    def watch(self) -> None:
        """Write the file after each change from now on."""
        self._parameters.watch(lambda name, node: self.file.changed())

    def _entries(self) -> tuple[list[tuple[str, Any]], int]:
        """Return the parameters of the file, and when it was written; in any thread."""
        if self._is_kept:
            self.file.check()
            if not self._path.exists():
                return [], 0
        try:
            text = parameter_files.read(self._path)
        except FibwsError as error:
            raise SettingError(f"{FLAG}: {error}") from None
        try:
            found = parameter_files.entries(text, "/")
        except FibwsError as error:
            raise SettingError(f"{FLAG}: {self._path}: {error}") from None
        return found, self._path.stat().st_mtime_ns

    def _text(self, tree: Namespace) -> bytes:
        document = self._document("", tree)
        return HEAD + parameter_files.saved(document or {}).encode()

    def _document(self, name: str, node: Namespace | bytes) -> Any:
        """Return a part of the tree with values as such; None for one that is not written.

        The event loop may change the tree meanwhile; the next write has what this one lacks.
        """
        if name in self._own or name == OF_ONE_RUN:
            return None
        if isinstance(node, bytes):
            return native(from_json(node))
        parts = {key: self._document(f"{name}/{key}", each) for key, each in list(node.items())}
        found = {key: each for key, each in parts.items() if each is not None}
        return None if parts and not found else found
