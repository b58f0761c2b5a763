"""Launch files read from texts in a fake environment."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import pytest
import yaml

from fibws.ros1.errors import PackageNotFound
from fibws.ros1.launch.model import Launch
from fibws.ros1.launch.reader import LaunchReader

MAIN = "main.launch"


class FakeEnvironment:
    """An `Environment` in memory."""

    def __init__(self) -> None:
        self.variables: Mapping[str, str] = {"HOME": "/home/me", "EMPTY": ""}
        self.files: dict[str, bytes] = {}
        self.commands: dict[str, str] = {}
        self.local: tuple[str, ...] = ("localhost",)

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

    def is_local(self, address: str) -> bool:
        return address in self.local

    def anonymous(self, name: str) -> str:
        return f"{name}_host_1"


Read: TypeAlias = Callable[..., Launch]


@pytest.fixture
def environment() -> FakeEnvironment:
    return FakeEnvironment()


@pytest.fixture
def read(environment: FakeEnvironment) -> Read:
    """Read the content of a <launch>, with values for its arguments."""

    def read(text: str, **values: str) -> Launch:
        reader = LaunchReader(environment, values)
        reader.read(MAIN, f"<launch>\n{text}\n</launch>".encode())
        return reader.launch

    return read
