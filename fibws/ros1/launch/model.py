"""The content of launch files: nodes, parameters, arguments; and its listings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from fibws import names

CORE_PARAMETERS = {"/rosdistro": "noetic\n", "/rosversion": "1.16.0\n"}
"""The parameters that every launch sets, as roslaunch does by its roscore.xml; the hub's own."""
LONGEST_VALUE = 20
"""Characters of a parameter's value in the summary."""


@dataclass(frozen=True)
class LaunchNode:
    """A <node>, or a <test>.

    Attributes:
        package: the package with its program, ``type``.
        namespace: a global name, ``/`` or ``/robot``.
        args: the program's arguments, written as in a shell.
        screen: whether its output is shown, and not only logged.
        respawn_delay: seconds from its end to its next start if it has ``respawn``.
        required: whether its end ends the launch.
        cwd: ``node`` for the folder of its program, else it runs in $ROS_HOME.
        prefix: a command to run its program with, ``gdb -ex run --args``.
        remaps: its remappings, from and to.
        environment: additional environment variables.
        is_test: whether it is a <test>, which only rostest runs.
        test_name: the ``test-name`` of a <test>.
        time_limit: seconds that a <test> may take.
        retry: how often a failed <test> is run again.
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
    test_name: str = ""
    time_limit: float = 60.0
    retry: int = 0

    @property
    def resolved(self) -> str:
        """Its global name in the graph."""
        return names.join(self.namespace, self.name)


@dataclass(frozen=True)
class RosparamStep:
    """A <rosparam> command to run before parameters are set: ``dump`` or ``delete``.

    Attributes:
        name: the namespace, or the parameter.
        file: the file of a dump.
    """

    command: str
    name: str
    file: str = ""


@dataclass(frozen=True)
class Argument:
    """An <arg> of a file; the command line may set it unless it has a fixed value."""

    name: str
    default: str | None = None
    doc: str = ""
    has_value: bool = False


@dataclass
class Launch:
    """The content of all files.

    Attributes:
        nodes: nodes by their global names, in their order of start.
        parameters: values by their global names; bytes are from a binfile.
        namespaces: the namespaces of parameters, each with one parameter in it.
        cleared: the namespaces whose parameters are deleted first.
        arguments: the arguments of the named files, without those of included files.
        files: all files, in the order of reading.
        warnings: likely mistakes, one line each.
    """

    nodes: dict[str, LaunchNode] = field(default_factory=dict)
    parameters: dict[str, Any] = field(default_factory=dict)
    namespaces: dict[str, str] = field(default_factory=dict)
    cleared: list[str] = field(default_factory=list)
    steps: list[RosparamStep] = field(default_factory=list)
    arguments: dict[str, Argument] = field(default_factory=dict)
    files: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def summary(launch: Launch) -> Iterator[str]:
    """Yield the lines of the summary: parameters, and nodes by namespace."""
    yield from ("", "SUMMARY", "========")
    if launch.cleared:
        yield from ("", "CLEAR PARAMETERS")
        yield from sorted(f" * {name.rstrip('/')}/" for name in launch.cleared)
    yield from ("", "PARAMETERS")
    yield from sorted(f" * {name}: {_short(each)}" for name, each in launch.parameters.items())
    yield from ("", "NODES")
    nodes = [node for node in launch.nodes.values() if not node.is_test]
    for namespace in sorted({node.namespace for node in nodes}):
        yield f"  {namespace.rstrip('/')}/"
        yield from sorted(
            f"    {node.name} ({node.package}/{node.type})"
            for node in nodes
            if node.namespace == namespace
        )
    yield ""


def argument_lines(arguments: Iterable[Argument]) -> Iterator[str]:
    """Yield the lines of the arguments that the command line may set."""
    allowed = sorted((each for each in arguments if not each.has_value), key=lambda arg: arg.name)
    if not allowed:
        yield "No arguments."
    required = [each for each in allowed if not each.default]
    if required:
        yield "Required Arguments:"
        yield from (f"  {each.name}: {each.doc or 'undocumented'}" for each in required)
    if len(required) < len(allowed):
        yield "Optional Arguments:"
        for each in allowed:
            if each.default:
                yield f'  {each.name} (default "{each.default}"): {each.doc or "undocumented"}'


def _short(value: Any) -> str:
    text = str(value)
    if len(text) > LONGEST_VALUE:
        text = f"{text[: LONGEST_VALUE - 3]}..."
    text = text.rstrip()
    return text if text.isprintable() else "<...>"
