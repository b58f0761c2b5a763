"""What launch files say is to be run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from fibws import names


@dataclass(frozen=True)
class Node:
    """One <node>.

    Attributes:
        package: the package that has its program, ``type``.
        namespace: a global name, ``/`` or ``/robot``.
        args: what its program is called with, written as for a shell.
        screen: whether what it prints is shown, and not only kept in a file.
        respawn_delay: seconds between its end and its next start, if it is to ``respawn``.
        required: whether all ends when it ends.
        cwd: ``node`` for the folder of its program; else it runs in $ROS_HOME.
        prefix: a command that starts its program, ``gdb -ex run --args``.
        remaps: the names that it finds changed, from and to.
        environment: variables that it is given besides those that there are.
        is_test: whether it is a <test>, which roslaunch does not run.
    """

    package: str
    type: str
    name: str
    file: str
    line: int
    namespace: str = "/"
    args: str = ""
    screen: bool = False
    respawn: bool = False
    respawn_delay: float = 0.0
    required: bool = False
    cwd: str | None = None
    prefix: str = ""
    remaps: tuple[tuple[str, str], ...] = ()
    environment: tuple[tuple[str, str], ...] = ()
    is_test: bool = False

    @property
    def resolved(self) -> str:
        """The global name that it has in the graph."""
        return names.join(self.namespace, self.name)


@dataclass(frozen=True)
class Step:
    """A <rosparam> that is done before parameters are set: ``dump`` or ``delete``.

    Attributes:
        name: the namespace, or the parameter.
        file: where it is written to, for a dump.
    """

    command: str
    name: str
    file: str = ""


@dataclass(frozen=True)
class Argument:
    """An <arg> at the top of a file: it may be given on the command line, unless it has a value."""

    name: str
    default: str | None = None
    doc: str = ""
    has_value: bool = False


@dataclass
class Launch:
    """What all files together say.

    Attributes:
        nodes: by their global names, in the order in which they start.
        parameters: values by their global names; bytes are those of a binfile.
        namespaces: those that they are in, each with one that is in it.
        cleared: the namespaces whose parameters are deleted first.
        arguments: those of the files that were named, not of the ones they include.
        files: all that were read, in that order.
        warnings: what is probably not meant so, one line each.
    """

    nodes: dict[str, Node] = field(default_factory=dict)
    parameters: dict[str, Any] = field(default_factory=dict)
    namespaces: dict[str, str] = field(default_factory=dict)
    cleared: list[str] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    arguments: dict[str, Argument] = field(default_factory=dict)
    files: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
