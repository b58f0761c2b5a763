"""The reader of launch files: <node>, <group>, <include> and the others, in order.

Each tag affects the tags that follow it. As in roslaunch, unknown tags and attributes are ignored
with a warning.
"""

from __future__ import annotations

import os.path
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from fibws import names
from fibws.errors import InvalidName
from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.environment import Environment
from fibws.ros1.launch.model import Argument, Launch, LaunchNode
from fibws.ros1.launch.parameters import read_param, read_rosparam, set_parameter
from fibws.ros1.launch.scope import Scope, normalized
from fibws.ros1.launch.xml_element import Attributes, LaunchElement, applies, parse
from fibws.suggestions import suggestion, suggestion_or_known

_NODE = (
    *("pkg", "type", "name", "args", "output", "respawn", "respawn_delay", "required", "ns"),
    *("cwd", "clear_params", "launch-prefix", "machine"),
)
_MACHINE = ("name", "address", "env-loader", "ssh-port", "user", "password", "default", "timeout")
_OLD_MACHINE = ("ros-root", "ros-package-path", "ros-ip", "ros-hostname")
"""The attributes of <machine> that were replaced by env-loader."""
ATTRIBUTES = {
    "launch": ("deprecated",),
    "arg": ("name", "value", "default", "doc"),
    "env": ("name", "value"),
    "group": ("ns", "clear_params"),
    "include": ("file", "ns", "clear_params", "pass_all_args"),
    "machine": _MACHINE,
    "node": _NODE,
    "param": ("name", "value", "type", "textfile", "binfile", "command"),
    "remap": ("from", "to"),
    "rosparam": ("command", "ns", "file", "param", "subst_value"),
    "test": (*_NODE, "test-name", "time-limit", "retry"),
}
"""The attributes of each tag, besides if and unless."""
NOT_OF_TESTS = ("respawn", "respawn_delay", "output")
IN_NODE = ("param", "rosparam", "remap", "env")
IN_INCLUDE = ("arg", "env")
STANDARD_INPUT = "<stdin>"
MOST_INCLUDES = 30
"""Deepest nesting of included files."""
MOST_FILES = 1000
"""Most files; without a limit, files that include two others each are read for ever."""


class LaunchReader:
    """Reads launch files into one `Launch`.

    Args:
        environment: this machine.
        values: arguments of the command line, which each file gets.
        namespace: the namespace around everything, a global name.
    """

    def __init__(
        self,
        environment: Environment,
        values: Mapping[str, str] | None = None,
        namespace: str = "/",
    ) -> None:
        self.launch = Launch()
        self._environment = environment
        self._values = dict(values or {})
        self._namespace = namespace
        self._machines: dict[str, dict[str, str | None]] = {}
        self._default_machine = ""
        self._on_machines: list[tuple[LaunchElement, str]] = []
        self._including: list[tuple[str, int]] = []
        self._tags: dict[str, Callable[[LaunchElement, Scope], None]] = {
            "arg": self._declare,
            "env": lambda element, scope: _read_env(element, scope, scope),
            "group": self._group,
            "include": self._include,
            "machine": self._machine,
            "node": self._node,
            "param": lambda element, scope: read_param(element, scope, self.launch),
            "remap": lambda element, scope: _read_remap(element, scope, scope),
            "rosparam": lambda element, scope: read_rosparam(element, scope, self.launch),
            "test": self._node,
        }

    def read(self, file: str, document: bytes | None = None) -> None:
        """Read a file and the files that it includes.

        Args:
            file: its path.
            document: its content if that is known.

        Raises:
            LaunchError: a file is invalid.
            OSError: the file cannot be read.
        """
        root, scope = self._root(file, document)
        for element in root.children:
            if element.name == "arg" and _may_apply(element, scope):
                self._add_argument(element, scope)
            self._read(element, scope)
        for element, machine in self._on_machines:
            self._check_machine(element, machine)

    def read_arguments(self, file: str, document: bytes | None = None) -> None:
        """Read only the <arg> tags of a file into ``launch.arguments``; raises as `read`.

        A default that needs missing arguments is kept as it is written.
        """
        root, scope = self._root(file, document)
        for element in root.children:
            if element.name == "arg" and _may_apply(element, scope):
                self._add_argument(element, scope)
                try:
                    self._declare(element, scope)
                except LaunchError:
                    continue

    def unknown_values(self) -> list[str]:
        """Return a warning for each argument of the command line without an <arg>."""
        known = list(self.launch.arguments)
        return [
            f"{name}:={value}: unknown arg {name}{suggestion_or_known(name, known)}"
            for name, value in self._values.items()
            if name not in known and not name.startswith("__")
        ]

    def _root(self, file: str, document: bytes | None) -> tuple[LaunchElement, Scope]:
        root = self._parse(file, self._environment.read(file) if document is None else document)
        return root, Scope(self._environment, file, self._namespace, dict(self._values))

    def _parse(self, file: str, document: bytes) -> LaunchElement:
        self.launch.files.append(file)
        root = parse(document, file)
        if root.name != "launch":
            raise root.fault(f"expected <launch>, got <{root.name}>")
        self._warn_of_attributes(root)
        if "deprecated" in root.attributes:
            self.launch.warnings.append(f"{file}: deprecated: {root.attributes['deprecated']}")
        return root

    def _read(self, element: LaunchElement, scope: Scope) -> None:
        if element.name == "master":
            self._warn(element, "<master> is obsolete and ignored")
        elif self._is_known(element, self._tags) and applies(element, scope):
            self._tags[element.name](element, scope)

    def _is_known(
        self, element: LaunchElement, known: Sequence[str] | Mapping[str, object]
    ) -> bool:
        """Return whether an element is known; warn of others."""
        if element.name not in known:
            near = suggestion(element.name, known)
            self._warn(element, f"ignoring unknown tag <{element.name}>{near}")
            return False
        self._warn_of_attributes(element)
        return True

    def _warn_of_attributes(self, element: LaunchElement) -> None:
        known = ATTRIBUTES[element.name]
        for name in element.attributes:
            if name not in (*known, "if", "unless"):
                text = f"ignoring unknown attribute {name} of <{element.name}>"
                self._warn(element, f"{text}{suggestion(name, known)}")

    def _warn(self, element: LaunchElement, text: str) -> None:
        self.launch.warnings.append(f"{element.file}:{element.line}: {text}")

    def _add_argument(self, element: LaunchElement, scope: Scope) -> None:
        name = element.attributes.get("name", "")
        default = element.attributes.get("default")
        try:
            if default is not None:
                default = Attributes(element, scope).text("default")
        except LaunchError:
            pass
        doc, has_value = element.attributes.get("doc", ""), "value" in element.attributes
        self.launch.arguments.setdefault(name, Argument(name, default, doc, has_value))

    def _declare(self, element: LaunchElement, scope: Scope) -> None:
        """Read an <arg> of a file."""
        name, value, default = _read_arg(element, scope, scope)
        if value is not None:
            if name in scope.values and not scope.passes_all:
                raise element.fault(
                    f"<arg>: cannot set {name} to {scope.values[name]!r}, since it has the fixed "
                    f"value {value!r}; write default={value!r} to allow others"
                )
            scope.values[name] = value
        elif default is not None:
            scope.values.setdefault(name, default)

    def _pass(self, element: LaunchElement, scope: Scope, included: Scope) -> None:
        """Read an <arg> of an <include>."""
        name, value, default = _read_arg(element, scope, included)
        if value is not None:
            included.values[name] = value
        elif default is not None:
            included.values.setdefault(name, default)
        elif name not in included.values:
            raise element.fault(f"<arg>: missing value of {name}")

    def _group(self, element: LaunchElement, scope: Scope) -> None:
        attributes = Attributes(element, scope)
        inner = scope.inner(_read_namespace(element, attributes))
        self._clear(element, attributes, inner)
        for child in element.children:
            self._read(child, inner)

    def _clear(self, element: LaunchElement, attributes: Attributes, inner: Scope) -> None:
        if attributes.text("clear_params") and attributes.flag("clear_params"):
            if "ns" not in element.attributes:
                raise element.fault(f"<{element.name} clear_params> requires attribute ns")
            self.launch.cleared.append(inner.namespace)

    def _machine(self, element: LaunchElement, scope: Scope) -> None:
        attributes = Attributes(element, scope)
        name = attributes.required("name")
        attributes.required("address")
        for old in _OLD_MACHINE:
            if attributes.text(old):
                raise attributes.fault(old, "not supported since ROS Fuerte; use env-loader")
        attributes.number("timeout", 10.0, positive=True)
        attributes.integer("ssh-port", 22)
        default = (attributes.text("default") or "false").lower()
        if default not in ("true", "false", "never"):
            raise attributes.fault("default", f"expected true, false or never, got {default!r}")
        if element.all("env"):
            raise element.fault("<machine>: <env> is not supported since ROS Fuerte")
        for child in element.children:
            self._is_known(child, ())
        values = {each: attributes.text(each) for each in _MACHINE if each != "default"}
        if self._machines.setdefault(name, values) != values:
            raise element.fault(f"<machine>: {name} is declared twice, with other attributes")
        if default == "true":
            self._default_machine = name

    def _check_machine(self, element: LaunchElement, machine: str) -> None:
        """Check that a node's machine is declared, and that it is this one."""
        if machine not in self._machines:
            near = suggestion_or_known(machine, list(self._machines))
            raise element.fault(f"<{element.name} machine>: unknown machine {machine}{near}")
        address = self._machines[machine]["address"] or ""
        if not self._environment.is_local(address):
            raise element.fault(
                f"<{element.name}>: cannot start nodes on machine {machine} ({address}), only on "
                "this one; launch it there with --hub and the URL of this machine's hub"
            )

    def _include(self, element: LaunchElement, scope: Scope) -> None:
        attributes = Attributes(element, scope)
        file = attributes.required("file")
        passes_all = attributes.flag("pass_all_args", False)
        inner = scope.included(file, _read_namespace(element, attributes), passes_all=passes_all)
        self._clear(element, attributes, inner)
        given = scope.inner()
        for child in _with_lower_case(element.children):
            if self._is_known(child, IN_INCLUDE) and applies(child, given):
                if child.name == "env":
                    _read_env(child, given, inner)
                else:
                    self._pass(child, given, inner)
        passed = set() if passes_all else set(inner.values)
        inner.declared = set()
        self._read_included(element, file, inner)
        unused = sorted(passed - inner.declared)
        if unused:
            near = suggestion_or_known(unused[0], sorted(inner.declared)) or "; it has none"
            raise element.fault(f"<include>: {file} has no <arg> {' or '.join(unused)}{near}")

    def _read_included(self, element: LaunchElement, file: str, scope: Scope) -> None:
        if len(self._including) >= MOST_INCLUDES:
            raise element.fault(f"<include>: nested too deeply (limit is {MOST_INCLUDES} files)")
        if len(self.launch.files) >= MOST_FILES:
            raise element.fault(f"<include>: too many files (limit is {MOST_FILES})")
        try:
            document = self._environment.read(file)
        except OSError as error:
            beside = "" if os.path.isabs(file) else f"; beside this file: $(dirname)/{file}"
            why = error.strerror or error
            raise element.fault(f"<include>: cannot read {file}: {why}{beside}") from None
        self._including.append((element.file, element.line))
        try:
            for each in self._parse(file, document).children:
                self._read(each, scope)
        except LaunchError as error:
            if error.files or (error.file, error.line) == (element.file, element.line):
                raise
            # Files that include each other appear once.
            files = tuple(dict.fromkeys(reversed(self._including)))
            raise LaunchError(error.file, error.line, error.fault, files) from None
        finally:
            self._including.pop()

    def _node(self, element: LaunchElement, scope: Scope) -> None:
        node = self._read_node(element, scope)
        other = self.launch.nodes.setdefault(node.resolved, node)
        if other is not node:
            raise element.fault(
                f"{node.resolved} is the name of another node, {other.file}:{other.line}; "
                "the later one would shut the earlier one down"
            )
        if machine := Attributes(element, scope).text("machine") or self._default_machine:
            self._on_machines.append((element, machine))  # It may be declared later.

    def _read_node(self, element: LaunchElement, scope: Scope) -> LaunchNode:
        """Read a <node> or a <test>, and set its parameters."""
        is_test = element.name == "test"
        attributes = Attributes(element, scope)
        name = _test_name(element, attributes) if is_test else attributes.required("name")
        try:
            names.check_base(name)
        except InvalidName as error:
            raise attributes.fault("name", str(error)) from None
        around = scope.inner(_read_namespace(element, attributes))
        within = around.inner(name)
        within.private = {}
        if attributes.text("clear_params") and attributes.flag("clear_params"):
            self.launch.cleared.append(within.namespace)
        own = scope.inner()
        for child in _with_lower_case(element.children):
            if self._is_known(child, IN_NODE) and applies(child, scope):
                self._read_in_node(child, scope, own, within)
        for key, value in {**scope.private, **within.private}.items():
            set_parameter(self.launch, element, within.join(key), value)
        respawn, required = attributes.flag("respawn", False), attributes.flag("required", False)
        if respawn and required:
            raise element.fault("<node> has both respawn and required; remove one")
        cwd = attributes.one_of("cwd", "node", "ROS_HOME", "ros_home")
        return LaunchNode(
            package=attributes.required("pkg").strip(),
            type=attributes.required("type").strip(),
            name=name,
            file=element.file,
            line=element.line,
            namespace=around.namespace,
            args=attributes.text("args", ""),
            screen=attributes.one_of("output", "screen", "log") == "screen",
            respawn=respawn,
            respawn_delay=attributes.number("respawn_delay", 0.0),
            required=required,
            cwd="node" if cwd == "node" else None,
            prefix=attributes.text("launch-prefix", ""),
            remaps=tuple(own.remaps.items()),
            environment=tuple(own.variables.items()),
            **(_test_attributes(attributes) if is_test else {}),
        )

    def _read_in_node(self, child: LaunchElement, scope: Scope, own: Scope, within: Scope) -> None:
        match child.name:
            case "remap":
                _read_remap(child, scope, own)
            case "env":
                _read_env(child, scope, own)
            case "param":
                read_param(child, within, self.launch, in_node=True)
            case _:
                read_rosparam(child, within, self.launch)


