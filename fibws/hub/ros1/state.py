"""The state file: the ROS 1 nodes that are registered, for a hub that starts after this one.

ROS 1 nodes register once and never again, so that a master without a memory loses them when it is
restarted. The file is JSON. It is written whole or not at all, in a thread, and soon after changes.
"""

from __future__ import annotations

import asyncio
import json
import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from pydantic import TypeAdapter

from fibws.errors import HubError
from fibws.files import check_writable, replace_file, reserved
from fibws.hub.ros1.nodes import SavedNode, is_api

logger = logging.getLogger("fibws.hub")

DELAY = 0.1
"""Seconds after a change in which further ones are waited for."""
RETRY = 10.0
"""Seconds after a failed write until the next attempt."""
VERSION = 1
_NODES = TypeAdapter(list[SavedNode])


class StateFile:
    """Keeps the nodes in a file.

    Args:
        path: of the file; a missing folder is created.
        saved: returns the nodes.
    """

    def __init__(self, path: Path, saved: Callable[[], Sequence[SavedNode]]) -> None:
        self._path = path
        self._saved = saved
        self._writing: asyncio.Task[None] | None = None
        self._is_changed = False
        self._is_closing = asyncio.Event()
        self._fault = ""
        """Why the last write failed; empty if it succeeded."""

    def check(self) -> None:
        """Raise `HubError` if the file cannot be read or written, or is another program's."""
        try:
            check_writable(self._path.parent)
            content = self._path.read_bytes() if self._path.exists() else b""
        except OSError as error:
            fault = f"cannot use {self._path}: {error.strerror}"
            raise HubError(f"--ros1-state: {fault}") from None
        # One that a crash has damaged, or a newer hub has written, is replaced.
        if (known := content.strip(b"\0 \n")) and not known.startswith(b"{"):
            raise HubError(f"--ros1-state: {self._path} is not a state file; choose another path")

    @contextmanager
    def reserved(self) -> Iterator[None]:
        """Keep other hubs from using the file.

        Raises:
            HubError: another hub uses it; each would overwrite what the other one has written.
        """
        with ExitStack() as stack:
            try:
                self._path.parent.mkdir(parents=True, exist_ok=True)
                stack.enter_context(reserved(self._path))
            except BlockingIOError:
                fault = f"another hub uses {self._path}; choose another file"
                raise HubError(f"--ros1-state: {fault}") from None
            except OSError:
                pass  # Writing fails, too, and says why.
            yield

    def read(self) -> list[SavedNode]:
        """Return the nodes of the file; an empty list if it is missing or invalid."""
        try:
            document = json.loads(self._path.read_bytes())
            if document["version"] != VERSION:
                raise ValueError(f"version {document['version']} is not {VERSION}")
            nodes = _NODES.validate_python(document["nodes"])
            return [node for node in nodes if node.name.startswith("/") and is_api(node.api)]
        except FileNotFoundError:
            return []
        except (OSError, ValueError, LookupError, TypeError, RecursionError) as error:
            reason = str(error).splitlines()[0]
            logger.warning("%s is ignored: it is not a state file: %s.", self._path, reason)
            return []

    def changed(self) -> None:
        """Write the file soon."""
        self._is_changed = True
        if self._writing is None or self._writing.done():
            self._writing = asyncio.get_running_loop().create_task(self._write_later())

    async def close(self) -> None:
        """Write what has changed."""
        self._is_closing.set()
        if self._writing is not None:
            await self._writing

    async def _write_later(self) -> None:
        """Write until nothing has changed; try again after a failure, and at the end once more."""
        while self._is_changed:
            with suppress(TimeoutError):
                async with asyncio.timeout(RETRY if self._fault else DELAY):
                    await self._is_closing.wait()
            self._is_changed = False
            await asyncio.to_thread(self._write, self._text())
            if self._fault and not self._is_closing.is_set():
                self._is_changed = True

    def _text(self) -> bytes:
        nodes = [each._asdict() for each in self._saved()]
        return json.dumps({"version": VERSION, "nodes": nodes}).encode()

    def _write(self, text: bytes) -> None:
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            replace_file(self._path, text)
        except OSError as error:
            fault = error.strerror or str(error)
            if fault != self._fault:
                logger.warning("%s cannot be written: %s.", self._path, fault)
            self._fault = fault
        else:
            if self._fault:
                logger.warning("%s is written again.", self._path)
            self._fault = ""
