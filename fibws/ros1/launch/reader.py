"""Launch files, read in the order of their tags: each holds for what follows it."""

from __future__ import annotations

import os.path
from collections.abc import Callable, Mapping

from fibws.errors import LaunchError
from fibws.ros1.launch.attributes import Attributes, applies
from fibws.ros1.launch.model import Argument, Launch
from fibws.ros1.launch.node import namespace_of, read_env, read_node, read_remap
from fibws.ros1.launch.parameter import read_param, read_rosparam
from fibws.ros1.launch.scope import Scope
from fibws.ros1.launch.tag import Tag, read
from fibws.ros1.launch.world import World
from fibws.suggestions import suggestion_or_known

MACHINE = ("name", "address", "env-loader", "ssh-port", "user", "password", "default", "timeout")
STANDARD_INPUT = "<stdin>"
MOST_INCLUDES = 30
"""Files that include each other."""
MOST_FILES = 1000
"""In all: two files that each include two others again and again would never be read."""


class Reader:
    """Reads launch files into one `Launch`.

    Args:
        world: where files, packages and variables are.
        values: arguments of the command line, which each file is given.
        namespace: the one in which all is, a global name.
    """

    def __init__(
        self, world: World, values: Mapping[str, str] | None = None, namespace: str = "/"
    ) -> None:
        self.launch = Launch()
        self._world = world
        self._values = dict(values or {})
        self._namespace = namespace
        self._machines: dict[str, str] = {}
        self._default_machine = ""
        self._including: list[tuple[str, int]] = []
        self._tags: dict[str, Callable[[Tag, Scope], None]] = {
            "arg": self._declare,
            "env": lambda tag, scope: read_env(tag, scope, scope),
            "group": self._group,
            "include": self._include,
            "machine": self._machine,
            "node": self._node,
            "param": lambda tag, scope: read_param(tag, scope, self.launch),
            "remap": lambda tag, scope: read_remap(tag, scope, scope),
            "rosparam": lambda tag, scope: read_rosparam(tag, scope, self.launch),
            "test": self._node,
        }

    def read(self, file: str, document: bytes | None = None) -> None:
        """Read a file, and those that it includes.

        Args:
            file: its path.
            document: what is in it, if that is known.

        Raises:
            LaunchError: it says what cannot be.
            OSError: it cannot be read.
        """
        root = self._root(file, self._world.read(file) if document is None else document)
        scope = Scope(self._world, file, self._namespace, dict(self._values))
        for tag in root.children:
            if tag.name == "arg" and applies_or_none(tag, scope):
                self._note_argument(tag, scope)
            self._read(tag, scope)

    def read_arguments(self, file: str, document: bytes | None = None) -> None:
        """Read no more than the <arg> tags of a file, into ``launch.arguments``; raises as `read`.

        One whose value needs others that were not given is known by what is written.
        """
        root = self._root(file, self._world.read(file) if document is None else document)
        scope = Scope(self._world, file, self._namespace, dict(self._values))
        for tag in root.children:
            if tag.name != "arg":
                continue
            if applies_or_none(tag, scope):
                self._note_argument(tag, scope)
                try:
                    self._declare(tag, scope)
                except LaunchError:
                    continue

    def unknown_values(self) -> list[str]:
        """A line for each argument of the command line that no file has an <arg> for."""
        known = list(self.launch.arguments)
        return [
            f"{name}:={value}: no <arg> is called {name}{suggestion_or_known(name, known)}"
            for name, value in self._values.items()
            if name not in known and not name.startswith("__")
        ]

    def _root(self, file: str, document: bytes) -> Tag:
        self.launch.files.append(file)
        root = read(document, file)
        if root.name != "launch":
            raise root.fault(f"a launch file is one <launch>, not a <{root.name}>")
        for name, text in root.attributes.items():
            if name != "deprecated":
                raise root.fault(f"<launch> has no attribute {name}; known are deprecated")
            self.launch.warnings.append(f"{file}: deprecated: {text}")
        return root

    def _read(self, tag: Tag, scope: Scope) -> None:
        if tag.name == "master":
            self._warn(tag, "<master> has no meaning any more, and is read past")
        elif tag.name not in self._tags:
            near = suggestion_or_known(tag.name, self._tags)
            raise tag.fault(f"there is no tag <{tag.name}>{near}")
        elif applies(tag, scope):
            self._tags[tag.name](tag, scope)

    def _note_argument(self, tag: Tag, scope: Scope) -> None:
        name = tag.attributes.get("name", "")
        default = tag.attributes.get("default")
        try:
            if default is not None:
                default = Attributes(tag, scope, None).text("default")
        except LaunchError:
            pass
        self.launch.arguments.setdefault(
            name, Argument(name, default, tag.attributes.get("doc", ""), "value" in tag.attributes)
        )

    def _declare(self, tag: Tag, scope: Scope) -> None:
        """Read an <arg> of a file."""
        name, value, default = _argument(tag, scope, scope)
        if value is not None:
            if name in scope.values and not scope.passes_all:
                raise tag.fault(
                    f"<arg>: {name} has the value {value!r} and was given {scope.values[name]!r}: "
                    f"only one with a default, default={value!r}, may be given"
                )
            scope.values[name] = value
        elif default is not None:
            scope.values.setdefault(name, default)

    def _pass(self, tag: Tag, scope: Scope, included: Scope) -> None:
        """Read an <arg> of an <include>."""
        name, value, default = _argument(tag, scope, included)
        if value is not None:
            included.values[name] = value
        elif default is not None:
            included.values.setdefault(name, default)
        elif name not in included.values:
            raise tag.fault(f"<arg>: {name} has no value to pass on")

    def _group(self, tag: Tag, scope: Scope) -> None:
        attributes = Attributes(tag, scope, ("ns", "clear_params"))
        inner = scope.inner(namespace_of(tag, attributes))
        self._clear(tag, attributes, inner)
        for child in tag.children:
            self._read(child, inner)

    def _clear(self, tag: Tag, attributes: Attributes, inner: Scope) -> None:
        if attributes.flag("clear_params", False):
            if "ns" not in tag.attributes:
                raise tag.fault(f"<{tag.name} clear_params> needs an ns, which is what it clears")
            self.launch.cleared.append(inner.namespace)

    def _node(self, tag: Tag, scope: Scope) -> None:
        node = read_node(tag, scope, self.launch)
        other = self.launch.nodes.setdefault(node.resolved, node)
        if other is not node:
            raise tag.fault(
                f"{node.resolved} is the name of the node in {other.file}:{other.line}, too: each "
                "must have its own, or the later one shuts the earlier one down"
            )
        machine = Attributes(tag, scope, None).text("machine") or self._default_machine
        address = self._machines.get(machine)
        if address is not None and not self._world.is_here(address):
            raise tag.fault(
                f"<{tag.name}>: the machine {machine} is {address}, and nodes are "
                "started on this machine alone: start it there, with --hub naming this one's hub"
            )

    def _machine(self, tag: Tag, scope: Scope) -> None:
        attributes = Attributes(tag, scope, MACHINE)
        name = attributes.required("name")
        self._machines[name] = attributes.required("address")
        if attributes.one_of("default", "true", "false", "never") == "true":
            self._default_machine = name

    def _include(self, tag: Tag, scope: Scope) -> None:
        attributes = Attributes(tag, scope, ("file", "ns", "clear_params", "pass_all_args"))
        file = attributes.required("file")
        passes_all = attributes.flag("pass_all_args", False)
        inner = scope.included(file, namespace_of(tag, attributes), passes_all=passes_all)
        self._clear(tag, attributes, inner)
        given = scope.inner()
        for child in tag.children:
            if child.name not in ("arg", "env"):
                hint = suggestion_or_known(child.name, ["arg", "env"])
                raise child.fault(f"<include> has no <{child.name}> in it{hint}")
            if applies(child, given):
                if child.name == "env":
                    read_env(child, given, inner)
                else:
                    self._pass(child, given, inner)
        passed = set() if passes_all else set(inner.values)
        inner.declared = set()
        self._included(tag, file, inner)
        unused = sorted(passed - inner.declared)
        if unused:
            raise tag.fault(
                f"<include>: {file} has no <arg> that is called {' or '.join(unused)}"
                f"{_meant(unused[0], sorted(inner.declared))}"
            )

    def _included(self, tag: Tag, file: str, scope: Scope) -> None:
        if len(self._including) >= MOST_INCLUDES:
            raise tag.fault(f"<include>: more than {MOST_INCLUDES} files include each other")
        if len(self.launch.files) >= MOST_FILES:
            raise tag.fault(f"<include>: more than {MOST_FILES} files are included")
        try:
            document = self._world.read(file)
        except OSError as error:
            beside = "" if os.path.isabs(file) else f"; one beside this file is $(dirname)/{file}"
            why = error.strerror or error
            raise tag.fault(f"<include>: cannot read {file}: {why}{beside}") from None
        self._including.append((tag.file, tag.line))
        try:
            for each in self._root(file, document).children:
                self._read(each, scope)
        except LaunchError as error:
            if error.files or (error.file, error.line) == (tag.file, tag.line):
                raise
            # Files that include each other are told of once.
            files = tuple(dict.fromkeys(reversed(self._including)))
            raise LaunchError(error.file, error.line, error.fault, files) from None
        finally:
            self._including.pop()

    def _warn(self, tag: Tag, text: str) -> None:
        self.launch.warnings.append(f"{tag.file}:{tag.line}: {text}")


def applies_or_none(tag: Tag, scope: Scope) -> bool:
    """Whether a tag is to be read, as far as that can be told without an error."""
    try:
        return applies(tag, scope)
    except LaunchError:
        return False


def _argument(tag: Tag, scope: Scope, into: Scope) -> tuple[str, str | None, str | None]:
    """The name, value and default of an <arg> in ``scope``, which is declared ``into`` another."""
    attributes = Attributes(tag, scope, ("name", "value", "default", "doc"))
    name = attributes.required("name")
    value, default = attributes.text("value"), attributes.text("default")
    attributes.text("doc")
    if value is not None and default is not None:
        raise tag.fault("<arg> has both value and default: one of them is enough")
    if name in into.declared and not into.passes_all:
        raise tag.fault(f"<arg>: {name} has been declared already")
    into.declared.add(name)
    return name, value, default


def _meant(name: str, known: list[str]) -> str:
    return suggestion_or_known(name, known) or "; it has none"
