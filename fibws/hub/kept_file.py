"""A file that the hub keeps up to date: written whole or not at all, in a thread, after changes."""

from __future__ import annotations

import asyncio
import logging
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Generic, TypeVar

from fibws.errors import SettingError
from fibws.files import check_writable, make_private, replace_file, reserved

logger = logging.getLogger("fibws.hub")

RETRY = 10.0
"""Seconds after a failed write until the next attempt."""
SHARE = 20
"""At most this part of the time is spent on writing."""
SUFFIX = ".orig"
"""What is added to the name of a file that another program has changed."""

Snapshot = TypeVar("Snapshot")


class KeptFile(Generic[Snapshot]):
    """A file with the state of a part of the hub.

    Args:
        path: of the file; a missing folder is created.
        flag: the flag that names the file, for errors.
        snapshot: returns the state; called in the event loop.
        encode: returns the file's content; called in a thread.
        delay: seconds after a change in which further ones are waited for.
        keeps_edits: keep what another program has written into the file while the hub ran, under
            another name.
    """

    def __init__(
        self,
        path: Path,
        flag: str,
        snapshot: Callable[[], Snapshot],
        encode: Callable[[Snapshot], bytes],
        *,
        delay: float,
        keeps_edits: bool = False,
    ) -> None:
        self.path = path
        self._flag = flag
        self._snapshot = snapshot
        self._encode = encode
        self._delay = delay
        self._keeps_edits = keeps_edits
        self._writing: asyncio.Task[None] | None = None
        self._is_changed = False
        self._is_closing = asyncio.Event()
        self._content: bytes | None = None
        """What the file holds, as far as is known."""
        self._stamp: tuple[int, ...] = ()
        """Tells whether another program has changed the file."""
        self._fault = ""
        """Why the last write failed; empty if it succeeded."""

    @property
    def has_failed(self) -> bool:
        """Whether the last write failed."""
        return bool(self._fault)

    def check(self) -> bytes:
        """Return the content, empty if there is no file.

        Raises:
            HubError: it cannot be read, or its folder cannot be written to.
        """
        try:
            make_private(self.path.parent)
            check_writable(self.path.parent)
            return self.read()
        except FileNotFoundError:
            return b""
        except OSError as error:
            fault = f"cannot use {self.path}: {error.strerror}"
            raise SettingError(f"{self._flag}: {fault}") from None

    @contextmanager
    def reserved(self) -> Iterator[None]:
        """Keep other hubs from using the file.

        Raises:
            HubError: another hub uses it; each would overwrite what the other one has written.
        """
        with ExitStack() as stack:
            try:
                make_private(self.path.parent)
                stack.enter_context(reserved(self.path))
            except BlockingIOError:
                fault = f"another hub uses {self.path}; choose another file"
                raise SettingError(f"{self._flag}: {fault}") from None
            except OSError:
                pass  # Writing fails, too, and says why.
            yield

    def read(self) -> bytes:
        """Return the content; raises `OSError`."""
        self._content = self.path.read_bytes()
        self._stamp = self._found()
        return self._content

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
        if self._fault:
            logger.warning("%s lacks the last changes: %s.", self.path, self._fault)

    async def _write_later(self) -> None:
        """Write until nothing has changed; try again after a failure, and at the end once more."""
        clock = asyncio.get_running_loop().time
        taken = 0.0
        while self._is_changed:
            pause = RETRY if self._fault else max(self._delay, SHARE * taken)
            with suppress(TimeoutError):
                async with asyncio.timeout(pause):
                    await self._is_closing.wait()
            self._is_changed = False
            begin = clock()
            await asyncio.to_thread(self._write, self._snapshot())
            taken = clock() - begin
            if self._fault and not self._is_closing.is_set():
                self._is_changed = True

    def _write(self, snapshot: Snapshot) -> None:
        try:
            content = self._encode(snapshot)
            is_edited = self._stamp != self._found()
            if content == self._content and not is_edited:
                return
            make_private(self.path.parent)
            if is_edited and self._keeps_edits:
                self._keep_edited()
            replace_file(self.path, content, keep=True, sync=True)
        except OSError as error:
            fault = error.strerror or str(error)
            if fault != self._fault:
                logger.warning("%s cannot be written: %s.", self.path, fault)
            self._fault = fault
        else:
            self._content, self._stamp = content, self._found()
            if self._fault:
                logger.warning("%s is written again.", self.path)
            self._fault = ""

    def _keep_edited(self) -> None:
        """Give a file that another program has written another name, which was free."""
        if not self.path.exists():
            return
        number = 1
        edited = self.path.with_name(f"{self.path.name}{SUFFIX}")
        while edited.exists():
            number += 1
            edited = self.path.with_name(f"{self.path.name}{SUFFIX}{number}")
        edited.write_bytes(self.path.read_bytes())
        logger.warning("Another program has changed %s, which is kept as %s.", self.path, edited)

    def _found(self) -> tuple[int, ...]:
        """Return what changes if another program changes the file; empty if there is none."""
        try:
            found = os.stat(self.path)
        except OSError:
            return ()
        return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns
