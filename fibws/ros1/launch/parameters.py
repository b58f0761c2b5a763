"""<param> and <rosparam>: parameters from attributes, files, commands and YAML."""

from __future__ import annotations

import math
from typing import Any

from fibws.errors import FibwsError
from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.environment import ReadYaml
from fibws.ros1.launch.model import Launch, RosparamStep
from fibws.ros1.launch.scope import PRIVATE, Scope, automatic, boolean, normalized
from fibws.ros1.launch.xml_element import Attributes, LaunchElement, substituted
from fibws.suggestions import nearest

SOURCES = ("value", "textfile", "binfile", "command")
COMMANDS = ("load", "dump", "delete")
TYPES = ("auto", "str", "string", "int", "double", "bool", "boolean", "yaml")
"""The types that <param> may name."""
MOST_BITS = 64
"""Largest integer; parameters are JSON, and clients read it into 64 bits."""


def read_param(
    element: LaunchElement, scope: Scope, launch: Launch, *, in_node: bool = False
) -> None:
    """Read a <param>; one in a node, or with a name in ~, goes to ``scope.private``."""
    attributes = Attributes(element, scope)
    name = attributes.required("name").strip()
    value = _value(element, attributes, scope)
    if in_node or name.startswith(PRIVATE):
        private = normalized(name.lstrip(PRIVATE))
        scope.private.pop(private, None)
        scope.private[private.lstrip("/")] = value
    else:
        set_parameter(launch, element, scope.join(name), value)


def read_rosparam(element: LaunchElement, scope: Scope, launch: Launch) -> None:
    """Read a <rosparam>; in a node, the scope's namespace is the node's name."""
    attributes = Attributes(element, scope)
    command = attributes.text("command") or "load"
    if command not in COMMANDS:
        raise attributes.fault("command", f"expected {' or '.join(COMMANDS)}, got {command!r}")
    namespace = attributes.text("ns", "").strip()
    name = attributes.text("param", "").strip()
    if namespace and not name.startswith(("/", PRIVATE)):
        name = f"{namespace.rstrip('/')}/{name}"
    if name.startswith(PRIVATE):
        raise element.fault(f"<rosparam>: {name} is private; move it into <node>, without ~")
    whole = scope.join(name) if name else scope.namespace
    file = attributes.text("file")
    match command:
        case "dump":
            if not file:
                raise element.fault('<rosparam command="dump"> requires attribute file')
            launch.steps.append(RosparamStep("dump", whole, file))
        case "delete":
            if file is not None:
                raise attributes.fault("file", 'not allowed with command="delete"')
            launch.steps.append(RosparamStep("delete", whole))
        case _:
            value = _loaded(element, attributes, scope, file)
            if not isinstance(value, dict) and not name:
                fault = "expected names with values; name a single value by param="
                raise element.fault(f"<rosparam>: {fault}")
            _set_leaves(launch, element, whole, value)


def set_parameter(launch: Launch, element: LaunchElement, name: str, value: Any) -> None:
    """Set a parameter, which replaces an earlier one of the same name.

    Raises:
        LaunchError: the value cannot be a parameter's.
    """
    fault = _fault(value)
    if fault:
        raise element.fault(f"<{element.name}>: {name}: {fault}")
    parts = name.split("/")
    above = ["/".join(parts[:end]) for end in range(2, len(parts))]
    values = launch.parameters
    conflicts = [(name, each) for each in above if not isinstance(values.get(each, {}), dict)]
    if name in launch.namespaces and not isinstance(value, dict):
        conflicts.append((launch.namespaces[name], name))
    for inner, outer in conflicts:
        launch.warnings.append(
            f"{element.file}:{element.line}: cannot set {inner}: {outer} is a value, "
            "not a namespace"
        )
    launch.namespaces |= dict.fromkeys(above, name)
    values[name] = value


