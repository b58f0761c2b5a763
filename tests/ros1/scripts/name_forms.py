#!/usr/bin/env python3
"""Uses names with slashes at their ends, and names that are searched."""

import rospy
from std_msgs.msg import String

rospy.init_node("name_forms")
for name in "/x/", "x//y", "~z/":
    try:
        publisher = rospy.Publisher(name, String, queue_size=1)
        print(name, publisher.name, publisher.resolved_name)
    except Exception as error:
        print(name, type(error).__name__, error)
rospy.set_param("~p", 1)
rospy.set_param("/top/of", 2)
for name in "~p", "p", "/p", "/top", "top/other", "~none", "none", "", "name_forms/p", "/top/":
    try:
        print(repr(name), rospy.search_param(name))
    except Exception as error:
        print(repr(name), type(error).__name__)
