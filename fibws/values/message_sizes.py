"""Checks of the sizes that messages claim, against the bytes that are there.

A message of 100 bytes may claim a billion pixels: check it before anything is allocated for them,
or anything loops over them.
"""

from __future__ import annotations

import struct

MOST_PIXELS = 2**26
"""Most pixels of a compressed picture: it may have a thousand bytes for a billion of them."""
DEFLATE_RATIO = 1032
"""Deflate, the compression of PNG, makes at most this many bytes of one."""
_PNG = b"\x89PNG\r\n\x1a\n"
_NO_FRAME = (0xC4, 0xC8, 0xCC)
"""Markers of JPEG among those of frames that mean something else."""


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


def check_picture(data: bytes) -> None:
    """Check a compressed picture before it is decoded, by its head: PNG, JPEG or WebP.

    Of other formats the size is not known.

    Raises:
        ValueError: it has too many pixels, or too few bytes for them.
    """
    size = picture_size(data)
    if size is None:
        return
    width, height = size
    if width * height > MOST_PIXELS:
        raise ValueError(f"{width} x {height} pixels are too many (limit {MOST_PIXELS})")
    if data.startswith(_PNG) and width * height > 8 * DEFLATE_RATIO * len(data):
        raise ValueError(f"{len(data)} bytes are too few for {width} x {height} pixels")


def picture_size(data: bytes) -> tuple[int, int] | None:
    """Return width and height in the head of a PNG, JPEG or WebP picture; None if unknown."""
    try:
        if data.startswith(_PNG):
            width, height = struct.unpack_from(">II", data, 16)
            return width, height
        if data.startswith(b"\xff\xd8"):
            return _jpeg_size(data)
        if data[:4] == b"RIFF" and data[8:12] == b"WEBP":
            return _webp_size(data)
    except struct.error:
        pass
    return None


def _jpeg_size(data: bytes) -> tuple[int, int] | None:
    at = 2
    while True:
        mark, kind, length = struct.unpack_from(">BBH", data, at)
        if mark != 0xFF:
            return None
        if 0xC0 <= kind <= 0xCF and kind not in _NO_FRAME:
            height, width = struct.unpack_from(">HH", data, at + 5)
            return width, height
        # Bytes of 0xFF may come before a marker, and some markers have no length.
        alone = kind == 0x01 or 0xD0 <= kind <= 0xD8
        at += 1 if kind == 0xFF else 2 if alone else 2 + max(2, length)


def _webp_size(data: bytes) -> tuple[int, int] | None:
    kind = data[12:16]
    if kind == b"VP8X":
        return _three_bytes(data, 24) + 1, _three_bytes(data, 27) + 1
    if kind == b"VP8 ":
        width, height = struct.unpack_from("<HH", data, 26)
        return width & 0x3FFF, height & 0x3FFF
    if kind == b"VP8L":
        (bits,) = struct.unpack_from("<I", data, 21)
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    return None


def _three_bytes(data: bytes, at: int) -> int:
    low, high = struct.unpack_from("<HB", data, at)
    return int(low | high << 16)


def _check_rows(what: str, width: int, height: int, step: int, each: int, size: int) -> None:
    row = width * each
    if step < row and height > 1:
        raise ValueError(f"a row has {step} bytes, but {width} {what} of {each} bytes are {row}")
    least = step * (height - 1) + row
    if size < least:
        raise ValueError(f"{width} x {height} {what} need {least} bytes, got {size}")
