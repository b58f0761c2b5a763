"""Occupancy grids: an array of rows and columns, in which unknown cells are masked."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np
from nav_msgs.msg import MapMetaData, OccupancyGrid

from fibws.values.message_sizes import check_grid
from ros_numpy.registry import converts_from_numpy, converts_to_numpy


@converts_to_numpy(OccupancyGrid)
def occupancygrid_to_numpy(msg: OccupancyGrid) -> Any:
    """Return the masked array of a grid.

    Raises:
        ValueError: the grid does not have as many cells as its size says.
    """
    check_grid(msg.info.width, msg.info.height, len(msg.data))
    data = np.asarray(msg.data, dtype=np.int8).reshape(msg.info.height, msg.info.width)
    return np.ma.array(data, mask=data == -1, fill_value=-1)


@converts_from_numpy(OccupancyGrid)
def numpy_to_occupancy_grid(arr: Any, info: MapMetaData | None = None) -> OccupancyGrid:
    """Return the grid of an array; masked cells are unknown.

    Args:
        info: resolution and origin.

    Raises:
        ValueError: the array has not two dimensions of int8.
    """
    if np.ndim(arr) != 2 or arr.dtype != np.int8:
        raise ValueError(f"expected 2 dimensions of int8, got {np.ndim(arr)} of {arr.dtype}")
    cells = np.ma.filled(arr, -1) if isinstance(arr, np.ma.MaskedArray) else arr
    grid = OccupancyGrid(info=info or MapMetaData())
    grid.data = array("b", np.ascontiguousarray(cells).tobytes())
    grid.info.height, grid.info.width = arr.shape
    return grid
