"""tf2 for rospy: http://wiki.ros.org/tf2_ros.

BufferInterface ─┬─ Buffer ── tf2_py.BufferCore    filled by a TransformListener
                 └─ BufferClient                   asks a BufferServer, over an action
TransformBroadcaster, StaticTransformBroadcaster   send to /tf and /tf_static
"""

from __future__ import annotations

from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage
from tf2_py import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

from tf2_ros.buffer import DEFAULT_CAN_TRANSFORM_POLLING_SCALE, Buffer
from tf2_ros.buffer_interface import (
    BufferInterface,
    ConvertRegistration,
    NotImplementedException,
    Stamped,
    TransformRegistration,
    TypeException,
    convert,
)
from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster
from tf2_ros.transform_broadcaster import TransformBroadcaster
from tf2_ros.transform_listener import TransformListener

__all__ = [
    "DEFAULT_CAN_TRANSFORM_POLLING_SCALE",
    "Buffer",
    "BufferClient",
    "BufferCore",
    "BufferInterface",
    "BufferServer",
    "ConnectivityException",
    "ConvertRegistration",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "NotImplementedException",
    "Stamped",
    "StaticTransformBroadcaster",
    "TFMessage",
    "TimeoutException",
    "TransformBroadcaster",
    "TransformException",
    "TransformListener",
    "TransformRegistration",
    "TransformStamped",
    "TypeException",
    "convert",
]


def __getattr__(name: str) -> object:
    """Load `BufferClient` or `BufferServer`, which need actionlib, when they are first used."""
    if name == "BufferClient":
        from tf2_ros.buffer_client import BufferClient

        return BufferClient
    if name == "BufferServer":
        from tf2_ros.buffer_server import BufferServer

        return BufferServer
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
