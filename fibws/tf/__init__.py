"""Coordinate frames and the transforms between them over time, as in tf2.

buffer = Buffer()
async with fibws.Node("robot") as node, asyncio.TaskGroup() as tasks:
    tasks.create_task(TransformListener(node, buffer).run())
    ...
    camera = buffer.lookup("map", "camera").transform
"""

from fibws.tf.buffer import Buffer
from fibws.tf.listener import TransformListener
from fibws.tf.transform import Transform

__all__ = ["Buffer", "Transform", "TransformListener"]
