#!/usr/bin/env python3
"""A client of the server: it reads descriptions, and changes parameters."""

import dynamic_reconfigure
import rospy
from dynamic_reconfigure.client import Client


def shown(value):
    if isinstance(value, dict):
        return [(key, shown(each)) for key, each in sorted(value.items())]
    if isinstance(value, list):
        return [shown(each) for each in value]
    return value


rospy.init_node("client")
print(sorted(dynamic_reconfigure.find_reconfigure_services()))
client = Client("server", timeout=30)
print("descriptions", shown(client.get_parameter_descriptions(timeout=30)))
print("groups", shown(client.get_group_descriptions(timeout=30)))
print("config", shown(client.get_configuration(timeout=30)))
for changes in (
    {"int_param": 7},
    {"int_param": "8", "double_param": "0.25"},
    {"size": "large"},
    {"size": "1"},
    {"bool_param": "no"},
    {"bool_param": 1},
    {"int_param": -5, "double_param": 5, "inner": 1e300},
    {"int_param": 13},
    {"str_param": "föö", "deepest": ""},
):
    print("changed", shown(client.update_configuration(changes)))
for changes in ({"nope": 1}, {"int_param": "seven"}):
    try:
        client.update_configuration(changes)
    except dynamic_reconfigure.DynamicReconfigureParameterException as error:
        print(type(error).__name__, error)
second = Client("server/second", timeout=30)
print("second", second.get_configuration(timeout=30)["str_param"])
try:
    second.update_configuration({"int_param": 99})
except dynamic_reconfigure.DynamicReconfigureCallbackException as error:
    print(type(error).__name__, error)
print("parameters", shown(rospy.get_param("/server")))
client.close()
try:
    Client("nobody", timeout=0.2)
except rospy.ROSException as error:
    print(type(error).__name__)
