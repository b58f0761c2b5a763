"""What a process prints, kept in a file."""

from __future__ import annotations

from pathlib import Path
from typing import TextIO


class Log:
    """A file that is there from its first line on."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: TextIO | None = None

    def write(self, line: str) -> None:
        """Add a line; it raises `OSError` if that cannot be done."""
        if self._file is None:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._file = self.path.open("a", encoding="utf-8", buffering=1)
        self._file.write(f"{line}\n")

    def close(self) -> None:
        """Close it; another line would open it again."""
        if self._file is not None:
            self._file.close()
            self._file = None
