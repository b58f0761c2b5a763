"""Message classes like those of ROS 1's genpy, created from definitions when first used.

    finder ─> classes ─> Message, with a Member for each field ─> JSON, ROS 1's bytes, YAML

A module of this name is on the path only where a script of ROS 1 runs (see `fibws.ros1`).
"""

from lazy_loader import attach_stub

# Each public name is loaded when it is first used: times need no definitions.
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
