"""The files that one client fetches: meshes and pictures of the robots that are loaded."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Protocol

from fibws.access.rights import Right
from fibws.errors import FibwsError
from fibws.hub.delivery.clock import Timer
from fibws.hub.delivery.deferred import Workers
from fibws.hub.foxglove.client import Client
from fibws.hub.foxglove.messages import FetchAsset, asset_error_frame, asset_frame
from fibws.hub.log_text import INTERNAL_ERROR, shortened

LONGEST_URI = 10_000
"""Most characters of a URI, which waits while other files are read."""
MOST_HELD = 2**27
"""Bytes of files that may wait for all clients together until they read."""


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


class AssetRoom:
    """The bytes of files that wait for the clients of one hub."""

    def __init__(self) -> None:
        self.held = 0


class Assets:
    """One client's requests for files, which are read one by one, and not before it reads.

    Args:
        files: None on a hub without assets.
        readers: read the files.
    """

    def __init__(
        self, client: Client, files: AssetFiles | None, readers: Workers, room: AssetRoom
    ) -> None:
        self._client = client
        self._files = files
        self._readers = readers
        self._room = room
        self._waiting: deque[FetchAsset] = deque()
        self._is_reading = False
        self._frame: bytes | None = None
        """The file that waits for the client to read."""
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
        self._forget()
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _wake(self) -> None:
        """Read the next file once the client reads."""
        self._timer = None
        if self._waiting and not self._is_reading and self._frame is None:
            self._client.queue.reply_fresh(self._begin)

    def _begin(self) -> bytes:
        """Read the next file in a thread; there is nothing to send yet."""
        if self._files is None or self._is_reading or not self._waiting:
            return b""
        self._is_reading = True
        request, files = self._waiting[0], self._files
        named = files.named(self._client.is_allowed)
        found: list[bytes] = []

        def read() -> None:
            try:
                frame = asset_frame(request.request, files.resolve(request.uri, named).read_bytes())
            except FibwsError as error:
                frame = asset_error_frame(request.request, shortened(str(error)))
            except OSError as error:
                text = f"the hub cannot read it: {error.strerror}"
                frame = asset_error_frame(request.request, text)
            except Exception:
                frame = asset_error_frame(request.request, INTERNAL_ERROR)
            found.append(frame)

        self._readers.run(read, lambda: self._done(found[0]))
        return b""

    def _done(self, frame: bytes) -> None:
        """Send what was read; a client that reads no more gets it later."""
        self._is_reading = False
        if not self._waiting:
            return  # The client has left.
        if not self._client.queue.paused:
            self._waiting.popleft()
            self._client.queue.reply(frame)
            # It may fill the socket, which shows at the end of this turn.
            self._timer = self._client.clock.call_later(0, self._wake)
        elif self._room.held + len(frame) <= MOST_HELD:
            self._waiting.popleft()
            self._frame = frame
            self._room.held += len(frame)
            self._client.queue.reply_fresh(self._take)
        else:
            self._wake()  # It is read again.

    def _take(self) -> bytes:
        frame = self._frame or b""
        self._forget()
        if self._timer is None:
            self._timer = self._client.clock.call_later(0, self._wake)
        return frame

    def _forget(self) -> None:
        if self._frame is not None:
            self._room.held -= len(self._frame)
            self._frame = None

    def _refuse(self, request: FetchAsset, text: str) -> None:
        self._client.queue.reply(asset_error_frame(request.request, text))
