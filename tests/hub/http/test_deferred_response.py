"""A file that is sent is closed whenever its response ends, whatever becomes of work in threads."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import TypeAlias

import pytest
from websockets.datastructures import Headers

from fibws.hub.http.requests import DeferredResponse, FileResponse

Work: TypeAlias = Callable[[], object]


class Threads:
    """Keeps the work until a test does it, or forgets it, as the hub does when it ends."""

    def __init__(self) -> None:
        self.work: list[tuple[Work, Work]] = []

    def run(self, work: Work, done: Work) -> None:
        self.work.append((work, done))

    def perform(self, *, is_loop_open: bool = True) -> None:
        work, done = self.work.pop(0)
        work()
        if is_loop_open:
            done()


class File(io.BytesIO):
    """A file that does something of a test while it is read."""

    def __init__(self) -> None:
        super().__init__(bytes(100))
        self.on_read: Work = lambda: None

    def read(self, size: int | None = -1) -> bytes:
        self.on_read()
        return super().read(size)


class Download:
    def __init__(self) -> None:
        self.file, self.threads = File(), Threads()
        self.taken: list[bytes] = []
        self.on_made: Work = lambda: None
        self.response = DeferredResponse(self._make, self.threads.run)

    def _make(self) -> FileResponse:
        made = FileResponse(Headers(), self.file, 100)
        self.on_made()
        return made

    def begin(self) -> None:
        """Make the response, and let its first piece wait for a thread."""
        self.response.start(lambda made: None)
        self.threads.perform()
        assert self.response.read_on(self.taken.append)


@pytest.fixture
def download() -> Download:
    return Download()


def test_piece_is_taken_and_the_end_closes_the_file(download: Download) -> None:
    download.begin()
    download.threads.perform()
    assert download.taken == [bytes(100)]
    download.response.end()
    assert download.file.closed


def test_end_before_a_piece_is_read_closes_the_file(download: Download) -> None:
    download.begin()
    download.response.end()
    assert download.file.closed
    download.threads.perform()
    assert download.taken == []


@pytest.mark.parametrize("is_loop_open", [True, False])
def test_end_while_a_piece_is_read_closes_the_file_after_it(
    download: Download, is_loop_open: bool
) -> None:
    download.begin()

    def end() -> None:
        download.response.end()
        assert not download.file.closed

    download.file.on_read = end
    download.threads.perform(is_loop_open=is_loop_open)
    assert download.file.closed
    assert download.taken == []


@pytest.mark.parametrize("is_loop_open", [True, False])
def test_end_while_the_response_is_made_closes_the_file(
    download: Download, is_loop_open: bool
) -> None:
    download.response.start(lambda made: None)
    download.on_made = download.response.end
    download.threads.perform(is_loop_open=is_loop_open)
    assert download.file.closed


def test_end_before_the_response_is_made_opens_no_file(download: Download) -> None:
    download.response.start(lambda made: None)
    download.response.end()
    download.on_made = lambda: pytest.fail("it is made")
    download.threads.perform()
