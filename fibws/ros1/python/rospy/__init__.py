"""The ROS client library for Python, on a hub: as programs know it that were written for ROS 1.

    script ─> client, topics, service, params, timer, log ─> core ─> background ─> fibws.Node

A module of this name is on the path only where a script of ROS 1 runs (see `fibws.ros1`).
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from genpy import Message

    from fibws.msg.std_msgs import Header
    from rospy.client import get_published_topics, init_node, myargv, on_shutdown, spin
    from rospy.core import get_node_uri, is_shutdown, signal_shutdown
    from rospy.exceptions import (
        ROSException,
        ROSInitException,
        ROSInternalException,
        ROSInterruptException,
        ROSSerializationException,
        ROSTimeMovedBackwardsException,
        TransportException,
        TransportInitError,
        TransportTerminated,
    )
    from rospy.log import (
        DEBUG,
        ERROR,
        FATAL,
        INFO,
        WARN,
        logdebug,
        logdebug_once,
        logdebug_throttle,
        logdebug_throttle_identical,
        logerr,
        logerr_once,
        logerr_throttle,
        logerr_throttle_identical,
        logfatal,
        logfatal_once,
        logfatal_throttle,
        logfatal_throttle_identical,
        loginfo,
        loginfo_once,
        loginfo_throttle,
        loginfo_throttle_identical,
        logout,
        logwarn,
        logwarn_once,
        logwarn_throttle,
        logwarn_throttle_identical,
    )
    from rospy.msg import AnyMsg
    from rospy.msproxy import MasterProxy
    from rospy.names import get_caller_id, get_name, get_namespace, remap_name, resolve_name
    from rospy.params import (
        delete_param,
        get_master,
        get_param,
        get_param_cached,
        get_param_names,
        has_param,
        search_param,
        set_param,
    )
    from rospy.rostime import Duration, Time, get_rostime, get_time, sleep
    from rospy.service import Service, ServiceException
    from rospy.service_proxy import ServiceProxy, wait_for_service
    from rospy.timer import Rate, Timer
    from rospy.topics import Publisher, SubscribeListener, Subscriber, wait_for_message

_HOMES = {
    "genpy": ("Message",),
    "std_msgs.msg": ("Header",),
    "rospy.client": (
        "get_published_topics",
        "init_node",
        "myargv",
        "on_shutdown",
        "spin",
    ),
    "rospy.core": (
        "get_node_uri",
        "is_shutdown",
        "signal_shutdown",
    ),
    "rospy.exceptions": (
        "ROSException",
        "ROSInitException",
        "ROSInternalException",
        "ROSInterruptException",
        "ROSSerializationException",
        "ROSTimeMovedBackwardsException",
        "TransportException",
        "TransportInitError",
        "TransportTerminated",
    ),
    "rospy.log": (
        "DEBUG",
        "ERROR",
        "FATAL",
        "INFO",
        "WARN",
        "logdebug",
        "logdebug_once",
        "logdebug_throttle",
        "logdebug_throttle_identical",
        "logerr",
        "logerr_once",
        "logerr_throttle",
        "logerr_throttle_identical",
        "logfatal",
        "logfatal_once",
        "logfatal_throttle",
        "logfatal_throttle_identical",
        "loginfo",
        "loginfo_once",
        "loginfo_throttle",
        "loginfo_throttle_identical",
        "logout",
        "logwarn",
        "logwarn_once",
        "logwarn_throttle",
        "logwarn_throttle_identical",
    ),
    "rospy.msg": ("AnyMsg",),
    "rospy.msproxy": ("MasterProxy",),
    "rospy.names": (
        "get_caller_id",
        "get_name",
        "get_namespace",
        "remap_name",
        "resolve_name",
    ),
    "rospy.params": (
        "delete_param",
        "get_master",
        "get_param",
        "get_param_cached",
        "get_param_names",
        "has_param",
        "search_param",
        "set_param",
    ),
    "rospy.rostime": (
        "Duration",
        "Time",
        "get_rostime",
        "get_time",
        "sleep",
    ),
    "rospy.service": (
        "Service",
        "ServiceException",
    ),
    "rospy.service_proxy": (
        "ServiceProxy",
        "wait_for_service",
    ),
    "rospy.timer": (
        "Rate",
        "Timer",
    ),
    "rospy.topics": (
        "Publisher",
        "SubscribeListener",
        "Subscriber",
        "wait_for_message",
    ),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "DEBUG",
    "ERROR",
    "FATAL",
    "INFO",
    "WARN",
    "AnyMsg",
    "Duration",
    "Header",
    "MasterProxy",
    "Message",
    "Publisher",
    "ROSException",
    "ROSInitException",
    "ROSInternalException",
    "ROSInterruptException",
    "ROSSerializationException",
    "ROSTimeMovedBackwardsException",
    "Rate",
    "Service",
    "ServiceException",
    "ServiceProxy",
    "SubscribeListener",
    "Subscriber",
    "Time",
    "Timer",
    "TransportException",
    "TransportInitError",
    "TransportTerminated",
    "delete_param",
    "get_caller_id",
    "get_master",
    "get_name",
    "get_namespace",
    "get_node_uri",
    "get_param",
    "get_param_cached",
    "get_param_names",
    "get_published_topics",
    "get_rostime",
    "get_time",
    "has_param",
    "init_node",
    "is_shutdown",
    "logdebug",
    "logdebug_once",
    "logdebug_throttle",
    "logdebug_throttle_identical",
    "logerr",
    "logerr_once",
    "logerr_throttle",
    "logerr_throttle_identical",
    "logfatal",
    "logfatal_once",
    "logfatal_throttle",
    "logfatal_throttle_identical",
    "loginfo",
    "loginfo_once",
    "loginfo_throttle",
    "loginfo_throttle_identical",
    "logout",
    "logwarn",
    "logwarn_once",
    "logwarn_throttle",
    "logwarn_throttle_identical",
    "myargv",
    "on_shutdown",
    "remap_name",
    "resolve_name",
    "search_param",
    "set_param",
    "signal_shutdown",
    "sleep",
    "spin",
    "wait_for_message",
    "wait_for_service",
]


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Load a name when it is first used: a program that only logs needs no services."""
        if name in _HOME:
            value = getattr(import_module(_HOME[name]), name)
        elif not name.startswith("_") and find_spec(f"rospy.{name}") is not None:
            value = import_module(f"rospy.{name}")
        else:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})
