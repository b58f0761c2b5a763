"""Conversion between configurations and messages.

A configuration is a `Config`: the values by name, and the tree of groups as ``groups``. In messages
values are lists by type, and groups a flat list in which each names the id of its parent.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from dynamic_reconfigure.msg import (
    BoolParameter,
    DoubleParameter,
    GroupState,
    IntParameter,
    ParamDescription,
    StrParameter,
)
from dynamic_reconfigure.msg import Config as ConfigMsg
from dynamic_reconfigure.msg import ConfigDescription as ConfigDescrMsg
from dynamic_reconfigure.msg import Group as GroupMsg

_LISTS: dict[type, tuple[str, Any]] = {
    int: ("ints", IntParameter),
    bool: ("bools", BoolParameter),
    str: ("strs", StrParameter),
    float: ("doubles", DoubleParameter),
}
"""The list of a message, and the class of its elements, by the type of a value."""


class Config(dict[str, Any]):
    """A dict whose values are attributes, too."""

    def __getattr__(self, name: str) -> Any:
        """Return a value; raises `KeyError`, as the original does."""
        if name.startswith("__"):
            raise AttributeError(name)  # What Python asks for itself, as copy and pickle do.
        return self[name]

    def __setattr__(self, name: str, value: Any) -> None:
        """Set a value."""
        self[name] = value

    def copy(self) -> Config:
        """Return a copy with the same values."""
        return Config(self)

    def __deepcopy__(self, memo: dict[int, Any]) -> Config:
        """Return a copy with copies of the values."""
        return Config((copy.deepcopy(key), copy.deepcopy(value)) for key, value in self.items())


# Of a server: its module, made from a .cfg file, and configurations.


def encode_description(descr: Any) -> ConfigDescrMsg:
    """Return the description of a module made from a .cfg file."""
    return ConfigDescrMsg(
        groups=encode_groups(None, descr.config_description),
        max=encode_config(descr.max),
        min=encode_config(descr.min),
        dflt=encode_config(descr.defaults),
    )


def encode_groups(parent: GroupMsg | None, group: Mapping[str, Any]) -> list[GroupMsg]:
    """Return a group of a module's description, followed by those in it."""
    parameters = [
        ParamDescription(
            each["name"], each["type"], each["level"], each["description"], each["edit_method"]
        )
        for each in group["parameters"]
    ]
    message = GroupMsg(group["name"], group["type"], parameters, group["parent"], group["id"])
    inner = (each for inside in group["groups"] for each in encode_groups(message, inside))
    return [message, *inner]


def encode_config(config: Mapping[str, Any], flat: bool = True) -> ConfigMsg:
    """Return a configuration as a message.

    Args:
        flat: whether groups are a tree, and not a list of groups.
    """
    message = ConfigMsg()
    for name, value in config.items():
        if type(value) in _LISTS:
            field, make = _LISTS[type(value)]
            getattr(message, field).append(make(name, value))
        elif isinstance(value, dict):
            groups = [value, *_inner_groups(value)] if flat else value
            states = [_state(group) for group in groups]
            message.groups = [*message.groups, *states] if flat else states
    return message


def _state(group: Any) -> GroupState:
    return GroupState(group["name"], group["state"], group["id"], group["parent"])


