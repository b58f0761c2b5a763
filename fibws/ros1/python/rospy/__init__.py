"""The ROS 1 client library for Python, on top of a hub.

    script ─> client, topics, service, params, timer, log ─> core ─> background ─> fibws.Node

A module of this name is on the path only where a script of ROS 1 runs (see `fibws.ros1`).
"""

from importlib import import_module

from lazy_loader import attach_stub

_load, __dir__, __all__ = attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """Load a public name, or a module such as ``rospy.core``, when it is first used."""
    if name in __all__:
        return _load(name)
    from importlib.util import find_spec

    if not name.startswith("_") and find_spec(f"rospy.{name}") is not None:
        return import_module(f"rospy.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
