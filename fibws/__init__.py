"""The ROS graph over WebSockets."""

from lazy_loader import attach_stub

__version__ = "0.1.0"

# Each public name is loaded when it is first used: the hub needs no node library.
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
