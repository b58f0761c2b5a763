#!/usr/bin/env python3
"""Logs by Python's loggers: those that are not rospy's are not printed once there is a node."""

import io
import logging
import sys

import rospy

sys.stderr = io.StringIO()
mine = logging.getLogger("mine")
mine.warning("before the node")
rospy.init_node("python_loggers")
mine.info("info")
mine.warning("warning")
logging.info("info of the root")
logging.warning("warning of the root")
logging.getLogger("rospy").warning("warning of rospy")
logging.getLogger("rospy.part").error("error of a part of rospy")
logging.basicConfig(level=logging.DEBUG)
mine.error("after basicConfig")
logging.getLogger("rosout").info("info of rosout")
logging.getLogger("rosout.part").info("info of a part of rosout")
rospy.loginfo("by rospy")
rospy.loginfo("by a logger below", logger_name="mine")
print(logging.getLogger().getEffectiveLevel(), mine.isEnabledFor(logging.DEBUG))
try:
    1 / 0
except ZeroDivisionError:
    mine.exception("exception")
print(sys.stderr.getvalue().splitlines())
