"""Coordinate frames and the transforms between them over time, as in tf2.

async with fibws.Node("robot") as node, TransformListener(node) as transforms:
    camera = await transforms.wait("map", "camera", timeout=1)
"""

from lazy_loader import attach_stub

# Each public name is loaded when it is first used: rospy's tf2_py needs no node library.
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
