"""The ROS graph over WebSockets."""

from lazy_loader import attach_stub

try:
    from fibws._version import __version__ as __version__  # hatch_build.py writes it
except ModuleNotFoundError:
    __version__ = "0.1.0.dev0"  # unknown: this checkout was never installed

# Each public name is loaded when it is first used: the hub needs no node library.
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
