"""Checks of the sizes that messages claim, against the bytes that are there.

A message of 100 bytes may claim a billion pixels: check it before anything is allocated for them,
or anything loops over them.
"""

from __future__ import annotations


def check_image(width: int, height: int, step: int, pixel: int, size: int) -> None:
    """Check a sensor_msgs/Image; the last row needs no padding.

    Args:
        step: bytes from one row to the next.
        pixel: bytes of a pixel.
        size: bytes of the data.

    Raises:
        ValueError: it has no pixels, its rows overlap, or there are too few bytes.
    """
    if not width or not height:
        raise ValueError(f"the image has no pixels: {width} x {height}")
    _check_rows("pixels", width, height, step, pixel, size)


def check_cloud(width: int, height: int, row_step: int, point_step: int, size: int) -> None:
    """Check a sensor_msgs/PointCloud2, which may have no points.

    Args:
        size: bytes of the data.

    Raises:
        ValueError: its points or rows overlap, or there are too few bytes.
    """
    if width and height:
        if not point_step:
            raise ValueError(f"point_step is 0, but there are {width} x {height} points")
        _check_rows("points", width, height, row_step, point_step, size)


def check_grid(width: int, height: int, cells: int) -> None:
    """Check a nav_msgs/OccupancyGrid.

    Raises:
        ValueError: it has another number of cells than its size says.
    """
    if width * height != cells:
        raise ValueError(f"expected {width} x {height} cells in the message, got {cells}")


def _check_rows(what: str, width: int, height: int, step: int, each: int, size: int) -> None:
    row = width * each
    if step < row and height > 1:
        raise ValueError(f"a row has {step} bytes, but {width} {what} of {each} bytes are {row}")
    least = step * (height - 1) + row
    if size < least:
        raise ValueError(f"{width} x {height} {what} need {least} bytes, got {size}")