def _inner_groups(group: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """Yield the groups in a group; each behind those in it."""
    for inside in group["groups"].values():
        yield from _inner_groups(inside)
        yield inside


def initial_config(msg: ConfigMsg, description: Any = None) -> Config:
    """Return the configuration that a server starts with.

    Args:
        description: the ``config_description`` of its module, which tells the groups' states.
    """
    config = _values(msg)
    if msg.groups and description is not None:
        states = {group["id"]: group["state"] for group in _described_groups(description)}

        def made(group: Any) -> Config:
            found = group_dict(group)
            if group.id:
                found["state"] = states.get(group.id, found["state"])
            return found

        config["groups"] = _tree(msg.groups, made)
        _add_initial_values(config["groups"], description, config)
    return config


def _described_groups(group: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    for inside in group["groups"]:
        yield inside
        yield from _described_groups(inside)


def _add_initial_values(group: Any, description: Mapping[str, Any], config: Config) -> None:
    for parameter in description["parameters"]:
        group["parameters"][parameter["name"]] = config[parameter["name"]]
    by_name = {inside["name"]: inside for inside in description["groups"]}
    for inside in group["groups"].values():
        if inside["name"] in by_name:
            _add_initial_values(inside, by_name[inside["name"]], config)


# Of a client: what it receives.


def decode_description(msg: ConfigDescrMsg) -> Config:
    """Return the groups of a server as a tree, with the descriptions of their parameters."""
    least, most, defaults = (decode_config(each) for each in (msg.min, msg.max, msg.dflt))

    def made(group: Any) -> Config:
        found = group_dict(group)
        found["parameters"] = [
            {
                "name": each.name,
                "min": least[each.name],
                "max": most[each.name],
                "default": defaults[each.name],
                "type": each.type,
                "level": each.level,
                "description": each.description,
                "edit_method": each.edit_method,
            }
            for each in group.parameters
        ]
        return found

    return _tree(msg.groups, made)


def decode_config(msg: ConfigMsg, description: Any = None) -> Config:
    """Return a configuration.

    Args:
        description: of the server, as from `decode_description`, or that of its module.
    """
    config = _values(msg)
    if msg.groups and description is not None:
        config["groups"] = get_tree(msg)
        _add_values(config["groups"], description, config)
    return config


def _add_values(group: Any, description: Any, config: Config) -> None:
    """Add the values to the groups of their parameters."""
    for parameter in description["parameters"]:
        if parameter["name"] in config:
            group[parameter["name"]] = config[parameter["name"]]
    by_name = {inside["name"]: inside for inside in _children(description)}
    for inside in group["groups"].values():
        if inside["name"] in by_name:
            _add_values(inside, by_name[inside["name"]], config)


def _children(group: Any) -> Iterable[Any]:
    """Return the groups in a group: a list in modules, a dict elsewhere."""
    groups = group["groups"]
    return groups.values() if isinstance(groups, dict) else groups


def _values(msg: ConfigMsg) -> Config:
    lists = msg.bools, msg.ints, msg.strs, msg.doubles
    return Config((each.name, each.value) for values in lists for each in values)


# Trees of groups.


def group_dict(group: Any) -> Config:
    """Return a group of a message, without the groups in it."""
    return Config(
        id=group.id,
        parent=group.parent,
        name=group.name,
        type=getattr(group, "type", ""),
        state=getattr(group, "state", True),
        groups=Config(),
        parameters=Config(),
    )


def get_tree(m: Any, group: Any = None) -> Config:
    """Return the groups of a message as a tree; of another group than the first those in it."""
    tree = _tree(m.groups, group_dict, group)
    if group is None or group.id == 0:
        return tree
    inner: Config = tree["groups"]
    return inner


def _tree(groups: Iterable[Any], made: Callable[[Any], Config], root: Any = None) -> Config:
    """Return a tree of groups.

    Args:
        made: returns a group of a message without those in it.
        root: the outermost group; by default that with the id 0.
    """
    inside: dict[int, list[Any]] = {}
    for group in groups:
        if group.id == 0:
            root = group if root is None else root
        else:
            inside.setdefault(group.parent, []).append(group)
    top = made(root)
    waiting = [top]
    while waiting:
        outer = waiting.pop()
        # Taken out, so that groups that contain each other end.
        for group in inside.pop(outer["id"], ()):
            inner = outer["groups"][group.name] = made(group)
            waiting.append(inner)
    return top


def extract_params(group: Any) -> list[Any]:
    """Return the descriptions of the parameters of a group and of those in it."""
    found = list(group["parameters"])
    for inside in _children(group):
        found += extract_params(inside)
    return found


def get_parents(group: Mapping[str, Any], descriptions: Mapping[str, Any]) -> list[Any]:
    """Return the groups around a group, the outermost first."""
    parents = []
    for each in descriptions["group"]:
        if each["id"] == group["parent"]:
            parents += [*get_parents(each, descriptions), each]
    return parents
