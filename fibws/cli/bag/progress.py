"""The progress line of commands that write bags, which looks like rosbag's."""

from __future__ import annotations

import os
import shutil
import time
from types import TracebackType
from typing import Self

import click

from fibws.bags.summary import size_text
from fibws.cli import output

_INTERVAL = 0.1
"""Seconds between two updates."""


class Progress:
    """Shows in a terminal how much of a bag was written; elsewhere only that all was.

    Args:
        path: the new bag.
        quiet: whether to show nothing.
    """

    def __init__(self, path: str | os.PathLike[str], *, quiet: bool = False) -> None:
        self._path = os.fspath(path)
        self.is_quiet = quiet
        self._is_live = output.has_control_sequences() and not quiet
        self._total = self._done = 0
        self._start = self._shown = time.monotonic()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        error_type: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if error is not None and self._is_live:
            click.echo()  # The error has a line of its own.

    def begin(self, total: int) -> None:
        """Start with a number of bytes to write."""
        self._total = total
        if self._is_live:
            self._show()

    def add(self, size: int) -> None:
        """Count bytes that were written."""
        self._done += size
        if self._is_live and time.monotonic() - self._shown > _INTERVAL:
            self._show()

    def finish(self) -> None:
        """Show that everything is done."""
        if not self.is_quiet:
            self._done = self._total
            self._show()
            click.echo()

    def _show(self) -> None:
        self._shown = time.monotonic()
        elapsed = self._shown - self._start
        width = max(10, shutil.get_terminal_size().columns - 37)
        path = self._path if len(self._path) <= width else f"...{self._path[3 - width :]}"
        path = output.visible(path, keep="").ljust(width)
        total = size_text(self._total)
        if self._done >= self._total:
            text = f"{path} 100% {total:>19} {_clock(elapsed)}    "
        else:
            left = elapsed * (self._total / self._done - 1) if self._done else float("inf")
            percent = 100 * self._done // self._total
            text = f"{path} {percent:3}% {size_text(self._done):>8} / {total:>8} {_clock(left)} ETA"
        click.echo(f"\r {text}", nl=False)


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60:02}:{int(seconds) % 60:02}" if seconds < 6000 else "--:--"