def convert(text: str, type_: str, read_yaml: ReadYaml) -> Any:
    """Return the value of a text for a type, one of `TYPES`.

    Raises:
        ValueError: the type is unknown, or the text does not fit it.
    """
    match type_:
        case "auto":
            return automatic(text)
        case "str" | "string":
            return text
        case "int" | "double":
            try:
                return int(text) if type_ == "int" else float(text)
            except ValueError:
                raise ValueError(f"expected {type_}, got {text.strip()[:80]!r}") from None
        case "bool" | "boolean":
            return boolean(text)
        case "yaml":
            return read_yaml(text)
    near = nearest({"float": "double"}.get(type_, type_), TYPES)
    known = f"did you mean {near}?" if near else f"known are {', '.join(TYPES)}"
    raise ValueError(f"unknown type {type_!r}; {known}")


def _value(element: LaunchElement, attributes: Attributes, scope: Scope) -> Any:
    given = [source for source in SOURCES if source in element.attributes]
    if len(given) != 1:
        has = f"has {' and '.join(given)}" if given else "has no value"
        raise element.fault(f"<param> {has}; expected one of {', '.join(SOURCES)}")
    [source] = given
    type_ = attributes.text("type", "auto").strip().lower()
    text = attributes.text(source, "")
    try:
        match source:
            case "value":
                text = text.strip()
            case "textfile":
                text = scope.environment.read(text).decode()
            case "binfile":
                return scope.environment.read(text)
            case _:
                text = scope.environment.output(text)
        return convert(text, type_ or TYPES[0], scope.environment.yaml)
    except OSError as error:
        raise attributes.fault(source, f"cannot read {text}: {error.strerror or error}") from None
    except (ValueError, FibwsError) as error:
        raise attributes.fault(source, str(error)) from None


def _loaded(element: LaunchElement, attributes: Attributes, scope: Scope, file: str | None) -> Any:
    text, source = element.text, "<rosparam>"
    if file is not None:
        if not file:
            raise attributes.fault("file", "must not be empty")
        source = f"<rosparam file>: {file}"
        try:
            text = scope.environment.read(file).decode()
        except OSError as error:
            raise element.fault(f"{source}: cannot read it: {error.strerror or error}") from None
        except ValueError:
            raise element.fault(f"{source}: invalid UTF-8") from None
    if attributes.flag("subst_value", False):
        text = substituted(text, element, scope)
    try:
        value = scope.environment.yaml(text)
    except (ValueError, FibwsError) as error:
        raise element.fault(f"{source}: invalid YAML: {error}") from None
    return {} if value is None else value


def _set_leaves(launch: Launch, element: LaunchElement, name: str, value: Any) -> None:
    """Set the values in an object one by one, and keep others in that namespace."""
    if not isinstance(value, dict):
        if name == "/":
            raise element.fault("<rosparam>: the root namespace / cannot have a value")
        set_parameter(launch, element, normalized(name), value)
        return
    for key, each in value.items():
        if not isinstance(key, str):
            raise _invalid_key(element, name, key)
        inner = key if key.startswith("/") else f"{name.rstrip('/')}/{key}"
        _set_leaves(launch, element, inner, each)


def _invalid_key(element: LaunchElement, name: str, key: object) -> LaunchError:
    return element.fault(
        f"<rosparam>: {name} has the key {key!r}, which is not text in YAML; quote it: '{key}'"
    )


def _fault(value: Any) -> str | None:
    """Return why a value cannot be a parameter's; None if it can."""
    match value:
        case bool() | str() | bytes():
            return None
        case int():
            too_large = value.bit_length() > MOST_BITS
            return f"number too large (limit is {MOST_BITS} bits)" if too_large else None
        case float():
            return None if math.isfinite(value) else f"{value} is not allowed (JSON has none)"
        case list():
            return next(filter(None, map(_fault, value)), None)
        case dict():
            if not all(isinstance(key, str) for key in value):
                return "names must be text; quote numbers"
            return next(filter(None, map(_fault, value.values())), None)
        case None:
            return "null is not allowed"
    return f"{value} is a {type(value).__name__} in YAML; quote it to get text"
