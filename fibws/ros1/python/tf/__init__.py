"""The first version of tf, on top of tf2_ros: http://wiki.ros.org/tf.

    TransformListener ── TransformerROS ── Transformer ── tf2_ros.Buffer
    TransformBroadcaster ── tf2_ros.TransformBroadcaster
    tf.transformations    matrices, quaternions and Euler angles; it needs numpy

Frames may begin with ``/``, which tf2 refuses.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from tf2_ros import ConnectivityException, ExtrapolationException, LookupException
from tf2_ros import TransformException as Exception

from tf.broadcaster import TransformBroadcaster
from tf.listener import Transformer, TransformerROS, TransformListener

if TYPE_CHECKING:
    from tf import transformations as transformations

__all__ = [
    "ConnectivityException",
    "Exception",
    "ExtrapolationException",
    "LookupException",
    "TransformBroadcaster",
    "TransformListener",
    "Transformer",
    "TransformerROS",
]


def __getattr__(name: str) -> object:
    """Load `tf.transformations`, which needs numpy, or ``tf.msg`` when they are first used."""
    if name in ("transformations", "msg", "srv"):
        return import_module(f"tf.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
