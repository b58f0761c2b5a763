#!/usr/bin/env python3
"""A server of parameters in groups, and two in one node."""

from types import SimpleNamespace

import rospy
from dynamic_reconfigure.encoding import extract_params
from dynamic_reconfigure.server import Server

inf = float("inf")


def parameter(name, type, default, least, most, level, edit_method=""):
    return {
        "name": name,
        "type": type,
        "default": default,
        "min": least,
        "max": most,
        "level": level,
        "description": "The " + name,
        "edit_method": edit_method,
    }


def group(name, id, parent, parameters, groups, state=True, type=""):
    return {
        "name": name,
        "id": id,
        "parent": parent,
        "parameters": parameters,
        "groups": groups,
        "state": state,
        "type": type,
    }


SIZES = repr(
    {
        "enum": [
            {"name": "Small", "type": "int", "value": 0, "description": "A small one"},
            {"name": "Large", "type": "int", "value": 2, "description": "A large one"},
        ],
        "enum_description": "Sizes",
    }
)
INNER = group("Deep", 2, 1, [parameter("deepest", "str", "x", "", "", 16)], [])
DESCRIPTION = group(
    "Default",
    0,
    0,
    [
        parameter("int_param", "int", 50, 0, 100, 1),
        parameter("double_param", "double", 0.5, 0.0, 1.0, 2),
        parameter("str_param", "str", "Hello", "", "", 4),
        parameter("bool_param", "bool", True, False, True, 8),
        parameter("size", "int", 0, 0, 2, 32, SIZES),
    ],
    [
        group(
            "Second_Group",
            1,
            0,
            [parameter("inner", "double", 2.0, -inf, inf, 64)],
            [INNER],
            False,
            "collapse",
        )
    ],
)
PARAMETERS = extract_params(DESCRIPTION)
TYPE = SimpleNamespace(
    config_description=DESCRIPTION,
    min={each["name"]: each["min"] for each in PARAMETERS},
    max={each["name"]: each["max"] for each in PARAMETERS},
    defaults={each["name"]: each["default"] for each in PARAMETERS},
    level={each["name"]: each["level"] for each in PARAMETERS},
    type={each["name"]: each["type"] for each in PARAMETERS},
    all_level=127,
)


def shown(value):
    if isinstance(value, dict):
        return [(key, shown(each)) for key, each in sorted(value.items())]
    return value


def changed(config, level):
    print("level", level, shown(config), flush=True)
    if config.int_param == 13:
        config["int_param"] = 14
        config.str_param = "not 13"
    return config


def changed_second(config, level):
    print("second", level, config["int_param"], flush=True)
    return config if config["int_param"] != 99 else None


rospy.init_node("server")
if rospy.has_param("~"):
    rospy.delete_param("~")
rospy.set_param("~int_param", 1000)
rospy.set_param("~second/str_param", "set before")
first = Server(TYPE, changed)
second = Server(TYPE, changed_second, namespace="second")
print("from here", shown(first.update_configuration({"double_param": 7.0})), flush=True)
print("parameters", shown(rospy.get_param("~")), flush=True)
print("ready", flush=True)
rospy.spin()
