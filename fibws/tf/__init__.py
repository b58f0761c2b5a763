"""Coordinate frames and the transforms between them over time, as in tf2.

buffer = Buffer()
async with fibws.Node("robot") as node, asyncio.TaskGroup() as tasks:
    tasks.create_task(TransformListener(node, buffer).run())
    ...
    camera = buffer.lookup("map", "camera").transform
"""

from lazy_loader import attach_stub

# Each public name is loaded when it is first used: rospy's tf2_py needs no node library.
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
