#!/usr/bin/env python3
"""Sets parameters that JSON has no values for."""

import datetime
from xmlrpc.client import Binary, DateTime

import rospy

rospy.init_node("param_kinds")
DATE = datetime.datetime(2020, 1, 2, 3, 4, 5)


def plain(value):
    if isinstance(value, Binary):
        return "Binary", value.data
    if isinstance(value, DateTime):
        return "DateTime", value.value
    if isinstance(value, list):
        return [plain(each) for each in value]
    if isinstance(value, dict):
        return {key: plain(value[key]) for key in sorted(value)}
    return value


def show(value):
    try:
        rospy.set_param("x", value)
    except TypeError as e:
        print("TypeError")
        return
    print(rospy.has_param("x"), repr(plain(rospy.get_param("x", "default"))))


for value in float("inf"), -float("inf"), float("nan"), -0.0, 5e-324, 1e308, 2**31 - 1, True, "":
    show(value)
show(b"")
show(b"\x00\xff")
show(Binary(b"ab"))
show(DATE)
show(DateTime(DATE))
show([float("nan"), b"a", [float("-inf")], DATE, {"b": b"c"}])
show({"a/b": 1})
show({"": 1, "c": {"d": 2}})
show({"n": {"e/f": [1]}, "o": 1})
show({"n": float("nan"), "d": {"b": b"\xfe", "i": float("inf")}, "a b": 1})
show({1, 2})
show({1: 2})
show([None])
show({"a": {"b": None}})
show(range(3))
print(rospy.get_param("x/n"), plain(rospy.get_param("x/d/b")))
print(rospy.get_param("unset", "default"), rospy.has_param("unset"))
try:
    rospy.get_param("unset")
except KeyError as e:
    print("KeyError", e)
