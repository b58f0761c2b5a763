"""Converting poses: http://wiki.ros.org/tf_conversions.

posemath           between PyKDL's frames, messages, tf's tuples and matrices
transformations    the same as tf.transformations
"""

from __future__ import annotations

from importlib import import_module


def __getattr__(name: str) -> object:
    """Load a function of `tf_conversions.posemath`, or ``transformations``, when it is used."""
    if name == "transformations":
        return import_module("tf.transformations")
    if name.startswith("_"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    posemath = import_module("tf_conversions.posemath")
    return posemath if name == "posemath" else getattr(posemath, name)
