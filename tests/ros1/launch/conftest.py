"""Launch files that are read from texts, in surroundings that are made up."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import pytest
import yaml

from fibws.errors import PackageNotFound
from fibws.ros1.launch.model import Launch
from fibws.ros1.launch.reader import Reader

MAIN = "main.launch"


class MadeUp:
    """A `World` in memory."""

    def __init__(self) -> None:
        self.environment: Mapping[str, str] = {"HOME": "/home/me", "EMPTY": ""}
        self.files: dict[str, bytes] = {}
        self.commands: dict[str, str] = {}
        self.here: tuple[str, ...] = ("localhost",)

    def find(self, package: str) -> Path:
        if package != "robot":
            raise PackageNotFound(package, "did you mean robot?")
        return Path("/ws/src/robot")

    def read(self, file: str) -> bytes:
        if file not in self.files:
            raise FileNotFoundError(2, "No such file or directory", file)
        return self.files[file]

    def output(self, command: str) -> str:
        if command not in self.commands:
            raise ValueError(f"cannot run {command}")
        return self.commands[command]

    def yaml(self, text: str) -> Any:
        try:
            return yaml.safe_load(text)
        except yaml.YAMLError as error:
            raise ValueError(str(error).partition("\n")[0]) from None

    def is_here(self, address: str) -> bool:
        return address in self.here

    def anonymous(self, name: str) -> str:
        return f"{name}_host_1"


Read: TypeAlias = Callable[..., Launch]


@pytest.fixture
def world() -> MadeUp:
    return MadeUp()


@pytest.fixture
def read(world: MadeUp) -> Read:
    """Read what stands in a <launch>, with values for its arguments."""

    def read(text: str, **values: str) -> Launch:
        reader = Reader(world, values)
        reader.read(MAIN, f"<launch>\n{text}\n</launch>".encode())
        return reader.launch

    return read
