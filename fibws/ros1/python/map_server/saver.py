"""map_saver: writes the next map of the topic ``map`` to files.

Source: map_saver of ROS Noetic, http://wiki.ros.org/map_server#map_saver.
"""

from __future__ import annotations

import math
import sys
from array import array
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import rospy
from nav_msgs.msg import OccupancyGrid

from fibws.ros1.errors import MapError
from fibws.ros1.map_files import GridMap, write_map
from fibws.values.message_sizes import check_grid

USAGE = "usage: map_saver [--occ THRESHOLD] [--free THRESHOLD] [-f NAME] [map:=TOPIC]"


class Options(NamedTuple):
    """The options of the command line."""

    name: str = "map"
    occupied: int = 65
    free: int = 25


def read_options(arguments: Sequence[str]) -> Options:
    """Return the options; end the program if they are invalid."""
    found: dict[str, Any] = {}
    words = iter(arguments)
    for word in words:
        value = next(words, None)
        if word in ("-h", "--help"):
            print(USAGE)
            sys.exit(0)
        if word not in ("-f", "--occ", "--free") or value is None:
            sys.exit(USAGE)
        if word == "-f":
            found["name"] = value
            continue
        least, most = (1, 100) if word == "--occ" else (0, 100)
        if not (value.isdecimal() and least <= int(value) <= most):
            sys.exit(f"map_saver: {word} must be {least} to {most}, got {value}")
        found["occupied" if word == "--occ" else "free"] = int(value)
    options = Options(**found)
    if options.occupied <= options.free:
        fault = f"--free must be less than --occ, got {options.free} and {options.occupied}"
        sys.exit(f"map_saver: {fault}")
    return options


def grid_of(message: Any) -> GridMap:
    """Return the map in a message.

    Raises:
        MapError: it does not have as many cells as it says.
    """
    info, origin = message.info, message.info.origin
    cells = array("b", message.data)
    try:
        check_grid(info.width, info.height, len(cells))
    except ValueError as error:
        raise MapError("image", str(error)) from None
    q = origin.orientation
    yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
    pose = (origin.position.x, origin.position.y, yaw)
    return GridMap(info.width, info.height, info.resolution, pose, cells)


def main() -> None:
    """Wait for a map, write it, and end."""
    options = read_options(rospy.myargv()[1:])
    rospy.init_node("map_saver")
    rospy.loginfo("Waiting for the map")
    message = rospy.wait_for_message("map", OccupancyGrid)
    try:
        grid = grid_of(message)
        rospy.loginfo(
            "Received a %d X %d map @ %.3f m/pix", grid.width, grid.height, grid.resolution
        )
        name = Path(options.name)
        for file in write_map(name, grid, occupied=options.occupied, free=options.free):
            rospy.loginfo("Wrote %s", file)
    except MapError as error:
        rospy.logfatal("%s", error)
        sys.exit(1)


if __name__ == "__main__":
    main()