def _with_lower_case(elements: Sequence[LaunchElement]) -> Iterator[LaunchElement]:
    """Yield elements with their names in lower case, as roslaunch reads them in nodes."""
    return (replace(element, name=element.name.lower()) for element in elements)


def _may_apply(element: LaunchElement, scope: Scope) -> bool:
    """Return whether an element's if or unless allows it; False if they are invalid."""
    try:
        return applies(element, scope)
    except LaunchError:
        return False


def _read_arg(
    element: LaunchElement, scope: Scope, into: Scope
) -> tuple[str, str | None, str | None]:
    """Return name, value and default of an <arg> in ``scope``, and declare it in ``into``."""
    attributes = Attributes(element, scope)
    name = attributes.required("name")
    value, default = attributes.text("value"), attributes.text("default")
    attributes.text("doc")
    if value is not None and default is not None:
        raise element.fault("<arg> has both value and default; remove one")
    if name in into.declared and not into.passes_all:
        raise element.fault(f"<arg>: {name} is declared twice")
    into.declared.add(name)
    return name, value, default


def _read_namespace(element: LaunchElement, attributes: Attributes) -> str | None:
    """Return the namespace in ``ns``; None without it."""
    if "ns" not in element.attributes:
        return None
    namespace = attributes.required("ns")
    if not namespace.strip("/"):
        return namespace
    try:
        path = names.check_namespace(normalized(namespace.lstrip("/")))
    except InvalidName as error:
        raise attributes.fault("ns", str(error)) from None
    return path if namespace.startswith("/") else path[1:]


