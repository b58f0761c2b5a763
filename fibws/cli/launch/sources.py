"""The launch files that a command line names, and the arguments that it gives them."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

import click

from fibws import names
from fibws.cli.launch.parameters import read_yaml
from fibws.cli.run import put_on_paths
from fibws.errors import FibwsError
from fibws.ros1.launch import files
from fibws.ros1.launch.reader import STANDARD_INPUT, Reader
from fibws.ros1.launch.surroundings import Surroundings
from fibws.ros1.workspace.packages import Packages

MARK = ":="
NAMESPACE = "__ns"


class Sources:
    """What the words of a command line name.

    Args:
        words: PACKAGE FILE or FILE, further files, ARG:=VALUE anywhere.
        workspace: one to be looked into besides those that the environment names.

    Attributes:
        packages: those that are known.

    Raises:
        UsageError: no file is named, or an argument has no name.
        WorkspaceError: there is no such file.
    """

    def __init__(self, words: Sequence[str], workspace: Path | None) -> None:
        if workspace is not None:
            put_on_paths(workspace)
        self.packages = Packages.from_environment(workspace)
        given = [word for word in words if MARK not in word]
        if not given:
            raise click.UsageError("Write PACKAGE FILE, or the path of a launch file.")
        if given.count(files.DASH) > 1:
            raise click.UsageError("Only one file can be -, which is what comes in by a pipe.")
        self._values = _values(words)
        self._files = files.named(given, self.packages)
        self._surroundings = Surroundings(self.packages, read_yaml)

    def read(self) -> Reader:
        """Read the files; it raises `LaunchError` or `OSError` if that cannot be done."""
        namespace = self._values.get(NAMESPACE) or os.environ.get("ROS_NAMESPACE") or "/"
        reader = Reader(self._surroundings, self._values, names.check_namespace(namespace))
        for file in self._files:
            reader.read(*_document(file))
        for package in self._surroundings.shared:
            reader.launch.warnings.append(f"{package}: nothing is started for it: the hub is one")
        return reader

    def read_arguments(self) -> Reader:
        """Read what the files have as arguments; raises as `read`."""
        reader = Reader(self._surroundings, self._values)
        for file in self._files:
            reader.read_arguments(*_document(file))
        return reader


def completions(words: Sequence[str], incomplete: str) -> list[str]:
    """What a word may be that begins so: a package, a launch file of it, an argument of that."""
    try:
        if not words:
            packages = Packages.from_environment()
            found = [package.name for package in packages if not package.is_standard]
        elif len(words) == 1 and not Path(words[0]).is_file():
            folder = Packages.from_environment().find(words[0]).folder
            found = [path.name for path in files.launch_files(folder)]
        else:
            known = Sources(words, None).read_arguments().launch.arguments.values()
            found = [f"{each.name}{MARK}" for each in known if not each.has_value]
    except (click.ClickException, FibwsError, OSError):
        return []
    return [each for each in found if each.startswith(incomplete)]


def _values(words: Sequence[str]) -> dict[str, str]:
    """The arguments that words give; private parameters, ``_x:=1``, are a node's alone."""
    values = {}
    for word in words:
        name, mark, value = (part.strip() for part in word.partition(MARK))
        if mark and not name:
            raise click.UsageError(f"{word!r} gives no argument a value: write ARG:=VALUE.")
        if mark and (not name.startswith("_") or name.startswith("__")):
            values[name] = value
    return values


def _document(file: str) -> tuple[str, bytes | None]:
    """A file's name in errors, and what is in it if that comes in by a pipe."""
    if file != files.DASH:
        return file, None
    if sys.stdin is None:
        raise click.UsageError("FILE is -, and nothing comes in by a pipe.")
    return STANDARD_INPUT, sys.stdin.buffer.read()
