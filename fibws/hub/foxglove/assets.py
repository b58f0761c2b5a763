"""The files that one client fetches: meshes and pictures of the robots that are loaded."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path
from typing import NamedTuple, Protocol

from fibws.access.rights import Right
from fibws.errors import FibwsError
from fibws.hub.delivery.clock import Timer, Workers
from fibws.hub.delivery.send_queue import Frame
from fibws.hub.foxglove.client import FoxgloveClient
from fibws.hub.foxglove.messages import FetchAsset, asset_error_frame, asset_frame
from fibws.hub.log.text import INTERNAL_ERROR, shortened
from fibws.hub.memory.byte_room import ByteRoom

LONGEST_URI = 10_000
"""Most characters of a URI, which waits while other files are read."""
MOST_HELD = 2**27
"""Bytes of files that may be on their way to all clients together: a file is one message, which is
held until its client has read it. Others wait for their turn."""


class AssetFiles(Protocol):
    """Finds files by their URIs, and decides which of them a client may have."""

    def named(self, allows: Callable[[Right, str], bool], /) -> Collection[str]:
        """Return the packages whose files may be read.

        Args:
            allows: returns whether the client may use a name.
        """

    def resolve(self, uri: str, named: Collection[str], /) -> Path:
        """Return the file of a URI, in any thread.

        Raises:
            FibwsError: there is no such file, or it is not to be served.
        """


class _Read(NamedTuple):
    """A frame that was made in a thread.

    Attributes:
        frame: None if there was no room for the file.
        held: the room that was taken.
    """

    frame: Frame | None
    held: int


class Assets:
    """One client's requests for files, which are read one by one, and not before it reads.

    Args:
        files: None on a hub without assets.
        readers: read the files.
    """

    def __init__(
        self, client: FoxgloveClient, files: AssetFiles | None, readers: Workers, room: ByteRoom
    ) -> None:
        self._client = client
        self._files = files
        self._readers = readers
        self._room = room
        self._waiting: deque[FetchAsset] = deque()
        self._is_reading = False
        self._frame: Frame | None = None
        """The file that waits for the client to read."""
        self._held = 0
        """The room that was taken for that file, until it is sent."""
        self._timer: Timer | None = None

    def fetch(self, request: FetchAsset) -> None:
        """Send a file, or why there is none."""
        limit = self._client.settings.max_calls
        if self._client.queue.overfull:
            return
        if self._files is None:
            self._refuse(request, "this hub has no assets")
        elif len(request.uri) > LONGEST_URI:
            self._refuse(request, f"the URI is too long (limit {LONGEST_URI} characters)")
        elif len(self._waiting) >= limit:
            self._refuse(request, f"too many files are fetched at once (limit {limit})")
        else:
            self._waiting.append(request)
            self._wake()

    def leave(self) -> None:
        """Forget all requests."""
        self._waiting.clear()
        self._room.forget(self._wake)
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if self._frame is None and self._held and self._client.queue.paused:
            # A file that is half written is held until the connection is closed.
            held, self._held = self._held, 0
            give_back = partial(self._room.give_back, held)
            self._client.clock.call_later(self._client.settings.close_timeout, give_back)
        self._give_back()

    @property
    def _is_busy(self) -> bool:
        """Whether a file is being read, or on its way to the client."""
        return self._is_reading or self._frame is not None or self._held > 0

    def _wake(self) -> None:
        """Read the next file once the client reads."""
        if self._waiting and not self._is_busy:
            self._client.queue.reply_fresh(self._begin)

    def _begin(self) -> bytes:
        """Read the next file in a thread; there is nothing to send yet."""
        if self._files is None or self._is_busy or not self._waiting:
            return b""
        self._is_reading = True
        request, files = self._waiting[0], self._files
        named = files.named(self._client.is_allowed)
        found: list[_Read] = []

        def read() -> None:
            try:
                read = self._read(request.request, files.resolve(request.uri, named))
            except FibwsError as error:
                read = _refusal(request.request, str(error))
            except OSError as error:
                read = _refusal(request.request, f"the hub cannot read it: {error.strerror}")
            except Exception:
                read = _refusal(request.request, INTERNAL_ERROR)
            found.append(read)

        self._readers.run(read, lambda: self._done(found[0]))
        return b""

    def _read(self, request: int, path: Path) -> _Read:
        """Read a file if there is room for it, in any thread."""
        with path.open("rb") as file:
            size = path.stat().st_size
            if size > self._room.size:
                text = f"it is too large: {size} bytes (limit {self._room.size})"
                return _refusal(request, text)
            if not self._room.take(size):
                return _Read(None, 0)
            try:
                return _Read(asset_frame(request, file.read(size)), size)
            except (OSError, MemoryError) as error:
                # Room is returned in the event loop, where others wait for it.
                return _refusal(request, f"the hub cannot read it: {error}")._replace(held=size)

    def _done(self, read: _Read) -> None:
        """Send what was read once the client reads; without room, read again when there is."""
        self._is_reading = False
        if not self._waiting:  # The client has left.
            self._room.give_back(read.held)
        elif read.frame is None:
            self._room.wait(self._wake)
        else:
            self._waiting.popleft()
            self._frame, self._held = read
            self._client.queue.reply_fresh(self._take)

    def _take(self) -> Frame:
        frame, self._frame = self._frame or b"", None
        if self._timer is None:
            # It may fill the socket, which shows at the end of this turn.
            self._timer = self._client.clock.call_later(0, self._follow)
        return frame

    def _follow(self) -> None:
        self._timer = None
        self._client.queue.reply_fresh(self._sent)

    def _sent(self) -> bytes:
        """Read the next file: the client has read this one."""
        self._give_back()
        self._wake()
        return b""

    def _give_back(self) -> None:
        held, self._held = self._held, 0
        self._frame = None
        self._room.give_back(held)

    def _refuse(self, request: FetchAsset, text: str) -> None:
        self._client.queue.reply(asset_error_frame(request.request, text))


def _refusal(request: int, text: str) -> _Read:
    return _Read(asset_error_frame(request, shortened(text)), 0)