def _read_remap(element: LaunchElement, scope: Scope, into: Scope) -> None:
    attributes = Attributes(element, scope)
    found = []
    for end in ("from", "to"):
        try:
            found.append(names.check(normalized(attributes.required(end).strip())))
        except InvalidName as error:
            raise attributes.fault(end, str(error)) from None
    into.remap(*found)


def _read_env(element: LaunchElement, scope: Scope, into: Scope) -> None:
    attributes = Attributes(element, scope)
    name, value = attributes.required("name"), attributes.text("value")
    if value is None:
        raise element.fault("<env> requires attribute value")
    if "=" in name or "\0" in name + value:
        raise attributes.fault("name", f"{name!r} is not a valid name of a variable")
    into.variables[name] = value


def _test_name(element: LaunchElement, attributes: Attributes) -> str:
    for name in NOT_OF_TESTS:
        if name in element.attributes:
            raise element.fault(f"<test> has no attribute {name}; only <node> has")
    test = attributes.required("test-name")
    return attributes.text("name") or test


def _test_attributes(attributes: Attributes) -> dict[str, Any]:
    """Return the attributes of a `LaunchNode` that only a <test> has."""
    time_limit = 60.0
    if attributes.text("time-limit"):
        time_limit = attributes.number("time-limit", time_limit, positive=True)
    return {
        "is_test": True,
        "test_name": attributes.required("test-name"),
        "time_limit": time_limit,
        "retry": attributes.integer("retry", 0),
    }
