"""What launch files read of this machine: files, packages, variables, outputs of commands."""

from __future__ import annotations

import os
import shlex
import socket
import subprocess
from collections.abc import Callable, Mapping
from functools import cached_property
from ipaddress import IPv4Address, ip_address
from pathlib import Path
from typing import Any, Protocol, TypeAlias

from fibws import names
from fibws.ros1.shell import ros_programs
from fibws.ros1.workspace.packages import Packages

MOST_BYTES = 2**26
"""Largest file that is read; a device may have no end."""
XACRO = Path(__file__).parent / "xacro"
"""The folder of a program that runs PyPI's xacro; launch files name it as ``$(find xacro)``."""
_BROADCAST = IPv4Address("255.255.255.255")

ReadYaml: TypeAlias = Callable[[str], Any]
"""Returns the value of a YAML text; raises `ValueError` if it is invalid."""


class Environment(Protocol):
    """The machine as a launch file sees it.

    Methods raise `OSError`, `ValueError` or a `fibws.errors.FibwsError`; the reader adds the line.
    """

    @property
    def variables(self) -> Mapping[str, str]:
        """The environment variables."""
        ...

    def find(self, package: str) -> Path:
        """Return the folder of a package."""
        ...

    def read(self, file: str) -> bytes:
        """Return the content of a file."""
        ...

    def output(self, command: str) -> str:
        """Return what a command, written as in a shell, prints."""
        ...

    def yaml(self, text: str) -> Any:
        """Return the value of a YAML text."""
        ...

    def is_local(self, address: str) -> bool:
        """Return whether an address or host name is one of this machine's."""
        ...

    def anonymous(self, name: str) -> str:
        """Return a unique name for a node, beginning with ``name``."""
        ...


class LocalEnvironment:
    """This machine as an `Environment`.

    Args:
        packages: the known packages.
        read_yaml: the reader of YAML.
    """

    def __init__(self, packages: Packages, read_yaml: ReadYaml) -> None:
        self.variables: Mapping[str, str] = os.environ
        self._packages = packages
        self._read_yaml = read_yaml

    def find(self, package: str) -> Path:
        """Return the folder of a package, or raise `PackageNotFound`."""
        if package == XACRO.name and not self._packages.has(package):
            return XACRO
        return self._packages.find(package).folder

    def read(self, file: str) -> bytes:
        """Return the content of a file, or raise `OSError`."""
        with open(file, "rb") as stream:
            content = stream.read(MOST_BYTES + 1)
        if len(content) > MOST_BYTES:
            raise OSError(f"file too large (limit is {MOST_BYTES} bytes)")
        return content

    def output(self, command: str) -> str:
        """Return what a command prints; raise `ValueError` if it is not found or fails."""
        words = self._substituted(split(command))
        if not words:
            raise ValueError("the command is empty")
        try:
            done = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        except OSError as error:
            raise ValueError(f"cannot run {words[0]}: {error.strerror or error}") from None
        if done.returncode:
            raise ValueError(f"{command}: failed with exit code {done.returncode}")
        return done.stdout.decode()

    def _substituted(self, words: list[str]) -> list[str]:
        """Return the command that runs PyPI's xacro if it is meant, and not one in a workspace."""
        program = Path(words[0]) if words else Path()
        is_bare = words[:1] in (["xacro"], ["xacro.py"]) and not self._packages.has_own(XACRO.name)
        if not is_bare and program.parent != XACRO:
            return words
        return ros_programs.command_line(XACRO.name, program.name, words[1:]) or words

    def yaml(self, text: str) -> Any:
        """Return the value of a YAML text, or raise `ValueError`."""
        return self._read_yaml(text)

    def is_local(self, address: str) -> bool:
        """Return whether this machine can bind an address, or one of a host name's addresses."""
        try:
            found = socket.getaddrinfo(address, 0, type=socket.SOCK_STREAM)
        except (OSError, ValueError):  # The latter for an impossible name.
            return False
        return any(_can_bind(family, where) for family, *_, where in found)

    def anonymous(self, name: str) -> str:
        """Return a unique name in roslaunch's form; see `names.anonymous_on_host`."""
        return names.anonymous_on_host(name, host=self._host, pid=os.getpid(), random=os.urandom(8))

    @cached_property
    def _host(self) -> str:
        return socket.gethostname()


def _can_bind(family: int, where: tuple[Any, ...]) -> bool:
    address = ip_address(where[0])
    if address.is_multicast or address == _BROADCAST:
        return False  # Linux binds these, too, but they are not a machine's own.
    try:
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            probe.bind(where)
    except OSError:
        return False
    return True


def split(command: str) -> list[str]:
    """Split a command into words, as a shell of this system does.

    Raises:
        ValueError: a quotation mark is not closed.
    """
    if os.name != "nt":
        return shlex.split(command)
    # posix=True would remove the backslashes of paths.
    words = shlex.split(command, posix=False)
    return [word[1:-1] if word[0] == word[-1] and word[0] in "'\"" else word for word in words]
