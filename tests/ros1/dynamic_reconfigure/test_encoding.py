"""Configurations as messages, and back."""

from __future__ import annotations

import copy
import pickle

import pytest
from dynamic_reconfigure.encoding import Config, decode_config, decode_description, encode_config
from dynamic_reconfigure.msg import Config as ConfigMsg
from dynamic_reconfigure.msg import ConfigDescription, Group, GroupState, IntParameter


def test_values_of_a_config_are_attributes() -> None:
    config = Config(size=1)
    config.name = "x"
    assert (config.size, config["name"]) == (1, "x")
    with pytest.raises(KeyError):
        _ = config.nothing
    for copied in (config.copy(), copy.deepcopy(config), pickle.loads(pickle.dumps(config))):
        assert copied == config and type(copied) is Config and copied is not config


def test_values_are_encoded_by_their_types() -> None:
    config = Config(a=1, b=True, c="text", d=0.5)
    assert decode_config(encode_config(config)) == config


def test_groups_that_contain_each_other_end() -> None:
    groups = [
        Group(name="Default"),
        Group(name="A", id=1, parent=2),
        Group(name="B", id=2, parent=1),
    ]
    tree = decode_description(ConfigDescription(groups=groups))
    assert tree["name"] == "Default" and not tree["groups"]


def test_group_that_is_its_own_parent_ends() -> None:
    message = ConfigMsg(
        ints=[IntParameter("size", 1)],
        groups=[GroupState("Default", True, 0, 0), GroupState("A", True, 1, 1)],
    )
    config = decode_config(message, {"parameters": [{"name": "size"}], "groups": {}})
    assert config["groups"]["size"] == 1
