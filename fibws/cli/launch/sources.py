"""The launch files and arguments of a command line."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

import click

from fibws import names
from fibws.cli.run import put_on_paths
from fibws.errors import FibwsError
from fibws.ros1.launch import launch_files
from fibws.ros1.launch.environment import LocalEnvironment
from fibws.ros1.launch.reader import STANDARD_INPUT, LaunchReader
from fibws.ros1.workspace.packages import Packages
from fibws.values import parameter_files

MARK = ":="
NAMESPACE = "__ns"


class Sources:
    """The launch files and arguments of a command line.

    Args:
        words: PACKAGE FILE or FILE, further files, and ARG:=VALUE anywhere.
        workspace: a workspace to search besides those in the environment variables.

    Attributes:
        packages: the known packages.
        files: the paths of the files; - for standard input.

    Raises:
        UsageError: no file is named, or an argument has no name.
        WorkspaceError: a file is not found.
    """

    def __init__(self, words: Sequence[str], workspace: Path | None) -> None:
        if workspace is not None:
            put_on_paths(workspace)
        self.packages = Packages.from_environment(workspace)
        files = [word for word in words if MARK not in word]
        if not files:
            raise click.UsageError("Missing arguments: PACKAGE FILE, or the path of a launch file.")
        if files.count(launch_files.STANDARD_INPUT) > 1:
            raise click.UsageError("FILE can be - (standard input) only once.")
        self._values = _values(words)
        for word in files:
            name, equals, value = word.partition("=")
            if equals and name.isidentifier() and not Path(word).exists():
                raise click.UsageError(f"{word} is not a file; did you mean {name}:={value}?")
        self.files = launch_files.find_launch_files(files, self.packages)
        self._environment = LocalEnvironment(self.packages, parameter_files.parse)

    def read(self) -> LaunchReader:
        """Read the files, or raise `LaunchError` or `OSError`."""
        namespace = self._values.get(NAMESPACE) or os.environ.get("ROS_NAMESPACE") or "/"
        reader = LaunchReader(self._environment, self._values, names.check_namespace(namespace))
        for file in self.files:
            reader.read(*_document(file))
        return reader

    def read_arguments(self) -> LaunchReader:
        """Read only the arguments of the files; raises as `read`."""
        reader = LaunchReader(self._environment, self._values)
        for file in self.files:
            reader.read_arguments(*_document(file))
        return reader


def completions(words: Sequence[str], incomplete: str, suffix: str = ".launch") -> list[str]:
    """Return the packages, the launch files of a package, or their arguments, for completion.

    Args:
        words: the words before the incomplete one.
        incomplete: the beginning of a word.
        suffix: the suffix of launch files.
    """
    try:
        if not words:
            packages = Packages.from_environment()
            found = [package.name for package in packages if not package.is_standard]
        elif len(words) == 1 and not Path(words[0]).is_file():
            folder = Packages.from_environment().find(words[0]).folder
            found = [path.name for path in launch_files.launch_files_in(folder, suffix)]
        else:
            known = Sources(words, None).read_arguments().launch.arguments.values()
            found = [f"{each.name}{MARK}" for each in known if not each.has_value]
    except (click.ClickException, FibwsError, OSError):
        return []
    return [each for each in found if each.startswith(incomplete)]


def _values(words: Sequence[str]) -> dict[str, str]:
    """Return the arguments in a command line; private parameters, ``_x:=1``, are only for nodes."""
    values = {}
    for word in words:
        name, mark, value = (part.strip() for part in word.partition(MARK))
        if mark and not name:
            raise click.UsageError(f"Missing name in {word!r}; expected ARG:=VALUE.")
        if mark and (not name.startswith("_") or name.startswith("__")):
            values[name] = value
    return values


def _document(file: str) -> tuple[str, bytes | None]:
    """Return a file's name for errors, and the content of standard input."""
    if file != launch_files.STANDARD_INPUT:
        return file, None
    if sys.stdin is None:
        raise click.UsageError("FILE is -, but standard input is closed.")
    return STANDARD_INPUT, sys.stdin.buffer.read()
