"""What launch files see of this machine."""

from __future__ import annotations

import os
import shlex
import socket
import subprocess
import time
from collections.abc import Mapping
from functools import cached_property
from ipaddress import IPv4Address, ip_address
from pathlib import Path
from typing import Any

from fibws.ros1.launch.value import Yaml
from fibws.ros1.workspace.packages import SHARE, Packages

MOST_BYTES = 2**26
"""Of a file: no launch file has as many, and a device may have no end."""

_EVERYBODY = IPv4Address("255.255.255.255")


class Surroundings:
    """This machine's files, packages and environment, a `World`.

    Args:
        packages: those that are known.
        yaml: what reads YAML.
    """

    def __init__(self, packages: Packages, yaml: Yaml) -> None:
        self._packages = packages
        self._yaml = yaml
        self.environment: Mapping[str, str] = os.environ
        self.shared: list[str] = []
        """The packages of `SHARE` that were asked for."""
        self._made = 0

    def find(self, package: str) -> Path:
        """The folder of a package; it raises `PackageNotFound` if there is none."""
        folder = self._packages.find(package).folder
        if folder.parent == SHARE and package not in self.shared:
            self.shared.append(package)
        return folder

    def read(self, file: str) -> bytes:
        """What is in a file; it raises `OSError` if it cannot be read."""
        with open(file, "rb") as stream:
            content = stream.read(MOST_BYTES + 1)
        if len(content) > MOST_BYTES:
            raise OSError(f"it has more than {MOST_BYTES} bytes")
        return content

    def output(self, command: str) -> str:
        """What a command prints; it raises `ValueError` if it is not there, or fails."""
        words = split(command)
        if not words:
            raise ValueError("there is no command")
        try:
            done = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        except OSError as error:
            raise ValueError(f"cannot run {words[0]}: {error.strerror or error}") from None
        if done.returncode:
            raise ValueError(f"{command}: it has failed with exit code {done.returncode}")
        return done.stdout.decode()

    def yaml(self, text: str) -> Any:
        """The value of a text in YAML; it raises `ValueError` if it is none."""
        return self._yaml(text)

    def is_here(self, address: str) -> bool:
        """Whether an address, or a host's name, is one of this machine's: one that it can bind."""
        try:
            found = socket.getaddrinfo(address, 0, type=socket.SOCK_STREAM)
        except (OSError, ValueError):  # The latter if it cannot be a name at all.
            return False
        return any(_can_bind(family, where) for family, *_, where in found)

    def anonymous(self, name: str) -> str:
        """A name that no other node has, formed as roslaunch's: ``name_<host>_<pid>_<number>``."""
        self._made += 1  # A clock may be slow to go on.
        made = f"{name}_{self._host}_{os.getpid()}_{time.time_ns()}_{self._made}"
        return "".join(each if each.isalnum() and each.isascii() else "_" for each in made)

    @cached_property
    def _host(self) -> str:
        return socket.gethostname()


def _can_bind(family: int, where: tuple[Any, ...]) -> bool:
    address = ip_address(where[0])
    if address.is_multicast or address == _EVERYBODY:
        return False  # Linux binds these, too, and they are no machine's own.
    try:
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            probe.bind(where)
    except OSError:
        return False
    return True


def split(command: str) -> list[str]:
    """The words of a command, as this system's shells have them.

    Raises:
        ValueError: a quotation mark is not closed.
    """
    if os.name != "nt":
        return shlex.split(command)
    # Else the backslashes of paths would be taken out.
    words = shlex.split(command, posix=False)
    return [word[1:-1] if word[0] == word[-1] and word[0] in "'\"" else word for word in words]
