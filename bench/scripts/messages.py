"""The messages that the robots' scripts publish, for rospy and for fibws.Node alike."""

import random
import struct
from importlib import import_module

VARIANTS = 4
"""Number of different messages that a publisher sends in turn, as a camera with its buffers."""


class Messages:
    """Builds the messages of one API.

    Args:
        modules: the name of a package's module of messages, such as ``"{}.msg"``.
    """

    def __init__(self, modules):
        self._modules = modules

    def message_class(self, type_name):
        """Return the class of a type, such as "sensor_msgs/Image"."""
        package, name = type_name.split("/")
        return getattr(import_module(self._modules.format(package)), name)

    def build(self, type_name, size):
        """Return several messages of a type, each with its own random content.

        Args:
            type_name: the type.
            size: bytes of a string, an image or a point cloud; ranges of a scan; transforms.
        """
        build = BUILDERS[type_name]
        return [build(self, random.Random(seed), size) for seed in range(VARIANTS)]

    def string(self, generator, size):
        text = "".join(generator.choices("abcdefghijklmnopqrstuvwxyz", k=size - STAMP_SIZE))
        return self.message_class("std_msgs/String")(data=STAMP_SIZE * " " + text)

    def laser_scan(self, generator, size):
        return self.message_class("sensor_msgs/LaserScan")(
            header=self._header("laser"),
            angle_min=-3.0,
            angle_max=3.0,
            angle_increment=_float32(6.0 / size),
            scan_time=0.025,
            range_min=0.125,
            range_max=12.0,
            ranges=[_float32(generator.uniform(0.125, 12.0)) for _ in range(size)],
        )

    def transforms(self, generator, size):
        stamped = self.message_class("geometry_msgs/TransformStamped")
        transform = self.message_class("geometry_msgs/Transform")
        vector = self.message_class("geometry_msgs/Vector3")
        quaternion = self.message_class("geometry_msgs/Quaternion")
        transforms = [
            stamped(
                header=self._header("base_link"),
                child_frame_id=f"link_{number}",
                transform=transform(
                    translation=vector(*(generator.random() for _ in range(3))),
                    rotation=quaternion(*(generator.random() for _ in range(4))),
                ),
            )
            for number in range(size)
        ]
        return self.message_class("tf2_msgs/TFMessage")(transforms=transforms)

    def point_cloud(self, generator, size):
        field = self.message_class("sensor_msgs/PointField")
        names = enumerate(("x", "y", "z", "intensity"))
        return self.message_class("sensor_msgs/PointCloud2")(
            header=self._header("lidar"),
            height=1,
            width=size // 16,
            fields=[field(name=name, offset=4 * n, datatype=7, count=1) for n, name in names],
            point_step=16,
            row_step=size,
            data=generator.randbytes(size),
            is_dense=True,
        )

    def image(self, generator, size):
        width = WIDTHS.get(size, 1000)
        return self.message_class("sensor_msgs/Image")(
            header=self._header("camera"),
            height=size // (3 * width),
            width=width,
            encoding="rgb8",
            step=3 * width,
            data=generator.randbytes(size),
        )

    def _header(self, frame):
        return self.message_class("std_msgs/Header")(frame_id=frame)


BUILDERS = {
    "std_msgs/String": Messages.string,
    "sensor_msgs/LaserScan": Messages.laser_scan,
    "tf2_msgs/TFMessage": Messages.transforms,
    "sensor_msgs/PointCloud2": Messages.point_cloud,
    "sensor_msgs/Image": Messages.image,
}
WIDTHS = {921_600: 640, 6_220_800: 1920}
STAMP_SIZE = 20
"""Bytes of "seconds.nanoseconds" in a string."""


def set_stamp(message, now):
    """Write the time into a message: into its headers, or into the text of a string."""
    if hasattr(message, "header"):
        message.header.stamp = now
    elif hasattr(message, "transforms"):
        for transform in message.transforms:
            transform.header.stamp = now
    elif isinstance(message.data, str):
        message.data = f"{now.secs:010}.{now.nsecs:09}" + message.data[STAMP_SIZE:]


def stamp(message):
    """Return the time in a message, in nanoseconds."""
    if hasattr(message, "header"):
        time = message.header.stamp
    elif hasattr(message, "transforms"):
        time = message.transforms[0].header.stamp
    else:
        return int(message.data[:STAMP_SIZE].replace(".", ""))
    return time.secs * 1_000_000_000 + time.nsecs


def content(message):
    """Return the random content of a message."""
    if hasattr(message, "ranges"):
        return list(message.ranges)
    if hasattr(message, "transforms"):
        return [each.transform.translation.x for each in message.transforms]
    return message.data[STAMP_SIZE:]


def _float32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]
