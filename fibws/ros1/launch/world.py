"""What a launch file asks of its surroundings, given to the reader from outside."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol


class World(Protocol):
    """Files, packages, commands, the environment.

    Whatever is not there raises `OSError`, `ValueError` or a `fibws.errors.FibwsError`; the reader
    tells in which line that was asked for.
    """

    @property
    def environment(self) -> Mapping[str, str]:
        """The variables of the environment."""
        ...

    def find(self, package: str) -> Path:
        """The folder of a package."""
        ...

    def read(self, file: str) -> bytes:
        """What is in a file."""
        ...

    def output(self, command: str) -> str:
        """What a command prints, which was written as for a shell."""
        ...

    def yaml(self, text: str) -> Any:
        """The value that a text in YAML stands for."""
        ...

    def is_here(self, address: str) -> bool:
        """Whether an address, or a host's name, is one of this machine's."""
        ...

    def anonymous(self, name: str) -> str:
        """A name for a node that no other node has, beginning with ``name``."""
        ...
