"""<param> and <rosparam>: parameters, each by itself, in files, or written in YAML."""

from __future__ import annotations

import math
from typing import Any

from fibws.errors import FibwsError, LaunchError
from fibws.ros1.launch.attributes import Attributes, substituted
from fibws.ros1.launch.model import Launch, Step
from fibws.ros1.launch.scope import PRIVATE, Scope, name_of
from fibws.ros1.launch.tag import Tag
from fibws.ros1.launch.value import TYPES, convert

PARAM = ("name", "value", "type", "textfile", "binfile", "command")
ROSPARAM = ("command", "ns", "file", "param", "subst_value")
SOURCES = ("value", "textfile", "binfile", "command")
COMMANDS = ("load", "dump", "delete")
MOST_BITS = 64
"""Of a whole number: no hub, nor any other tool, has more room."""


def read_param(tag: Tag, scope: Scope, launch: Launch, *, in_node: bool = False) -> None:
    """Read a <param>; one in a node, or whose name begins with ~, is kept in ``scope.private``."""
    attributes = Attributes(tag, scope, PARAM)
    name = attributes.required("name").strip()
    value = _value(tag, attributes, scope)
    if in_node or name.startswith(PRIVATE):
        scope.private.pop(name_of(name.lstrip(PRIVATE)), None)
        scope.private[name_of(name.lstrip(PRIVATE)).lstrip("/")] = value
    else:
        set_parameter(launch, tag, scope.join(name), value)


def read_rosparam(tag: Tag, scope: Scope, launch: Launch) -> None:
    """Read a <rosparam>; one in a node has the node's own name as its scope's namespace."""
    attributes = Attributes(tag, scope, ROSPARAM)
    command = attributes.text("command", "load")
    if command not in COMMANDS:
        raise attributes.fault("command", f"{command!r} is none of {', '.join(COMMANDS)}")
    inner = attributes.text("ns", "").strip()
    name = attributes.text("param", "").strip()
    if inner and not name.startswith(("/", PRIVATE)):
        name = f"{inner.rstrip('/')}/{name}"
    if name.startswith(PRIVATE):
        raise tag.fault(
            f"<rosparam>: {name} is private to a node: write it within <node>, without ~"
        )
    whole = scope.join(name) if name else scope.namespace
    file = attributes.text("file")
    match command:
        case "dump":
            if not file:
                raise tag.fault('<rosparam command="dump"> has no file to write to')
            launch.steps.append(Step("dump", whole, file))
        case "delete":
            if file is not None:
                raise attributes.fault("file", 'command="delete" has no use for one')
            launch.steps.append(Step("delete", whole))
        case _:
            value = _loaded(tag, attributes, scope, file)
            if not isinstance(value, dict) and not name:
                fault = "what it has is no names with values: say by param= what it is called"
                raise tag.fault(f"<rosparam>: {fault}")
            _set_leaves(launch, tag, whole, value)


def set_parameter(launch: Launch, tag: Tag, name: str, value: Any) -> None:
    """Have a parameter set; a later one of the same name replaces an earlier one.

    Raises:
        LaunchError: the value is nothing that a parameter can be.
    """
    fault = _fault(value)
    if fault:
        raise tag.fault(f"<{tag.name}>: {name}: {fault}")
    parts = name.split("/")
    above = ["/".join(parts[:end]) for end in range(2, len(parts))]
    values = launch.parameters
    beside = [(name, each) for each in above if not isinstance(values.get(each, {}), dict)]
    if name in launch.namespaces and not isinstance(value, dict):
        beside.append((launch.namespaces[name], name))
    for inner, outer in beside:
        launch.warnings.append(
            f"{tag.file}:{tag.line}: {inner} cannot be beside {outer}, which is no namespace"
        )
    launch.namespaces |= dict.fromkeys(above, name)
    values[name] = value


def _value(tag: Tag, attributes: Attributes, scope: Scope) -> Any:
    given = [source for source in SOURCES if source in tag.attributes]
    if len(given) != 1:
        have = f"has {' and '.join(given)}" if given else "has no value"
        raise tag.fault(f"<param> {have}: give one of {', '.join(SOURCES)}")
    [source] = given
    type_ = attributes.text("type", "auto").strip().lower()
    text = attributes.text(source, "")
    try:
        match source:
            case "value":
                text = text.strip()
            case "textfile":
                text = scope.world.read(text).decode()
            case "binfile":
                return scope.world.read(text)
            case _:
                text = scope.world.output(text)
        return convert(text, type_ or TYPES[0], scope.world.yaml)
    except OSError as error:
        raise attributes.fault(source, f"cannot read {text}: {error.strerror or error}") from None
    except (ValueError, FibwsError) as error:
        raise attributes.fault(source, str(error)) from None


def _loaded(tag: Tag, attributes: Attributes, scope: Scope, file: str | None) -> Any:
    text, source = tag.text, "<rosparam>"
    if file:
        source = f"<rosparam file>: {file}"
        try:
            text = scope.world.read(file).decode()
        except OSError as error:
            raise tag.fault(f"{source}: cannot read it: {error.strerror or error}") from None
        except ValueError:
            raise tag.fault(f"{source} is no text in UTF-8") from None
    if attributes.flag("subst_value", False):
        text = substituted(text, tag, scope)
    try:
        value = scope.world.yaml(text)
    except (ValueError, FibwsError) as error:
        raise tag.fault(f"{source}: this is no YAML: {error}") from None
    return {} if value is None else value


def _set_leaves(launch: Launch, tag: Tag, name: str, value: Any) -> None:
    """Set what is in an object one by one, so that what else is in that namespace stays."""
    if not isinstance(value, dict):
        if name == "/":
            raise tag.fault("<rosparam>: / is the namespace of all: it can have no value itself")
        set_parameter(launch, tag, name_of(name), value)
        return
    for key, each in value.items():
        if not isinstance(key, str):
            raise _not_text(tag, name, key)
        _set_leaves(launch, tag, key if key.startswith("/") else f"{name.rstrip('/')}/{key}", each)


def _not_text(tag: Tag, name: str, key: object) -> LaunchError:
    fault = (
        f"{name} has the key {key!r}, which is no text to YAML: write '{key}' in quotation marks"
    )
    return tag.fault(f"<rosparam>: {fault}")


def _fault(value: Any) -> str | None:
    """What keeps a value from being a parameter's."""
    match value:
        case bool() | str() | bytes():
            return None
        case int():
            return "this number is too large" if value.bit_length() > MOST_BITS else None
        case float():
            return None if math.isfinite(value) else f"{value} is no number that JSON has"
        case list():
            return next(filter(None, map(_fault, value)), None)
        case dict():
            if not all(isinstance(key, str) for key in value):
                return "the names in it must be texts: put numbers in quotation marks"
            return next(filter(None, map(_fault, value.values())), None)
        case None:
            return "null is no value that a parameter can have"
    kind = type(value).__name__
    return f"{value} is a {kind} to YAML: put it between quotation marks to be a text"
