"""ROS 1's actions over topics: http://wiki.ros.org/actionlib.

    ActionServer ── ServerGoalHandle ── fibws.node.actions' Record
      └─ SimpleActionServer, which executes one goal at a time
    ActionClient ── ClientGoalHandle ── CommStateMachine ── comm_state
      └─ SimpleActionClient, which follows one goal at a time

It uses only public names of rospy.
"""

from __future__ import annotations

# Scripts that import * use these without importing them, since ROS's actionlib has them.
import threading
import time
import traceback
import weakref

import rospy
from std_msgs.msg import Header

from actionlib.action_client import (
    ActionClient,
    ClientGoalHandle,
    CommState,
    CommStateMachine,
    GoalID,
    GoalStatus,
    GoalStatusArray,
    TerminalState,
    get_name_of_constant,
)
from actionlib.action_server import ActionServer
from actionlib.exceptions import ActionException
from actionlib.goal_id_generator import GoalIDGenerator
from actionlib.server_goal_handle import ServerGoalHandle
from actionlib.simple_action_client import SimpleActionClient, SimpleGoalState
from actionlib.simple_action_server import SimpleActionServer

__all__ = [
    "ActionClient",
    "ActionException",
    "ActionServer",
    "ClientGoalHandle",
    "CommState",
    "CommStateMachine",
    "GoalID",
    "GoalIDGenerator",
    "GoalStatus",
    "GoalStatusArray",
    "Header",
    "ServerGoalHandle",
    "SimpleActionClient",
    "SimpleActionServer",
    "SimpleGoalState",
    "TerminalState",
    "get_name_of_constant",
    "rospy",
    "threading",
    "time",
    "traceback",
    "weakref",
]
