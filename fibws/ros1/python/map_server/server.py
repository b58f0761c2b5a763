"""map_server: publishes a map from its files.

Source: map_server of ROS Noetic, http://wiki.ros.org/map_server.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import rospy
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap, GetMapResponse, LoadMap, LoadMapResponse

from fibws.ros1.errors import MapError
from fibws.ros1.map_files import GridMap, read_map

USAGE = "usage: map_server MAP.yaml"
_RESULTS = {
    "file": LoadMapResponse.RESULT_MAP_DOES_NOT_EXIST,
    "metadata": LoadMapResponse.RESULT_INVALID_MAP_METADATA,
    "image": LoadMapResponse.RESULT_INVALID_MAP_DATA,
}


class MapServer:
    """Publishes one map at a time, latched, and serves it.

    Args:
        grid: the first map.
    """

    def __init__(self, grid: GridMap) -> None:
        self._frame = str(rospy.get_param("~frame_id", "map"))
        self._publisher = rospy.Publisher("map", OccupancyGrid, latch=True, queue_size=1)
        self._metadata = rospy.Publisher("map_metadata", MapMetaData, latch=True, queue_size=1)
        self._use(grid)
        rospy.Service("static_map", GetMap, lambda request: GetMapResponse(self._map))
        rospy.Service("change_map", LoadMap, self._change)

    def _use(self, grid: GridMap) -> None:
        self._map = _message(grid, self._frame)
        self._publisher.publish(self._map)
        self._metadata.publish(self._map.info)

    def _change(self, request: Any) -> Any:
        try:
            self._use(read_map(Path(request.map_url)))
        except MapError as error:
            rospy.logerr("change_map: %s", error)
            return LoadMapResponse(OccupancyGrid(), _RESULTS[error.part])
        return LoadMapResponse(self._map, LoadMapResponse.RESULT_SUCCESS)


def _message(grid: GridMap, frame: str) -> OccupancyGrid:
    message = OccupancyGrid()
    message.header.stamp = message.info.map_load_time = rospy.Time.now()
    message.header.frame_id = frame
    info, origin = message.info, message.info.origin
    info.resolution, info.width, info.height = grid.resolution, grid.width, grid.height
    origin.position.x, origin.position.y, yaw = grid.origin
    origin.orientation.z, origin.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    message.data = grid.cells
    return message


def main() -> None:
    """Run the program until the node ends."""
    arguments = rospy.myargv()[1:]
    if len(arguments) != 1:
        sys.exit(USAGE)
    try:
        grid = read_map(Path(arguments[0]))
    except MapError as error:
        sys.exit(f"map_server: {error}")
    rospy.init_node("map_server")
    server = MapServer(grid)
    rospy.loginfo(
        "Read a %d X %d map @ %.3f m/cell from %s",
        *(grid.width, grid.height, grid.resolution, arguments[0]),
    )
    rospy.spin()
    del server


if __name__ == "__main__":
    main()
